"""What differs from one problem of a family to the next: the mode, its drive and its swing."""

import numpy as np

from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.initial_state import FreeSwing
from design.model.lag_motions import ramp_responses
from design.model.plants.mode import Mode
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
    either unit ramp, and error and rate that either leaves in its own lag.

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
        ramps = [w * ramp for ramp in actuator.unit_ramps_s]
        scaled += ramps
        first, second = np.array(scaled[0:4:2]), np.array(scaled[1:4:2])
        scaled += ramp_responses(first, second, np.array(ramps)).ravel().tolist()
    return np.array([mode.damping_ratio, *scaled])


ACCEL_TO_DECEL = {1: 3, 2: 4, 5: 6, 7: 9, 8: 10}
"""Places in `lag_parameters` of what tells of the accelerating set and of the other."""


def with_equal_sets(parameters: FloatArray) -> FloatArray:
    """Return `lag_parameters` of an actuator that brakes as it accelerates.

    What follows them stays.

    Parameters
    ----------
    parameters
        Of lags without limits and of at most one more number, or with limits, shape (p,).

    Returns
    -------
    FloatArray
        Shape (p,).
    """
    equal = parameters.copy()
    ramped = parameters.size >= LAG_PARAMETERS[True]
    for accel, decel in ACCEL_TO_DECEL.items():
        if ramped or decel < LAG_PARAMETERS[False]:
            equal[decel] = parameters[accel]
    return equal


def swing_parameters(mode: Mode, swing: FreeSwing | None) -> FloatArray:
    """Return the four parameters of `with_swing`, or none.

    Parameters
    ----------
    mode
        The plant's mode.
    swing
        What the payload swings at the first step.

    Returns
    -------
    FloatArray
        Shape (4,), or (0,) without a swing.
    """
    if swing is None:
        return np.zeros(0)
    w = mode.natural_frequency_rad_s
    return np.array([
        w * swing.deflection_s, swing.rate, swing.frequency_power, w * swing.delay_s
    ])  # fmt: skip
