"""What a switched actuator's one state adds where the set in force changes."""

import numpy as np

from design.model.ramps import Reference
from design.response.closed_form import LagStates
from design.types import FloatArray


def pass_on_state(states: LagStates, changes: Reference, second_s2: FloatArray) -> FloatArray:
    """Return what a switched lag's state adds where its set changes.

    Parameters
    ----------
    states
        Just before each change, of m commands or actuators.
    changes
        The n changes.
    second_s2
        Coefficients, columns accel and decel, shape (m, 2) or (1, 2) [s^2].

    Returns
    -------
    FloatArray
        Gains by either set, then their rates, shape (m, n, 4) [-], [s].
    """
    error, rate = states.errors.sum(axis=-1), states.rates_s.sum(axis=-1)
    forces = np.where(changes.accelerates, 0, 1)
    columns = np.zeros((*error.shape, 4))
    for which in (0, 1):
        # To the new set less from the old; at rest there is nothing to pass on.
        sign = (forces == which).astype(float)
        sign[1:] -= forces[:-1] == which
        columns[..., which] = -sign * error
        columns[..., 2 + which] = sign * second_s2[:, which, None] * rate
    return columns
