"""Which points of a grid a cell is interpolated from."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

IndexArray = NDArray[np.signedinteger[Any]]

STENCIL = 4
"""Points along each axis: a cubic."""


def first_of_stencil(cell: IndexArray, points: int) -> tuple[IndexArray, int]:
    """Return where the stencil of a cell begins along an axis.

    Parameters
    ----------
    cell
        Numbers of cells along the axis.
    points
        Points of the axis.

    Returns
    -------
    tuple of IndexArray and int
        Number of the first point of each, and how many there are.
    """
    size = min(STENCIL, points)
    return np.clip(cell - (size - 2) // 2, 0, points - size), size
