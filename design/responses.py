"""Exact response of actuator and mode to a stepped command, in closed form.

Between two steps every lag moves freely and the mode rings; `Lag.free_motion` and one complex
exponential say how, for any damping. Nothing is stepped through time.
"""

import math
from dataclasses import dataclass

import numpy as np

from design.actuators import IDEAL_LAG, Actuator, Lag
from design.errors import InvalidInputError
from design.impulses import Impulses
from design.plants import Mode
from design.types import BoolArray, ComplexArray, FloatArray

AT_REST = 1e-12
"""Share of all steps within which their sum counts as 0: rounding of as many additions [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class LagStates:
    """Velocity less command, and its rate, around each of n steps; columns: accel, decel set.

    A switched actuator has one state, which stands in the column of the set in force. Of many
    commands, each array has one more axis, ahead of the others.

    Attributes
    ----------
    before, rates_before
        Just before each step, shape (n, 2) [-], [1/s].
    after, rates_after
        Just after it, shape (n, 2) [-], [1/s].
    velocity_jumps
        By how much the velocity itself jumps, into a set that follows at once, shape (n,) [-].
    """

    before: FloatArray
    rates_before: FloatArray
    after: FloatArray
    rates_after: FloatArray
    velocity_jumps: FloatArray


def lag_states(impulses: Impulses, actuator: Actuator) -> LagStates:
    """Return the states of the actuator around each step of a command."""
    lags = (actuator.accel_lag, actuator.decel_lag)
    gaps = impulses.times_s[1:] - impulses.times_s[:-1]
    motions = [lag.free_motion(gaps).tolist() for lag in lags]
    switched = actuator.model == "switched"
    count = impulses.times_s.size
    before, after = np.zeros((2, count, 2)), np.zeros((2, count, 2))
    state = [(0.0, 0.0), (0.0, 0.0)]  # error and rate of either set
    steps = zip(impulses.accelerates.tolist(), impulses.amplitudes.tolist(), strict=True)
    for index, (rising, amplitude) in enumerate(steps):
        if index > 0:
            state = [
                _moved(lag, motion[index - 1], *one)
                for lag, motion, one in zip(lags, motions, state, strict=True)
            ]
        before[:, index] = np.transpose(state)
        force = 0 if rising else 1
        error, rate = state[force]
        if switched and state[1 - force] != (0.0, 0.0):
            error, rate = state[1 - force]
            state[1 - force] = (0.0, 0.0)
        state[force] = (error - amplitude, rate) if lags[force] != IDEAL_LAG else (0.0, 0.0)
        after[:, index] = np.transpose(state)
    jumps = impulses.amplitudes + (after[0] - before[0]).sum(axis=1)
    if IDEAL_LAG not in lags:
        jumps[:] = 0.0  # but for rounding
    return LagStates(before[0], before[1], after[0], after[1], jumps)


def switched_states_of_many(
    times_s: FloatArray, amplitudes: FloatArray, accelerates: BoolArray, actuator: Actuator
) -> LagStates:
    """Return the `lag_states` of many commands of a switched actuator at once.

    Parameters
    ----------
    times_s
        Times of the steps, shape (m, n), not decreasing along a row [s].
    amplitudes, accelerates
        Heights of the steps and which increase the command, the same for all, shape (n,).
    actuator
        The actuator, switched.

    Returns
    -------
    LagStates
        Arrays of shape (m, n, 2), the jumps (m, n).
    """
    lags = (actuator.accel_lag, actuator.decel_lag)
    shape = (*times_s.shape, 2)
    before, rates_before = np.zeros(shape), np.zeros(shape)
    after, rates_after = np.zeros(shape), np.zeros(shape)
    error = rate = np.zeros(len(times_s))
    force = 0
    for index, rising in enumerate(accelerates.tolist()):
        if index > 0:
            lag = lags[force]
            motion = lag.free_motion(times_s[:, index] - times_s[:, index - 1])
            scaled = rate / lag.corner_rad_s if lag.corner_rad_s > 0 else rate
            error, rate = (
                motion[:, 0, 0] * error + motion[:, 0, 1] * scaled,
                lag.corner_rad_s * (motion[:, 1, 0] * error + motion[:, 1, 1] * scaled),
            )
            before[:, index, force], rates_before[:, index, force] = error, rate
        force = 0 if rising else 1
        error = error - amplitudes[index]
        if lags[force] == IDEAL_LAG:
            error = rate = np.zeros(len(times_s))
        after[:, index, force], rates_after[:, index, force] = error, rate
    jumps = amplitudes + (after - before).sum(axis=-1)
    if IDEAL_LAG not in lags:
        jumps[:] = 0.0  # but for rounding
    return LagStates(before, rates_before, after, rates_after, jumps)


def _moved(lag: Lag, motion: list[list[float]], error: float, rate_s: float) -> tuple[float, float]:
    (a, b), (c, d) = motion
    corner = lag.corner_rad_s
    scaled = rate_s / corner if corner > 0 else 0.0
    return a * error + b * scaled, corner * (c * error + d * scaled)


def travel(impulses: Impulses, actuator: Actuator) -> float:
    """Return the distance of a rest-to-rest command at full speed 1: the integral of v [s].

    Exact in both models; times the speed it is a distance.

    Parameters
    ----------
    impulses
        A command that ends at level 0: its amplitudes sum to 0.
    actuator
        The actuator; it comes to rest after the last step.

    Raises
    ------
    InvalidInputError
        If the command does not come back to 0: the distance has no end.

    Notes
    -----
    A lag's error e = v - u obeys ``e + first v' + second v'' = 0``: over a segment its integral is
    ``first (e0 - e1) + second (e0' - e1')``. Summed over all, what each step changes is left.

    Examples
    --------
    >>> from design.actuators import FirstOrder
    >>> drive = FirstOrder(accel_time_constant_s=0.3, decel_time_constant_s=0.1)
    >>> move = Impulses(times_s=np.array([0.0, 2.0]), amplitudes=np.array([1.0, -1.0]))
    >>> round(travel(move, drive), 12)
    1.8
    """
    end = float(impulses.amplitudes.sum())
    if abs(end) > AT_REST * float(np.abs(impulses.amplitudes).sum()):
        raise InvalidInputError("amplitudes", f"a sum of {end:g}", "of sum 0: a command to rest")
    states = lag_states(impulses, actuator)
    lags = (actuator.accel_lag, actuator.decel_lag)
    errors = (states.after - states.before).sum(axis=0)
    rates = (states.rates_after - states.rates_before).sum(axis=0)
    lagging = errors @ [lag.first_s for lag in lags] + rates @ [lag.second_s2 for lag in lags]
    # Times from the first step on: a late clock would only cost digits.
    return float(lagging - impulses.amplitudes @ (impulses.times_s - impulses.times_s[0]))


def ringing_of_lag(
    lag: Lag, errors: FloatArray, rates_s: FloatArray, pole_rad_s: complex
) -> ComplexArray:
    """Return what a lag's state will have left in the mode once it is at rest [-].

    ``G (second s e' - e)``: its free motion from there, seen at the pole.
    """
    left: ComplexArray = (lag.second_s2 * pole_rad_s * rates_s - errors) / lag.denominator(
        pole_rad_s
    )
    return left


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class History:
    """What happens over time, all of shape (n,).

    Attributes
    ----------
    times_s
        Times [s].
    command
        Commanded velocity as share of full speed [-].
    velocity
        Velocity of the actuator as share of full speed [-].
    deflection
        Deflection of the payload times w over full speed: a unit step through an ideal actuator
        swings with amplitude 1 if undamped [-].
    """

    times_s: FloatArray
    command: FloatArray
    velocity: FloatArray
    deflection: FloatArray


def history(impulses: Impulses, mode: Mode, actuator: Actuator, times_s: FloatArray) -> History:
    """Return the time history of a command, exact at each of ``times_s``.

    Parameters
    ----------
    impulses
        The command.
    mode, actuator
        The plant's mode and its drive; no set may have its own pole at the plant's.
    times_s
        Times, shape (n,) [s]; before the first step all is at rest.

    Notes
    -----
    With ``q'' + 2 z w q' + w^2 q = w^2 v`` and ``p = q'/w``, the deflection is -p, and the modal
    coordinate ``(v - q) + s/w p``, with what the lags will still leave added, rings as exp(s t).
    """
    lags = (actuator.accel_lag, actuator.decel_lag)
    states = lag_states(impulses, actuator)
    pole = mode.pole_rad_s
    segment = np.searchsorted(impulses.times_s, times_s, side="right") - 1
    moving = segment >= 0
    started = np.maximum(segment, 0)
    elapsed = np.where(moving, times_s - impulses.times_s[started], 0.0)
    ringing = _ringing_after_steps(impulses, states, lags, pole)[started] * np.exp(pole * elapsed)
    error = np.zeros(times_s.size)
    for column, lag in enumerate(lags):
        motion = lag.free_motion(elapsed)
        corner = lag.corner_rad_s
        first = states.after[started, column]
        second = states.rates_after[started, column] / corner if corner > 0 else 0.0
        now = motion[:, 0, 0] * first + motion[:, 0, 1] * second
        rate = corner * (motion[:, 1, 0] * first + motion[:, 1, 1] * second)
        error += now
        ringing -= ringing_of_lag(lag, now, rate, pole)
    command = np.where(moving, np.cumsum(impulses.amplitudes)[started], 0.0)
    return History(
        times_s=times_s,
        command=command,
        velocity=command + np.where(moving, error, 0.0),
        deflection=np.where(moving, -ringing.imag / math.sqrt(1 - mode.damping_ratio**2), 0.0),
    )


def _ringing_after_steps(
    impulses: Impulses, states: LagStates, lags: tuple[Lag, Lag], pole_rad_s: complex
) -> ComplexArray:
    """Modal coordinate just after each step, the lags' future share included, shape (n,)."""
    added = states.velocity_jumps.astype(np.complex128)
    for column, lag in enumerate(lags):
        added += ringing_of_lag(
            lag, states.after[:, column], states.rates_after[:, column], pole_rad_s
        ) - ringing_of_lag(
            lag, states.before[:, column], states.rates_before[:, column], pole_rad_s
        )
    # Summed at the last step, where no exponential overflows, and carried on step by step.
    turns = np.exp(pole_rad_s * np.diff(impulses.times_s, prepend=impulses.times_s[0])).tolist()
    ringing, summed = [], 0j
    for turn, one in zip(turns, added.tolist(), strict=True):
        summed = summed * turn + one
        ringing.append(summed)
    return np.array(ringing)
