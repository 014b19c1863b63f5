"""What commands on samples leave: of many at once, at the nominal frequency or over a band."""

import numpy as np

from design.analysis.residuals_of_many import vectors_of_many
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.sampling.sample_grid import AnyIntArray
from design.types import ComplexArray, FloatArray

Band = tuple[float, float]
"""Ends of a band of frequencies, over the nominal one [-]."""

FREQUENCY_ERROR = 0.05
"""Relative error in frequency that a shaper with zero slope is to stand [-]."""

DIFFERENCE = 1e-5
"""Relative step of the central difference in frequency: its error and rounding are 1e-10 [-]."""

BAND_POINTS = 17
"""Frequencies at which what is left over a band is compared [-]."""

TIE = 1e-12
"""Shapers this near in what they leave are equally good: it is rounding [-]."""

FEW_POINTS = 3
"""Frequencies at which every command is looked at first, ends included."""

WANTED = 100
"""Commands that are compared exactly where the list is of a coarser grid or another actuator."""


def cuts_ramps(impulses: Impulses, actuator: Actuator, sample_time_s: float) -> bool:
    """Return whether steps moved by a sample may cut a ramp.

    A step then begins before the ramp of the one before is over, or reverses the command, whose two
    ramps a formula of many commands does not know. Nor does it know ramps of limited jerk.

    Parameters
    ----------
    impulses
        The shaper, before its steps are moved.
    actuator
        The drive; without limits nothing is cut.
    sample_time_s
        Sample time [s].

    Returns
    -------
    bool
        Whether such commands must be computed one by one.
    """
    if isinstance(actuator, RateLimited) and actuator.jerk_limit_m_s3 is not None:
        return True
    accelerating, braking = unit_ramps_s(actuator)
    if max(accelerating, braking) == 0:
        return False
    sizes, rising = np.abs(impulses.amplitudes), impulses.accelerates
    ramps = sizes * np.where(rising, accelerating, braking)
    levels = np.cumsum(impulses.amplitudes)
    reversed_steps = bool((levels * impulses.amplitudes.sum() < -REVERSED).any())
    gaps = np.diff(impulses.times_s)
    return reversed_steps or bool((gaps - 2 * sample_time_s < ramps[:-1]).any())


REVERSED = 1e-9
"""Level on the other side of zero that is no rounding [-]."""


def residuals_of_many(
    times_s: FloatArray,
    amplitudes: FloatArray,
    mode: Mode,
    actuator: Actuator,
    *,
    slope: bool,
    band: Band | None = None,
) -> FloatArray:
    """Return what `unity_on_grid` minimises, of many shapers.

    Parameters
    ----------
    times_s
        Times of the steps, shape (m, n) [s].
    amplitudes
        Their heights, the same for all, shape (n,) [-].
    mode, actuator
        The plant's mode and its drive.
    slope
        Whether ``0.05 |dV/d ln w|`` is added; it is not over a band.
    band
        Ends of a band of which the largest residual counts [-]; None for the nominal frequency.

    Returns
    -------
    FloatArray
        Shape (m,) [-].
    """
    lag = actuator.accel_lag

    def vibration(ratio: float) -> ComplexArray:
        pole = mode.pole_rad_s * ratio
        poles = np.full(len(times_s), pole)
        # Phase and unit of the nominal frequency, so that only V itself differs.
        unit = lag.denominator(mode.pole_rad_s) / lag.denominator(pole)
        turn = np.exp((mode.pole_rad_s - pole) * (times_s[:, -1] - times_s[:, 0]))
        vectors: ComplexArray = vectors_of_many(times_s, amplitudes, poles, actuator) * turn * unit
        return vectors

    if band is not None:
        ratios = np.linspace(*band, BAND_POINTS)
        return _largest_at(times_s, amplitudes, mode, actuator, ratios)
    left: FloatArray = np.abs(vibration(1.0))
    if slope:
        change = vibration(1 + DIFFERENCE) - vibration(1 - DIFFERENCE)
        left = left + FREQUENCY_ERROR * np.abs(change) / (2 * DIFFERENCE)
    return left


def _largest_at(
    times_s: FloatArray,
    amplitudes: FloatArray,
    mode: Mode,
    actuator: Actuator,
    ratios: FloatArray,
) -> FloatArray:
    """Return the largest residual of each of many shapers at some ratios of frequency."""
    largest: FloatArray = np.zeros(len(times_s))
    for ratio in ratios.tolist():
        poles = np.full(len(times_s), mode.pole_rad_s * ratio)
        left = np.abs(vectors_of_many(times_s, amplitudes, poles, actuator))
        largest = np.maximum(largest, left)
    return largest


def largest_over_band(
    times_s: FloatArray, amplitudes: FloatArray, mode: Mode, actuator: Actuator, band: Band
) -> FloatArray:
    """Return the largest residual over a band of the best shapers.

    The residual over a band is at least that at three of its frequencies. Those that cannot
    be the best by this are not looked at.

    Parameters
    ----------
    times_s
        Times of the steps, shape (m, n) [s].
    amplitudes
        Their heights, the same for all, shape (n,) [-].
    mode, actuator
        The plant's mode and its drive.
    band
        Lowest and highest ratio of true and nominal frequency [-].

    Returns
    -------
    FloatArray
        Shape (m,) [-]; inf for those not looked at.
    """
    least = _largest_at(times_s, amplitudes, mode, actuator, np.linspace(*band, FEW_POINTS))
    order = np.argsort(least, kind="stable")
    largest: FloatArray = np.full(len(times_s), np.inf)

    def look_at(ones: AnyIntArray) -> None:
        if ones.size:
            largest[ones] = residuals_of_many(
                times_s[ones], amplitudes, mode, actuator, slope=False, band=band
            )

    look_at(order[:WANTED])
    others = order[WANTED:]
    look_at(others[least[others] <= largest.min()])
    return largest
