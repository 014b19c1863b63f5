"""Residual vibration of a command, from the transfer function (docs/theory.md, section 1)."""

import cmath

import numpy as np

from design.analysis.terms import swing_over_step
from design.analysis.vectors import residual_vectors
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode


def residual_vibration(
    impulses: Impulses, mode: Mode, actuator: Actuator, swing: FreeSwing | None = None
) -> float:
    """Return the residual vibration over that of an unshaped step [-].

    The amplitude of free vibration, extrapolated back to the last step, over the amplitude that
    an unshaped unit step has through the acceleration set. The actuator's own transient is
    not part of it. A whole move (amplitudes sum to 0) is measured by the same unit, and so is what
    is left of a swing that the payload made at the first step already.

    Parameters
    ----------
    impulses, mode, actuator
        The command, the mode and its drive; no set may have its own pole at the mode's.
    swing
        What the payload swings already at the first step; None for a plant at rest.

    Returns
    -------
    float
        At least 0 [-]; 1 for the unshaped step itself.

    Examples
    --------
    >>> import numpy as np
    >>> from design.model.actuators.ideal import Ideal
    >>> half_period = Impulses(times_s=np.array([0.0, np.pi]), amplitudes=np.array([0.5, 0.5]))
    >>> residual_vibration(half_period, Mode(natural_frequency_rad_s=1.0), Ideal()) < 1e-15
    True
    """
    vector = residual_vectors(impulses, np.array([mode.pole_rad_s]), actuator)[0]
    if swing is not None:
        turn = cmath.exp(mode.pole_rad_s * impulses.duration_s)
        vector += turn * swing_over_step(swing, mode, actuator)
    return float(abs(vector))
