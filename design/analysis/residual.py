"""Residual vibration from the transfer function at the pole (docs/theory.md, section 1)."""

import math
from dataclasses import dataclass

import numpy as np

from design.actuators import IDEAL_LAG, Actuator, Model, free_motions
from design.errors import InvalidInputError
from design.impulses import Impulses
from design.plants import Mode
from design.responses import LagStates, lag_states, switched_states_of_many
from design.types import ComplexArray, FloatArray

SLOWEST = 100.0
"""Largest time constant of a set times the plant's natural frequency [-]."""

RESONANCE = 1e-6
"""Below this ``|1/G|`` at the plant's pole, a set of the actuator rings with the plant [-]."""

SMALLEST_DENOMINATOR = 1e-12
"""Where a sensitivity curve meets a set's own pole, ``|1/G|`` is taken as this [-]."""


def require_workable(mode: Mode, actuator: Actuator) -> None:
    """Raise InvalidInputError if a set of the actuator is out of all proportion to the plant.

    A set with its own pole at the plant's rings with it, and a residual in units of the unshaped
    step means nothing; one a hundred times slower passes so little on that it drowns in rounding.
    """
    for name, lag in (("accel", actuator.accel_lag), ("decel", actuator.decel_lag)):
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


@dataclass(frozen=True, slots=True, eq=False)
class StepContributions:
    """What each step adds to the vibration, apart from the plant.

    ``V exp(s t_n) = sum (gain_i + s rate_i) G(s) exp(s (t_n - t_i))``, over both sets.

    Attributes
    ----------
    until_last_s
        Time from each step to the last, shape (n,) [s].
    columns
        Gains by the acceleration set, by the deceleration set, then their rates, shape (n, 4).
    """

    until_last_s: FloatArray
    columns: FloatArray


def step_contributions(impulses: Impulses, actuator: Actuator) -> StepContributions:
    """Return what each step adds to the vibration, in closed form.

    A superposed step adds its height by its own set. Where one actuator is switched, its state is
    taken from the old set and given to the new, and each would let it ring in its own way.
    """
    if actuator.model == "superposed":
        columns: FloatArray = np.zeros((impulses.times_s.size, 4))
        columns[:, 0] = np.where(impulses.accelerates, impulses.amplitudes, 0.0)
        columns[:, 1] = impulses.amplitudes - columns[:, 0]
    else:
        columns = _switched_columns(lag_states(impulses, actuator), actuator)
    return StepContributions(impulses.times_s[-1] - impulses.times_s, columns)


def _switched_columns(states: LagStates, actuator: Actuator) -> FloatArray:
    """Columns of `StepContributions` of one command or many, shape (..., n, 4)."""
    lags = (actuator.accel_lag, actuator.decel_lag)
    gains = states.before - states.after
    # A set that follows at once moves the velocity itself: a lag with G = 1.
    gains[..., 0 if lags[0] == IDEAL_LAG else 1] += states.velocity_jumps
    rates = (states.rates_after - states.rates_before) * [lag.second_s2 for lag in lags]
    return np.concatenate((gains, rates), axis=-1)


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
    return _joined(swings @ steps.columns.astype(np.complex128), poles_rad_s, actuator)


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
    first = Impulses(times_s=np.zeros(amplitudes.size), amplitudes=amplitudes)
    swings = np.exp(poles_rad_s[:, None] * (times_s[:, -1:] - times_s))
    if actuator.model == "superposed":
        columns = step_contributions(first, actuator).columns
    else:
        states = switched_states_of_many(times_s, amplitudes, first.accelerates, actuator)
        columns = _switched_columns(states, actuator)
    sums = (swings[:, None, :] @ columns.astype(np.complex128))[:, 0]
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
        Of all actuators.

    Returns
    -------
    FloatArray
        Residual vibration, shape (m,) [-].
    """
    s = poles_rad_s[:, None]
    below = 1 + s * (first_s + s * second_s2)
    gains = 1 / np.where(np.abs(below) < SMALLEST_DENOMINATOR, SMALLEST_DENOMINATOR, below)
    vectors = np.zeros(poles_rad_s.size, dtype=np.complex128)
    error, rate = np.zeros((2, poles_rad_s.size))  # the rate times the time scale of the set
    before = -1
    last = impulses.times_s[-1]
    steps = zip(
        impulses.times_s.tolist(),
        impulses.amplitudes.tolist(),
        impulses.accelerates.tolist(),
        strict=True,
    )
    previous = 0.0
    for time, amplitude, rising in steps:
        after = 0 if rising else 1
        added = amplitude * gains[:, after]
        if model == "switched":
            if before >= 0:
                scale = np.sqrt(second_s2[:, before])
                gap = np.array([time - previous])
                motion = free_motions(first_s[:, before], second_s2[:, before], gap)
                error, rate = (
                    motion[:, 0, 0] * error + motion[:, 0, 1] * rate,
                    motion[:, 1, 0] * error + motion[:, 1, 1] * rate,
                )
                rate_s = np.where(scale > 0, rate / np.where(scale > 0, scale, 1.0), 0.0)
                for which, sign in ((after, 1.0), (before, -1.0)):
                    ringing = second_s2[:, which] * poles_rad_s * rate_s - error
                    added = added + sign * gains[:, which] * ringing
                rate = rate_s * np.sqrt(second_s2[:, after])
            error = error - amplitude
            before, previous = after, time
        vectors += added * np.exp(poles_rad_s * (last - time))
    return np.abs(vectors * below[:, 0])


def evenly_spaced_vectors(
    impulses: Impulses, first_rad_s: complex, last_rad_s: complex, points: int, actuator: Actuator
) -> ComplexArray:
    """Return `residual_vectors` at ``points`` poles, evenly spaced on a line.

    The exponentials of an even spacing are products of two short lists, coarse and fine, so that
    ``2 sqrt(points)`` of them do and a matrix product does the rest.
    """
    steps = step_contributions(impulses, actuator)
    step = (last_rad_s - first_rad_s) / (points - 1)
    block = math.isqrt(points - 1) + 1
    coarse = np.exp(
        np.multiply.outer(steps.until_last_s, first_rad_s + step * np.arange(0, points, block))
    )
    fine = np.exp(np.multiply.outer(np.arange(block) * step, steps.until_last_s))
    summed = fine @ (steps.columns.T[:, :, None] * coarse)  # (4, block, blocks)
    vectors: ComplexArray = summed.transpose(2, 1, 0).reshape(-1, 4)[:points]
    return _joined(vectors, first_rad_s + step * np.arange(points), actuator)


def _joined(sums: ComplexArray, poles_rad_s: ComplexArray, actuator: Actuator) -> ComplexArray:
    """Join the columns, summed over the steps, shape (m, 4), in units of the unshaped step."""
    below = actuator.decel_lag.denominator(poles_rad_s)
    # On the pole of the deceleration set itself the vibration grows without bound: cut, finite.
    below = np.where(np.abs(below) < SMALLEST_DENOMINATOR, SMALLEST_DENOMINATOR, below)
    ratio = actuator.accel_lag.denominator(poles_rad_s) / below
    if actuator.model == "switched":
        sums = sums[:, :2] + poles_rad_s[:, None] * sums[:, 2:]
    joined: ComplexArray = sums[:, 0] + ratio * sums[:, 1]
    return joined


def residual_vibration(impulses: Impulses, mode: Mode, actuator: Actuator) -> float:
    """Return the residual vibration of a command, a share of one unshaped step [-].

    The amplitude of free vibration, extrapolated back to the last step, over the amplitude that
    an unshaped unit step leaves through the acceleration set. The actuator's own transient is
    not part of it. A whole move (amplitudes sum to 0) is measured by the same unit.

    Examples
    --------
    >>> import numpy as np
    >>> from design.actuators import Ideal
    >>> half_period = Impulses(times_s=np.array([0.0, np.pi]), amplitudes=np.array([0.5, 0.5]))
    >>> residual_vibration(half_period, Mode(natural_frequency_rad_s=1.0), Ideal()) < 1e-15
    True
    """
    return float(residual_curve(impulses, mode, actuator, np.ones(1))[0])


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
