"""Gaps between steps: a period, the shortest that keeps an order, one in which a step settles."""

import math

import numpy as np

from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.settling import settling_time_s
from design.types import FloatArray

PERIOD_RAD = 2 * math.pi

MIN_GAP_RAD = 1e-6
"""Keeps the impulses in order; a thousandth of a degree of swing [rad]."""


def settling_gaps_rad(mode: Mode, actuator: Actuator, impulses: int, *, settle: bool) -> FloatArray:
    """Return the shortest gaps: just ordered, or settled to 80 %.

    After a step up the acceleration set has to settle before the next, after a step down the
    deceleration set (Kim 2011, eq. 3.40). A ramp, where limits make one, is over before.

    Parameters
    ----------
    mode, actuator, impulses, settle
        The plant's mode, its drive, the number n of impulses, whether each step must settle.

    Returns
    -------
    FloatArray
        Shape (n - 1,) [rad].
    """
    w = mode.natural_frequency_rad_s
    ramps = unit_ramps_s(actuator)
    settling = (0.0, 0.0)
    if settle:
        settling = settling_time_s(actuator.accel_lag), settling_time_s(actuator.decel_lag)
    shortest = [
        max(MIN_GAP_RAD, w * (ramp_s + settling_s))
        for ramp_s, settling_s in zip(ramps, settling, strict=True)
    ]
    return np.array([shortest[number % 2] for number in range(impulses - 1)])


def of_gaps(
    gaps_rad: FloatArray, natural_frequency_rad_s: float, amplitudes: FloatArray
) -> Impulses:
    """Return the impulses of dimensionless gaps.

    Parameters
    ----------
    gaps_rad
        Gaps between the impulses times the natural frequency, shape (n - 1,) [rad].
    natural_frequency_rad_s, amplitudes
        Turns them into times [rad/s]; heights of the impulses, shape (n,) [-].

    Returns
    -------
    Impulses
        The first at time 0.
    """
    phases = np.concatenate(([0.0], np.cumsum(gaps_rad)))
    return Impulses(times_s=phases / natural_frequency_rad_s, amplitudes=amplitudes)
