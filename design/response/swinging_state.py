"""The state of a mode that swings already at the first step."""

import numpy as np

from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode
from design.response.matrix_exponential import exponentials
from design.types import FloatArray


def swinging_state(swing: FreeSwing, mode: Mode, ratios: FloatArray) -> FloatArray:
    """Return the state of a mode at the first step, at many frequencies.

    The deflection is ``-q'/w^2``, and its rate ``q - v + 2 z q'/w``, at v = 0. During the dead time
    of the actuator it moves freely.

    Parameters
    ----------
    swing, mode
        What the payload swings, and its mode.
    ratios
        True over nominal frequency, shape (f,) [-].

    Returns
    -------
    FloatArray
        ``q, q'/w`` of the mode, shape (f, 2).
    """
    z, w = mode.damping_ratio, mode.natural_frequency_rad_s * ratios
    deflection, rate = np.multiply.outer(
        (swing.deflection_s, swing.rate), ratios**swing.frequency_power
    )
    turned = -w * deflection
    state = np.column_stack((rate - 2 * z * turned, turned))
    free = np.array([[0.0, 1.0], [-1.0, -2 * z]])
    freely: FloatArray = exponentials(swing.delay_s * w[:, None, None] * free)
    moved: FloatArray = (freely @ state[..., None])[..., 0]
    return moved
