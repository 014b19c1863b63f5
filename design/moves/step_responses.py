"""What steps at given times and of given sets make, each of height 1: all of it is linear in them.

A switched drive too: what its one state passes on at each change of set is linear in the steps
before, as long as these come at the same times and by the same sets.
"""

from dataclasses import dataclass

import numpy as np

from design.model.actuators.registry import Actuator
from design.model.initial_state import FreeSwing
from design.model.lag_motions import free_motions
from design.model.plants.mode import Mode
from design.types import BoolArray, ComplexArray, FloatArray

NODES = 12
"""Frequencies on a circle around the plant's, for a derivative by Cauchy's formula [-]."""

TURN_RAD = 0.25
"""Turn of the phase over the circle's radius: the first power that the nodes confuse with the
derivative is below rounding [rad]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StepResponses:
    """What each step makes, and what is there without them.

    Attributes
    ----------
    vectors
        Residual vibration at the end of the command, over an unshaped step's, shape (k, m): the
        first row itself, then, where asked, the derivative by the logarithm of the frequency.
    swings
        The same of a swing that the payload makes already, shape (k,).
    travel_s
        Way behind the drive over full speed, shape (m,) [s].
    """

    vectors: ComplexArray
    swings: ComplexArray
    travel_s: FloatArray


def circle(mode: Mode, lasting_s: float, *, slope: bool) -> ComplexArray:
    """Return the frequencies at which `with_derivative` wants values.

    Parameters
    ----------
    mode
        The plant's mode.
    lasting_s
        How long the command lasts [s].
    slope
        Whether the derivative is wanted too.

    Returns
    -------
    ComplexArray
        Over the plant's own, which is the first, shape (r,) [-].
    """
    if not slope:
        return np.ones(1, dtype=np.complex128)
    radius = TURN_RAD / max(1.0, mode.natural_frequency_rad_s * lasting_s)
    turns = np.exp(2j * np.pi * np.arange(NODES) / NODES)
    ratios: ComplexArray = np.concatenate(([1.0], 1 + radius * turns))
    return ratios


def with_derivative(values: ComplexArray, ratios: ComplexArray) -> ComplexArray:
    """Return values at the plant's frequency, and their derivative.

    By the logarithm of the frequency, where values on a circle are given too.

    Parameters
    ----------
    values
        Of a function without poles, at each of the ratios, shape (r, ...).
    ratios
        Of `circle`, shape (r,) [-].

    Returns
    -------
    ComplexArray
        Shape (1, ...) or (2, ...).
    """
    if ratios.size == 1:
        return values
    weights = 1 / (ratios[1:] - 1) / NODES
    found: ComplexArray = np.stack((values[0], np.tensordot(weights, values[1:], axes=1)))
    return found


def swinging(swing: FreeSwing | None, mode: Mode, ratios: ComplexArray) -> ComplexArray:
    """Return what a swing adds to the vibration.

    Parameters
    ----------
    swing
        What the payload swings at the first step.
    mode
        The plant's mode.
    ratios
        Its frequency over the plant's own, shape (r,), complex too [-].

    Returns
    -------
    ComplexArray
        Seen at the first step, shape (r,) [-].
    """
    if swing is None:
        return np.zeros(ratios.size, dtype=np.complex128)
    pole = mode.pole_rad_s
    own = pole.conjugate() * ratios * swing.deflection_s - swing.rate
    turned: ComplexArray = (
        own * ratios**swing.frequency_power * np.exp(pole * ratios * swing.delay_s)
    )
    return turned


def step_responses(
    times_s: FloatArray,
    rising: BoolArray,
    mode: Mode,
    actuator: Actuator,
    *,
    swing: FreeSwing | None,
    slope: bool,
) -> StepResponses:
    """Return what steps of height 1 make at the end of the command.

    Parameters
    ----------
    times_s, rising
        When, ascending, and which go by the acceleration set, shape (m,) each [s].
    mode, actuator
        The plant's mode and its drive, without limits.
    swing
        What the payload swings at the first of the times.
    slope
        Whether the derivative by the logarithm of the frequency is wanted too.

    Returns
    -------
    StepResponses
        Times the denominator of the deceleration set over what it is at the plant's frequency:
        the derivative of that product is zero where both are, and has no pole.
    """
    ratios = circle(mode, float(times_s[-1] - times_s[0]), slope=slope)
    poles = mode.pole_rad_s * ratios
    lags = (actuator.accel_lag, actuator.decel_lag)
    accel, decel = (lag.denominator(poles) for lag in lags)
    left = np.exp(np.multiply.outer(poles, times_s[-1] - times_s))
    by_set = np.stack((left * decel[:, None], left * accel[:, None]))
    sets = np.where(rising, 0, 1)
    vectors = np.where(rising, by_set[0], by_set[1])
    first = np.array([lag.first_s for lag in lags])
    travel = times_s[0] - times_s - first[sets]
    if actuator.model == "switched":
        passed, lagging = _passed_on(times_s, sets, poles, by_set, actuator)
        vectors = vectors + passed
        travel = times_s[0] - times_s - lagging
    swings = left[:, 0] * accel * decel * swinging(swing, mode, ratios)
    unit = decel[0]
    return StepResponses(
        vectors=with_derivative(vectors, ratios) / unit,
        swings=with_derivative(swings, ratios) / unit,
        travel_s=travel,
    )


def _passed_on(
    times_s: FloatArray,
    sets: FloatArray,
    poles: ComplexArray,
    by_set: ComplexArray,
    actuator: Actuator,
) -> tuple[ComplexArray, FloatArray]:
    """Return what a switched state adds to the vibration, and the way lost to the lags."""
    lags = (actuator.accel_lag, actuator.decel_lag)
    first = np.array([lag.first_s for lag in lags])
    second = np.array([lag.second_s2 for lag in lags])
    count = times_s.size
    gaps = np.diff(times_s)
    flows = free_motions(first[sets[:-1]], second[sets[:-1]], gaps)
    corners = np.where(second > 0, second, 1.0)[sets[:-1]] ** -0.5
    flows[:, 0, 1] /= corners
    flows[:, 1, 0] *= corners
    added = np.zeros((poles.size, count), dtype=np.complex128)
    lagging = np.zeros(count)
    state = np.zeros((2, count))  # Velocity less reference, and its rate, by each step
    before = np.zeros((2, count))  # Velocity and its rate at the last change
    for number in range(count + 1):
        if number == count:
            now = np.zeros((2, count))  # At rest in the end, at the sum of all steps
            now[0] = 1.0
        else:
            now = state.copy()
            now[0, :number] += 1.0
        if number > 0:
            force = sets[number - 1]
            lagging += first[force] * (now[0] - before[0]) + second[force] * (now[1] - before[1])
            if number < count and force != sets[number]:
                for which, sign in ((sets[number], 1.0), (force, -1.0)):
                    gain = by_set[which, :, number, None]
                    rates = poles[:, None] * second[which] * state[1]
                    added += sign * gain * (rates - state[0])
        if number < count - 1:
            state[0, number] -= 1.0
            before = now
            state = flows[number] @ state
        else:
            before = now
    return added, lagging
