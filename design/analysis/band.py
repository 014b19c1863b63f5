"""The largest residual where frequency and damping are known within ranges, by simulation."""

import math

import numpy as np

from design.analysis.peaks import largest_between
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.response.simulation import ringing_after
from design.types import FloatArray

BAND_STEP_RAD = 0.1
"""Turn of the last impulse's phase from one point of a band to the next, at most [rad]."""

MIN_BAND_POINTS = 33
"""Points at which a band is looked at, at least."""

BLOCK = 100_000
"""Impulses times frequencies that are simulated at once: their matrices take 40 MB."""

BESIDE_POLE = 2.0**-40
"""How far beside a pole of the actuator frequencies are taken where one is exactly there [-].

A share of a step is nearly the same there, as both swing alike, while rounding is 4,000 times less.
"""

Pair = tuple[float, float]
"""Frequency ratio and damping ratio [-]."""


def largest_in_band(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    band: tuple[float, float],
    damping: tuple[float, float] | None = None,
) -> float:
    """Return the largest residual over frequencies and damping ratios.

    Peaks are found between grid points. Of both ranges only the rim is looked at: the velocity
    does not depend on the plant, so that V is an analytic function of the pole s, whose size is
    largest on the rim of any region without a pole of V. In units of the unshaped step V has
    poles where the decelerating set has; one within the region is reported as an infinite residual.

    Parameters
    ----------
    impulses
        The command.
    mode, actuator
        The nominal mode and its actuator.
    band
        Lowest and highest ratio of true and nominal frequency [-].
    damping
        Least and largest damping ratio [-]; None for the mode's own.

    Returns
    -------
    float
        Share of the unshaped step at the same pole [-]; inf if a pole of V is within both ranges.
    """
    low, high = band
    if damping is None:
        own = mode.damping_ratio
        return _largest_between(impulses, mode, actuator, (low, own), (high, own))
    least, most = damping
    if _rings_within(impulses, mode, actuator, band, damping):
        return math.inf
    corners = [(low, least), (high, least), (high, most), (low, most)]
    return max(
        _largest_between(impulses, mode, actuator, corner, following)
        for corner, following in zip(corners, corners[1:] + corners[:1], strict=True)
    )


def _largest_between(
    impulses: Impulses, mode: Mode, actuator: Actuator, start: Pair, end: Pair
) -> float:
    """Return the largest residual on the straight way between two pairs."""
    first, along = np.array(start), np.subtract(end, start)

    def residuals(shares: FloatArray) -> FloatArray:
        ratios, damping = (first + shares.reshape(-1, 1) * along).T
        frequencies = mode.natural_frequency_rad_s * ratios
        found = np.empty(frequencies.size)
        block = max(1, BLOCK // impulses.times_s.size)
        for begin in range(0, frequencies.size, block):
            part = slice(begin, begin + block)
            found[part] = _shares(impulses, actuator, frequencies[part], damping[part])
        return found.reshape(shares.shape)

    if not along.any():  # a frequency that is known is one place, not as many peaks as places
        return float(residuals(np.zeros(1))[0])
    # Damping moves the pole by as much as frequency does, up to its ratio of frequency.
    reach = abs(along[0]) + max(start[0], end[0]) * abs(along[1])
    nominal = np.array([mode.natural_frequency_rad_s])
    _, _, moving_s = ringing_after(impulses, actuator, nominal, mode.damping_ratio)
    turns = mode.natural_frequency_rad_s * moving_s * reach
    return largest_between(
        residuals, 0.0, 1.0, max(MIN_BAND_POINTS, int(turns / BAND_STEP_RAD) + 2)
    )


def _shares(
    impulses: Impulses, actuator: Actuator, frequencies_rad_s: FloatArray, damping: FloatArray
) -> FloatArray:
    """Return the residuals of modes, shares of the unshaped step of each."""
    try:
        ringing, unit, _ = ringing_after(impulses, actuator, frequencies_rad_s, damping)
    except np.linalg.LinAlgError:
        beside = frequencies_rad_s * (1 + BESIDE_POLE)
        ringing, unit, _ = ringing_after(impulses, actuator, beside, damping)
    return np.abs(ringing) / np.abs(unit)


def _rings_within(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    band: tuple[float, float],
    damping: tuple[float, float],
) -> bool:
    """Whether the decelerating set, if it is used, has its pole within both ranges."""
    lag = actuator.decel_lag
    if impulses.accelerates.all() or lag.second_s2 == 0:
        return False
    ratio = lag.corner_rad_s / mode.natural_frequency_rad_s
    return (
        band[0] <= ratio <= band[1]
        and damping[0] <= lag.first_s * lag.corner_rad_s / 2 <= damping[1]
    )
