"""How the errors of lags move, in closed form: freely, and while their input is a ramp."""

import numpy as np
from numpy.polynomial.legendre import leggauss

from design.types import (
    FloatArray,
)

GENTLE_RAMP = 0.1
"""Turn of a lag's fastest mode over a ramp up to which four Gauss nodes are exact [rad].

Their error is ``turn^8 / 2e9``; the closed form of longer ramps loses a digit to subtraction.
"""

GENTLE_BEND = 3.0
"""The same of a bent ramp, up to which twelve nodes are exact to rounding [rad]."""

GAUSS = tuple((part + 1) / 2 if which == 0 else part / 2 for which, part in enumerate(leggauss(4)))
"""Nodes and weights of Gauss and Legendre on [0, 1] [-]."""

BEND_GAUSS = (1 + leggauss(12)[0]) / 2, leggauss(12)[1] / 2
"""The same of twelve nodes [-]."""


def free_motions(first_s: FloatArray, second_s2: FloatArray, elapsed_s: FloatArray) -> FloatArray:
    """Return how the errors of lags move freely, in closed form.

    The state is ``[v - u, v' / corner]``, with ``corner`` of `Lag.corner_rad_s`; a first-order lag
    uses the first entry only, an ideal one is at rest at once.

    Parameters
    ----------
    first_s, second_s2
        Coefficients of the lags [s], [s^2].
    elapsed_s
        Times since a moment, >= 0; its shape and those of the lags broadcast to (...) [s].

    Returns
    -------
    FloatArray
        Matrices from the state at that moment to the state at each time, shape (..., 2, 2) [-].
    """
    second_order = second_s2 > 0
    corner = np.where(second_order, second_s2, 1.0) ** -0.5
    damping = np.where(second_order, first_s * corner / 2, 1.0)
    phase = corner * elapsed_s
    root = np.sqrt(np.abs(damping**2 - 1))
    turn = root * phase
    decay = np.exp(-np.minimum(damping, 1.0) * phase)
    slow = np.exp(-phase / (np.maximum(damping, 1.0) + root))
    # expm1 keeps the digits of two poles that nearly coincide.
    apart = np.where(root == 0, phase, -np.expm1(-2 * turn) / np.where(root == 0, 1.0, 2 * root))
    even = np.where(damping < 1, decay * np.cos(turn), slow * (1 + np.exp(-2 * turn)) / 2)
    odd = np.where(damping < 1, decay * phase * np.sinc(turn / np.pi), slow * apart)
    constant = np.where(first_s > 0, first_s, 1.0)
    alone = np.where(first_s > 0, np.exp(-elapsed_s / constant), 0.0)
    motion = np.zeros((*even.shape, 2, 2))
    motion[..., 0, 0] = np.where(second_order, even + damping * odd, alone)
    motion[..., 0, 1] = np.where(second_order, odd, 0.0)
    motion[..., 1, 0] = np.where(second_order, -odd, 0.0)
    motion[..., 1, 1] = np.where(second_order, even - damping * odd, 0.0)
    return motion


def ramp_responses(first_s: FloatArray, second_s2: FloatArray, ramps_s: FloatArray) -> FloatArray:
    """Return the errors of lags at the end of ramps, from 1 below to 0.

    The mean of the free motion of a unit error over the ramp: 1 and 0 for a step.

    Parameters
    ----------
    first_s, second_s2
        Coefficients of the lags [s], [s^2].
    ramps_s
        Durations of the ramps, >= 0; its shape and those of the lags broadcast to (...) [s].

    Returns
    -------
    FloatArray
        State ``[error, rate]``, shape (..., 2) [-], [1/s]; 0 for an ideal lag.
    """
    corner = np.where(second_s2 > 0, np.where(second_s2 > 0, second_s2, 1.0) ** -0.5, 0.0)
    slowness = np.where(second_s2 > 0, second_s2, first_s)
    fastest = np.where(second_s2 > 0, first_s, 1.0) / np.where(slowness > 0, slowness, 1.0) + corner
    gentle = fastest * ramps_s <= GENTLE_RAMP
    mean = np.zeros((*gentle.shape, 2))
    for node, weight in zip(*GAUSS, strict=True):
        motion = free_motions(first_s, second_s2, node * ramps_s)
        mean[..., 0] += weight * motion[..., 0, 0]
        mean[..., 1] += weight * corner * motion[..., 1, 0]
    # e + first e' + second e'' = 0, integrated over the ramp.
    last = free_motions(first_s, second_s2, ramps_s)
    lost = 1 - last[..., 0, 0]
    long = np.where(gentle, 1.0, ramps_s)
    closed = np.stack(
        ((first_s * lost - second_s2 * corner * last[..., 1, 0]) / long, -lost / long), axis=-1
    )
    closed[..., 1] *= second_s2 > 0
    return np.where(gentle[..., None], mean, closed)


def bent_ramp_responses(
    first_s: FloatArray, second_s2: FloatArray, ramps_s: FloatArray, bends: FloatArray
) -> FloatArray:
    """Return what `ramp_responses` does, for ramps that bend.

    The mean of the free motion over the ramp of duration T, ``1 - b (2 t / T - 1)`` its weight: of
    a slope that grows the late share is large, and has moved for the shortest time.

    Parameters
    ----------
    first_s, second_s2, ramps_s
        As of `ramp_responses`.
    bends
        Of each ramp, as of a `Reference`; its shape and the others' broadcast to (...) [-].

    Returns
    -------
    FloatArray
        State ``[error, rate]``, shape (..., 2) [-], [1/s].
    """
    straight = ramp_responses(first_s, second_s2, ramps_s)
    if not bends.any():
        return straight
    corner = np.where(second_s2 > 0, np.where(second_s2 > 0, second_s2, 1.0) ** -0.5, 0.0)
    slowness = np.where(second_s2 > 0, second_s2, first_s)
    fastest = np.where(second_s2 > 0, first_s, 1.0) / np.where(slowness > 0, slowness, 1.0) + corner
    gentle = fastest * ramps_s <= GENTLE_BEND
    tilt = np.zeros((*gentle.shape, 2))
    for node, weight in zip(*BEND_GAUSS, strict=True):
        motion = free_motions(first_s, second_s2, node * ramps_s)
        tilt[..., 0] += weight * (2 * node - 1) * motion[..., 0, 0]
        tilt[..., 1] += weight * (2 * node - 1) * corner * motion[..., 1, 0]
    # t (e + first e' + second e'') = 0, integrated over the ramp.
    last = free_motions(first_s, second_s2, ramps_s)
    error, rate = last[..., 0, 0], corner * last[..., 1, 0]
    long = np.where(gentle, 1.0, ramps_s)
    late = first_s * (straight[..., 0] - error) - second_s2 * (rate + (1 - error) / long)
    closed = np.stack(
        (2 * late / long - straight[..., 0], 2 * (error - straight[..., 0]) / long), axis=-1
    )
    closed[..., 1] -= straight[..., 1]
    closed[..., 1] *= second_s2 > 0
    return straight - bends[..., None] * np.where(gentle[..., None], tilt, closed)
