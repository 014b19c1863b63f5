"""The residual of one unshaped step: the unit of every other."""

import numpy as np

from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.commands import step
from design.model.plants.mode import Mode
from design.model.ramps import ramped


def unshaped_gain(mode: Mode, actuator: Actuator) -> float:
    """Return the residual of an unshaped step over that of an ideal one [-].

    Limits are no part of it: a ramp of whole periods has no residual, and none is no unit.

    Parameters
    ----------
    mode
        The mode that swings.
    actuator
        The actuator, of which a step from rest uses the acceleration set.

    Returns
    -------
    float
        Share of the residual of a step through an ideal actuator [-].
    """
    return 1 / abs(actuator.accel_lag.denominator(mode.pole_rad_s))


def unshaped_ramp_residual(mode: Mode, actuator: RateLimited) -> float:
    """Return the residual of an unshaped ramp over that of the step itself.

    By its pieces where the jerk is limited.

    Parameters
    ----------
    mode
        The mode that swings.
    actuator
        The limits.

    Returns
    -------
    float
        At the ramp's end, ``|(exp(s T) - 1) / (s T)|`` for a duration T [-]; 0 where it lasts whole
        periods of an undamped mode.
    """
    pole = np.array([mode.pole_rad_s])
    ramp = ramped(step(), actuator)
    until_end_s = ramp.times_s[-1] + ramp.ramps_s[-1] - ramp.times_s
    return float(abs((ramp.factors(pole) * np.exp(pole * until_end_s)) @ ramp.changes))


def unshaped_deflection_s(mode: Mode, actuator: Actuator) -> float:
    """Return the residual amplitude of an unshaped step over its speed [s].

    Times a residual and the speed it is the amplitude of what remains, extrapolated back as above.
    A vector V rings as ``d = -Im(V exp(s t)) / Im(s)``: the damped frequency it is, not w.

    Parameters
    ----------
    mode, actuator
        The mode and its drive.

    Returns
    -------
    float
        Of the payload's deflection, over the speed of the step [s].

    Examples
    --------
    >>> from design.model.actuators.ideal import Ideal
    >>> half_damped = Mode(natural_frequency_rad_s=2.0, damping_ratio=0.5)
    >>> round(unshaped_deflection_s(half_damped, Ideal()), 5)
    0.57735
    """
    return unshaped_gain(mode, actuator) / mode.pole_rad_s.imag
