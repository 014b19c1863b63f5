"""RepRapFirmware: an M593 P"custom" line for each row, for positive shapers.

``H`` and ``T`` changed their meaning with version 3.6 [1]_ [2]_:

- from 3.6 on, ``H`` is the individual amplitude of each impulse but the last, which gets what is
  left of 1, and ``T`` the delay of each impulse but the first, in seconds, strictly increasing;
- from 3.4 to 3.5, ``H`` is the cumulative amplitude of each impulse but the last, and ``T`` the
  duration of each of those.

Both lines are written, the older one in a comment. Firmware of either age holds four numbers of
each, hence five impulses. It holds them in single precision, and 3.6 holds delays as whole counts
of a step clock. What the impulses leave as it holds them stands with each row; a row of which they
leave `ROUNDED_AWAY` more than the row itself does is refused.

References
----------
.. [1] Duet3D, G-code dictionary, "M593: Configure Input Shaping", sections "RepRapFirmware 3.6 and
   later" and "RepRapFirmware 3.3 to 3.5".
.. [2] Duet3D/RepRapFirmware, src/Movement/AxisShaper.cpp, AxisShaper::Configure, case custom;
   AxisShaper.h, MaxImpulses = 5 (before: MaxExtraImpulses = 4).
"""

from collections.abc import Iterable, Iterator
from itertools import accumulate, pairwise

import numpy as np

from design.analysis.residual import residual_vibration
from design.errors import InvalidInputError
from design.export.firmware import firmware_lines, require_positive_row, require_positive_shaper
from design.export.kind import Export
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.registry import Plant
from design.tables.columns import require_times, varied_paths
from design.tables.rows import Rows, TableHead, subject_of

MAX_IMPULSES = 5
"""``MaxImpulses`` of AxisShaper.h."""

DECIMALS = 9
"""The firmware reads single precision: seven digits of a time of 10 ms."""

CLOCK_HZ = 750_000
"""Slowest step clock of the boards (StepTimer.h, StepClockRate) [Hz]."""

MIN_GAP_S = 2e-6
"""Delays must strictly increase, as counts of that clock [s]."""

ROUNDED_AWAY = 1e-3
"""What rounding may add to a residual, a tenth of a percent of an unshaped step: the clock alone
adds so much for modes above a kilohertz [-]."""


def check_reprap(head: TableHead) -> None:
    """Raise InvalidInputError unless RepRapFirmware takes the impulses."""
    require_positive_shaper(head, "RepRapFirmware")
    if not 1 < head.impulses <= MAX_IMPULSES:
        raise InvalidInputError(
            "impulses",
            head.impulses,
            f"2 to {MAX_IMPULSES} for RepRapFirmware",
            code="wrong_count_for_reprap",
        )
    require_times(head)


def write_reprap(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as lines for RepRapFirmware.

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
        If the firmware cannot take the impulses of a row, or rounds them too far.
    """
    subject = subject_of(head)
    paths = varied_paths(head)

    def commands(rows: Rows, index: int) -> list[str]:
        shaped = require_positive_row(head, rows, index, "RepRapFirmware")
        plant, actuator, _ = subject.at(paths, rows.fields[index].tolist())
        return reprap_lines(shaped, plant, actuator, f"row {rows.first + index}")[0]

    remarks = [
        'take the line of your row; M593 P"custom" as of RepRapFirmware 3.6, below it in a comment',
        "the line for 3.4 to 3.5, which reads the same letters in another way",
    ]
    return firmware_lines(head, runs, remarks, commands)


def reprap_lines(
    shaped: Impulses, plant: Plant, actuator: Actuator, where: str
) -> tuple[list[str], Impulses]:
    """Return the lines for a shaper, and what the firmware plays then.

    Parameters
    ----------
    shaped
        The shaper, of impulses above 0 that add up to 1.
    plant, actuator
        What it was designed for.
    where
        Whose it is, for a refusal.

    Returns
    -------
    list of str
        The line, between its residual and the line of older firmware, both as comments.
    Impulses
        What firmware 3.6 plays.

    Raises
    ------
    InvalidInputError
        If the firmware cannot take so many impulses, or rounds them too far.
    """
    times, amplitudes = shaped.times_s.tolist(), shaped.amplitudes.tolist()
    if not 1 < len(times) <= MAX_IMPULSES:
        raise InvalidInputError(
            "impulses",
            len(times),
            f"2 to {MAX_IMPULSES} for RepRapFirmware",
            code="wrong_count_for_reprap",
        )
    delays = [time - times[0] for time in times[1:]]
    gaps = [after - before for before, after in pairwise(times)]
    if min(gaps) < MIN_GAP_S:
        raise InvalidInputError(
            f"times_s of {where}",
            times,
            f"{MIN_GAP_S:g} s or more apart for RepRapFirmware",
            code="gap_too_short_for_reprap",
        )
    held = held_impulses(amplitudes[:-1], delays)
    left, played = (
        max(residual_vibration(one, mode, actuator) for mode in plant.modes)
        for one in (shaped, held)
    )
    if not played <= left + ROUNDED_AWAY:
        raise InvalidInputError(
            f"times_s of {where}",
            times,
            f"such that the residual in RepRapFirmware, which counts {CLOCK_HZ} a second, is "
            f"at most {100 * ROUNDED_AWAY:g} % more than {100 * left:.3g} %; it is "
            f"{100 * played:.3g} %",
            code="reprap_rounds_too_much",
        )
    newer = _command(amplitudes[:-1], delays)
    older = _command(list(accumulate(amplitudes[:-1])), gaps)
    told = f"; rounded as the firmware does, it leaves {100 * played:.3g} %"
    return [told, newer, f"; 3.4 to 3.5: {older}"], held


def held_impulses(heights: list[float], delays_s: list[float]) -> Impulses:
    """Return the impulses that firmware 3.6 holds for the numbers of a line.

    Parameters
    ----------
    heights
        Of all impulses except the last, n - 1 [-].
    delays_s
        Times of all impulses except the first, from the first on, n - 1 [s].

    Returns
    -------
    Impulses
        Of n impulses: times in whole ticks of its clock, the last height from the sum 1.
    """
    held = np.array([float(np.float32(_text(height))) for height in heights])
    counts = [round(float(np.float32(_text(delay))) * CLOCK_HZ) for delay in delays_s]
    return Impulses(
        times_s=np.array([0, *counts]) / CLOCK_HZ,
        amplitudes=np.append(held, 1 - held.sum()),
    )


def _text(value: float) -> str:
    return f"{value:.{DECIMALS}f}"


def _command(amplitudes: list[float], times_s: list[float]) -> str:
    heights, times = (":".join(map(_text, numbers)) for numbers in (amplitudes, times_s))
    return f'M593 P"custom" H{heights} T{times}'


EXPORT = Export(
    name="rrf",
    media_type="text/plain; charset=utf-8",
    suffix=".g",
    checks=check_reprap,
    write=write_reprap,
)
