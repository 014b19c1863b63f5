"""Vibration vectors of a command at many poles, over that of the unshaped step."""

import math

import numpy as np

from design.analysis.step_contributions import step_contributions
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.ramps import ramp_factors
from design.types import ComplexArray

MIN_DENOMINATOR = 1e-12
"""Where a sensitivity curve meets a set's own pole, ``|1/G|`` is taken as this [-]."""


def residual_vectors(
    impulses: Impulses, poles_rad_s: ComplexArray, actuator: Actuator
) -> ComplexArray:
    """Return the vibration vector at each pole over the unshaped step's.

    Parameters
    ----------
    impulses, actuator
        The command and the actuator.
    poles_rad_s
        Upper poles of the modes, shape (m,) [rad/s].

    Returns
    -------
    ComplexArray
        ``V exp(s t_n) / G_accel(s)``, shape (m,) [-]; its magnitude is the residual vibration.
    """
    steps = step_contributions(impulses, actuator)
    swings = np.exp(np.multiply.outer(poles_rad_s, steps.until_last_s))
    sums = swings @ steps.columns.astype(np.complex128)
    if steps.ramps_s is not None and steps.heights is not None:
        ramped = swings * ramp_factors(poles_rad_s[:, None], steps.ramps_s)
        sums[:, :2] += ramped @ steps.heights.astype(np.complex128)
    return join_sets(sums, poles_rad_s, actuator)


def evenly_spaced_vectors(
    impulses: Impulses, first_rad_s: complex, last_rad_s: complex, points: int, actuator: Actuator
) -> ComplexArray:
    """Return `residual_vectors` at poles evenly spaced on a line.

    The exponentials of an even spacing are products of two short lists, coarse and fine, so that
    ``2 sqrt(points)`` of them do and a matrix product does the rest.

    Parameters
    ----------
    impulses, actuator
        The command and the actuator.
    first_rad_s, last_rad_s, points
        Poles at the ends of the line, both among the m points, m >= 2 [rad/s].

    Returns
    -------
    ComplexArray
        Shape (m,) [-].
    """
    step = (last_rad_s - first_rad_s) / (points - 1)
    poles = first_rad_s + step * np.arange(points)
    if isinstance(actuator, RateLimited):
        return residual_vectors(impulses, poles, actuator)
    steps = step_contributions(impulses, actuator)
    block = math.isqrt(points - 1) + 1
    coarse = np.exp(np.multiply.outer(steps.until_last_s, poles[::block]))
    fine = np.exp(np.multiply.outer(np.arange(block) * step, steps.until_last_s))
    summed = fine @ (steps.columns.T[:, :, None] * coarse)  # (columns, block, blocks)
    vectors: ComplexArray = summed.transpose(2, 1, 0).reshape(-1, len(summed))[:points]
    return join_sets(vectors, poles, actuator)


def join_sets(sums: ComplexArray, poles_rad_s: ComplexArray, actuator: Actuator) -> ComplexArray:
    """Join what the sets add, in units of the unshaped step.

    Parameters
    ----------
    sums, poles_rad_s
        As of `join_over_accel`.
    actuator
        The actuator.

    Returns
    -------
    ComplexArray
        Shape (m,) [-].
    """
    accel, decel = (
        lag.denominator(poles_rad_s) for lag in (actuator.accel_lag, actuator.decel_lag)
    )
    return join_over_accel(sums, poles_rad_s, accel, decel)


def join_over_accel(
    sums: ComplexArray, poles_rad_s: ComplexArray, accel: ComplexArray, decel: ComplexArray
) -> ComplexArray:
    """Join what the sets add by their denominators, over G_accel.

    Parameters
    ----------
    sums
        Gains by either set, then, if there are any, their rates: shape (m, 2) or (m, 4) [-], [s].
    poles_rad_s
        Upper poles, shape (m,) or (1,) [rad/s].
    accel, decel
        ``1 / G`` of either set at the poles, shape (m,) or (1,) [-]; below 1e-12 that of the
        deceleration set counts as 1e-12.

    Returns
    -------
    ComplexArray
        Shape (m,) [-].
    """
    # On the pole of the deceleration set itself the vibration grows without bound: cut, finite.
    below = np.where(np.abs(decel) < MIN_DENOMINATOR, MIN_DENOMINATOR, decel)
    by_set = sums[:, :2] + poles_rad_s[:, None] * sums[:, 2:] if sums.shape[1] > 2 else sums  # noqa: PLR2004
    joined: ComplexArray = by_set[:, 0] + accel / below * by_set[:, 1]
    return joined
