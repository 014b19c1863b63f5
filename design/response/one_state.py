"""Lag states of a switched actuator: one state, moved by the set in force."""

import numpy as np

from design.types import FloatArray


def one_state(
    blocks: list[FloatArray],
) -> tuple[FloatArray, list[int], FloatArray, FloatArray]:
    """Return matrices, velocity errors, jumps and what is kept of one state.

    The blocks are those of the set in force after a step that decreases the command, and of the
    other, shape (order, order) each; of the sets of two orders the lower comes to rest at once.
    """
    order = max(map(len, blocks))
    matrices, jumps, kept = np.zeros((2, order, order)), np.zeros((2, order)), np.ones((2, order))
    jumps[:, :1] = 1.0
    for which, block in enumerate(blocks):
        if len(block) == order:
            matrices[which] = block
        else:
            kept[which] = 0.0
    return matrices, [0] if order else [], jumps, kept
