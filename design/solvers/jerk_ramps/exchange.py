"""Where a stationary course of limited jerk is not the optimum, and what structure to try next.

Between events y is positive where the jerk is at its upper limit and negative at the lower; at a
limit of the slope ``P + N`` drives the slope into it; at rest P drives the level into its end, and
N does so where the course touches. What breaks a rule, or one of the limits, is exchanged.
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from design.solvers.jerk_ramps.events import EventCourse, Group
from design.solvers.jerk_ramps.optimality import Stationary
from design.solvers.jerk_ramps.rules import POINTS, piece_rules, with_pieces
from design.solvers.ramps.functionals import Functionals
from design.types import FloatArray

NEGLIGIBLE = 1e-8
"""Share of the largest y or P that breaks no rule: rounding, or a gain of nothing [-]."""

BEYOND = 1e-9
"""By how much slope or level are beyond a limit that is kept, over the limit [-]."""

SHORTEST = 1e-4
"""Share of the time to the steepest slope below which an interval is none [-]."""


SHORTEST_RAD = 1e-9
"""Intervals shorter than this are none, at most [rad]."""


def next_structures(found: Stationary, functionals: Functionals) -> Iterator[EventCourse]:
    """Yield courses whose structures keep a rule that one breaks.

    Near it: a start for the stationary courses of those structures.

    Parameters
    ----------
    found
        The course, its multipliers and prices.
    functionals
        What counts.

    Yields
    ------
    EventCourse
        The likeliest first; none where no rule is broken.
    """
    course = found.course
    yield from _without_short_intervals(course)
    if course.widths.min() < shortest_rad(course):
        return
    yield from _limits_passed(course)
    yield from signs_broken(found, functionals)


def within_limits(course: EventCourse) -> list[EventCourse] | None:
    """Return what keeps an order or a limit that a course passes.

    Parameters
    ----------
    course
        The course.

    Returns
    -------
    list of EventCourse, or None
        At most one, near the course; None where it keeps all.
    """
    if course.widths.min() < shortest_rad(course):
        return [*_without_short_intervals(course)]
    return [*_limits_passed(course)] or None


def shortest_rad(course: EventCourse) -> float:
    """Return below which an interval between two events is none [rad]."""
    limits = course.limits
    return min(SHORTEST * min(limits.up, limits.down) / limits.jerk, SHORTEST_RAD)


def _without_short_intervals(course: EventCourse) -> Iterator[EventCourse]:
    """Yield the structure without its shortest interval, if that is none."""
    widths = course.widths
    shortest = int(np.argmin(widths))
    if widths[shortest] >= shortest_rad(course):
        return
    times = course.times.tolist()
    for number, group in enumerate(course.groups):
        first, count = course.firsts[number], len(group.signs)
        if group.rests and shortest == first + count:
            merged = [*times[: first + count], sum(times[shortest : shortest + 2]) / 2]
            groups = _with(course.groups, number, replace(group, rests=False))
            yield _ordered(course, groups, [*merged, *times[shortest + 2 :]])
            return
        piece = shortest - first
        if 0 <= piece < count:
            inner = times[first : first + count + 1]
            made = _dropped(list(group.signs), inner, piece)
            if made is not None:
                signs, kept = made
                groups = _with(course.groups, number, replace(group, signs=tuple(signs)))
                yield _ordered(course, groups, [*times[:first], *kept, *times[first + count + 1 :]])
            return


def _dropped(
    signs: list[int], times: list[float], piece: int
) -> tuple[list[int], list[float]] | None:
    """Return pieces and events of a group without one of its pieces; None where none is left."""
    if not 0 < piece < len(signs) - 1:
        return None
    middle = (times[piece] + times[piece + 1]) / 2
    signs = [*signs[:piece], *signs[piece + 1 :]]
    times = [*times[:piece], middle, *times[piece + 2 :]]
    # Pieces that meet and are alike are one, and so are two at one limit with nothing between.
    number = piece
    if signs[number - 1] == signs[number]:
        del signs[number], times[number]
    elif signs[number - 1] == 0 and number + 1 < len(signs) and signs[number + 1] == 0:
        del signs[number : number + 2], times[number : number + 2]
    elif signs[number] == 0 and number > 1 and signs[number - 2] == 0:
        del signs[number - 1 : number + 1], times[number - 1 : number + 1]
    differ = all(one != other for one, other in pairwise(signs))
    turn = all(
        0 < number < len(signs) - 1 and signs[number - 1] == -signs[number + 1]
        for number, sign in enumerate(signs)
        if sign == 0
    )
    return (signs, times) if differ and turn else None


def _limits_passed(course: EventCourse) -> Iterator[EventCourse]:
    """Yield the structure at a limit of slope or level that it passes by most."""
    worst, best = BEYOND, None
    limits, times = course.limits, course.times.tolist()
    for number, group in enumerate(course.groups):
        first, slopes = course.firsts[number], course.slopes_of(number)
        for event in range(1, len(group.signs)):
            up = group.signs[event - 1] > 0 > group.signs[event]
            down = group.signs[event - 1] < 0 < group.signs[event]
            limit = limits.up if up else limits.down
            passed = (slopes[event] if up else -slopes[event]) / limit - 1
            if (up or down) and passed > worst:
                worst = float(passed)
                half = passed * limit / limits.jerk
                signs = (*group.signs[:event], 0, *group.signs[event:])
                at = times[first + event]
                best = (
                    _with(course.groups, number, replace(group, signs=signs)),
                    [*times[: first + event], at - half, at + half, *times[first + event + 1 :]],
                )
        level = course.level_before(number)
        widths = course.widths_of(number)
        for piece, sign in enumerate(group.signs):
            before, after = slopes[piece : piece + 2]
            turns = piece < len(group.signs) - 1 and before * after < 0
            if turns:
                till = abs(before) / limits.jerk
                turned = level + before * till / 2
                passed = turned - 1 if before > 0 else -turned
                if passed > worst:
                    worst = float(passed)
                    goal = 1.0 if before > 0 else 0.0
                    parts = (
                        Group(signs=group.signs[: piece + 1], goal=goal, rests=False),
                        replace(group, signs=(sign, *group.signs[piece + 1 :])),
                    )
                    best = (
                        (*course.groups[:number], *parts, *course.groups[number + 1 :]),
                        [
                            *times[: first + piece + 1],
                            times[first + piece] + till,
                            *times[first + piece + 1 :],
                        ],
                    )
            level += (before + after) / 2 * widths[piece]
    if best is not None:
        yield _ordered(course, *best)


def signs_broken(found: Stationary, functionals: Functionals) -> Iterator[EventCourse]:
    """Yield structures that exchange what breaks a rule of signs.

    Parameters
    ----------
    found
        A course that passes no limit, its multipliers and prices.
    functionals
        What counts.

    Yields
    ------
    EventCourse
        Near the course, what breaks its rule most first; none where no rule is broken.
    """
    course, times = found.course, found.course.times.tolist()
    scale_once = float(np.abs(_weighted(found, functionals.integrals(course.times))).max())
    scale = float(np.abs(_weighted(found, functionals.kernels(course.times))).max())
    made: list[tuple[float, tuple[Group, ...], list[float]]] = []
    rules = piece_rules(course, found.multipliers, found.prices, functionals)
    for number, piece, inner, broken in rules:
        size = scale_once if course.groups[number].signs[piece] else scale
        stretch = _worst_stretch(broken, NEGLIGIBLE * size)
        if stretch is not None:
            low, high = float(inner[stretch[0]]), float(inner[stretch[1]])
            made.append((
                float(broken.max()) / size,
                *with_pieces(course, number, piece, low, high),
            ))
    for number, group in enumerate(course.groups[:-1]):
        after = course.firsts[number] + len(group.signs)
        into = 1.0 if group.goal == 1 else -1.0
        if group.rests:
            inner = np.linspace(times[after], times[after + 1], POINTS)
            pull = into * _weighted(found, functionals.kernels(inner))
            falls = np.maximum.accumulate(pull) - pull
            worst = int(np.argmax(falls))
            if falls[worst] > NEGLIGIBLE * scale:
                low, high = float(inner[int(np.argmax(pull[: worst + 1]))]), float(inner[worst])
                way = -1 if group.goal == 1 else 1
                dip = Group(signs=(way, -way, way), goal=group.goal, rests=True)
                quarter = (high - low) / 4
                cuts = [low, low + quarter, high - quarter, high]
                made.append((
                    float(falls[worst]) / scale,
                    (*course.groups[: number + 1], dip, *course.groups[number + 1 :]),
                    [*times[: after + 1], *cuts, *times[after + 1 :]],
                ))
            continue
        # Where it touches, N jumps the way that the level drives it, and y has the jerk's sign.
        level = course.level_conditions[number]
        jump = found.prices[course.level_conditions[number + 1]] - found.prices[level]
        wrong_jump = into * float(jump) / scale
        touching = _weighted(found, functionals.integrals(np.array([times[after]])))
        wrong_jerk = -group.signs[-1] * float(touching[0] - found.prices[level - 1]) / scale_once
        if wrong_jump > NEGLIGIBLE:
            made.append((wrong_jump, *_joined(course, number)))
        elif wrong_jerk > NEGLIGIBLE:
            made.append((wrong_jerk, *_stays(course, number)))
    for _, groups, events in sorted(made, key=lambda one: -one[0]):
        yield _ordered(course, groups, events)


def without_touches(course: EventCourse) -> Iterator[EventCourse]:
    """Yield a course without each of its touches of 0 or 1.

    A structure that touches may have fewer events than conditions: the optimum has more switches,
    and the course without the touch shows where.

    Parameters
    ----------
    course
        The course.

    Yields
    ------
    EventCourse
        The pieces on both sides of a touch as one.
    """
    for number, group in enumerate(course.groups[:-1]):
        if not group.rests:
            yield _ordered(course, *_joined(course, number))


def staying(course: EventCourse) -> Iterator[EventCourse]:
    """Yield a course that stays where it touches 0 or 1, for each touch.

    Parameters
    ----------
    course
        The course.

    Yields
    ------
    EventCourse
        With a stay of no time.
    """
    for number, group in enumerate(course.groups[:-1]):
        if not group.rests:
            yield _ordered(course, *_stays(course, number))


def _stays(course: EventCourse, number: int) -> tuple[tuple[Group, ...], list[float]]:
    """Return groups and events with a stay at the end of a group in place of a touch."""
    groups = _with(course.groups, number, replace(course.groups[number], rests=True))
    after = course.firsts[number] + len(course.groups[number].signs)
    times = course.times.tolist()
    return groups, [*times[: after + 1], *times[after:]]


def _joined(course: EventCourse, number: int) -> tuple[tuple[Group, ...], list[float]]:
    """Return groups and events without the touch at the end of a group."""
    group, following = course.groups[number : number + 2]
    signs = (*group.signs, *following.signs[1:])
    joined = Group(signs=signs, goal=following.goal, rests=following.rests)
    groups = (*course.groups[:number], joined, *course.groups[number + 2 :])
    times = course.times.tolist()
    after = course.firsts[number] + len(group.signs)
    return groups, [*times[:after], *times[after + 1 :]]


def _weighted(found: Stationary, kernels: np.ndarray) -> FloatArray:
    weighted: FloatArray = (found.multipliers.conj() @ kernels).real
    return weighted


def _worst_stretch(broken: FloatArray, negligible: float) -> tuple[int, int] | None:
    """Return the first and the last point of the stretch that breaks its rule most."""
    worst = int(np.argmax(broken))
    if broken[worst] <= negligible:
        return None
    first = last = worst
    while first > 1 and broken[first - 1] > 0:
        first -= 1
    while last < broken.size - 2 and broken[last + 1] > 0:
        last += 1
    return (first, last) if first < last else (max(worst - 1, 0), min(worst + 1, broken.size - 1))


def _with(groups: tuple[Group, ...], number: int, group: Group) -> tuple[Group, ...]:
    return (*groups[:number], group, *groups[number + 1 :])


def _ordered(course: EventCourse, groups: tuple[Group, ...], times: list[float]) -> EventCourse:
    widths = np.diff(np.maximum.accumulate(np.array(times)))
    return replace(course, groups=groups, widths=widths)
