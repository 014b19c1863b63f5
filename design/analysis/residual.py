"""Residual vibration of a command at one pole or many, from the transfer function."""

import cmath
import math

import numpy as np

from design.analysis.step_contributions import step_contributions
from design.analysis.swing import swing_over_step
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode
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
        ``V exp(s t_e) / G_accel(s)``, t_e the end of the reference, shape (m,) [-]; the residual
        vibration is its magnitude.
    """
    steps = step_contributions(impulses, actuator)
    swings = np.exp(np.multiply.outer(poles_rad_s, steps.until_end_s))
    sums = swings @ steps.columns.astype(np.complex128)
    if steps.ramps is not None and steps.heights is not None:
        ramped = swings * steps.ramps.factors(poles_rad_s[:, None])
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
    coarse = np.exp(np.multiply.outer(steps.until_end_s, poles[::block]))
    fine = np.exp(np.multiply.outer(np.arange(block) * step, steps.until_end_s))
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
    sums, poles_rad_s
        Gains by either set, then their rates, if any, shape (m, 2) or (m, 4) [-], [s]; upper poles,
        shape (m,) or (1,) [rad/s].
    accel, decel
        ``1 / G`` of either set there, shape (m,) or (1,) [-].

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


def residual_vibration(
    impulses: Impulses, mode: Mode, actuator: Actuator, swing: FreeSwing | None = None
) -> float:
    """Return the residual vibration over that of an unshaped step [-].

    The amplitude of free vibration, extrapolated back to the last step (the end of the last ramp
    behind limits), over the amplitude after an unshaped unit step through the acceleration set. The
    actuator's own transient is not part of it. A whole move (amplitudes sum to 0) is measured by
    the same unit, and so is what is left of a swing that the payload made at the first step.

    Parameters
    ----------
    impulses, mode, actuator
        The command, the mode and its drive; no set may have its own pole at the mode's.
    swing
        What the payload swings already at the first step; None for a plant at rest.

    Returns
    -------
    float
        At least 0 [-]; 1 for the unshaped step itself.
    """
    vector = residual_vectors(impulses, np.array([mode.pole_rad_s]), actuator)[0]
    if swing is not None:
        steps = step_contributions(impulses, actuator)
        turn = cmath.exp(mode.pole_rad_s * steps.until_end_s[0])
        vector += turn * swing_over_step(swing, mode, actuator)
    return float(abs(vector))
