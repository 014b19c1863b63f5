"""What ramps of the reference do to the state of actuator and mode."""

import numpy as np

from design.model.ramps import Reference
from design.response.matrix_exponential import exponentials
from design.types import FloatArray


def whole_ramp_flows(
    matrices: FloatArray, changes: Reference, jumps: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the `ramp_flows` of whole ramps.

    Parameters
    ----------
    matrices
        State matrices in each ramp, shape (r, f, n, n).
    changes
        The r ramps.
    jumps
        What each takes off in all, shape (r, n).

    Returns
    -------
    tuple of FloatArray
        As of `ramp_flows`.
    """
    growths = 2 * changes.bends[:, None] * jumps
    return ramp_flows(matrices, changes.ramps_s, jumps - growths / 2, growths)


def ramp_flows(
    matrices: FloatArray, ramps_s: FloatArray, jumps: FloatArray, growths: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return what ramps do: the flow of the state, and what they take off.

    Parameters
    ----------
    matrices
        State matrices in each ramp, shape (r, f, n, n).
    ramps_s
        Durations of the ramps, shape (r,) [s].
    jumps
        What each would take off in all at the rate at which it begins, shape (r, n).
    growths
        By how much that grows over the ramp, evenly, shape (r, n).

    Returns
    -------
    tuple of FloatArray
        Flows, shape (r, f, n, n), and what becomes of a state at rest, shape (r, f, n).
    """
    size = matrices.shape[-1]
    augmented = np.zeros((*matrices.shape[:2], size + 2, size + 2))
    augmented[..., :size, :size] = matrices * ramps_s[:, None, None, None]
    augmented[..., :size, size] = -jumps[:, None]
    augmented[..., :size, size + 1] = -growths[:, None]
    augmented[..., size + 1, size] = 1.0  # the share of the ramp that is over
    both = exponentials(augmented)
    return both[..., :size, :size], both[..., :size, size]
