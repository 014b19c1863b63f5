"""A swing that the payload makes at the first step already, over that of the unshaped step."""

from design.model.actuators.registry import Actuator
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode


def swing_over_step(swing: FreeSwing, mode: Mode, actuator: Actuator) -> complex:
    """Return the vector of a swing over that of the unshaped step [-].

    Parameters
    ----------
    swing
        What the payload swings already, over the speed.
    mode, actuator
        The mode and its drive.

    Returns
    -------
    complex
        At the first step [-].
    """
    return swing.vector(mode) * actuator.accel_lag.denominator(mode.pole_rad_s)
