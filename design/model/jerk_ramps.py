"""The course of a reference whose acceleration, deceleration and jerk are limited.

Each piece has constant jerk, and the reference's magnitude only grows in it or only falls.
"""

import math
from collections.abc import Iterator
from itertools import pairwise

from design.model.actuators.rate_limited import RateLimited

ARRIVING = 1e-13
"""Level within which the place where the reference would stop is its goal: rounding [-]."""

Piece = tuple[float, float, float, bool, float]
"""Start [s], duration [s], change [-], whether the magnitude grows, bend [-]."""


def jerk_limited_pieces(
    times_s: list[float], levels: list[float], actuator: RateLimited, jerk_limit_m_s3: float
) -> list[Piece]:
    """Return the pieces of the course that a command's levels ask for.

    From where it is, and from the slope that it has, the reference goes to the command's level in
    least time, and comes to rest there. One on the other side of zero is the goal only once it has
    come to rest at zero.

    Parameters
    ----------
    times_s, levels
        When the command changes, ascending, and to what, n each [s], [-].
    actuator, jerk_limit_m_s3
        The limits.

    Returns
    -------
    list of tuple
        Start, duration, change, whether the magnitude grows, and the bend: the slope at the end
        less that at the start, over twice the mean slope, -1 to 1.
    """
    jerk = jerk_limit_m_s3 / actuator.speed_m_s
    rise, fall = (
        limit / actuator.speed_m_s
        for limit in (actuator.accel_limit_m_s2, actuator.decel_limit_m_s2)
    )
    pieces: list[Piece] = []
    level = slope = 0.0
    for (start, end), goal in zip(pairwise([*times_s, math.inf]), levels, strict=True):
        now = start
        while now < end and (level != goal or slope != 0.0):
            target = 0.0 if level * goal < 0 else goal
            # Of a reference below zero the mirror image rises.
            side = -1.0 if level < 0 or (level == 0 and target < 0) else 1.0
            phases = _phases(side * level, side * slope, side * target, (rise, fall), jerk)
            for duration, rate in phases:
                held = min(duration, end - now)
                before, after = side * slope, side * slope + rate * held
                if held == duration and abs(after) <= ARRIVING * (rise + fall):
                    after = 0.0
                mean = (before + after) / 2
                if mean != 0 and held > 0:
                    bend = (after - before) / (2 * mean)
                    pieces.append((now, held, side * mean * held, mean > 0, bend))
                level, slope, now = level + side * mean * held, side * after, now + held
                if held < duration:
                    break
            else:
                level, slope = target, 0.0
    return pieces


def _phases(
    level: float, slope: float, goal: float, limits: tuple[float, float], jerk: float
) -> Iterator[tuple[float, float]]:
    """Yield durations and jerks of the fastest way to rest at a goal, on this side of zero.

    In none of them does the slope change its sign.
    """
    rise, fall = limits
    stop = level + slope * abs(slope) / (2 * jerk)
    if abs(stop - goal) <= ARRIVING:
        if slope != 0:
            yield abs(slope) / jerk, math.copysign(jerk, -slope)
        return
    way = 1.0 if goal > stop else -1.0
    limit = rise if way > 0 else fall
    toward = way * slope
    if toward < 0:
        yield -toward / jerk, way * jerk
        level, toward = stop, 0.0
    distance = way * (goal - level)
    fastest = min(limit, math.sqrt(jerk * distance + toward * toward / 2))
    if fastest > toward:
        yield (fastest - toward) / jerk, way * jerk
    left = distance - (2 * fastest * fastest - toward * toward) / (2 * jerk)
    if left > 0 and fastest == limit:
        yield left / limit, 0.0
    yield fastest / jerk, -way * jerk
