"""State of drive and payload, observed: a Kalman filter around the exact propagation.

The prediction is `design.live.propagation.carry`, which is affine in the state and exact. The
covariance goes with it, and readings of the trolley's velocity and of the load's deflection correct
both, each when there is one (Kalman 1960).
"""

from dataclasses import dataclass, replace

import numpy as np

from design.checks import MAX_VALUE, require_between, require_scale
from design.errors import InvalidInputError
from design.live.kernel import FIRST, OF_SET, SET_SIZE
from design.live.machine import LiveMachine
from design.live.planning import task_of
from design.live.propagation import Rows, carry
from design.live.state import AxisState
from design.types import FloatArray

OBSERVED = 4
"""Numbers that are observed: error and rate of the drive's lag, and the modal coordinate."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Noise:
    """How far readings and model are off.

    Attributes
    ----------
    velocity
        Standard deviation of a reading of the trolley's velocity, over full speed, > 0 [-].
    deflection_s
        The same of the load's deflection, over full speed, > 0 [s].
    drive_drift
        What the model does not know of the velocity, grown in a second, over full speed, >= 0 [-].
    swing_drift
        The same of the modal coordinate, >= 0 [-].
    """

    velocity: float
    deflection_s: float
    drive_drift: float
    swing_drift: float

    def __post_init__(self) -> None:
        for name in ("velocity", "deflection_s"):
            require_scale(name, getattr(self, name))
        for name in ("drive_drift", "swing_drift"):
            require_between(name, getattr(self, name), 0.0, MAX_VALUE)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observer:
    """What is observed of one axis.

    Attributes
    ----------
    axis
        The axis, with the lag and the modal coordinate that are the likeliest.
    covariance
        Of `OBSERVED` numbers, shape (4, 4) [-].
    """

    axis: AxisState
    covariance: FloatArray


def init(machine: LiveMachine, axis: AxisState) -> Observer:
    """Return the observer of an axis whose state is known.

    Parameters
    ----------
    machine
        The machine that is assumed.
    axis
        Its state, at rest for instance.

    Returns
    -------
    Observer
        Without doubt of that state.

    Raises
    ------
    InvalidInputError
        If several modes swing, or the drive's steps are superposed by two sets.
    """
    if len(machine.modes) != 1:
        raise InvalidInputError(
            "plant.modes",
            len(machine.modes),
            "one mode: a deflection does not say which of several modes swings",
            code="modes_not_observed",
        )
    drive = machine.actuator
    if drive.model == "superposed" and drive.accel_lag != drive.decel_lag:
        raise InvalidInputError(
            "actuator.model",
            drive.model,
            "switched where the sets differ: a velocity does not say which of two lags is off",
            code="drive_not_observed",
        )
    return Observer(axis=axis, covariance=np.zeros((OBSERVED, OBSERVED)))


def update(
    machine: LiveMachine,
    observer: Observer,
    at_s: float,
    noise: Noise,
    *,
    velocity: float | None = None,
    deflection_s: float | None = None,
) -> Observer:
    """Return the observer after a sample.

    Parameters
    ----------
    machine
        The machine that is assumed.
    observer
        Before the sample.
    at_s
        The time of the sample, not before the observer's [s].
    noise
        Of readings and model.
    velocity
        Of the trolley, over full speed; None if it is not read then [-].
    deflection_s
        How far the load is ahead of the trolley, over full speed; None if not seen then [s].

    Returns
    -------
    Observer
        At that time, all due switches of the plan made.

    Raises
    ------
    InvalidInputError
        If that is before the observer, or a reading is not a finite number.
    """
    elapsed = at_s - observer.axis.time_s
    if not elapsed >= 0.0:
        raise InvalidInputError(
            "at_s",
            at_s,
            f"not before the latest sample, at {observer.axis.time_s:.9g} s",
            code="sample_in_the_past",
        )
    rows = task_of(machine.actuator, machine.modes, machine.max_iterations).rows
    axis, flow = _predicted(rows, observer.axis, at_s)
    drift = noise.drive_drift if rows.drive[FIRST : FIRST + 2].any() else 0.0
    grown = np.array([drift, 0.0, noise.swing_drift, noise.swing_drift]) ** 2 * elapsed
    covariance = flow @ observer.covariance @ flow.T + np.diag(grown)
    numbers = _numbers(axis)
    readings = (
        ("velocity", velocity, np.array([1.0, 0.0, 0.0, 0.0]), axis.level, noise.velocity),
        ("deflection_s", deflection_s, _deflection(machine, rows, axis), 0.0, noise.deflection_s),
    )
    for name, reading, seen, offset, deviation in readings:
        if reading is None:
            continue
        require_between(name, reading, -MAX_VALUE, MAX_VALUE)
        gain = covariance @ seen / (seen @ covariance @ seen + deviation**2)
        numbers = numbers + gain * (reading - offset - seen @ numbers)
        kept = np.eye(OBSERVED) - np.outer(gain, seen)
        covariance = kept @ covariance @ kept.T + deviation**2 * np.outer(gain, gain)
    return Observer(axis=_with_numbers(axis, numbers), covariance=covariance)


def with_observed(axis: AxisState, observer: Observer) -> AxisState:
    """Return an axis with the state that is observed in place of the model's.

    The slope and the coordinate behind an ideal drive stay the model's: nothing measures them.

    Parameters
    ----------
    axis
        The axis, with its plan.
    observer
        Of the same time, level and set.

    Returns
    -------
    AxisState
        For `design.live.planning.solve_plan`.

    Raises
    ------
    InvalidInputError
        If the observer is of another time, or follows another command.
    """
    seen = observer.axis
    if (axis.time_s, axis.level, axis.force) != (seen.time_s, seen.level, seen.force):
        raise InvalidInputError(
            "observer",
            f"level {seen.level:g} at {seen.time_s:.9g} s",
            f"of the axis's time and command, level {axis.level:g} at {axis.time_s:.9g} s",
            code="observer_of_another_state",
        )
    return _with_numbers(axis, _numbers(seen))


def _numbers(axis: AxisState) -> FloatArray:
    return np.concatenate((axis.lag[0], axis.rings[0, :2]))


def _with_numbers(axis: AxisState, numbers: FloatArray) -> AxisState:
    lag, rings = axis.lag.copy(), axis.rings.copy()
    lag[0], rings[0, :2] = numbers[:2], numbers[2:]
    return replace(axis, lag=lag, rings=rings)


def _predicted(rows: Rows, axis: AxisState, at_s: float) -> tuple[AxisState, FloatArray]:
    """Return an axis carried to a time, and how its numbers follow those before, shape (4, 4)."""
    after = carry(rows, axis, at_s)
    numbers, then = _numbers(axis), _numbers(after)
    moved = [_numbers(carry(rows, _with_numbers(axis, numbers + one), at_s)) for one in np.eye(4)]
    return after, np.array(moved).T - then[:, None]


def _deflection(machine: LiveMachine, rows: Rows, axis: AxisState) -> FloatArray:
    """Return the deflection over full speed as a row on the numbers, shape (4,).

    Of the coordinate z without what the lag will add, ``d = -Im(z - a e - b v') / w_d``.
    """
    begin = OF_SET + SET_SIZE * axis.force
    imaginary = np.array([-rows.modes[0, begin + 1], -rows.modes[0, begin + 3], 0.0, 1.0])
    seen: FloatArray = -imaginary / machine.modes[0].pole_rad_s.imag
    return seen
