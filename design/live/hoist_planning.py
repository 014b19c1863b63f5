"""An axis carried through a hoist, and the rest of its command solved with the course known."""

import itertools
import math
from dataclasses import replace

import numpy as np

from design.live.hoist import Gains, Hoist, gains_of
from design.live.hoist_kernel import MAX_ARCS, PARTS, gains_at, search_hoisting, turn_of_switch
from design.live.kernel import FIRST, SECOND, SWITCHED, lag_flow, set_of
from design.live.machine import IDEAL_ROW, LiveKind
from design.live.patterns import guesses_s, patterns
from design.live.planning import (
    LEAST_PULSE,
    LEAST_REST,
    LEAST_SUPERPOSED_PULSE,
    LONGEST_MOVE,
    NOTHING,
    Task,
    plan_of,
    solve_plan,
)
from design.live.propagation import carry
from design.live.state import AxisState, Plan
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import Unlimited
from design.types import FloatArray

TOO_SMALL = 1e-7
"""Swing below which nothing is sent for it where the level stays: the pulse would be shorter than
any that plans have, and what lags leave while their length changes is of that size [-]."""

SMALL_FIRST, SMALL_SECOND = (0.1, 0.3, 0.5, 0.7, 0.9, 1.1), (0.01, 0.001)
"""Guesses of a wait and of a short pulse for a small swing at a level that stays, in periods of the
mode [-]."""

UNKNOWNS = 2
"""Switches that are free: as many as the coordinate has parts."""


def carry_hoisted(
    task: Task,
    actuator: Unlimited,
    hoist: Hoist | None,
    axis: AxisState,
    until_s: float,
    *,
    through: bool = True,
) -> AxisState:
    """Return an axis at a later time, through what is left of a hoist.

    Parameters
    ----------
    task
        The machine on the last length.
    actuator, hoist
        Its drive, and the latest hoist, if there was any.
    axis, until_s, through
        As of `design.live.propagation.carry`.

    Returns
    -------
    AxisState
        With the rest of its plan.
    """
    if hoist is not None and axis.time_s < hoist.end_s:
        gains, ideal = gains_of(actuator, hoist), gains_of(Ideal(), hoist)
        drive = task.rows.drive
        then_s = min(until_s, hoist.end_s)
        made = 0
        for time_s, level in zip(axis.plan.times_s, axis.plan.levels, strict=True):
            acts_s = time_s + task.rows.dead_time_s
            if acts_s >= hoist.end_s or acts_s > until_s or (acts_s == until_s and not through):
                break
            axis = _lag_moved(drive, axis, acts_s)
            axis = _switched(drive, gains, ideal, axis, level)
            made += 1
        plan = axis.plan
        left = replace(plan, times_s=plan.times_s[made:], levels=plan.levels[made:])
        axis = replace(_lag_moved(drive, axis, then_s), plan=left if made else plan)
    return carry(task.rows, axis, until_s, through=through)


def _lag_moved(drive: FloatArray, axis: AxisState, until_s: float) -> AxisState:
    lag = axis.lag.copy()
    elapsed = max(until_s - axis.time_s, 0.0)
    for row in (0, 1):
        force = axis.force if drive[SWITCHED] else row
        flow = lag_flow(drive[FIRST + force], drive[SECOND + force], elapsed)
        lag[row] = np.array(flow).reshape(2, 2) @ lag[row]
    return replace(axis, time_s=until_s, lag=lag)


def _switched(
    drive: FloatArray, gains: Gains, ideal: Gains, axis: AxisState, level: float
) -> AxisState:
    change = level - axis.level
    force = set_of(axis.level, level, axis.force)
    lag, rings, ideals = axis.lag.copy(), axis.rings.copy(), axis.ideal_rings.copy()
    of = 0 if drive[SWITCHED] else force
    if change != 0.0:
        now = _values(gains, axis.time_s)
        turn_of_switch(drive, now, change, axis.force, force, lag[of], rings[0, :2])
        now = _values(ideal, axis.time_s)
        turn_of_switch(IDEAL_ROW, now, change, axis.force, force, np.zeros(2), ideals[0, :2])
    return replace(axis, level=level, force=force, lag=lag, rings=rings, ideal_rings=ideals)


def _values(gains: Gains, time_s: float, which: int = 0) -> FloatArray:
    found = np.empty((2, 2 * PARTS))
    gains_at(gains.ends_s, gains.values, gains.slopes, gains.last, gains.pole, time_s, found)
    values: FloatArray = found[which]
    return values


def begin_hoist(
    task: Task, actuator: Unlimited, before: Hoist | None, hoist: Hoist, axis: AxisState
) -> AxisState:
    """Return an axis whose swing is seen at the end of a new hoist.

    Parameters
    ----------
    task
        The machine on the length before: the last one of an earlier hoist.
    actuator
        Its drive.
    before
        The latest hoist before, which may last yet.
    hoist
        The hoist.
    axis
        The axis as it begins.

    Returns
    -------
    AxisState
        The same with other coordinates.
    """
    lasts = before is not None and axis.time_s < before.end_s
    rate = before.rate_m_s if before is not None and lasts else 0.0
    mode = task.modes[0]
    drag = 2 * mode.damping_ratio * math.sqrt(hoist.first.gravity_m_s2 / hoist.first.cable_length_m)
    found = []
    for drive, rows, rings, lag in (
        (actuator, task.rows.modes, axis.rings, axis.lag),
        (Ideal(), task.rows.ideal_modes, axis.ideal_rings, np.zeros((2, 2))),
    ):
        sets = ((axis.force, 0),) if drive.model == "switched" else ((0, 0), (1, 1))
        if before is not None and lasts:
            was = gains_of(drive, before)
            old = _values(was, axis.time_s)
            kernel, slope = _kernel_of(before, axis.time_s)
        else:
            old = rows[0, 2:].reshape(2, -1)[:, :PARTS].ravel()
            kernel, slope = 1.0 + 0j, -mode.pole_rad_s
        coordinate = complex(*rings[0, :2]) - _left(old, sets, lag)
        # The coordinate is -[k y' + (c k - k') y]: two equations of its real and imaginary part.
        factor = drag * kernel - slope
        system = np.array([[kernel.real, factor.real], [kernel.imag, factor.imag]])
        speed, deflection = np.linalg.solve(system, [-coordinate.real, -coordinate.imag])
        speed += (hoist.rate_m_s - rate) * deflection / hoist.first.cable_length_m
        kernel, slope = _kernel_of(hoist, axis.time_s)
        seen = -(kernel * speed + (drag * kernel - slope) * deflection)
        seen += _left(_values(gains_of(drive, hoist), axis.time_s), sets, lag)
        moved = np.zeros_like(rings)
        moved[0, :2] = seen.real, seen.imag
        found.append(moved)
    return replace(axis, rings=found[0], ideal_rings=found[1])


def _kernel_of(hoist: Hoist, time_s: float) -> tuple[complex, complex]:
    """Return the kernel and its rate at a time of a hoist: an ideal drive's A is its negative."""
    ideal = gains_of(Ideal(), hoist)
    value, slope = _values(ideal, time_s), _values(ideal, time_s, 1)
    return -complex(value[0], value[1]), -complex(slope[0], slope[1])


def _left(gains: FloatArray, sets: tuple[tuple[int, int], ...], lag: FloatArray) -> complex:
    """Return what lags will still leave, of pairs of a set and its row."""
    total = 0j
    for force, row in sets:
        a, b = gains[PARTS * force : PARTS * (force + 1)].copy().view(np.complex128)
        total += complex(a * lag[row, 0] + b * lag[row, 1])
    return total


def solve_hoisted(
    task: Task,
    actuator: Unlimited,
    hoist: Hoist | None,
    kind: LiveKind,
    axis: AxisState,
    target: float,
) -> AxisState | None:
    """Return an axis with a plan to a level, made for the course of a hoist.

    Parameters
    ----------
    task, actuator, hoist
        As of `carry_hoisted`.
    kind, axis, target
        As of `design.live.planning.solve_plan`.

    Returns
    -------
    AxisState or None
        With the plan; None if none was found.
    """
    if hoist is None or axis.time_s >= hoist.end_s:
        return solve_plan(task, kind, axis, target)
    if axis.level == target and np.abs(axis.rings[:, :2]).max() <= NOTHING:
        return replace(axis, target=target, plan=Plan())
    if axis.level == target and np.abs(axis.rings[:, :2]).max() <= TOO_SMALL:
        left = Plan(swing_left=TOO_SMALL, rests_s=hoist.end_s)
        return replace(axis, target=target, plan=left)
    waited = carry_hoisted(task, actuator, hoist, replace(axis, plan=Plan()), hoist.end_s)
    late = solve_plan(task, kind, waited, target)
    latest_s = math.inf if late is None else _last_s(late) + task.rows.dead_time_s - axis.time_s
    found = _earliest(task, gains_of(actuator, hoist), axis, target, latest_s)
    plan = found if found is not None else None if late is None else late.plan
    if plan is None and axis.level == target:
        plan = _there_and_back(task, actuator, hoist, kind, axis)
    return None if plan is None else replace(axis, target=target, plan=plan)


def _there_and_back(
    task: Task, actuator: Unlimited, hoist: Hoist, kind: LiveKind, axis: AxisState
) -> Plan | None:
    """Return a plan to rest, or at rest to full speed, and back, which serves a small swing.

    Superposed steps need it: short pulses leave much in that model, and few swings are theirs.
    """
    there = solve_hoisted(task, actuator, hoist, kind, axis, 0.0 if axis.level else 1.0)
    if there is None or not there.plan.times_s:
        return None
    end_s = there.plan.times_s[-1] + task.rows.dead_time_s
    ended = carry_hoisted(task, actuator, hoist, there, end_s)
    back = solve_hoisted(task, actuator, hoist, kind, ended, axis.level)
    return None if back is None else there.plan + back.plan


def _last_s(axis: AxisState) -> float:
    return axis.plan.times_s[-1] if axis.plan.times_s else axis.time_s


def _earliest(
    task: Task, gains: Gains, axis: AxisState, target: float, best_s: float
) -> Plan | None:
    """Return the earliest plan of all patterns that is earlier than a time from now."""
    period_s = task.modes[0].period_s
    least = LEAST_SUPERPOSED_PULSE if task.apart else LEAST_PULSE
    guesses = guesses_s(task.modes, UNKNOWNS)
    if axis.level == target:
        small = period_s * np.array(list(itertools.product(SMALL_FIRST, SMALL_SECOND)))
        guesses = np.concatenate((guesses, small))
    others = dict.fromkeys((0.0, axis.level, axis.target))
    beside = tuple(one for one in others if one != target and one * target >= 0) or (1.0,)
    memory = (
        np.empty((MAX_ARCS + 2, 2)),
        np.empty((MAX_ARCS + 2, 2)),
        np.empty((2, 2 * PARTS)),
        np.empty(MAX_ARCS),
    )
    best = None
    groups = patterns(axis.level, target, beside, period_s / 2, LEAST_REST * period_s, UNKNOWNS)
    for pattern in itertools.chain.from_iterable(groups):
        given = np.array(pattern.given_s)
        found = np.empty(given.size)
        earliest_s = search_hoisting(
            task.rows.drive,
            gains.ends_s,
            gains.values,
            gains.slopes,
            gains.last,
            gains.pole,
            axis.time_s,
            axis.level,
            axis.force,
            axis.lag[0],
            axis.rings[0, :2].copy(),
            np.array(pattern.levels),
            given,
            guesses,
            least * period_s,
            LONGEST_MOVE * period_s,
            task.iterations,
            NOTHING,
            best_s,
            found,
            *memory,
        )
        if earliest_s < best_s:
            best_s = earliest_s
            best = plan_of(task.rows, axis, pattern, found, LEAST_PULSE * period_s)
    return best
