"""Lengths of the cable over time, as hoists that follow one another."""

from collections.abc import Sequence
from itertools import pairwise

from design.errors import InvalidInputError
from design.model.plants.hoisting import Hoisting, LengthCourse
from design.model.plants.pendulum import Pendulum
from design.rig.scenario import HoistTo


def hoists_of(course: LengthCourse) -> list[HoistTo]:
    """Return the hoists that make a course of lengths.

    Parameters
    ----------
    course
        The lengths; times count from the start of the run.

    Returns
    -------
    list of HoistTo
        One for each piece on which the length changes; their events are the pieces.
    """
    points = zip(course.times_s, course.values, strict=True)
    return [
        HoistTo(event=piece, at_s=start_s, over_s=end_s - start_s, cable_length_m=goal_m)
        for piece, ((start_s, before_m), (end_s, goal_m)) in enumerate(pairwise(points))
        if goal_m != before_m
    ]


def plant_from(first: Pendulum, hoists: Sequence[HoistTo], at_s: float) -> Pendulum | Hoisting:
    """Return what swings from a moment on, from which its times count.

    A hoist that begins before the one ahead of it is over ends that one.

    Parameters
    ----------
    first
        The load on its cable before all hoists.
    hoists
        What is hoisted, in any order.
    at_s
        The moment, >= 0 [s].

    Returns
    -------
    Pendulum or Hoisting
        A pendulum where nothing is hoisted from then on.

    Raises
    ------
    InvalidInputError
        If the lengths break a rule of `Hoisting`.
    """
    times, lengths = _knots(first.cable_length_m, hoists)
    if not times:
        return first
    course = LengthCourse(times_s=tuple(times), values=tuple(lengths))
    now = [(0.0, course.at(at_s))] if times[0] <= at_s else []
    later = [(time - at_s, length) for time, length in zip(times, lengths, strict=True)]
    points = now + [point for point in later if point[0] > 0]
    lasting = {"damping_ratio": first.damping_ratio, "gravity_m_s2": first.gravity_m_s2}
    if len({length for _, length in points}) == 1:
        return Pendulum(cable_length_m=points[-1][1], **lasting)
    moments, values = zip(*points, strict=True)
    return Hoisting(cable_length_m=LengthCourse(times_s=moments, values=values), **lasting)


def require_taut(first_m: float, hoists: Sequence[HoistTo], gravity_m_s2: float, name: str) -> None:
    """Check that a hook can follow its hoists.

    A rate that jumps stands for a ramp within the hoists on either side of it. Through the points
    of a course there is one that keeps the cable taut if no rate grows there by more than a free
    fall over half of both hoists makes it; where the cable stays, over that of the other alone.

    Parameters
    ----------
    first_m
        The length before all hoists [m].
    hoists
        What is hoisted, in any order.
    gravity_m_s2
        Acceleration of free fall [m/s^2].
    name
        Field that the error names.

    Raises
    ------
    InvalidInputError
        If the cable would be slack however it is hoisted between the points.
    """
    if not hoists:
        return
    times, lengths = _knots(first_m, hoists)
    pieces = [
        (end_s - start_s, (after_m - before_m) / (end_s - start_s))
        for (start_s, end_s), (before_m, after_m) in zip(
            pairwise(times), pairwise(lengths), strict=True
        )
    ]
    held = (0.0, 0.0)
    around = pairwise([held, *pieces, held])
    for time_s, ((before_s, before), (after_s, after)) in zip(times, around, strict=True):
        # A cable that stays gives no time in which its rate could change.
        within_s = (before_s if before else 0.0) + (after_s if after else 0.0)
        most = gravity_m_s2 * within_s / 2
        if after - before > most * (1 + 1e-9):  # rounding of the times
            raise InvalidInputError(
                name,
                f"{before:.6g} m/s before and {after:.6g} m/s after {time_s:.6g} s",
                "such that the cable stays taut: a hook that falls freely gains at most "
                f"{most:.4g} m/s between the middles of these hoists",
                code="faster_than_free_fall",
            )


def _knots(first_m: float, hoists: Sequence[HoistTo]) -> tuple[list[float], list[float]]:
    """Return the times at which the rate of a length changes, and the lengths then."""
    times: list[float] = []
    lengths: list[float] = []
    for hoist in sorted(hoists, key=lambda one: one.at_s):
        if not times:
            times, lengths = [hoist.at_s], [first_m]
        elif hoist.at_s > times[-1]:
            times.append(hoist.at_s)
            lengths.append(lengths[-1])
        elif hoist.at_s < times[-1]:
            (start_s, end_s), (start_m, end_m) = times[-2:], lengths[-2:]
            lengths[-1] = start_m + (end_m - start_m) * (hoist.at_s - start_s) / (end_s - start_s)
            times[-1] = hoist.at_s
            if hoist.at_s == start_s:  # of two at one time the later in the list counts
                times.pop(), lengths.pop()
        times.append(hoist.at_s + hoist.over_s)
        lengths.append(hoist.cable_length_m)
    return times, lengths
