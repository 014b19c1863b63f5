"""Residual vibration from the transfer function at the pole (docs/theory.md, section 1)."""

import cmath
import math
from dataclasses import dataclass, replace

import numpy as np

from design.errors import InvalidInputError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.impulses import SAME_TIME, Impulses
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode
from design.model.reference_ramps import Reference, ramp_factors, reference
from design.response.closed_form import LagStates, lag_states, states_of
from design.types import ComplexArray, FloatArray

SLOWEST = 100.0
"""Largest time constant of a set times the plant's natural frequency [-]."""

LONGEST_RAMP_RAD = 6 * math.pi
"""Longest ramp to full speed, three periods: the formulations integrate no longer ones [rad]."""

RESONANCE = 1e-6
"""Below this ``|1/G|`` at the plant's pole, a set of the actuator rings with the plant [-]."""

LIMITS = ("accel_limit_m_s2", "decel_limit_m_s2")
"""Fields of the limits, in the order of the ramps that they make."""

SMALLEST_DENOMINATOR = 1e-12
"""Where a sensitivity curve meets a set's own pole, ``|1/G|`` is taken as this [-]."""


def require_workable(mode: Mode, actuator: Actuator) -> None:
    """Raise InvalidInputError if a set of the actuator is out of all proportion to the plant.

    A set with its own pole at the plant's rings with it, and a residual in units of the unshaped
    step means nothing; one a hundred times slower passes so little on that it drowns in rounding.
    """
    start, drive = "", actuator
    if isinstance(actuator, RateLimited):
        start, drive = "then.", actuator.then
    end = "_time_constant_s" if isinstance(drive, FirstOrder) else ""
    sets = (("accel", drive.accel_lag), ("decel", drive.decel_lag))
    for name, lag in ((f"{start}{one}{end}", lag) for one, lag in sets):
        slowness = mode.natural_frequency_rad_s * max(lag.first_s, lag.second_s2**0.5)
        if slowness > SLOWEST:
            raise InvalidInputError(
                f"actuator.{name}",
                f"{slowness:.3g} times slower",
                f"at most {SLOWEST:g} times slower than the plant",
            )
        distance = abs(lag.denominator(mode.pole_rad_s))
        if distance < RESONANCE:
            raise InvalidInputError(
                f"actuator.{name}",
                f"1/G = {distance:.1e} there",
                "without a pole at the plant's own, where it rings with it",
            )
    for name, ramp_s in zip(LIMITS, unit_ramps_s(actuator), strict=True):
        turn = mode.natural_frequency_rad_s * ramp_s
        if turn > LONGEST_RAMP_RAD:
            raise InvalidInputError(
                f"actuator.{name}",
                f"a ramp of {turn:.3g} rad of the plant's swing",
                f"such that a ramp to or from full speed takes at most {LONGEST_RAMP_RAD:.5g} rad",
            )
        left = abs(ramp_factors(np.array([mode.pole_rad_s]), np.array([ramp_s]))[0])
        if left < RESONANCE:
            raise InvalidInputError(
                f"actuator.{name}",
                f"a ramp of {turn:.9g} rad of the plant's swing",
                "such that a ramp does not last whole periods: alone it leaves no vibration",
            )


@dataclass(frozen=True, slots=True, eq=False)
class StepContributions:
    """What each change of the reference adds to the vibration, apart from the plant.

    ``V exp(s t_n) = sum (gain_i + s rate_i) G(s) exp(s (t_n - t_i))``, over both sets; the height
    of a ramp counts ``(1 - exp(-s T)) / (s T)`` times.

    Attributes
    ----------
    until_last_s
        Time from each change to the command's last step, shape (n,) [s].
    columns
        Gains by the acceleration set, by the deceleration set, then, if there are any, their rates,
        shape (n, 2) or (n, 4).
    ramps_s
        Durations of the ramps, shape (n,); None where all are steps [s].
    heights
        Gains that are a ramp's height and not in ``columns``, shape (n, 2); None for steps.
    """

    until_last_s: FloatArray
    columns: FloatArray
    ramps_s: FloatArray | None = None
    heights: FloatArray | None = None


def step_contributions(impulses: Impulses, actuator: Actuator) -> StepContributions:
    """Return what each change of the reference adds to the vibration, in closed form.

    A superposed step adds its height by its own set. Where one actuator is switched, its state is
    taken from the old set and given to the new, and each would let it ring in its own way.
    """
    changes = reference(impulses, actuator)
    until_last = impulses.times_s[-1] - changes.times_s
    heights = _heights(changes)
    limited = isinstance(actuator, RateLimited)
    if actuator.model == "superposed":
        columns = np.zeros_like(heights) if limited else heights
    else:
        second = np.array([[lag.second_s2 for lag in (actuator.accel_lag, actuator.decel_lag)]])
        columns = _passed_on(states_of(changes, actuator), changes, second)[0]
        if not limited:
            columns[:, :2] += heights
    if not limited:
        return StepContributions(until_last, columns)
    return StepContributions(until_last, columns, changes.ramps_s, heights)


def _heights(changes: Reference) -> FloatArray:
    """Return the changes by set, shape (n, 2)."""
    heights = np.zeros((changes.changes.size, 2))
    heights[:, 0] = np.where(changes.accelerates, changes.changes, 0.0)
    heights[:, 1] = changes.changes - heights[:, 0]
    return heights


def _passed_on(states: LagStates, changes: Reference, second_s2: FloatArray) -> FloatArray:
    """Gains and rates, shape (m, n, 4), that a switched lag's state adds where its set changes."""
    error, rate = states.errors.sum(axis=-1), states.rates_s.sum(axis=-1)
    forces = np.where(changes.accelerates, 0, 1)
    columns = np.zeros((*error.shape, 4))
    for which in (0, 1):
        # To the new set less from the old; at rest there is nothing to pass on.
        sign = (forces == which).astype(float)
        sign[1:] -= forces[:-1] == which
        columns[..., which] = -sign * error
        columns[..., 2 + which] = sign * second_s2[:, which, None] * rate
    return columns


def residual_vectors(
    impulses: Impulses, poles_rad_s: ComplexArray, actuator: Actuator
) -> ComplexArray:
    """Return the vibration vector at each pole over that of the unshaped step.

    Parameters
    ----------
    impulses
        The command.
    poles_rad_s
        Upper poles of the modes, shape (m,) [rad/s].
    actuator
        The actuator.

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
    return _joined(sums, poles_rad_s, actuator)


def terms_of_residual(impulses: Impulses, pole_rad_s: complex, actuator: Actuator) -> ComplexArray:
    """Return what each change of the reference adds to `residual_vectors` at one pole, shape (n,).

    A step is one change, a ramp too; one that reverses the command is two. Phases count from the
    first step, whose term is then real.
    """
    steps = step_contributions(impulses, actuator)
    columns = steps.columns.astype(np.complex128)
    if steps.ramps_s is not None and steps.heights is not None:
        factors = ramp_factors(np.array([pole_rad_s]), steps.ramps_s)
        columns[:, :2] += factors[:, None] * steps.heights
    turns = pole_rad_s * steps.until_last_s - 1j * pole_rad_s.imag * impulses.duration_s
    terms = np.exp(turns)[:, None] * columns
    return _joined(terms, np.array([pole_rad_s]), actuator)


def residuals_of_many(
    times_s: FloatArray, amplitudes: FloatArray, poles_rad_s: ComplexArray, actuator: Actuator
) -> FloatArray:
    """Return the residual vibration of many commands, each at a pole of its own, shape (m,) [-].

    Its parameters are those of `vectors_of_many`.
    """
    return np.abs(vectors_of_many(times_s, amplitudes, poles_rad_s, actuator))


def vectors_of_many(
    times_s: FloatArray, amplitudes: FloatArray, poles_rad_s: ComplexArray, actuator: Actuator
) -> ComplexArray:
    """Return `residual_vectors` of many commands, each at a pole of its own.

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
        # Steps that meet are one, of a sign of its own.
        meeting = gaps <= SAME_TIME * (times_s[:, -1:] - times_s[:, :1])
        whole = disordered | ~np.any(meeting, axis=1)
    elif changes.changes.size == amplitudes.size:
        whole = disordered | np.all(gaps >= changes.ramps_s[:-1], axis=1)
    else:  # a reversal makes two changes of a step
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
    heights = _heights(changes).astype(np.complex128)
    swings = np.exp(poles_rad_s[:, None] * (changes.times_s[:, -1:] - changes.times_s))
    limited = changes.ramps_s.any()
    ramped = swings * ramp_factors(poles_rad_s[:, None], changes.ramps_s) if limited else swings
    sums = ramped @ heights
    if actuator.model == "switched":
        lags = (actuator.accel_lag, actuator.decel_lag)
        second = np.array([[lag.second_s2 for lag in lags]])
        columns = _passed_on(states_of(changes, actuator), changes, second)
        passed = (swings[:, None, :] @ columns.astype(np.complex128))[:, 0]
        sums = np.concatenate((passed[:, :2] + sums, passed[:, 2:]), axis=1)
    return _joined(sums, poles_rad_s, actuator)


def residuals_of_cases(
    impulses: Impulses,
    poles_rad_s: ComplexArray,
    first_s: FloatArray,
    second_s2: FloatArray,
    model: Model,
) -> FloatArray:
    """Return the residual vibration of one command for many plants and actuators.

    Parameters
    ----------
    impulses
        The command.
    poles_rad_s
        Poles of the plants, shape (m,) [rad/s].
    first_s, second_s2
        Coefficients of the actuators' lags, columns accel and decel, shape (m, 2) [s], [s^2].
    model
        Of all actuators, none of them rate-limited.

    Returns
    -------
    FloatArray
        Residual vibration, shape (m,) [-].
    """
    changes = reference(impulses, Ideal())
    columns = _heights(changes)
    if model == "switched":
        columns = _passed_on(lag_states(changes, first_s, second_s2, model), changes, second_s2)
        columns[..., :2] += _heights(changes)
    s = poles_rad_s[:, None]
    swings = np.exp(s * (impulses.times_s[-1] - impulses.times_s))
    sums = (swings[:, None, :] @ columns.astype(np.complex128))[:, 0]
    below = 1 + s * (first_s + s * second_s2)
    return np.abs(_over_accel(sums, poles_rad_s, below[:, 0], below[:, 1]))


def evenly_spaced_vectors(
    impulses: Impulses, first_rad_s: complex, last_rad_s: complex, points: int, actuator: Actuator
) -> ComplexArray:
    """Return `residual_vectors` at ``points`` poles, evenly spaced on a line.

    The exponentials of an even spacing are products of two short lists, coarse and fine, so that
    ``2 sqrt(points)`` of them do and a matrix product does the rest.
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
    return _joined(vectors, poles, actuator)


def _joined(sums: ComplexArray, poles_rad_s: ComplexArray, actuator: Actuator) -> ComplexArray:
    """Join the columns, summed over the steps, in units of the unshaped step."""
    accel, decel = (
        lag.denominator(poles_rad_s) for lag in (actuator.accel_lag, actuator.decel_lag)
    )
    vectors = _over_accel(sums, poles_rad_s, accel, decel)
    rise_s, _ = unit_ramps_s(actuator)
    return vectors / ramp_factors(poles_rad_s, np.array(rise_s)) if rise_s > 0 else vectors


def _over_accel(
    sums: ComplexArray, poles_rad_s: ComplexArray, accel: ComplexArray, decel: ComplexArray
) -> ComplexArray:
    """Join gains and rates, shape (m, 2) or (m, 4), by the sets' denominators: over G_accel."""
    # On the pole of the deceleration set itself the vibration grows without bound: cut, finite.
    below = np.where(np.abs(decel) < SMALLEST_DENOMINATOR, SMALLEST_DENOMINATOR, decel)
    by_set = sums[:, :2] + poles_rad_s[:, None] * sums[:, 2:] if sums.shape[1] > 2 else sums  # noqa: PLR2004
    joined: ComplexArray = by_set[:, 0] + accel / below * by_set[:, 1]
    return joined


def unshaped_gain(mode: Mode, actuator: Actuator) -> float:
    """Return what an unshaped step leaves, over what one through an ideal actuator does [-]."""
    rise_s, _ = unit_ramps_s(actuator)
    ramp = abs(ramp_factors(np.array([mode.pole_rad_s]), np.array([rise_s]))[0])
    return float(ramp / abs(actuator.accel_lag.denominator(mode.pole_rad_s)))


def unshaped_deflection_s(mode: Mode, actuator: Actuator) -> float:
    """Return the amplitude that an unshaped step leaves at the payload, over its speed [s].

    Times a residual and the speed it is the amplitude of what remains, extrapolated back likewise.
    A vector V rings as ``d = -Im(V exp(s t)) / Im(s)``: the damped frequency it is, not w.

    Examples
    --------
    >>> from design.model.actuators.ideal import Ideal
    >>> half_damped = Mode(natural_frequency_rad_s=2.0, damping_ratio=0.5)
    >>> round(unshaped_deflection_s(half_damped, Ideal()), 5)
    0.57735
    """
    return unshaped_gain(mode, actuator) / mode.pole_rad_s.imag


def residual_vibration(
    impulses: Impulses, mode: Mode, actuator: Actuator, swing: FreeSwing | None = None
) -> float:
    """Return the residual vibration of a command, a share of one unshaped step [-].

    The amplitude of free vibration, extrapolated back to the last step, over the amplitude that
    an unshaped unit step leaves through the acceleration set. The actuator's own transient is
    not part of it. A whole move (amplitudes sum to 0) is measured by the same unit, and so is what
    is left of a swing that the payload made at the first step already.

    Examples
    --------
    >>> import numpy as np
    >>> from design.model.actuators.ideal import Ideal
    >>> half_period = Impulses(times_s=np.array([0.0, np.pi]), amplitudes=np.array([0.5, 0.5]))
    >>> residual_vibration(half_period, Mode(natural_frequency_rad_s=1.0), Ideal()) < 1e-15
    True
    """
    vector = residual_vectors(impulses, np.array([mode.pole_rad_s]), actuator)[0]
    if swing is not None:
        turn = cmath.exp(mode.pole_rad_s * impulses.duration_s)
        vector += turn * swing_over_step(swing, mode, actuator)
    return float(abs(vector))


def swing_over_step(swing: FreeSwing, mode: Mode, actuator: Actuator) -> complex:
    """Return the vector of a swing over that of the unshaped step, at the first step [-]."""
    pole = mode.pole_rad_s
    rise_s, _ = unit_ramps_s(actuator)
    ramp = complex(ramp_factors(np.array(pole), np.array(rise_s)))
    return swing.vector(mode) * actuator.accel_lag.denominator(pole) / ramp


def residual_curve(
    impulses: Impulses, mode: Mode, actuator: Actuator, frequency_ratios: FloatArray
) -> FloatArray:
    """Return the residual vibration with the natural frequency scaled by each ratio.

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
