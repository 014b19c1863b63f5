"""The rest of a command of one axis, solved from its state."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from design.live.kernel import MAX_ARCS, MAX_UNKNOWNS, OF_MODE, search
from design.live.machine import IDEAL_ROW, LiveKind, drive_row, mode_rows
from design.live.patterns import Pattern, guesses_s, patterns
from design.live.propagation import Rows, carry
from design.live.state import AxisState, Plan
from design.model.actuators.rate_limited import Unlimited
from design.model.plants.mode import Mode
from design.types import FloatArray

NOTHING = 1e-11
"""Largest part of a modal coordinate that counts as nothing: a hundredth of what a certificate
allows [-]."""

LONGEST_MOVE = 0.17
"""Longest move of a gap in an iteration, over the fastest mode's period: farther on it is another
branch [-]."""

LEAST_PULSE = 1e-8
"""Shortest time between two switches, over the fastest mode's period: their order [-]."""

LEAST_SUPERPOSED_PULSE = 0.01
"""The same of superposed steps of two sets, where two steps that nearly coincide leave something in
that model alone: no drive can follow them [-]."""


FEW, SOON = 2, 0.8
"""Unknown gaps above which longer patterns are tried only if the last switch is later than this, in
periods of the slowest mode: four unknown gaps take milliseconds a pattern [-]."""


LEAST_REST = 0.01
"""Time at rest between two directions and at the end of a plan before the next begins, over the
fastest mode's period: two switches at once would be one to the drive, maybe of another set [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Task:
    """What planning needs of a machine whose modes stay as they are.

    Attributes
    ----------
    rows
        The machine as the kernel knows it.
    modes
        Its modes.
    apart
        Whether its steps are superposed, by two sets that differ.
    iterations
        Of Newton's method from one guess.
    """

    rows: Rows
    modes: tuple[Mode, ...]
    apart: bool
    iterations: int


@lru_cache(maxsize=64)
def task_of(actuator: Unlimited, modes: tuple[Mode, ...], iterations: int) -> Task:
    """Return the task of a drive on modes.

    Parameters
    ----------
    actuator, modes
        The machine.
    iterations
        Of Newton's method from one guess.

    Returns
    -------
    Task
        For `solve_plan`.
    """
    drive = drive_row(actuator)
    rows = Rows(drive, mode_rows(modes, drive), mode_rows(modes, IDEAL_ROW), actuator.dead_time_s)
    apart = actuator.model == "superposed" and actuator.accel_lag != actuator.decel_lag
    return Task(rows=rows, modes=modes, apart=apart, iterations=iterations)


def solve_plan(task: Task, kind: LiveKind, axis: AxisState, target: float) -> AxisState | None:
    """Return an axis with a plan to a level at which nothing swings.

    Parameters
    ----------
    task
        The machine.
    kind
        What counts as nothing swinging.
    axis
        The axis now, all that it was sent answered: its own plan is not looked at.
    target
        The level to end at, signed [-].

    Returns
    -------
    AxisState or None
        With the plan; None if none was found.
    """
    rings = axis.ideal_rings if kind.ideal else axis.rings
    parts = OF_MODE if kind.slope else OF_MODE // 2
    if axis.level == target and np.abs(rings[:, :parts]).max() <= NOTHING:
        return replace(axis, target=target, plan=Plan())
    found = _earliest(task, kind, axis, target)
    if axis.level * target < 0:
        stopped = solve_plan(task, kind, axis, 0.0)
        if stopped is not None:
            found = _earlier(found, wait_and_solve(task, kind, stopped, target))
    return found


def wait_and_solve(task: Task, kind: LiveKind, axis: AxisState, target: float) -> AxisState | None:
    """Return an axis that ends its plan first, and then goes to a level.

    Parameters
    ----------
    task, kind, target
        As of `solve_plan`.
    axis
        The axis now, with its plan.

    Returns
    -------
    AxisState or None
        With both plans in one; None if the second was not found.
    """
    first = axis.plan
    if not first.times_s:
        return solve_plan(task, kind, axis, target)
    rest_s = LEAST_REST * min(mode.period_s for mode in task.modes)
    ended = carry(task.rows, axis, first.times_s[-1] + task.rows.dead_time_s + rest_s)
    after = solve_plan(task, kind, ended, target)
    if after is None:
        return None
    return replace(axis, target=target, plan=first + after.plan)


def _earlier(one: AxisState | None, other: AxisState | None) -> AxisState | None:
    if one is None or other is None:
        return other if one is None else one
    return one if last_switch_s(one) <= last_switch_s(other) else other


def last_switch_s(axis: AxisState) -> float:
    """Return when an axis's plan has its last switch; now if it has none [s]."""
    return axis.plan.times_s[-1] if axis.plan.times_s else axis.time_s


def _earliest(task: Task, kind: LiveKind, axis: AxisState, target: float) -> AxisState | None:
    """Return the axis with the earliest of the patterns' plans."""
    rows = task.rows
    drive, modes, rings = rows.drive, rows.modes, axis.rings
    if kind.ideal:
        drive, modes, rings = IDEAL_ROW, rows.ideal_modes, axis.ideal_rings
    lag = axis.lag[0]
    count = len(task.modes)
    unknowns = count * (4 if kind.slope else 2)
    periods_s = [mode.period_s for mode in task.modes]
    slowest_s, fastest_s = max(periods_s), min(periods_s)
    apart = task.apart and not kind.ideal
    shortest_s = fastest_s * (LEAST_SUPERPOSED_PULSE if apart else LEAST_PULSE)
    memory = (
        np.empty((MAX_UNKNOWNS + 1, 2)),
        np.empty((MAX_UNKNOWNS + 1, count, OF_MODE)),
        np.empty((MAX_UNKNOWNS + 2, MAX_ARCS + 1)),
    )
    guesses = _guesses(task.modes, unknowns)
    best_s, best = math.inf, None
    for group in _patterns(task, axis, target, unknowns):
        for pattern in group:
            given = np.array(pattern.given_s)
            found = np.empty(given.size)
            earliest_s = search(
                drive,
                modes,
                int(kind.slope),
                axis.level,
                axis.force,
                lag,
                rings,
                np.array(pattern.levels),
                given.size,
                np.where(np.isnan(given), 0, -1),
                given,
                guesses,
                shortest_s,
                LONGEST_MOVE * fastest_s,
                task.iterations,
                NOTHING,
                best_s,
                found,
                *memory,
            )
            if earliest_s < best_s:
                best_s, best = (
                    earliest_s,
                    plan_of(rows, axis, pattern, found, LEAST_PULSE * fastest_s),
                )
        if unknowns > FEW and best_s <= SOON * slowest_s:
            break
    return None if best is None else replace(axis, target=target, plan=best)


@lru_cache(maxsize=64)
def _guesses(modes: tuple[Mode, ...], unknowns: int) -> FloatArray:
    return guesses_s(modes, unknowns)


def _patterns(
    task: Task, axis: AxisState, target: float, unknowns: int
) -> Iterator[tuple[Pattern, ...]]:
    others = dict.fromkeys((0.0, axis.level, axis.target))
    beside = tuple(one for one in others if one != target and one * target >= 0)
    half_s = math.pi / min(mode.pole_rad_s.imag for mode in task.modes)
    rest_s = LEAST_REST * min(mode.period_s for mode in task.modes)
    return patterns(axis.level, target, beside, half_s, rest_s, unknowns)


def plan_of(
    rows: Rows, axis: AxisState, pattern: Pattern, gaps_s: FloatArray, shortest_s: float
) -> Plan:
    """Return the switches of a pattern.

    One to the level that is held already is none, and so is one to a first arc of no length.

    Parameters
    ----------
    rows, axis
        The machine, and the axis as the pattern begins.
    pattern, gaps_s
        The levels, and how long each arc is, shape (arcs,) [s].
    shortest_s
        A first arc that is shorter is none [s].

    Returns
    -------
    Plan
        When each is commanded: a dead time before the drive answers.
    """
    begins = axis.time_s - rows.dead_time_s + np.concatenate(([0.0], np.cumsum(gaps_s)))
    times, levels, level = [], [], axis.level
    first = int(gaps_s.size > 0 and gaps_s[0] < shortest_s)
    for time_s, to in zip(begins.tolist()[first:], pattern.levels[first:], strict=True):
        if to != level:
            times.append(time_s)
            levels.append(to)
            level = to
    return Plan(times_s=tuple(times), levels=tuple(levels))
