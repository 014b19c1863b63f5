"""A swing that the payload makes at the first step already, over that of the unshaped step."""

import numpy as np

from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode
from design.model.ramps import ramp_factors


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
    pole = mode.pole_rad_s
    rise_s, _ = unit_ramps_s(actuator)
    ramp = complex(ramp_factors(np.array(pole), np.array(rise_s)))
    return swing.vector(mode) * actuator.accel_lag.denominator(pole) / ramp
