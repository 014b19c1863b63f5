"""What the bounds behind limits share: sums of exponentials, bounded between points."""

from collections.abc import Callable

import numpy as np

from design.types import BoolArray, ComplexArray, FloatArray

FIRST_SHARE = 1e-10
"""Share of the duration by which the first bound that is tried is below it [-]."""

TRIES = 24
"""Bounds that are tried, each twice as far below."""


def steepest(
    poles: ComplexArray,
    orders: FloatArray,
    multipliers: ComplexArray,
    times: FloatArray,
    derivative: int,
) -> FloatArray:
    """Return bounds of a derivative of P.

    ``P(t) = Re sum conj(c_k) (-t)^o_k exp(-s_k t)``.

    Modes that decay grow backward: each bound is that of all times until then.

    Parameters
    ----------
    poles, orders, multipliers
        s, o and c, shape (m,).
    times
        Shape (n,) [rad].
    derivative
        Its order, > 0.

    Returns
    -------
    FloatArray
        Shape (n,).
    """
    size, first = np.abs(poles)[:, None], orders[:, None] == 1
    largest = size**derivative * np.where(first, times, 1.0)
    largest = largest + np.where(first, derivative * size ** (derivative - 1), 0.0)
    grown = np.exp(np.maximum(-poles.real[:, None], 0.0) * times)
    bounds: FloatArray = np.abs(multipliers) @ (largest * grown)
    return bounds


def agree(before: FloatArray, after: FloatArray, margin: FloatArray) -> BoolArray:
    """Return whether both are a margin away from 0 on the same side.

    Parameters
    ----------
    before, after, margin
        Shape (n,) each.

    Returns
    -------
    BoolArray
        Shape (n,).
    """
    low, high = np.minimum(before, after), np.maximum(before, after)
    alike: BoolArray = (low >= margin) | (high <= -margin)
    return alike


def longest_excluded(surplus: Callable[[float], float], end: float) -> float:
    """Return the longest of some durations that a surplus above 0 excludes.

    Parameters
    ----------
    surplus
        Of a duration.
    end
        When the optimum ends, the least upper bound [rad].

    Returns
    -------
    float
        At most that [rad]; 0 excludes nothing.
    """
    short = max(-surplus(end), FIRST_SHARE * end)
    for _ in range(TRIES):
        duration = end - short
        if duration <= 0:
            return 0.0
        if surplus(duration) > 0:
            return duration
        short *= 2
    return 0.0
