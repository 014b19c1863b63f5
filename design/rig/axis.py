"""One axis of the machine: a drive that follows commands as they come, compiled.

An axis is a row of numbers, so that compiled code can keep it: `drive_row` makes one of an
actuator. Nothing of its motion is integrated: between two corners of its reference, position,
velocity and acceleration are closed forms of the state at the first. Levels are shares of full
speed; positions, velocities and accelerations leave in metres.
"""

import math

import numpy as np

from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.rig.lag import lag_motion
from design.tables.compiled import compiled
from design.types import FloatArray

MAX_PHASES = 4
"""Pieces of constant jerk of one way to rest at a level."""

(
    SPEED,  # Full speed [m/s]
    RISE,  # Limit to the growth of the reference's magnitude; 0 if there is none [1/s]
    FALL,  # Limit to its fall [1/s]
    JERK,  # Limit to the rate of either; 0 if there is none [1/s^2]
    SWITCHED,  # 1 if the sets share one state, 0 if each has its own
    FIRST,  # Coefficients of the accelerating and the decelerating lag: four numbers [s], [s^2]
    _FIRST_DECEL,
    SECOND,
    _SECOND_DECEL,
    TIME,  # When the segment began that the numbers below are of [s]
    POSITION,  # [m]
    LEVEL,  # What is commanded [-]
    REFERENCE,  # What the lags follow [-]
    SLOPE,  # Its rate [1/s]
    BEND,  # The constant rate of that [1/s^2]
    SET,  # 0 if the accelerating set is in force, 1 if the decelerating one
    ERROR,  # State of the lags: two errors [-], two rates [1/s]; the first alone if switched
    _ERROR_DECEL,
    RATE,
    _RATE_DECEL,
    CORNER,  # When the reference turns next; infinite if it does not [s]
    TARGET,  # Where the way ends that it is on [-]
    PHASE,  # Which phase of this way it is in
    PHASES,  # How many there are
    SIDE,  # 1 if this way is above zero, -1 if it is below
    LOW,  # Ends of the stroke, and the limit switches before them [m]
    HIGH,
    LOW_SWITCH,
    HIGH_SWITCH,
    BLOCKED,  # The side whose switch is pressed: -1, 0 or 1
    DURATIONS,  # Durations of the phases [s], and then their signed jerks [1/s^2]
) = range(31)

BENDS = DURATIONS + MAX_PHASES
AXIS_SIZE = BENDS + MAX_PHASES

SAME_LEVEL = 1e-12
"""Share of two levels within which they are one: rounding of their sum [-]."""

ARRIVING = 1e-13
"""Level within which the place where the reference would stop is its goal: rounding [-]."""


def drive_row(actuator: Actuator, speed_m_s: float) -> FloatArray:
    """Return an axis at rest at position 0 and time 0.

    Parameters
    ----------
    actuator
        What drives it.
    speed_m_s
        Full speed [m/s].

    Returns
    -------
    FloatArray
        Shape (AXIS_SIZE,).
    """
    row = np.zeros(AXIS_SIZE)
    row[SPEED] = speed_m_s
    if isinstance(actuator, RateLimited):
        row[RISE] = actuator.accel_limit_m_s2 / actuator.speed_m_s
        row[FALL] = actuator.decel_limit_m_s2 / actuator.speed_m_s
        row[JERK] = (actuator.jerk_limit_m_s3 or 0.0) / actuator.speed_m_s
    row[SWITCHED] = actuator.model == "switched"
    for index, lag in enumerate((actuator.accel_lag, actuator.decel_lag)):
        row[FIRST + index], row[SECOND + index] = lag.first_s, lag.second_s2
    row[CORNER] = row[HIGH] = row[HIGH_SWITCH] = math.inf
    row[LOW] = row[LOW_SWITCH] = -math.inf
    return row


@compiled
def axis_motion(axis: FloatArray, elapsed_s: float) -> tuple[float, float, float]:
    """Return position, velocity and acceleration within a segment.

    The time since then, not the time of day: a lag of microseconds would see the rounding of that.

    Parameters
    ----------
    axis
        The axis, shape (AXIS_SIZE,).
    elapsed_s
        Since `TIME`, 0 to the corner [s].

    Returns
    -------
    tuple of float
        Position [m], velocity [m/s], acceleration [m/s^2].
    """
    slope, bend, active = axis[SLOPE], axis[BEND], int(axis[SET])
    gained = elapsed_s * (slope + elapsed_s * bend / 2)
    travel = elapsed_s * (axis[REFERENCE] + elapsed_s * (slope / 2 + elapsed_s * bend / 6))
    velocity = axis[REFERENCE] + gained
    acceleration = 0.0
    for state in range(1 if axis[SWITCHED] else 2):
        of_set = active if axis[SWITCHED] else state
        first, second = axis[FIRST + of_set], axis[SECOND + of_set]
        error, rate = axis[ERROR + state], axis[RATE + state]
        pulled = 1.0 if of_set == active else 0.0
        now, now_rate = lag_motion(
            first, second, error, rate, pulled * slope, pulled * bend, elapsed_s
        )
        moved = now - error + pulled * gained
        velocity += now
        acceleration += now_rate
        # The lag's equation, integrated over the time since.
        travel -= first * moved + second * (now_rate - rate)
    speed = axis[SPEED]
    return axis[POSITION] + speed * travel, speed * velocity, speed * acceleration


@compiled
def begin_segment(axis: FloatArray, time_s: float) -> None:
    """Begin the next segment at a time of the present one.

    Parameters
    ----------
    axis
        The axis, shape (AXIS_SIZE,); changed.
    time_s
        The time [s].
    """
    elapsed = time_s - axis[TIME]
    if elapsed == 0.0:
        return
    axis[POSITION] = axis_motion(axis, elapsed)[0]
    slope, bend, active = axis[SLOPE], axis[BEND], int(axis[SET])
    for state in range(1 if axis[SWITCHED] else 2):
        of_set = active if axis[SWITCHED] else state
        pulled = 1.0 if of_set == active else 0.0
        axis[ERROR + state], axis[RATE + state] = lag_motion(
            axis[FIRST + of_set],
            axis[SECOND + of_set],
            axis[ERROR + state],
            axis[RATE + state],
            pulled * slope,
            pulled * bend,
            elapsed,
        )
    axis[REFERENCE] += elapsed * (slope + elapsed * bend / 2)
    axis[SLOPE] += elapsed * bend
    axis[TIME] = time_s


@compiled
def command_level(axis: FloatArray, time_s: float, level: float) -> float:
    """Command a level from a time on.

    Parameters
    ----------
    axis
        The axis, shape (AXIS_SIZE,); changed.
    time_s
        The time, not after the next corner [s].
    level
        Share of full speed, signed; 0 counts for one toward a switch that is pressed [-].

    Returns
    -------
    float
        By how much the velocity jumps: other than 0 where a set follows at once [m/s].
    """
    begin_segment(axis, time_s)
    axis[LEVEL] = 0.0 if axis[BLOCKED] * level > 0.0 else level
    return _go_on(axis, time_s)


@compiled
def turn_corner(axis: FloatArray, time_s: float) -> float:
    """Go on at a corner of the reference.

    Parameters
    ----------
    axis
        The axis, shape (AXIS_SIZE,); changed.
    time_s
        Its corner [s].

    Returns
    -------
    float
        By how much the velocity jumps [m/s].
    """
    begin_segment(axis, time_s)
    axis[PHASE] += 1
    if axis[PHASE] < axis[PHASES]:
        return _begin_phase(axis, time_s)
    axis[REFERENCE] = axis[TARGET]
    axis[SLOPE] = 0.0
    return _go_on(axis, time_s)


@compiled
def _go_on(axis: FloatArray, time_s: float) -> float:
    """Find the way from here to the level, and begin it."""
    level, now = axis[LEVEL], axis[REFERENCE]
    axis[CORNER], axis[BEND] = math.inf, 0.0
    if axis[RISE] == 0.0:
        change = level - now
        axis[REFERENCE] = level
        if abs(change) <= SAME_LEVEL * (abs(level) + abs(now)):
            return 0.0
        larger = abs(level) - abs(now) > SAME_LEVEL * (abs(level) + abs(now))
        axis[SET] = 0.0 if larger else 1.0
        axis[ERROR + (0 if axis[SWITCHED] else int(axis[SET]))] -= change
        return _catch_up(axis)
    if now == level and (axis[SLOPE] == 0.0 or axis[JERK] == 0.0):
        axis[SLOPE] = 0.0
        return 0.0
    target = 0.0 if level * now < 0.0 else level
    axis[TARGET], axis[PHASE] = target, 0
    if axis[JERK] == 0.0:
        way = 1.0 if target > now else -1.0
        grows = abs(target) > abs(now)
        limit = axis[RISE] if grows else axis[FALL]
        axis[SLOPE], axis[PHASES] = way * limit, 1
        axis[SET] = 0.0 if grows else 1.0
        axis[CORNER] = time_s + abs(target - now) / limit
        return _catch_up(axis)
    side = -1.0 if now < 0.0 or (now == 0.0 and target < 0.0) else 1.0
    axis[SIDE] = side
    _plan_phases(axis, side * now, side * axis[SLOPE], side * target)
    for phase in range(int(axis[PHASES])):
        axis[BENDS + phase] *= side
    if axis[PHASES] == 0.0:
        axis[REFERENCE], axis[SLOPE] = target, 0.0
        return 0.0
    return _begin_phase(axis, time_s)


@compiled
def _plan_phases(axis: FloatArray, level: float, slope: float, goal: float) -> None:
    """Fill in the fastest way to rest at a goal, all of it on this side of zero."""
    jerk, count = axis[JERK], 0
    stop = level + slope * abs(slope) / (2 * jerk)
    if abs(stop - goal) <= ARRIVING:
        if slope != 0.0:
            axis[DURATIONS], axis[BENDS] = abs(slope) / jerk, math.copysign(jerk, -slope)
            count = 1
        axis[PHASES] = count
        return
    way = 1.0 if goal > stop else -1.0
    limit = axis[RISE] if way > 0 else axis[FALL]
    toward = way * slope
    if toward < 0:
        axis[DURATIONS], axis[BENDS] = -toward / jerk, way * jerk
        level, toward, count = stop, 0.0, 1
    distance = way * (goal - level)
    fastest = min(limit, math.sqrt(jerk * distance + toward * toward / 2))
    if fastest > toward:
        axis[DURATIONS + count], axis[BENDS + count] = (fastest - toward) / jerk, way * jerk
        count += 1
    left = distance - (2 * fastest * fastest - toward * toward) / (2 * jerk)
    if left > 0 and fastest == limit:
        axis[DURATIONS + count], axis[BENDS + count] = left / limit, 0.0
        count += 1
    axis[DURATIONS + count], axis[BENDS + count] = fastest / jerk, -way * jerk
    axis[PHASES] = count + 1


@compiled
def _begin_phase(axis: FloatArray, time_s: float) -> float:
    """Begin the present phase of the way; the set in force is that of its mean slope."""
    phase = int(axis[PHASE])
    duration, bend = axis[DURATIONS + phase], axis[BENDS + phase]
    if phase > 0 and abs(axis[SLOPE]) <= ARRIVING * (axis[RISE] + axis[FALL]):
        axis[SLOPE] = 0.0
    axis[BEND], axis[CORNER] = bend, time_s + duration
    mean = axis[SLOPE] + duration * bend / 2
    axis[SET] = 0.0 if axis[SIDE] * mean > 0.0 else 1.0
    return _catch_up(axis)


@compiled
def _catch_up(axis: FloatArray) -> float:
    """Let a set that follows at once be where its reference is; return the jump of velocity."""
    active = int(axis[SET])
    if axis[FIRST + active] > 0.0 or axis[SECOND + active] > 0.0:
        return 0.0
    state = 0 if axis[SWITCHED] else active
    jump = -axis[SPEED] * axis[ERROR + state]
    axis[ERROR + state], axis[RATE + state] = 0.0, 0.0
    return float(jump)
