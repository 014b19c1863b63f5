"""Least squares that return no number where numbers overflowed."""

import numpy as np

from design.types import FloatArray

SMALLEST = 1e-200
"""Size of a row or column of zeros [-]."""


def least_squares(
    matrix: FloatArray, right: FloatArray, smallest: float | None = None
) -> FloatArray:
    """Return the shortest of the x that miss ``matrix @ x = right`` least.

    Parameters
    ----------
    matrix, right
        Shapes (m, n) and (m,).
    smallest
        Share of the largest singular value below which one counts as none; that of rounding if
        None [-].

    Returns
    -------
    FloatArray
        Shape (n,); not a number each where anything given is not finite, as it is where Newton's
        method diverges.
    """
    if not (np.isfinite(matrix).all() and np.isfinite(right).all()):
        return np.full(matrix.shape[1], np.nan)
    found: FloatArray = np.linalg.lstsq(matrix, right, rcond=smallest)[0]
    return found


def evened_least_squares(
    matrix: FloatArray, right: FloatArray, smallest: float | None = None
) -> FloatArray:
    """Return an x that misses least, from rows and columns of one size.

    With short ramps some are a million times as large as others.

    Parameters
    ----------
    matrix, right, smallest
        As of `least_squares`.

    Returns
    -------
    FloatArray
        As of `least_squares`.
    """
    rows = 1 / np.abs(matrix).max(axis=1, initial=SMALLEST)
    evened = matrix * rows[:, None]
    columns = 1 / np.abs(evened).max(axis=0, initial=SMALLEST)
    found: FloatArray = columns * least_squares(evened * columns, rows * right, smallest)
    return found
