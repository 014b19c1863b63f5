"""What differs from one problem of a family to the next: the mode and its drive."""

import numpy as np

from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.lag_motions import ramp_responses
from design.model.plants.mode import Mode
from design.model.ramps import ramp_factors
from design.types import FloatArray


def switched_order(actuator: Actuator) -> int:
    """Return the order of a switched actuator's lags; 0 for superposed steps."""
    if actuator.model == "superposed":
        return 0
    return 2 if actuator.accel_lag.second_s2 > 0 else 1


LAG_PARAMETERS = {False: 5, True: 11}
"""How many numbers describe plant and actuator, without and with ramps."""


def lag_parameters(mode: Mode, actuator: Actuator) -> FloatArray:
    """Return what describes plant and actuator at w = 1.

    z, then ``first, second`` of either set, accel before decel; with limits also the duration of
    either unit ramp, and error and rate in its own lag after either.

    Parameters
    ----------
    mode, actuator
        The plant's mode and its drive.

    Returns
    -------
    FloatArray
        Shape (5,), or with limits (11,) [-].
    """
    w = mode.natural_frequency_rad_s
    lags = (actuator.accel_lag, actuator.decel_lag)
    scaled = [part for lag in lags for part in (lag.first_s * w, lag.second_s2 * w * w)]
    if isinstance(actuator, RateLimited):
        ramps = [w * ramp for ramp in actuator.straight_ramps_s]
        scaled += ramps
        first, second = np.array(scaled[0:4:2]), np.array(scaled[1:4:2])
        scaled += ramp_responses(first, second, np.array(ramps)).ravel().tolist()
    return np.array([mode.damping_ratio, *scaled])


def decel_over_accel(mode: Mode, actuator: Actuator) -> complex:
    """Return G_decel / G_accel at the plant's pole (Kim 2011, 3.50).

    It is ``alpha exp(-j beta)``. A ramp, where limits make one, is part of G.

    Parameters
    ----------
    mode, actuator
        The plant's mode and its drive.

    Returns
    -------
    complex
        1 behind equal sets [-].
    """
    pole = mode.pole_rad_s
    lags = actuator.accel_lag.denominator(pole) / actuator.decel_lag.denominator(pole)
    if not isinstance(actuator, RateLimited):
        return lags
    rise, fall = ramp_factors(np.array([pole]), np.array(actuator.straight_ramps_s)).tolist()
    return complex(lags * fall / rise)
