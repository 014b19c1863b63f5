"""The signs that multipliers have along an optimum, and pieces more where they differ.

Where the jerk is at its upper limit y is positive, and negative at the lower; at a limit of the
slope ``P + N`` drives the slope into it. Both are linear in multipliers and prices.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from design.solvers.jerk_ramps.events import EventCourse, Group
from design.solvers.ramps.functionals import Functionals
from design.types import ComplexArray, FloatArray

POINTS = 41
"""Points of a piece at which its rule is looked at."""

VANISHING = 1e-9
"""Share of the largest singular value below which one is 0 [-]."""

FIRST_WIDTHS_RAD = (0.1, 0.01, 0.001)
"""Widths of a piece that enters, to be tried [rad]."""


def piece_rules(
    course: EventCourse, multipliers: ComplexArray, prices: FloatArray, functionals: Functionals
) -> Iterator[tuple[int, int, FloatArray, FloatArray]]:
    """Yield by how much each piece of a course breaks its rule.

    Parameters
    ----------
    course
        The course.
    multipliers, prices
        Of its targets, shape (m,), and of its conditions, shape (c,).
    functionals
        What counts.

    Yields
    ------
    tuple
        Numbers of group and piece, times within it, and what is positive where the rule is broken.
    """
    start = 0
    for number, group in enumerate(course.groups):
        at_limit = [piece for piece, sign in enumerate(group.signs) if sign == 0]
        own = prices[start : start + len(at_limit) + 2]
        start += own.size
        times = course.times[course.events_of(number)]
        slopes = course.slopes_of(number)
        for piece, sign in enumerate(group.signs):
            inner = np.linspace(times[piece], times[piece + 1], POINTS)
            if sign:
                later = sum(own[at] for at, limit in enumerate(at_limit) if limit > piece)
                y = (multipliers.conj() @ functionals.integrals(inner)).real
                y = y - later - own[-2] - own[-1] * (times[-1] - inner)
                yield number, piece, inner, -sign * y
            else:
                way = 1.0 if slopes[piece] > 0 else -1.0
                pull = (multipliers.conj() @ functionals.kernels(inner)).real
                yield number, piece, inner, way * (pull + own[-1])


def with_pieces(
    course: EventCourse, number: int, piece: int, low: float, high: float
) -> tuple[tuple[Group, ...], list[float]]:
    """Return groups and events of a course with a piece turned for a while.

    Parameters
    ----------
    course
        The course.
    number, piece
        Which group and piece.
    low, high
        From when until when the jerk is the other way; a slope at a limit goes away from it and
        back [rad].

    Returns
    -------
    tuple
        Groups, and times of events.
    """
    group, times = course.groups[number], course.times.tolist()
    sign, begins = group.signs[piece], course.firsts[number] + piece
    if sign:
        new: tuple[int, ...] = (sign, -sign, sign)
        cuts = [low, high]
    else:
        way = 1 if course.slopes_of(number)[piece] > 0 else -1
        new, cuts = (0, -way, way, 0), [low, (low + high) / 2, high]
    signs = (*group.signs[:piece], *new, *group.signs[piece + 1 :])
    groups = (
        *course.groups[:number],
        replace(group, signs=signs),
        *course.groups[number + 1 :],
    )
    return groups, [*times[: begins + 1], *cuts, *times[begins + 1 :]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Weighed:
    """What of a course has weights, beside its conditions.

    Attributes
    ----------
    changes
        Derivatives in each event after the first, shape (k, n - 1).
    multipliers
        Those that a unit of each weight is, shape (k, m).
    """

    changes: FloatArray
    multipliers: ComplexArray


def targets_of(course: EventCourse, functionals: Functionals) -> Weighed:
    """Return what is weighed where targets are met.

    Parameters
    ----------
    course, functionals
        The course, and what counts, m of them.

    Returns
    -------
    Weighed
        Real parts first, then imaginary ones, shape (2 m, n - 1).
    """
    changes, each = course.changes(functionals)[:, 1:], np.eye(functionals.poles.size)
    return Weighed(
        changes=np.vstack((changes.real, changes.imag)), multipliers=np.vstack((each, 1j * each))
    )


def entering_pieces(
    course: EventCourse, functionals: Functionals, weighed: Weighed
) -> Iterator[EventCourse]:
    """Yield courses that touch 0 or 1 with the piece more that this takes.

    Where a stationary course of as many events as conditions passes 0 or 1, a touch is a condition
    too many. Its price is free, then: it grows until a rule is broken, and there pieces enter.

    Parameters
    ----------
    course
        The stationary course, with its touch as part of its structure: the level is not yet met.
    functionals, weighed
        What counts, and by what its multipliers are made up.

    Yields
    ------
    EventCourse
        With pieces of several widths.
    """
    solved = _all_weights(course, weighed)
    if solved is None:
        return
    base, free = solved
    skipped = len(weighed.changes)
    for number, group in enumerate(course.groups[:-1]):
        if group.rests:
            continue
        first, second = skipped + course.level_conditions[number : number + 2]
        into = 1.0 if group.goal == 1 else -1.0
        direction = -into * ((free[:, second] - free[:, first]) @ free)
        grown = direction[second] - direction[first]
        if abs(grown) < VANISHING:
            continue
        start = base - (base[second] - base[first]) / grown * direction
        broken = _first_broken(course, functionals, weighed, (start, direction), number)
        if broken is None:
            continue
        owner, piece, middle = broken
        end = float(course.times[course.events_of(number)][-1])
        if owner == number and middle == end:
            stays = replace(group, rests=True)
            groups = (*course.groups[:number], stays, *course.groups[number + 1 :])
            after = course.firsts[number] + len(group.signs)
            yield replace(course, groups=groups, widths=np.insert(course.widths, after, 0.0))
            continue
        for width in FIRST_WIDTHS_RAD:
            half = min(width, float(course.widths_of(owner)[piece]) / 4) / 2
            groups, events = with_pieces(course, owner, piece, middle - half, middle + half)
            widths = np.diff(np.maximum.accumulate(np.array(events)))
            yield replace(course, groups=groups, widths=widths)


def _all_weights(course: EventCourse, weighed: Weighed) -> tuple[FloatArray, FloatArray] | None:
    """Return weights, then prices, of a stationary course, and all directions that are free.

    None where the course is not stationary.
    """
    rows = np.vstack((weighed.changes, course.condition_changes[:, 1:]))
    ends = np.zeros(rows.shape[1])
    ends[-1] = -1.0
    left, sizes, right = np.linalg.svd(rows.T)
    count = int(np.count_nonzero(sizes > VANISHING * sizes[0]))
    base: FloatArray = right[:count].T @ ((left[:, :count].T @ ends) / sizes[:count])
    if np.abs(rows.T @ base - ends).max() > VANISHING * np.abs(rows).max():
        return None
    return base, right[count:]


def _first_broken(
    course: EventCourse,
    functionals: Functionals,
    weighed: Weighed,
    along: tuple[FloatArray, FloatArray],
    touching: int,
) -> tuple[int, int, float] | None:
    """Return group, piece and time at which a rule is broken first, from a start along."""
    count = len(weighed.changes)
    of_start, of_direction = (
        piece_rules(course, one[:count] @ weighed.multipliers, one[count:], functionals)
        for one in along
    )
    first: tuple[int, int, float] | None = None
    least = np.inf
    for (number, piece, times, broken), (*_, breaking) in zip(of_start, of_direction, strict=True):
        # At its ends a piece keeps its rule by itself, except where it touches.
        touches = number == touching and piece == len(course.groups[number].signs) - 1
        inner = slice(1, None if touches else -1)
        grows = breaking[inner] > 0
        shares = np.where(grows, -broken[inner] / np.where(grows, breaking[inner], 1.0), np.inf)
        at = int(np.argmin(shares))
        if shares[at] < least:
            least, first = float(shares[at]), (number, piece, float(times[at + 1]))
    return first
