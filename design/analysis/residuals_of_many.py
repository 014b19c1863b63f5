"""Residual vibration of many commands, or behind many actuators, at once."""

from dataclasses import replace

import numpy as np

from design.analysis.passed_on_state import pass_on_state
from design.analysis.residual import join_over_accel, join_sets, residual_vectors
from design.analysis.step_contributions import heights_by_set
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.impulses import SAME_TIME, Impulses
from design.model.plants.mode import Mode
from design.model.ramps import Reference, ramp_factors
from design.model.reference_ramps import reference
from design.response.closed_form import lag_states, states_of
from design.types import ComplexArray, FloatArray


def residuals_of_many(
    times_s: FloatArray, amplitudes: FloatArray, poles_rad_s: ComplexArray, actuator: Actuator
) -> FloatArray:
    """Return the residuals of many commands, each at a separate pole.

    Parameters
    ----------
    times_s
        Times of the steps, shape (m, n) [s].
    amplitudes
        Their heights, the same for all, shape (n,) [-].
    poles_rad_s
        A pole for each command, shape (m,) [rad/s].
    actuator
        The actuator.

    Returns
    -------
    FloatArray
        Residual vibration, shape (m,) [-].
    """
    return np.abs(vectors_of_many(times_s, amplitudes, poles_rad_s, actuator))


def vectors_of_many(
    times_s: FloatArray, amplitudes: FloatArray, poles_rad_s: ComplexArray, actuator: Actuator
) -> ComplexArray:
    """Return the vibration vectors of commands, each at its own pole.

    Parameters
    ----------
    times_s
        Times of the steps, shape (m, n) [s].
    amplitudes
        Their heights, the same for all, shape (n,) [-].
    poles_rad_s
        A pole for each command, shape (m,) [rad/s].
    actuator
        The actuator.

    Returns
    -------
    ComplexArray
        Vibration vector over that of the unshaped step, shape (m,) [-].
    """
    # The signs of the changes are the same for all, whatever their times.
    changes = _apart(amplitudes, actuator)
    gaps = np.diff(times_s)
    # Times that a poor fit puts out of order are no command: judged as if ramps could overlap.
    disordered = np.any(gaps < 0, axis=1)
    if not isinstance(actuator, RateLimited):
        # Steps that meet are one, with the sign of their sum.
        meeting = gaps <= SAME_TIME * (times_s[:, -1:] - times_s[:, :1])
        whole = disordered | ~np.any(meeting, axis=1)
    elif changes.changes.size == amplitudes.size:
        whole = disordered | np.all(gaps >= changes.ramps_s[:-1], axis=1)
    else:  # a reversal makes two changes of a step, a limit to the jerk two or three
        whole = np.full(len(times_s), fill_value=False)
    vectors = np.empty(len(times_s), dtype=np.complex128)
    if whole.any():
        those = replace(changes, times_s=times_s[whole])
        vectors[whole] = _vectors_of_whole(those, poles_rad_s[whole], actuator)
    for row in np.flatnonzero(~whole).tolist():
        command = Impulses(times_s=times_s[row], amplitudes=amplitudes)
        vectors[row] = residual_vectors(command, poles_rad_s[row : row + 1], actuator)[0]
    return vectors


def _apart(amplitudes: FloatArray, actuator: Actuator) -> Reference:
    """Return what steps make where each comes long after the ramp of the one before."""
    longest = float(np.abs(amplitudes).sum()) * sum(unit_ramps_s(actuator)) + 1.0
    times = longest * np.arange(amplitudes.size)
    return reference(Impulses(times_s=times, amplitudes=amplitudes), actuator)


def _vectors_of_whole(
    changes: Reference, poles_rad_s: ComplexArray, actuator: Actuator
) -> ComplexArray:
    """Return `vectors_of_many` where no ramp is cut; times of shape (m, n)."""
    heights = heights_by_set(changes).astype(np.complex128)
    ends = changes.times_s[:, -1:] + changes.ramps_s[-1]
    swings = np.exp(poles_rad_s[:, None] * (ends - changes.times_s))
    limited = changes.ramps_s.any()
    ramped = swings * ramp_factors(poles_rad_s[:, None], changes.ramps_s) if limited else swings
    sums = ramped @ heights
    if actuator.model == "switched":
        lags = (actuator.accel_lag, actuator.decel_lag)
        second = np.array([[lag.second_s2 for lag in lags]])
        columns = pass_on_state(states_of(changes, actuator), changes, second)
        passed = (swings[:, None, :] @ columns.astype(np.complex128))[:, 0]
        sums = np.concatenate((passed[:, :2] + sums, passed[:, 2:]), axis=1)
    return join_sets(sums, poles_rad_s, actuator)


def residuals_of_cases(
    impulses: Impulses,
    poles_rad_s: ComplexArray,
    first_s: FloatArray,
    second_s2: FloatArray,
    model: Model,
    limits: RateLimited | None = None,
) -> FloatArray:
    """Return the residuals of one command for many plants and actuators.

    Parameters
    ----------
    impulses
        The command.
    poles_rad_s
        Poles of the plants, shape (m,) [rad/s].
    first_s, second_s2
        Coefficients of the actuators' lags, columns accel and decel, shape (m, 2) [s], [s^2].
    model
        Of all actuators.
    limits
        Those that all of them have; what follows its ramps does not count. None without limits.

    Returns
    -------
    FloatArray
        Residual vibration, shape (m,) [-].
    """
    changes = reference(impulses, Ideal() if limits is None else limits)
    heights = heights_by_set(changes)
    columns = heights if limits is None else np.zeros_like(heights)
    if model == "switched":
        passed = pass_on_state(lag_states(changes, first_s, second_s2, model), changes, second_s2)
        passed[..., :2] += columns
        columns = passed
    s = poles_rad_s[:, None]
    swings = np.exp(s * (changes.times_s[-1] + changes.ramps_s[-1] - changes.times_s))
    sums = (swings[:, None, :] @ columns.astype(np.complex128))[:, 0]
    if limits is not None:
        sums[:, :2] += (swings * changes.factors(s)) @ heights.astype(np.complex128)
    below = 1 + s * (first_s + s * second_s2)
    return np.abs(join_over_accel(sums, poles_rad_s, below[:, 0], below[:, 1]))


def residual_curve(
    impulses: Impulses, mode: Mode, actuator: Actuator, frequency_ratios: FloatArray
) -> FloatArray:
    """Return the residual at each ratio of true and nominal frequency.

    Damping ratio and times stay; the pole and the normalising step move along.

    Parameters
    ----------
    impulses
        The command.
    mode, actuator
        The nominal mode and its actuator.
    frequency_ratios
        True frequency over the nominal one, shape (m,), > 0 [-].

    Returns
    -------
    FloatArray
        Residual vibration, shape (m,) [-].
    """
    return np.abs(residual_vectors(impulses, mode.pole_rad_s * frequency_ratios, actuator))
