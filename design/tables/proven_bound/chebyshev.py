"""How far a function is from what a few of its values say, by bounds on ellipses.

A function that is analytic and at most M on the ellipse of Bernstein of parameter ``rho`` about
[-1, 1] has Chebyshev coefficients of at most ``2 M rho^-k`` (Trefethen 2013, theorem 8.1). So its
polynomial of degree n is within ``2 M rho^-n / (rho - 1)`` (theorem 8.2). In two variables the
coefficients are at most ``4 M rho_1^-j rho_2^-k``.

A polynomial of degree n that is at most B at the m > n zeros of Chebyshev's polynomial is at most
``B / cos(pi n / (2 m))`` on [-1, 1] (Ehlich, Zeller 1964, Math. Z. 86, 41-44). Where it is largest,
turned to be real and positive there, it stays above ``cos(n t)`` of that at a distance t of the
angle ``arccos(u)`` (M. Riesz 1914), and the next zero is within ``pi / (2 m)``.
"""

import numpy as np

from design.types import FloatArray

MOST = 1e200
"""Magnitude from which on nothing is known: no product overflows before [-]."""


def truncation(largest: FloatArray, reach: FloatArray, degree: int) -> FloatArray:
    """Return how far a function is at most from its polynomial.

    Over [-1, 1] on each axis.

    Parameters
    ----------
    largest
        Of its magnitude where each ``|u|`` is at most the reach, shape (m,); may be infinite.
    reach
        Shape (m, axes), > 1 [-].
    degree
        Of the polynomial along each axis.

    Returns
    -------
    FloatArray
        Shape (m,), as the magnitude.

    Notes
    -----
    The ellipse whose half axes sum to rho is within the disk of radius ``(rho + 1 / rho) / 2``.
    """
    largest = np.where(largest < MOST, largest, np.inf)
    rho = reach + np.sqrt(reach**2 - 1)
    tails = rho ** (-degree) / (rho - 1)
    found: FloatArray = 2 * largest * tails[:, 0]
    if reach.shape[1] > 1:
        # Over all orders of one axis the powers sum to rho / (rho - 1), 1 of order 0 among them.
        sums = rho / (rho - 1)
        found = 4 * largest * (tails[:, 0] * sums[:, 1] + sums[:, 0] * tails[:, 1])
    return found


def zeros(count: int) -> FloatArray:
    """Return the zeros of Chebyshev's polynomial of a degree, shape (count,)."""
    found: FloatArray = np.cos(np.pi * (np.arange(count) + 0.5) / count)
    return found


def between_zeros(degree: int, count: int, axes: int) -> float:
    """Return by how much a polynomial may be larger than at the zeros.

    Parameters
    ----------
    degree, count
        Of the polynomial along each axis, and of zeros, more than the degree.
    axes
        One or two.

    Returns
    -------
    float
        A factor, >= 1 [-].
    """
    return float(np.cos(np.pi * degree / (2 * count)) ** -axes)
