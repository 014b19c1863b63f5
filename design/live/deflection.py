"""Least time to a level with a limit to the deflection on the way.

On even times a command is a staircase, and the least peak of the deflection is a linear programme:
the command between 0 and full speed, nothing swinging after the last step. The time of the
staircase is made as short as its least peak is within the limit. Behind an ideal drive from rest
that is, in the limit of many steps: full speed until the limit is reached, a command that rises
evenly while the payload hangs back at the limit, nothing, and full speed.

Examples
--------
>>> from design.live.machine import LiveKind
>>> from design.live.state import at_rest
>>> from design.model.actuators.ideal import Ideal
>>> from design.model.plants.pendulum import Pendulum
>>> crane = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
>>> found = limited_plan(Ideal(), crane.modes, at_rest(1, LiveKind()), 1.0, 0.5)
>>> periods = found.plan.times_s[-1] * crane.mode.natural_frequency_rad_s / math.tau
>>> 0.396 < periods < 0.404, found.peak <= 0.5
(True, True)
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from design.checks import require_between
from design.live.deflection_peak import peak_deflection
from design.live.machine import IDEAL_ROW, MAX_LIMIT, MIN_LIMIT, drive_row, mode_rows
from design.live.propagation import Rows, carry
from design.live.stair_programme import (
    CELLS,
    NO_STEP,
    Stairs,
    least_peak,
    sets_of,
    steps_of_levels,
)
from design.live.staircase import Staircase, response_of
from design.live.state import AxisState, Plan
from design.model.actuators.rate_limited import Unlimited
from design.model.plants.mode import Mode
from design.types import IntArray

FIRST_PERIODS = 0.4
"""Time that is tried first, in periods of the slowest mode [-]."""

LONGER = 1.3
"""Ratio by which a time that is too short grows [-]."""

MAX_PERIODS = 5.0
"""Longest time of a staircase, in periods of the slowest mode, beside the settling of lags [-]."""

SEARCHES = 10
"""Times between one that is too short and one that is long enough."""

EXACT_TIME = 2e-3
"""Share to which the time is the least [-]."""

MAX_SCHEDULES = 2
"""Times that the signs of steps are changed to suit unequal sets."""

MAX_REPAIRS = 6
"""Times that sets are taken anew from the steps that they led to."""

MAX_MARGINS = 4
"""Times that the limit of the programme is lowered by what the peak exceeds it."""

AT_LEAST = 1.002
"""What is allowed above the least peak that can be, where the limit cannot be kept [-]."""

TURN_PERIODS = 1e-3
"""Time that a reversal stands still, in periods of the slowest mode [-]."""

ROUNDING = 1e-6
"""Share that a lowered limit is below what the peak asks for [-]."""

LOWER = 0.995
"""Ratio by which the limit is lowered where rounding cannot be taken off a staircase [-]."""

RESIDUAL = 1e-9
"""Largest vibration after the last step, over an unshaped one's [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LimitedPlan:
    """A command with limited deflection.

    Attributes
    ----------
    plan
        Its switches; ``fallback`` says by how much the limit is exceeded, if it is.
    peak
        Largest deflection from now on, over that of an unshaped step: the worst mode's [-].
    """

    plan: Plan
    peak: float


def limited_plan(
    actuator: Unlimited, modes: tuple[Mode, ...], axis: AxisState, target: float, limit: float
) -> LimitedPlan | None:
    """Return the fastest staircase to a level that keeps a limit.

    Parameters
    ----------
    actuator, modes
        The drive, and the modes of the plant as it is now.
    axis
        The axis when the drive first answers: after the dead time, what was sent before made.
    target
        The level to end at, signed; a reversal stops first [-].
    limit
        Largest deflection, over that of an unshaped step [-].

    Returns
    -------
    LimitedPlan or None
        If the limit cannot be kept, with about the least peak. None if no staircase ends at rest.

    Raises
    ------
    InvalidInputError
        If the limit is not from 0.05 to 10.
    """
    require_between("deflection_limit", limit, MIN_LIMIT, MAX_LIMIT)
    if axis.level * target < 0:
        return _reversed(actuator, modes, axis, target, limit)
    velocity = float(axis.lag[:, 0].sum())
    direction = math.copysign(1.0, axis.level or target or velocity)
    mirrored = replace(
        axis,
        level=direction * axis.level,
        lag=direction * axis.lag,
        rings=direction * axis.rings,
        plan=Plan(),
    )
    stairs = Staircase(axis=mirrored, actuator=actuator, modes=modes)
    kept = limit * (1 - ROUNDING)  # the other route's peak is another by rounding
    allowed, best = kept, None
    for _ in range(MAX_MARGINS):
        found = _shortest(stairs, direction * target, allowed)
        if found is None:
            break
        plan = _polished(stairs, direction * target, found)
        if plan is None:
            allowed *= LOWER
            continue
        peak = peak_deflection(actuator, modes, replace(mirrored, plan=plan))
        best = LimitedPlan(plan=_sent(plan, actuator, direction), peak=peak)
        if peak <= kept or found.limit > allowed:
            break
        allowed *= (kept / peak) * (1 - ROUNDING)
    return None if best is None else _told(best, limit)


def _told(found: LimitedPlan, limit: float) -> LimitedPlan:
    """Return a plan that says by how much it exceeds the limit."""
    if found.peak <= limit:
        return found
    reason = (
        f"the deflection reaches {found.peak:.4g} of an unshaped step's, "
        f"{found.peak - limit:.2g} above the limit of {limit:g}: from this swing that is about "
        "the least"
    )
    return replace(found, plan=replace(found.plan, fallback=reason))


def _reversed(
    actuator: Unlimited, modes: tuple[Mode, ...], axis: AxisState, target: float, limit: float
) -> LimitedPlan | None:
    """Return a stop and the start that follows it."""
    stop = limited_plan(actuator, modes, axis, 0.0, limit)
    if stop is None:
        return None
    acts = [time_s + actuator.dead_time_s for time_s in stop.plan.times_s]
    stopping = replace(axis, plan=replace(stop.plan, times_s=tuple(acts)))
    # Off, and on the other way at once, would be one step, which only one of two sets follows.
    turn_s = max([axis.time_s, *acts]) + TURN_PERIODS * math.tau / min(
        mode.natural_frequency_rad_s for mode in modes
    )
    standing = carry(_rows(actuator, modes), stopping, turn_s)
    start = limited_plan(actuator, modes, standing, target, limit)
    if start is None:
        return None
    plan = Plan(
        times_s=stop.plan.times_s + start.plan.times_s,
        levels=stop.plan.levels + start.plan.levels,
    )
    return _told(LimitedPlan(plan=plan, peak=max(stop.peak, start.peak)), limit)


def _sent(plan: Plan, actuator: Unlimited, direction: float) -> Plan:
    """Return a plan as it is commanded, a dead time before the drive answers."""
    return Plan(
        times_s=tuple(time_s - actuator.dead_time_s for time_s in plan.times_s),
        levels=tuple(direction * level + 0.0 for level in plan.levels),
    )


def _shortest(stairs: Staircase, target: float, limit: float) -> Stairs | None:
    """Return the staircase of least time."""
    first_s = FIRST_PERIODS * math.tau / stairs.slowest_rad_s
    found = _search(stairs, target, limit, first_s, None)
    if found is None or stairs.alike:
        return found
    # What alike sets would do says when the command rises and when it falls.
    sets = sets_of(stairs, found.levels, target)
    held = _consistent(stairs, target, limit, found.time_s, sets)
    for _ in range(MAX_SCHEDULES):
        if held is None:
            return None
        others = (
            least_peak(stairs, target, held.time_s, other) for other in _neighbours(held.sets)
        )
        better = min(
            (one for one in others if one is not None and _is_consistent(stairs, target, one)),
            key=lambda one: one.peak,
            default=held,
        )
        if better.peak >= held.peak * (1 - EXACT_TIME):
            break
        other = _consistent(stairs, target, limit, held.time_s, better.sets)
        if other is None or other.time_s >= held.time_s:
            break
        held = other
    return held


def _is_consistent(stairs: Staircase, target: float, one: Stairs) -> bool:
    """Return whether the steps choose the sets that were assumed."""
    return bool(np.array_equal(sets_of(stairs, one.levels, target), one.sets))


def _consistent(
    stairs: Staircase, target: float, limit: float, time_s: float, sets: IntArray
) -> Stairs | None:
    """Return the staircase of least time whose steps choose the sets that were assumed.

    A step of no height that was to change the set does not: the sets are taken from the steps, and
    the time is searched anew.
    """
    for _ in range(MAX_REPAIRS):
        found = _search(stairs, target, limit, time_s, sets)
        if found is None or _is_consistent(stairs, target, found):
            return found
        time_s, sets = found.time_s, sets_of(stairs, found.levels, target)
    return None


def _search(
    stairs: Staircase, target: float, limit: float, time_s: float, sets: IntArray | None
) -> Stairs | None:
    """Return the least time from which on the least peak keeps the limit, with given sets."""
    longest_s = MAX_PERIODS * math.tau / stairs.slowest_rad_s + stairs.settling_s
    short_s, peak_of_short = 0.0, math.inf
    best = least_peak(stairs, target, time_s, sets)
    while (best is None or best.peak > limit) and time_s < longest_s:
        short_s, peak_of_short = time_s, math.inf if best is None else best.peak
        time_s = min(LONGER * time_s, longest_s)
        best = least_peak(stairs, target, time_s, sets)
    if best is None:
        return None
    if best.peak > limit:
        limit, short_s, peak_of_short = AT_LEAST * best.peak, 0.0, math.inf
    for _ in range(SEARCHES):
        if best.time_s - short_s <= EXACT_TIME * best.time_s:
            break
        if best.peak >= limit * (1 - EXACT_TIME):
            break
        share = 0.5
        if math.isfinite(peak_of_short):
            share = (peak_of_short - limit * (1 - EXACT_TIME / 2)) / (peak_of_short - best.peak)
            share = min(max(share, 0.1), 0.95)
        time_s = short_s + share * (best.time_s - short_s)
        found = least_peak(stairs, target, time_s, sets)
        if found is not None and found.peak <= limit:
            best = found
        else:
            short_s, peak_of_short = time_s, math.inf if found is None else found.peak
    return best._replace(limit=limit)


def _neighbours(sets: IntArray) -> list[IntArray]:
    """Return sets whose changes are a cell earlier or later, one at a time."""
    found = []
    for change in (np.flatnonzero(np.diff(sets)) + 1).tolist():
        for place, value in ((change - 1, sets[change]), (change, sets[change - 1])):
            other = sets.copy()
            other[place] = value
            found.append(other)
    return found


def _polished(stairs: Staircase, target: float, found: Stairs) -> Plan | None:
    """Return the plan of a staircase, moved by rounding so that nothing swings."""
    whole = np.concatenate(([stairs.axis.level], found.levels, [target]))
    for number in range(1, whole.size - 1):
        if abs(whole[number] - whole[number - 1]) <= NO_STEP:
            whole[number] = whole[number - 1]
    if abs(target - whole[-2]) <= NO_STEP:
        whole[whole == whole[-2]] = target
    highest = max(1.0, stairs.axis.level, target)
    whole[1:-1] = np.where(whole[1:-1] <= NO_STEP, 0.0, whole[1:-1])
    whole[1:-1] = np.where(whole[1:-1] >= highest - NO_STEP, highest, whole[1:-1])
    groups = np.concatenate(([0], np.cumsum(np.diff(whole) != 0)))
    sets = sets_of(stairs, whole[1:-1], target)
    response = response_of(stairs, found.time_s / CELLS, sets)
    by_levels = response.vibration_by_steps @ steps_of_levels()
    free = [
        group for group in range(1, int(groups[-1])) if 0.0 < whole[groups == group][0] < highest
    ]
    if free:
        columns = np.stack([by_levels[:, groups[1:-1] == group].sum(axis=1) for group in free], 1)
        given = np.diff(whole)
        missed = response.vibration + response.vibration_by_steps @ given
        matrix = np.concatenate((columns.real, columns.imag))
        moves = np.linalg.lstsq(matrix, -np.concatenate((missed.real, missed.imag)), rcond=None)[0]
        for group, move in zip(free, moves.tolist(), strict=True):
            whole[groups == group] += move
    changed = np.flatnonzero(np.diff(whole))
    times = stairs.axis.time_s + changed * found.time_s / CELLS
    plan = Plan(times_s=tuple(times.tolist()), levels=tuple(whole[changed + 1].tolist()))
    inside = min(plan.levels, default=0.0) >= 0.0 and max(plan.levels, default=0.0) <= highest
    return plan if inside and _residual(stairs, plan) <= RESIDUAL else None


def _residual(stairs: Staircase, plan: Plan) -> float:
    """Return what swings after a plan, as the drive chooses its sets itself."""
    axis = replace(stairs.axis, plan=plan)
    end_s = plan.times_s[-1] if plan.times_s else axis.time_s
    ended = carry(_rows(stairs.actuator, stairs.modes), axis, end_s)
    return float((np.abs(ended.vibration) / stairs.units).max())


def _rows(actuator: Unlimited, modes: tuple[Mode, ...]) -> Rows:
    """Return a machine as the kernel knows it, its dead time apart."""
    drive = drive_row(actuator)
    return Rows(drive, mode_rows(modes, drive), mode_rows(modes, IDEAL_ROW), 0.0)
