"""Exact response of actuator and mode to a command, in closed form.

Between two changes of the reference every lag moves freely and the mode rings;
`design.model.lag_motions.free_motions` and one complex exponential say how, for any damping.
Nothing is stepped through time.
"""

import math
from dataclasses import dataclass

import numpy as np

from design.errors import InvalidInputError
from design.model.actuators.model import Model
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.lag_motions import bent_ramp_responses, free_motions
from design.model.lags import Lag
from design.model.plants.mode import Mode
from design.model.ramps import Reference, ramp_factors
from design.model.reference_ramps import reference
from design.types import ComplexArray, FloatArray

AT_REST = 1e-12
"""Share of all steps within which their sum counts as 0: rounding of as many additions [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class LagStates:
    """Velocity less reference, and the velocity's rate, just before each of n changes.

    Of m commands or actuators; columns: accel, decel set. A switched actuator has one state, which
    stands in the column of the set in force until then.

    Attributes
    ----------
    errors
        Shape (m, n, 2) [-].
    rates_s
        Shape (m, n, 2); 0 for lags of first order [1/s].
    """

    errors: FloatArray
    rates_s: FloatArray


def lag_states(
    changes: Reference, first_s: FloatArray, second_s2: FloatArray, model: Model
) -> LagStates:
    """Return the states of lags just before each change they follow.

    Parameters
    ----------
    changes
        What they follow; times and ramps of shape (n,), or (m, n) for m references whose changes
        differ in time alone.
    first_s, second_s2
        Coefficients, columns accel and decel, shape (m, 2) or (1, 2) [s], [s^2].
    model
        Of all actuators.

    Returns
    -------
    LagStates
        Of m commands or actuators, n changes each; at rest before the first change.
    """
    times, ramps = np.atleast_2d(changes.times_s), np.atleast_2d(changes.ramps_s)
    many = max(len(times), len(first_s))
    gaps = times[:, 1:] - times[:, :-1]
    forces = np.where(changes.accelerates, 0, 1)[:-1]
    states = LagStates(*np.zeros((2, many, forces.size + 1, 2)))
    chains = [forces] if model == "switched" else [np.full_like(forces, one) for one in (0, 1)]
    for chain in chains:
        driven = np.where(chain == forces, changes.changes[:-1], 0.0)
        of_chain = first_s[:, chain], second_s2[:, chain]
        moved = _carry(*of_chain, gaps, ramps[:, :-1], changes.bends[:-1], driven)
        after = np.arange(1, forces.size + 1)
        states.errors[:, after, chain], states.rates_s[:, after, chain] = moved
    return states


def states_of(changes: Reference, actuator: Actuator) -> LagStates:
    """Return the `lag_states` of one actuator.

    Parameters
    ----------
    changes
        What its lags follow, n changes.
    actuator
        The actuator.

    Returns
    -------
    LagStates
        Arrays of shape (1, n, 2).
    """
    return lag_states(changes, *_coefficients(actuator), actuator.model)


def _coefficients(actuator: Actuator) -> tuple[FloatArray, FloatArray]:
    lags = (actuator.accel_lag, actuator.decel_lag)
    return np.array([[lag.first_s for lag in lags]]), np.array([[lag.second_s2 for lag in lags]])


def _carry(
    first_s: FloatArray,
    second_s2: FloatArray,
    gaps_s: FloatArray,
    ramps_s: FloatArray,
    bends: FloatArray,
    driven: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Carry lags from rest over gaps, each begun by a change ``driven``: shape (m, gaps) each."""
    flows = _flows(first_s, second_s2, gaps_s)
    pulls = flows[..., 0]
    if ramps_s.any():
        held = _flows(first_s, second_s2, np.maximum(gaps_s - ramps_s, 0.0))
        pulled = bent_ramp_responses(first_s, second_s2, ramps_s, bends)
        pulls = (held @ pulled[..., None])[..., 0]
    moves = np.concatenate((flows.reshape(*flows.shape[:2], 4), pulls), axis=-1)
    # Plain numbers where there is one: five times as fast as arrays of one.
    each = moves[0].tolist() if len(moves) == 1 else moves.transpose(1, 2, 0)
    error = rate = 0.0
    errors, rates = [], []
    for (a, b, c, d, p, q), change in zip(each, driven.tolist(), strict=True):
        error, rate = a * error + b * rate - change * p, c * error + d * rate - change * q
        errors.append(error)
        rates.append(rate)
    shape = flows.shape[1::-1]
    return np.array(errors).reshape(shape).T, np.array(rates).reshape(shape).T


def _flows(first_s: FloatArray, second_s2: FloatArray, elapsed_s: FloatArray) -> FloatArray:
    """Return the free motion of ``[error, rate]`` in [-] and [1/s], shape (..., 2, 2)."""
    flows = free_motions(first_s, second_s2, elapsed_s)
    corner = np.where(second_s2 > 0, second_s2, 1.0) ** -0.5
    flows[..., 0, 1] /= corner
    flows[..., 1, 0] *= corner
    return flows


def travel(impulses: Impulses, actuator: Actuator) -> float:
    """Return the distance of a rest-to-rest command at full speed 1 [s].

    The integral of the velocity.

    Exact in both models; times the speed it is a distance.

    Parameters
    ----------
    impulses
        A command that ends at level 0: its amplitudes sum to 0.
    actuator
        The actuator; it comes to rest after the last step.

    Returns
    -------
    float
        Times the speed it is a distance [s]; negative for a move backward.

    Raises
    ------
    InvalidInputError
        If the command does not come back to 0: the distance has no end.

    Notes
    -----
    A lag obeys ``v - r + first v' + second v'' = 0``: over a segment of one set the integral of
    v - r is ``first (v0 - v1) + second (v0' - v1')``.

    Examples
    --------
    >>> from design.model.actuators.first_order import FirstOrder
    >>> drive = FirstOrder(accel_time_constant_s=0.3, decel_time_constant_s=0.1)
    >>> move = Impulses(times_s=np.array([0.0, 2.0]), amplitudes=np.array([1.0, -1.0]))
    >>> round(travel(move, drive), 12)
    1.8
    """
    end = float(impulses.amplitudes.sum())
    if abs(end) > AT_REST * float(np.abs(impulses.amplitudes).sum()):
        raise InvalidInputError(
            "amplitudes",
            f"a sum of {end:g}",
            "of sum 0: a command to rest",
            code="command_not_to_rest",
        )
    changes = reference(impulses, actuator)
    forces = np.where(changes.accelerates, 0, 1)
    first, second = (part[0] for part in _coefficients(actuator))
    if actuator.model == "superposed":
        lagging = float(first[forces] @ changes.changes)
    else:
        states = states_of(changes, actuator)
        levels = np.concatenate(([0.0], np.cumsum(changes.changes)[:-1]))
        velocities = np.append(levels + states.errors[0].sum(axis=1), 0.0)
        rates = np.append(states.rates_s[0].sum(axis=1), 0.0)
        lagging = float(first[forces] @ np.diff(velocities) + second[forces] @ np.diff(rates))
    # Times from the first step on: a late clock would only cost digits.
    middles = changes.times_s - changes.times_s[0]
    middles += changes.ramps_s * (1 / 2 + changes.bends / 6)
    return -float(changes.changes @ middles) - lagging


def ringing_of_lag(
    lag: Lag, errors: FloatArray, rates_s: FloatArray, pole_rad_s: complex
) -> ComplexArray:
    """Return the vibration of the mode once a lag's state is at rest.

    ``G (second s e' - e)``: its free motion from there, seen at the pole s.

    Parameters
    ----------
    lag
        The lag, of transfer function G.
    errors
        Velocity less reference e, shape (n,) [-].
    rates_s
        Rate of the velocity e', shape (n,) [1/s].
    pole_rad_s
        Upper pole of the mode, no pole of the lag [rad/s].

    Returns
    -------
    ComplexArray
        Modal coordinate, shape (n,) [-].
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
    """Return the time history of a command in closed form.

    Parameters
    ----------
    impulses
        The command.
    mode, actuator
        The plant's mode and its drive; no set may have its own pole at the plant's.
    times_s
        Times, shape (n,) [s]; before the first step all is at rest.

    Returns
    -------
    History
        All of shape (n,).

    Notes
    -----
    With ``q'' + 2 z w q' + w^2 q = w^2 v`` and ``p = q'/w``, the deflection is -p, and the modal
    coordinate ``(v - q) + s/w p``, with what the lags will still leave added, rings as exp(s t).
    """
    lags = (actuator.accel_lag, actuator.decel_lag)
    changes = reference(impulses, actuator)
    states = states_of(changes, actuator)
    pole = mode.pole_rad_s
    switched = actuator.model == "switched"
    segment = np.searchsorted(changes.times_s, times_s, side="right") - 1
    moving = segment >= 0
    started = np.maximum(segment, 0)
    elapsed = np.where(moving, times_s - changes.times_s[started], 0.0)
    forces = np.where(changes.accelerates, 0, 1)
    ramps = np.minimum(elapsed, changes.ramps_s[started])
    whole = changes.ramps_s[started] == ramps
    shares = np.where(whole, 1.0, ramps / np.where(whole, 1.0, changes.ramps_s[started]))
    # Over a part of a ramp the mean slope, and by how much it bends about that, are others.
    means = 1 + changes.bends[started] * (shares - 1)
    done = changes.changes[started] * shares * means
    bends = changes.bends[started] * shares / np.where(means > 0, means, 1.0)
    gains = 1 / np.array([lag.denominator(pole) for lag in lags])
    forced = gains[forces[started]] * done * ramp_factors(np.array([pole]), ramps, bends)
    before = _ringing_before_changes(changes, states, lags, pole, switched=switched)
    ringing = (before[started] + forced) * np.exp(pole * elapsed)
    error = np.zeros(times_s.size)
    for column, lag in enumerate(lags):
        own = forces[started] == column
        start = [part[0, :, column] for part in (states.errors, states.rates_s)]
        if switched:
            start = [part[0].sum(axis=1) for part in (states.errors, states.rates_s)]
        value, rate = (part[started] for part in start)
        push = np.where(own, done, 0.0)
        coefficients = np.array(lag.first_s), np.array(lag.second_s2)
        flow = _flows(*coefficients, elapsed)
        if changes.ramps_s.any():
            pull = push[:, None] * bent_ramp_responses(*coefficients, ramps, bends)
            left = _flows(*coefficients, elapsed - ramps) @ pull[..., None]
            now, now_rate = (-left[:, 0, 0], -left[:, 1, 0])
        else:
            value = value - push
            now = now_rate = np.zeros(times_s.size)
        now = now + flow[:, 0, 0] * value + flow[:, 0, 1] * rate
        now_rate = now_rate + flow[:, 1, 0] * value + flow[:, 1, 1] * rate
        if switched:
            now, now_rate = np.where(own, now, 0.0), np.where(own, now_rate, 0.0)
        error += now
        ringing -= ringing_of_lag(lag, now, now_rate, pole)
    levels, reached = (
        np.concatenate(([0.0], np.cumsum(steps)))
        for steps in (impulses.amplitudes, changes.changes)
    )
    return History(
        times_s=times_s,
        command=levels[np.searchsorted(impulses.times_s, times_s, side="right")],
        velocity=np.where(moving, reached[started] + done + error, 0.0),
        deflection=np.where(moving, -ringing.imag / math.sqrt(1 - mode.damping_ratio**2), 0.0),
    )


def _ringing_before_changes(
    changes: Reference,
    states: LagStates,
    lags: tuple[Lag, Lag],
    pole_rad_s: complex,
    *,
    switched: bool,
) -> ComplexArray:
    """Modal coordinate as each change begins, the lags' future share included, shape (n,).

    A switched lag's state passes to the new set, and each would let it ring in its own way.
    """
    gains = [1 / lag.denominator(pole_rad_s) for lag in lags]
    factors = changes.factors(np.array([pole_rad_s])).tolist()
    turns = np.exp(pole_rad_s * np.diff(changes.times_s, prepend=changes.times_s[0])).tolist()
    passed = np.zeros(changes.changes.size, dtype=np.complex128)
    if switched:
        errors, rates = (part[0].sum(axis=1) for part in (states.errors, states.rates_s))
        left = np.array([ringing_of_lag(lag, errors, rates, pole_rad_s) for lag in lags])
        forces = np.where(changes.accelerates, 0, 1)
        each = np.arange(1, forces.size)
        passed[1:] = left[forces[1:], each] - left[forces[:-1], each]
    ringing, summed = [], 0j
    steps = zip(turns, passed.tolist(), changes.changes.tolist(), changes.accelerates, strict=True)
    for (turn, one, change, rising), factor in zip(steps, factors, strict=True):
        summed = summed * turn + one
        ringing.append(summed)
        summed += change * factor * gains[0 if rising else 1]
    return np.array(ringing)
