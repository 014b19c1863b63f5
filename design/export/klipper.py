"""Klipper: a SET_INPUT_SHAPER line for each row and axis.

A line names one axis, so that the other keeps what it has: axes have other modes. Parameters that a
line does not name stay [3]_.

Klipper takes no impulses, it takes the name of a shaper, a frequency and a damping ratio, and
computes the impulses itself [1]_ [2]_. So only its own six kinds can be handed over, designed for a
drive that follows its command; anything else is refused by name. Its impulses are computed here
from the numbers of each line, by `design.export.klipper_shapers`:

- ``zv``, ``zvd`` and ``mzv`` must be those of the row, to rounding;
- ``ei`` and the two with more humps are fits in Klipper. The tolerance must hold over the whole
  band that the design claims, by the rule of recommendations: to `PLAYED_WITHIN`. The tolerance of
  ``ei`` is lowered until it holds to the last digit, ``ei(v_tol=...)``; what does not hold is
  refused, with the figure. Zeros within the band are not asked for: a remark says what is left.

A name without brackets is read by every Klipper and by Kalico, which compute humps in other ways:
it is written where all keep the claims. Brackets, even empty ones, are read by Klipper from
v0.13.0-631 of 27 April 2026 on; others refuse the line. Up to v0.13.0-641 SET_INPUT_SHAPER did not
take over a frequency then [4]_.

References
----------
.. [1] Klipper, docs/G-Codes.md, "SET_INPUT_SHAPER", and docs/Config_Reference.md,
   "[input_shaper]".
.. [2] Klipper, klippy/extras/shaper_defs.py: INPUT_SHAPERS and init_shaper.
.. [3] Klipper, klippy/extras/input_shaper.py, cmd_SET_INPUT_SHAPER: SHAPER_TYPE_X counts where no
   SHAPER_TYPE is given.
.. [4] Klipper, commit 77d5d942e of 4 May 2026, "Fix shaper_freq not updated by SET_INPUT_SHAPER".
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import cast

import numpy as np

from design.analysis.certificate import Claim, certify_modes
from design.claims import Promise
from design.errors import InvalidInputError
from design.export.firmware import firmware_lines, require_positive_row
from design.export.kind import Export
from design.export.klipper_shapers import (
    MAX_DAMPING_RATIOS,
    MAX_IMPULSES,
    USUAL_TOLERANCE,
    klipper_impulses,
    older_klipper_impulses,
    rounding_of_mzv,
)
from design.model.actuators.ideal import Ideal
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.recommendations.firmware import PLAYED_WITHIN
from design.shapers.ei import ToleranceOptions
from design.shapers.positive import MzvOptions
from design.tables.columns import require_times, varied_paths
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

AXES = "XY"
"""Those that are shaped."""

BRACKETS = "brackets behind a shaper's name need Klipper v0.13.0-642, of 4 May 2026, or later"
"""A remark beside them."""

SAME = 1e-9
"""Impulses that differ by less are the same, as a share of their duration and of 1 [-]."""

TOLERANCE_DECIMALS = 6
"""Klipper reads digits and a point in brackets, no exponent."""

MIN_TOLERANCE = 10.0**-TOLERANCE_DECIMALS

ROUNDING = 1e-6
"""Of a tolerance over the least one: 0.29 over 1e-6 is 289999.99999999994 [-]."""

LOWERINGS = 12
"""More often the tolerance of ``ei`` is not lowered: where the fit serves, four times do."""


def check_klipper(head: TableHead) -> None:
    """Raise InvalidInputError unless Klipper computes the shaper."""
    subject = subject_of(head)
    if subject.kind.name not in NAMES:
        raise InvalidInputError(
            "shaper.kind",
            subject.kind.name,
            f"one of Klipper's own, {', '.join(NAMES)}: it takes no impulses",
            code="not_klipper_shaper",
        )
    if not isinstance(subject.actuator, Ideal):
        raise InvalidInputError(
            "actuator.kind",
            subject.actuator.kind,
            "ideal for Klipper: its shapers know no drive",
            code="klipper_knows_no_actuator",
        )
    if subject.grid is not None:
        raise InvalidInputError(
            "shaper.sample_time_s",
            subject.grid.sample_time_s,
            "left out for Klipper: it computes its own impulses, which lie between samples",
            code="klipper_not_on_samples",
        )
    if isinstance(subject.options, MzvOptions) and subject.options.n > MAX_IMPULSES:
        raise InvalidInputError(
            "shaper.n",
            subject.options.n,
            f"at most {MAX_IMPULSES} for Klipper",
            code="too_many_for_klipper",
        )
    require_times(head)


def write_klipper(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as lines for Klipper, one for each axis.

    Parameters
    ----------
    head, runs
        The table, its runs in order.

    Returns
    -------
    iterator of bytes
        Pieces of the file; a row that is refused is found as its piece is asked for.

    Raises
    ------
    InvalidInputError
        If Klipper would refuse the line of a row, or play other impulses than those of the row.
    """
    subject = subject_of(head)
    paths = varied_paths(head)

    def commands(rows: Rows, index: int) -> list[str]:
        plant, _, options = subject.at(paths, rows.fields[index].tolist())
        row = Subject(plant=plant, actuator=Ideal(), kind=subject.kind, options=options)
        shaped = require_positive_row(head, rows, index, "Klipper")
        line = klipper_line(row, shaped, f"row {rows.first + index}")
        return [*(f"; {remark}" for remark in line.remarks), *line.commands]

    remarks = [
        "take the line of your row and of your axis, X or Y: each axis has its own mode;",
        "frequencies in Hz; to keep a line, write its parameters in lower case into the section",
        "[input_shaper] of printer.cfg, as shaper_type_x: ...",
        f"{BRACKETS}: others refuse them",
    ]
    return firmware_lines(head, runs, remarks, commands)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class KlipperLine:
    """A shaper as Klipper takes it."""

    shaper: str  # Its name, with its parameters in brackets
    frequency_hz: float
    damping_ratio: float
    remarks: list[str]  # What its fit leaves
    played: Impulses  # What Klipper of 2026 plays
    without_brackets: tuple[Impulses, ...] = ()  # What versions play by the name alone

    @property
    def commands(self) -> tuple[str, ...]:
        """The commands that set it, one for each axis."""
        return tuple(
            f"SET_INPUT_SHAPER SHAPER_TYPE_{axis}={self.shaper} "
            f"SHAPER_FREQ_{axis}={self.frequency_hz!r} DAMPING_RATIO_{axis}={self.damping_ratio!r}"
            for axis in AXES
        )


def klipper_line(
    row: Subject, shaped: Impulses, where: str, *, keeps_claims: bool = True
) -> KlipperLine:
    """Return a shaper as Klipper takes it.

    Parameters
    ----------
    row, shaped
        What was designed, for an ideal actuator, and its impulses.
    where
        Whose it is, for a refusal.
    keeps_claims
        Whether a fit that breaks what the design claims is refused; else it is taken as it is, for
        a caller who measures the residual.

    Returns
    -------
    KlipperLine
        Its parameters, and what is played.

    Raises
    ------
    InvalidInputError
        If Klipper would refuse it, or play others, or break what it claims.
    """
    name, mode = NAMES[row.kind.name], row.plant.modes[0]
    if mode.damping_ratio > MAX_DAMPING_RATIOS[name]:
        raise InvalidInputError(
            f"damping_ratio of {where}",
            mode.damping_ratio,
            f"at most {MAX_DAMPING_RATIOS[name]} for Klipper's {name}",
            code="too_damped_for_klipper",
        )
    alone: tuple[Impulses, ...] = ()
    if isinstance(row.options, ToleranceOptions):
        shaper, remarks, played = _fit(row, name, shaped, where, keeps_claims=keeps_claims)
        if "(" in shaper:
            alone = _played_by_name_alone(name, mode)
    else:
        shaper, remarks, played = _exact(name, mode, row.options, shaped, where), [], shaped
    return KlipperLine(
        shaper=shaper,
        frequency_hz=_frequency_hz(mode),
        damping_ratio=mode.damping_ratio,
        remarks=remarks,
        played=played,
        without_brackets=alone,
    )


def _played_by_name_alone(name: str, mode: Mode) -> tuple[Impulses, ...]:
    """Return what each version plays by a name without brackets; none where one plays rubbish."""
    hertz, damping = _frequency_hz(mode), mode.damping_ratio
    if name == "3hump_ei" and damping > 0:  # the missing comma
        return ()
    alone = klipper_impulses(name, hertz, damping)
    return alone, older_klipper_impulses(name, hertz, damping)


def _frequency_hz(mode: Mode) -> float:
    return mode.natural_frequency_rad_s / (2 * math.pi)


def _exact(name: str, mode: Mode, options: object, shaped: Impulses, where: str) -> str:
    """Return the shaper as Klipper writes it, whose impulses are those of the row."""
    hertz, damping = _frequency_hz(mode), mode.damping_ratio
    if isinstance(options, MzvOptions) and options != MzvOptions():
        n, t = options.n, options.duration_periods
        shaper = f"mzv(n={n},t={t!r})"
        rounding = rounding_of_mzv(n, t)
        if not rounding <= SAME:
            raise InvalidInputError(
                f"t of {where}",
                t,
                f"shorter for Klipper, whose equations of {n} impulses are too near singular: "
                f"rounding moves its heights by up to {rounding:.1g}, at most {SAME:g} is the same",
                code="klipper_near_singular",
            )
        played = klipper_impulses(name, hertz, damping, impulses=n, periods=t)
    else:
        shaper = name
        played = klipper_impulses(name, hertz, damping)
    if _same(shaped, played):
        return shaper
    raise InvalidInputError(
        f"impulses of {where}",
        [shaped.times_s.tolist(), shaped.amplitudes.tolist()],
        f"those that Klipper computes for {shaper}, times_s {played.times_s.tolist()} and "
        f"amplitudes {played.amplitudes.tolist()}",
        code="klipper_computes_others",
    )


def _round_down(tolerance: float) -> float:
    """Return a tolerance that is written in full with `TOLERANCE_DECIMALS`."""
    steps = math.floor(tolerance / MIN_TOLERANCE + ROUNDING)
    return float(f"{steps * MIN_TOLERANCE:.{TOLERANCE_DECIMALS}f}")


def _line_read_by_most(row: Subject, name: str, told: float, claims: tuple[Claim, ...]) -> str:
    """Return the shaper as Klipper writes it, plainly where older ones keep the claims too."""
    mode = row.plant.modes[0]
    hertz, damping = _frequency_hz(mode), mode.damping_ratio
    text = f"{told:.{TOLERANCE_DECIMALS}f}"
    plain = {
        "ei": told == USUAL_TOLERANCE,
        "2hump_ei": True,
        "3hump_ei": damping == 0,  # else the missing comma matters
    }
    older = _measure_claims(older_klipper_impulses(name, hertz, damping), row, claims)
    if plain[name] and all(map(_is_kept, older)):
        return name
    return f"{name}(v_tol={text})" if name == "ei" else f"{name}()"


def _same(one: Impulses, other: Impulses) -> bool:
    if one.times_s.size != other.times_s.size:
        return False
    late = (one.times_s - one.times_s[0]) - (other.times_s - other.times_s[0])
    high = one.amplitudes - other.amplitudes
    return bool(np.abs(late).max() <= SAME * one.duration_s and np.abs(high).max() <= SAME)


def _fit(
    row: Subject, name: str, shaped: Impulses, where: str, *, keeps_claims: bool
) -> tuple[str, list[str], Impulses]:
    """Return the shaper as Klipper writes it, remarks, and impulses that keep what is claimed."""
    mode = row.plant.modes[0]
    hertz, damping = _frequency_hz(mode), mode.damping_ratio
    made = design(row.plant, row.actuator, row.kind, row.options)
    if not _same(shaped, made.impulses):
        raise InvalidInputError(
            f"impulses of {where}",
            [shaped.times_s.tolist(), shaped.amplitudes.tolist()],
            f"those of {row.kind.name} in continuous time, which Klipper fits",
            code="not_continuous_time",
        )
    claims = made.certificate.claims
    told = _round_down(cast(ToleranceOptions, row.options).tolerance)  # of every ei kind
    judged: tuple[Claim, ...] = ()
    played = shaped
    for _ in range(LOWERINGS):
        played = klipper_impulses(name, hertz, damping, tolerance=told)
        judged = _measure_claims(played, row, claims)
        if all(claim.holds if name == "ei" else _is_kept(claim) for claim in judged):
            return _line_read_by_most(row, name, told, claims), _remark_on_fit(judged), played
        # The residual of Klipper's fit is a little above its tolerance: a smaller one mends that.
        worst = max(claim.value / claim.limit for claim in judged)
        told = _round_down(min(told / worst, told - MIN_TOLERANCE))
        if name != "ei" or told < MIN_TOLERANCE:
            break
    if not keeps_claims and name != "ei":
        return f"{name}()", _remark_on_fit(judged), played
    broken = max(judged, key=lambda claim: claim.value / claim.limit)
    place = _where(broken).replace("of it", "of the frequency")
    raise InvalidInputError(
        f"impulses of {where}",
        f"{100 * broken.value:.4g} %",
        f"such that Klipper's {name} keeps what {row.kind.name} claims, at most "
        f"{100 * broken.limit:.4g} % {place} and 1 % of that for its digits; recommend with "
        "firmware klipper goes by the band that you ask for",
        code="klipper_breaks_claim",
    )


def _is_kept(claim: Claim) -> bool:
    return claim.value <= PLAYED_WITHIN * claim.limit


def _measure_claims(played: Impulses, row: Subject, claims: tuple[Claim, ...]) -> tuple[Claim, ...]:
    """Return what impulses leave where the design claims something: a zero as the tolerance."""
    tolerance = cast(ToleranceOptions, row.options).tolerance
    promises = tuple(
        Promise(
            quantity=claim.quantity,
            limit=tolerance if claim.is_zero else claim.limit,
            mode=claim.mode,
            band=claim.band,
        )
        for claim in claims
    )
    return certify_modes(played, row.plant.modes, row.actuator, promises).claims


def _remark_on_fit(judged: tuple[Claim, ...]) -> list[str]:
    return [f"Klipper's fit leaves {', '.join(_percent(claim) for claim in judged)}"]


def _percent(claim: Claim) -> str:
    most = "" if claim.band is None else "at most "
    return f"{100 * claim.value:.4g} % {most}{_where(claim)}"


def _where(claim: Claim) -> str:
    if claim.band is None:
        return "at the frequency of the row"
    return f"from {claim.band[0]:.4g} to {claim.band[1]:.4g} of it"


EXPORT = Export(
    name="klipper",
    media_type="text/plain; charset=utf-8",
    suffix=".gcode",
    checks=check_klipper,
    write=write_klipper,
)
