"""What the lags of an actuator follow: the command's steps, or the ramps that limits make of it."""

import numpy as np

from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.ramps import Reference, ramped


def reference(command: Impulses, actuator: Actuator) -> Reference:
    """Return what the lags of an actuator follow under a command.

    A rate-limited actuator turns each step into a ramp; one that passes zero becomes two.

    Parameters
    ----------
    command, actuator
        The command and the drive; all except a rate-limited one follow the command itself.

    Returns
    -------
    Reference
        The changes; without limits, one for each step of the command.
    """
    if not isinstance(actuator, RateLimited):
        return Reference(
            times_s=command.times_s,
            ramps_s=np.zeros(command.times_s.size),
            changes=command.amplitudes,
            accelerates=command.accelerates,
            bends=np.zeros(command.times_s.size),
        )
    return ramped(command, actuator)
