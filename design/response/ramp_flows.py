"""What ramps of the reference do to the state of actuator and mode."""

import numpy as np

from design.response.matrix_exponential import exponentials
from design.types import FloatArray


def ramp_flows(
    matrices: FloatArray, ramps_s: FloatArray, jumps: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return what ramps do: the flow of the state, and what they take off.

    Parameters
    ----------
    matrices
        State matrices in each ramp, shape (r, f, n, n).
    ramps_s
        Durations of the ramps, shape (r,) [s].
    jumps
        What each takes off in all, at a constant rate, shape (r, n).

    Returns
    -------
    tuple of FloatArray
        Flows, shape (r, f, n, n), and what becomes of a state at rest, shape (r, f, n).
    """
    size = matrices.shape[-1]
    augmented = np.zeros((*matrices.shape[:2], size + 1, size + 1))
    augmented[..., :size, :size] = matrices * ramps_s[:, None, None, None]
    augmented[..., :size, size] = -jumps[:, None]
    both = exponentials(augmented)
    return both[..., :size, :size], both[..., :size, size]
