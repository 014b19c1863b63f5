"""Marlin: an M593 line for an axis, for `zv` alone.

Marlin's shaping is ZV, per axis, from version 2.1.2 on [1]_. It takes a frequency, of whose period
its second impulse is half late: that is the damped frequency. Of the damping ratio it makes the
heights as 128ths by a cubic, rounded down [2]_, so that damped modes keep up to two per cent of an
unshaped step. The second impulse is late by whole ticks of a timer of a megahertz or more, which is
far below that.

References
----------
.. [1] Marlin, docs/gcode/M593.md.
.. [2] Marlin, Marlin/src/module/stepper.cpp, Stepper::set_shaping_damping_ratio and
   Stepper::set_shaping_frequency.
"""

import math

import numpy as np

from design.model.impulses import Impulses
from design.model.plants.mode import Mode

HEIGHT_OF_SECOND = (64.44056192, -99.02008832, -7.58095488, 43.073216)
"""Height of the second impulse in 128ths: ascending powers of the damping ratio, rounded down."""

WHOLE = 128
"""A step in the units of these heights."""

DIGITS = 7
"""Of the numbers in a line: Marlin reads single precision."""


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


def marlin_lines(mode: Mode) -> tuple[str, ...]:
    """Return the lines for both axes; that of one axis may have another mode."""
    frequency, damping = marlin_numbers(mode)
    numbers = f"F{frequency:.{DIGITS}g} D{damping:.{DIGITS}g}"
    return (
        "; ZV shaping, the frequency is the damped one; SHAPING_MIN_FREQ of the build is at most F",
        f"M593 X {numbers}",
        f"M593 Y {numbers}",
        "M500",
    )


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
