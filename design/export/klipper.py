"""Klipper: a SET_INPUT_SHAPER line for each row.

Klipper takes no impulses, it takes the name of a shaper, a frequency and a damping ratio, and
computes the impulses itself [1]_ [2]_. So only its own six kinds can be handed over, designed for a
drive that follows its command; anything else is refused by name. Its impulses are computed here
from the numbers of each line, by `design.export.klipper_shapers`:

- ``zv``, ``zvd`` and ``mzv`` must be those of the row, to rounding;
- ``ei`` and the two with more humps are fits in Klipper. What these leave is judged as a design is:
  the tolerance must hold over the whole band that the design claims, and where the design claims
  zero no more than `READ_AS_ZERO` may be left. The tolerance of ``ei`` is lowered until it does,
  ``ei(v_tol=...)``; what does not is refused, with the figure.

A name without brackets is read by every Klipper and by Kalico, which compute humps in other ways:
it is written where all keep the claims. Brackets, even empty ones, are read by Klipper as of 31
March 2026 alone; others refuse the line.

References
----------
.. [1] Klipper, docs/G-Codes.md, "SET_INPUT_SHAPER", and docs/Config_Reference.md,
   "[input_shaper]".
.. [2] Klipper, klippy/extras/shaper_defs.py: INPUT_SHAPERS and init_shaper.
"""

import math
from collections.abc import Iterable, Iterator

import numpy as np

from design.actuators import Ideal
from design.analysis.certificate import Claim, certify_modes
from design.errors import InvalidInputError
from design.export.firmware import firmware_lines, require_positive_row
from design.export.kind import Export
from design.export.klipper_shapers import (
    LARGEST_DAMPING_RATIOS,
    MOST_IMPULSES,
    USUAL_TOLERANCE,
    klipper_impulses,
    older_klipper_impulses,
)
from design.impulses import Impulses
from design.pipeline import design
from design.plants import Mode
from design.shapers.ei import ToleranceOptions
from design.shapers.positive import MzvOptions
from design.shapers.problem import Promise
from design.tables.columns import names_of, require_times
from design.tables.rows import Rows, Subject, TableHead, subject_of

NAMES = {
    "zv": "zv",
    "mzv": "mzv",
    "zvd": "zvd",
    "ei": "ei",
    "two_hump_ei": "2hump_ei",
    "three_hump_ei": "3hump_ei",
}
"""Klipper's names of the kinds that it computes."""

SAME = 1e-9
"""Impulses that differ by less are the same, as a share of their duration and of 1 [-]."""

READ_AS_ZERO = 1e-3
"""What a fit may leave where the design leaves nothing: its coefficients have five digits [-]."""

TOLERANCE_DECIMALS = 6
"""Klipper reads digits and a point in brackets, no exponent."""

LOWERINGS = 12
"""More often the tolerance of ``ei`` is not lowered: where the fit serves, four times do."""


def check_klipper(head: TableHead) -> None:
    """Raise InvalidInputError unless Klipper has the kind of shaper."""
    subject = subject_of(head)
    if subject.kind.name not in NAMES:
        raise InvalidInputError(
            "shaper.kind",
            subject.kind.name,
            f"one of Klipper's own, {', '.join(NAMES)}: it takes no impulses",
        )
    if not isinstance(subject.actuator, Ideal):
        raise InvalidInputError(
            "actuator.kind", subject.actuator.kind, "ideal for Klipper: its shapers know no drive"
        )
    if isinstance(subject.options, MzvOptions) and subject.options.n > MOST_IMPULSES:
        raise InvalidInputError(
            "shaper.n", subject.options.n, f"at most {MOST_IMPULSES} for Klipper"
        )
    require_times(head)


def write_klipper(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as lines for Klipper, both axes alike.

    Raises
    ------
    InvalidInputError
        If Klipper would refuse the line of a row, or play other impulses than those of the row.
    """
    subject = subject_of(head)
    paths = [name.split(".") for name in names_of(head, "field")]

    def commands(rows: Rows, index: int) -> list[str]:
        where = f"row {rows.first + index}"
        plant, _, options = subject.at(paths, rows.fields[index].tolist())
        name, mode = NAMES[subject.kind.name], plant.modes[0]
        if mode.damping_ratio > LARGEST_DAMPING_RATIOS[name]:
            raise InvalidInputError(
                f"damping_ratio of {where}",
                mode.damping_ratio,
                f"at most {LARGEST_DAMPING_RATIOS[name]} for Klipper's {name}",
            )
        shaped = require_positive_row(head, rows, index, "Klipper")
        if isinstance(options, ToleranceOptions):
            row = Subject(plant=plant, actuator=Ideal(), kind=subject.kind, options=options)
            shaper, remarks = _fitted(row, name, where)
        else:
            shaper, remarks = _exact(name, mode, options, shaped, where), []
        frequency, damping = repr(_frequency_hz(mode)), repr(mode.damping_ratio)
        line = (
            f"SET_INPUT_SHAPER SHAPER_TYPE={shaper} SHAPER_FREQ_X={frequency} "
            f"SHAPER_FREQ_Y={frequency} DAMPING_RATIO_X={damping} DAMPING_RATIO_Y={damping}"
        )
        return [*(f"; {remark}" for remark in remarks), line]

    remarks = [
        "take the line of your row, frequencies in Hz; to keep it, write its parameters in lower",
        "case into the section [input_shaper] of printer.cfg, as shaper_type: ...",
        "brackets behind a shaper's name need Klipper as of 31 March 2026, others refuse them",
    ]
    return firmware_lines(head, runs, remarks, commands)


def _frequency_hz(mode: Mode) -> float:
    return mode.natural_frequency_rad_s / (2 * math.pi)


def _exact(name: str, mode: Mode, options: object, shaped: Impulses, where: str) -> str:
    """Return the shaper as Klipper writes it, whose impulses are those of the row."""
    hertz, damping = _frequency_hz(mode), mode.damping_ratio
    if isinstance(options, MzvOptions) and options != MzvOptions():
        n, t = options.n, options.duration_periods
        shaper = f"mzv(n={n},t={t!r})"
        played = klipper_impulses(name, hertz, damping, impulses=n, periods=t)
    else:
        shaper = name
        played = klipper_impulses(name, hertz, damping)
    if played.times_s.size == shaped.times_s.size:
        late = float(np.abs(played.times_s - (shaped.times_s - shaped.times_s[0])).max())
        high = float(np.abs(played.amplitudes - shaped.amplitudes).max())
        if late <= SAME * shaped.duration_s and high <= SAME:
            return shaper
    raise InvalidInputError(
        f"impulses of {where}",
        [shaped.times_s.tolist(), shaped.amplitudes.tolist()],
        f"those that Klipper computes for {shaper}, times_s {played.times_s.tolist()} and "
        f"amplitudes {played.amplitudes.tolist()}",
    )


def _fitted(row: Subject, name: str, where: str) -> tuple[str, list[str]]:
    """Return the shaper as Klipper writes it, whose impulses keep what is claimed, and remarks."""
    mode, tolerance = row.plant.modes[0], row.options.tolerance
    hertz, damping = _frequency_hz(mode), mode.damping_ratio
    claims = design(row.plant, row.actuator, row.kind, row.options).certificate.claims
    older = older_klipper_impulses(name, hertz, damping)
    told = tolerance
    for _ in range(LOWERINGS):
        new = klipper_impulses(name, hertz, damping, tolerance=told)
        judged = _judged(new, row, claims)
        if all(claim.holds for claim in judged):
            anywhere = (name != "3hump_ei" or damping == 0) and told == USUAL_TOLERANCE
            if name == "2hump_ei":
                anywhere = True
            if anywhere and all(claim.holds for claim in _judged(older, row, claims)):
                return name, _told(judged)
            brackets = f"v_tol={told:.{TOLERANCE_DECIMALS}f}" if name == "ei" else ""
            return f"{name}({brackets})", _told(judged)
        worst = max(claim.value / claim.limit for claim in judged)
        if name != "ei":
            break
        # Klipper's fit leaves a little more than it is told to: told less, it leaves the tolerance.
        lower = math.floor(told / worst * 10**TOLERANCE_DECIMALS) / 10**TOLERANCE_DECIMALS
        told = min(lower, told - 10**-TOLERANCE_DECIMALS)
        if told <= 0:
            break
    broken = [claim for claim in judged if not claim.holds]
    raise InvalidInputError(
        f"impulses of {where}",
        ", ".join(_percent(claim) for claim in broken),
        f"such that Klipper's {name} keeps what {row.kind.name} claims: "
        + ", ".join(f"at most {100 * claim.limit:.4g} %" for claim in broken),
    )


def _judged(played: Impulses, row: Subject, claims: tuple[Claim, ...]) -> tuple[Claim, ...]:
    """Return what impulses leave where the design claims something."""
    promises = tuple(
        Promise(
            quantity=claim.quantity,
            limit=READ_AS_ZERO if claim.is_zero else claim.limit,
            mode=claim.mode,
            band=claim.band,
        )
        for claim in claims
    )
    return certify_modes(played, row.plant.modes, row.actuator, promises).claims


def _told(judged: tuple[Claim, ...]) -> list[str]:
    return [f"Klipper's fit leaves {', '.join(_percent(claim) for claim in judged)}"]


def _percent(claim: Claim) -> str:
    where = "at the frequency of the row"
    if claim.band is not None:
        where = f"at most from {claim.band[0]:.4g} to {claim.band[1]:.4g} of it"
    return f"{100 * claim.value:.4g} % {where}"


KLIPPER = Export(
    name="klipper",
    media_type="text/plain; charset=utf-8",
    suffix=".gcode",
    checks=check_klipper,
    write=write_klipper,
)
