"""Marlin: an M593 line for each row and axis, for `zv` alone.

Marlin's shaping is ZV, per axis, from version 2.1.2 on [1]_. It takes a frequency, of whose period
its second impulse is half late: that is the damped frequency. Of the damping ratio it makes the
heights as 128ths by a cubic, rounded down [2]_, so that damped modes keep up to one per cent of an
unshaped step. The second impulse is late by whole ticks of a timer of a megahertz or more, which is
far below that.

References
----------
.. [1] Marlin, docs/gcode/M593.md.
.. [2] Marlin, Marlin/src/module/stepper.cpp, Stepper::set_shaping_damping_ratio and
   Stepper::set_shaping_frequency.
"""

import math
from collections.abc import Iterable, Iterator

import numpy as np

from design.analysis.residual import residual_vibration
from design.errors import InvalidInputError
from design.export.firmware import firmware_lines
from design.export.kind import Export
from design.model.actuators.ideal import Ideal
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.tables.columns import require_times, varied_paths
from design.tables.rows import Rows, TableHead, subject_of

HEIGHT_OF_SECOND = (64.44056192, -99.02008832, -7.58095488, 43.073216)
"""Height of the second impulse in 128ths: ascending powers of the damping ratio, rounded down."""

WHOLE = 128
"""A step in the units of these heights."""

DIGITS = 7
"""Of the numbers in a line: Marlin reads single precision."""


KIND = "zv"
"""The kind that Marlin computes."""


def check_marlin(head: TableHead) -> None:
    """Raise InvalidInputError unless Marlin computes the shaper."""
    subject = subject_of(head)
    if subject.kind.name != KIND:
        raise InvalidInputError(
            "shaper.kind",
            subject.kind.name,
            f"{KIND} for Marlin, which computes no other",
            code="not_marlin_shaper",
        )
    if not isinstance(subject.actuator, Ideal):
        raise InvalidInputError(
            "actuator.kind",
            subject.actuator.kind,
            "ideal for Marlin: its shaper knows no drive",
            code="marlin_knows_no_actuator",
        )
    if subject.grid is not None:
        raise InvalidInputError(
            "shaper.sample_time_s",
            subject.grid.sample_time_s,
            "left out for Marlin: it computes its own impulses, which lie between samples",
            code="marlin_not_on_samples",
        )
    require_times(head)


def write_marlin(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as lines for Marlin, one for each axis.

    Parameters
    ----------
    head, runs
        The table, its runs in order.

    Returns
    -------
    iterator of bytes
        Pieces of the file, with the residual of what Marlin plays in each row.
    """
    subject, paths = subject_of(head), varied_paths(head)

    def commands(rows: Rows, index: int) -> list[str]:
        mode = subject.at(paths, rows.fields[index].tolist())[0].modes[0]
        played = marlin_impulses(*marlin_numbers(mode))
        left = residual_vibration(played, mode, Ideal())
        return [f"; residual {100 * left:.3g} % as Marlin rounds it", *axis_lines(mode)]

    remarks = [
        "take the line of your row and of your axis, X or Y: each axis has its own mode;",
        "F is the damped frequency in Hz; M500 keeps what is set; SHAPING_MIN_FREQ is at most F",
    ]
    return firmware_lines(head, runs, remarks, commands)


def marlin_numbers(mode: Mode) -> tuple[float, float]:
    """Return F and D: the damped frequency [Hz] and the damping ratio [-]."""
    damped_rad_s = mode.natural_frequency_rad_s * math.sqrt(1 - mode.damping_ratio**2)
    return _rounded(damped_rad_s / math.tau), _rounded(mode.damping_ratio)


def marlin_impulses(frequency_hz: float, damping_ratio: float) -> Impulses:
    """Return what Marlin plays for the numbers F and D of a line.

    Parameters
    ----------
    frequency_hz, damping_ratio
        F [Hz] and D [-].

    Returns
    -------
    Impulses
        Two, half a period of F apart, of sum 1.
    """
    powers = (height * damping_ratio**power for power, height in enumerate(HEIGHT_OF_SECOND))
    second = math.floor(sum(powers)) if damping_ratio > 0 else WHOLE // 2
    return Impulses(
        times_s=np.array([0.0, 0.5 / frequency_hz]),
        amplitudes=np.array([WHOLE - second, second]) / WHOLE,
    )


def axis_lines(mode: Mode) -> tuple[str, ...]:
    """Return a line for each axis."""
    frequency, damping = marlin_numbers(mode)
    numbers = f"F{frequency:.{DIGITS}g} D{damping:.{DIGITS}g}"
    return f"M593 X {numbers}", f"M593 Y {numbers}"


def marlin_lines(mode: Mode) -> tuple[str, ...]:
    """Return the lines for both axes; that of one axis may have another mode."""
    return (
        "; ZV shaping, the frequency is the damped one; SHAPING_MIN_FREQ of the build is at most F",
        *axis_lines(mode),
        "M500",
    )


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


EXPORT = Export(
    name="marlin",
    media_type="text/plain; charset=utf-8",
    suffix=".gco",
    checks=check_marlin,
    write=write_marlin,
)
