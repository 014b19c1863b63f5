"""The machine's motion from event to event: compiled.

A step of the Runge-Kutta method never spans a command, a corner of a reference, a turn of the hoist
or a time that is asked for: between them all is smooth.
"""

import math

import numpy as np

from design.rig.axis import CORNER, REFERENCE, SPEED, TIME, axis_motion, command_level, turn_corner
from design.rig.plant import LEAST_HEIGHT, LINEAR, MASS_RATIO, MAX_HOIST
from design.rig.swing import (
    LOWER,
    LOWER_Z,
    STATE_SIZE,
    UPPER,
    UPPER_Z,
    WORK,
    energy,
    jump_velocity,
    keep_unit,
    swing_rates,
    tensions,
)
from design.rig.tableau import FIFTH, NODES, STAGES, THIRD, WEIGHTS
from design.rig.travel import press_switches, time_outside
from design.tables.compiled import compiled
from design.types import FloatArray

NOW, STEP = range(2)
"""Of a clock: the time, and the step to try next [s]."""

ROPE_TIME, ROPE_LENGTH, ROPE_RATE, ROPE_END, ROPE_GOAL = range(5)
"""Of a hoist: when its rate began, its length then, its rate, when it ends, its length then."""

DONE, SWITCH, STROKE, SWING, HOIST_SPEED = range(5)
"""Why a march ends.

At its end, at a limit switch, past a stroke, past the largest swing, or where the hoist would be
faster than it can.
"""

LEVEL_X, LEVEL_Y, HOIST = range(3)
"""Kinds of events: the level of an axis, or a length and the time to go there."""

SLACK_SINCE, SLACK_FOR, LEAST_TENSION = range(3)
"""Of a cable that should push: when it first does, for how long in all [s], and the least tension
over the mass below it [m/s^2]."""

MOTION = STATE_SIZE
"""Column of a row from which position, velocity, acceleration and reference of x and y stand."""

ROPE = MOTION + 8
"""Column of a row from which length, its rate and the tension over the hook's mass stand."""

ROW_SIZE = ROPE + 3

TOLERANCE = 1e-12
"""Error of a step, relative and absolute: what several thousand steps add up to is below 1e-9."""

LEAST_STEP = 1e-15
"""Share of the time below which a step is none [-]."""

STEP_FACTORS = 0.2, 8.0
"""Least and largest change from a step to the next."""

SLACK_HALVINGS = 45
"""Halvings of a step that find where a tension is zero, to rounding of most times."""

SAFETY = 0.9
"""Share of the step at which the error is expected to be the tolerance."""


@compiled
def _rates_at(
    now_s: float,
    ahead_s: float,
    plant: FloatArray,
    state: FloatArray,
    axes: FloatArray,
    rope: FloatArray,
    rates: FloatArray,
) -> None:
    _, velocity_x, accel_x = axis_motion(axes[0], now_s - axes[0, TIME] + ahead_s)
    _, velocity_y, accel_y = axis_motion(axes[1], now_s - axes[1, TIME] + ahead_s)
    length = rope[ROPE_LENGTH] + (now_s - rope[ROPE_TIME] + ahead_s) * rope[ROPE_RATE]
    swing_rates(
        plant, state, length, rope[ROPE_RATE], velocity_x, velocity_y, accel_x, accel_y, rates
    )


@compiled
def _try_step(
    time_s: float,
    step_s: float,
    plant: FloatArray,
    state: FloatArray,
    axes: FloatArray,
    rope: FloatArray,
    work: FloatArray,
) -> float:
    """Fill in the state after a step as the last row; return its error over the tolerance."""
    stages = NODES.size
    moved = work[stages]
    _rates_at(time_s, 0.0, plant, state, axes, rope, work[0])
    for stage in range(1, stages):
        for index in range(STATE_SIZE):
            total = 0.0
            for before in range(stage):
                total += STAGES[stage, before] * work[before, index]
            moved[index] = state[index] + step_s * total
        _rates_at(time_s, NODES[stage] * step_s, plant, moved, axes, rope, work[stage])
    fifth = third = 0.0
    for index in range(STATE_SIZE):
        total = by_fifth = by_third = 0.0
        for stage in range(stages):
            rate = work[stage, index]
            total += WEIGHTS[stage] * rate
            by_fifth += FIFTH[stage] * rate
            by_third += THIRD[stage] * rate
        moved[index] = state[index] + step_s * total
        scale = TOLERANCE * (1 + max(abs(state[index]), abs(moved[index])))
        fifth += (by_fifth / scale) ** 2
        third += (by_third / scale) ** 2
    if fifth == 0.0 and third == 0.0:
        return 0.0
    return float(abs(step_s) * fifth / math.sqrt((fifth + third / 100) * STATE_SIZE))


@compiled
def _tensions_at(
    now_s: float,
    ahead_s: float,
    plant: FloatArray,
    state: FloatArray,
    axes: FloatArray,
    rope: FloatArray,
) -> tuple[float, float]:
    accel_x = axis_motion(axes[0], now_s - axes[0, TIME] + ahead_s)[2]
    accel_y = axis_motion(axes[1], now_s - axes[1, TIME] + ahead_s)[2]
    length = rope[ROPE_LENGTH] + (now_s - rope[ROPE_TIME] + ahead_s) * rope[ROPE_RATE]
    return tensions(plant, state, length, rope[ROPE_RATE], accel_x, accel_y)


@compiled
def _note_slack(
    now_s: float,
    step_s: float,
    plant: FloatArray,
    state: FloatArray,
    axes: FloatArray,
    rope: FloatArray,
    work: FloatArray,
    slack: FloatArray,
) -> None:
    """Note where in a step a cable would have to push.

    The last row of the work is the state at the end. Steps follow a drive closely, so that a
    tension has one sign in a step, or changes it once.
    """
    ends = work[NODES.size]
    first = _tensions_at(now_s, 0.0, plant, state, axes, rope)
    last = _tensions_at(now_s, step_s, plant, ends, axes, rope)
    for cable in range(2 if plant[MASS_RATIO] > 0.0 else 1):
        least = min(first[cable], last[cable])
        if least >= 0.0:
            continue
        begin, end = 0.0, step_s
        if max(first[cable], last[cable]) > 0.0:
            kept = ends.copy()
            for _ in range(SLACK_HALVINGS):
                middle = (begin + end) / 2
                _try_step(now_s, middle, plant, state, axes, rope, work)
                tension = _tensions_at(now_s, middle, plant, ends, axes, rope)[cable]
                if (tension > 0.0) == (first[cable] > 0.0):
                    begin = middle
                else:
                    end = middle
            ends[:] = kept
            if first[cable] > 0.0:
                end = step_s
            else:
                begin = 0.0
        slack[cable, SLACK_SINCE] = min(slack[cable, SLACK_SINCE], now_s + begin)
        slack[cable, SLACK_FOR] += end - begin
        slack[cable, LEAST_TENSION] = min(slack[cable, LEAST_TENSION], least)


@compiled
def _jump(
    time_s: float,
    plant: FloatArray,
    state: FloatArray,
    axes: FloatArray,
    rope: FloatArray,
    axis: int,
    jump_m_s: float,
    hoist_jump_m_s: float,
) -> None:
    """Let velocities jump to those of the axes and the hoist now, and count the work of it."""
    if jump_m_s == 0.0 and hoist_jump_m_s == 0.0:
        return
    x = axis_motion(axes[0], time_s - axes[0, TIME])[1]
    y = axis_motion(axes[1], time_s - axes[1, TIME])[1]
    length = rope[ROPE_LENGTH] + (time_s - rope[ROPE_TIME]) * rope[ROPE_RATE]
    rate = rope[ROPE_RATE]
    jump_x, jump_y = (jump_m_s, 0.0) if axis == 0 else (0.0, jump_m_s)
    before = energy(plant, state, length, rate - hoist_jump_m_s, x - jump_x, y - jump_y)
    jump_velocity(plant, state, length, jump_x, jump_y, hoist_jump_m_s)
    if not plant[LINEAR]:
        state[WORK] += energy(plant, state, length, rate, x, y) - before


@compiled
def _turn_rope(rope: FloatArray, time_s: float, goal_m: float, over_s: float) -> float:
    """Begin to hoist to a length, or end it; return the jump of the rate."""
    before = rope[ROPE_RATE]
    rope[ROPE_LENGTH] += (time_s - rope[ROPE_TIME]) * before
    rope[ROPE_TIME] = time_s
    rope[ROPE_GOAL] = goal_m
    if over_s > 0.0:
        rope[ROPE_RATE] = (goal_m - rope[ROPE_LENGTH]) / over_s
        rope[ROPE_END] = time_s + over_s
    else:
        rope[ROPE_LENGTH], rope[ROPE_RATE], rope[ROPE_END] = goal_m, 0.0, math.inf
    return float(rope[ROPE_RATE] - before)


@compiled
def _swings_too_far(plant: FloatArray, state: FloatArray) -> bool:
    least = plant[LEAST_HEIGHT]
    if plant[LINEAR]:
        most = math.acos(least) ** 2 if least > -1.0 else math.inf
        if state[UPPER] ** 2 + state[UPPER + 1] ** 2 > most:
            return True
        return bool(state[LOWER] ** 2 + state[LOWER + 1] ** 2 > most)
    if -state[UPPER_Z] < least:
        return True
    return bool(plant[MASS_RATIO] > 0.0 and -state[LOWER_Z] < least)


@compiled
def _write_row(
    time_s: float,
    plant: FloatArray,
    state: FloatArray,
    axes: FloatArray,
    rope: FloatArray,
    row: FloatArray,
) -> None:
    row[:STATE_SIZE] = state
    for axis in range(2):
        column = MOTION + 4 * axis
        row[column], row[column + 1], row[column + 2] = axis_motion(
            axes[axis], time_s - axes[axis, TIME]
        )
        row[column + 3] = axes[axis, SPEED] * axes[axis, REFERENCE]
    length = rope[ROPE_LENGTH] + (time_s - rope[ROPE_TIME]) * rope[ROPE_RATE]
    row[ROPE], row[ROPE + 1] = length, rope[ROPE_RATE]
    row[ROPE + 2] = tensions(
        plant, state, length, rope[ROPE_RATE], row[MOTION + 2], row[MOTION + 6]
    )[0]


@compiled
def march(
    clock: FloatArray,
    plant: FloatArray,
    state: FloatArray,
    axes: FloatArray,
    rope: FloatArray,
    slack: FloatArray,
    events: FloatArray,
    event: int,
    times_s: FloatArray,
    rows: FloatArray,
    row: int,
    until_s: float,
) -> tuple[int, int, int, int]:
    """Go on to a time, through all events up to it.

    Parameters
    ----------
    clock, plant, state, axes, rope
        The machine: shapes (2,), (PLANT_SIZE,), (STATE_SIZE,), (2, AXIS_SIZE), (5,). All except
        the plant change.
    slack
        Of the upper and the lower cable, shape (2, 3); what is slack is added.
    events
        Events in order of time: time [s], kind and two numbers each, shape (m, 4).
    event
        The next of them.
    times_s, rows
        Times to look at, ascending, shape (n,) [s]; what is seen then, shape (n, ROW_SIZE), after
        the events at that time.
    row
        The next of them.
    until_s
        Where to end [s].

    Returns
    -------
    tuple of int
        Why it ends, at which axis, the next event and the next row. After a limit switch it can be
        called again; the drive has been commanded to stop.
    """
    work = np.empty((NODES.size + 1, STATE_SIZE))
    while True:
        now = clock[NOW]
        for axis in range(2):
            while axes[axis, CORNER] <= now:
                jump = turn_corner(axes[axis], axes[axis, CORNER])
                _jump(now, plant, state, axes, rope, axis, jump, 0.0)
        if rope[ROPE_END] <= now:
            change = _turn_rope(rope, now, rope[ROPE_GOAL], 0.0)
            _jump(now, plant, state, axes, rope, 0, 0.0, change)
        while event < len(events) and events[event, 0] <= now:
            if events[event, 1] == HOIST:
                change = _turn_rope(rope, now, events[event, 2], events[event, 3])
                if abs(rope[ROPE_RATE]) > plant[MAX_HOIST]:
                    return HOIST_SPEED, 0, event, row
                _jump(now, plant, state, axes, rope, 0, 0.0, change)
            else:
                axis = int(events[event, 1])
                jump = command_level(axes[axis], now, events[event, 2])
                _jump(now, plant, state, axes, rope, axis, jump, 0.0)
            event += 1
        corner = min(axes[0, CORNER], axes[1, CORNER], rope[ROPE_END])
        if corner <= now:
            continue
        while row < len(times_s) and times_s[row] <= now:
            _write_row(now, plant, state, axes, rope, rows[row])
            row += 1
        if now >= until_s:
            return DONE, 0, event, row
        goal = min(until_s, corner)
        if event < len(events):
            goal = min(goal, events[event, 0])
        if row < len(times_s):
            goal = min(goal, times_s[row])
        wanted = clock[STEP]
        cut = wanted >= goal - now
        end = goal if cut else now + wanted
        passed = -1
        for axis in range(2):
            outside = time_outside(axes[axis], now, end)
            if outside < end or (outside == end and passed < 0):
                end, cut, passed = outside, True, axis
        step = end - now
        error = _try_step(now, step, plant, state, axes, rope, work)
        least = step <= LEAST_STEP * max(1.0, abs(now))
        smallest, largest = STEP_FACTORS
        # A step far too long may overflow: its error is no number then.
        finite = error < math.inf
        factor = largest if error == 0.0 else SAFETY * error ** (-1 / 8)
        factor = min(max(factor, smallest), largest) if finite else smallest
        if not error <= 1.0 and not (least and finite):
            clock[STEP] = step * min(factor, 1.0)
            continue
        clock[STEP] = max(wanted, step * factor) if cut else step * factor
        if not plant[LINEAR]:
            _note_slack(now, step, plant, state, axes, rope, work, slack)
        clock[NOW] = end
        state[:] = work[NODES.size]
        if not plant[LINEAR]:
            keep_unit(state, UPPER)
            keep_unit(state, LOWER)
        if _swings_too_far(plant, state):
            return SWING, 0, event, row
        for axis in range(2):
            exceeded = press_switches(axes[axis], end)
            if exceeded:
                return STROKE, axis, event, row
        if passed >= 0:
            jump = command_level(axes[passed], end, 0.0)
            _jump(end, plant, state, axes, rope, passed, jump, 0.0)
            return SWITCH, passed, event, row
