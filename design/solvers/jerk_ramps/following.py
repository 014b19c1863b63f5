"""The course that follows an on-off command, as events of a structure."""

import numpy as np

from design.model.actuators.rate_limited import RateLimited
from design.model.jerk_ramps import jerk_limited_pieces
from design.solvers.jerk_ramps.events import EventCourse, Group, Limits
from design.types import FloatArray

TOUCHES = 1e-9
"""Distance from 0 or 1 within which a course that turns there touches it [-]."""

ROUNDING_RAD = 1e-13
"""Pieces as short as this are rounding [rad]."""

STAYS_RAD = 1e-12
"""Shortest stay at 0 or 1 that is one [rad]."""


def course_following(switches: FloatArray, limits: Limits) -> EventCourse:
    """Return the course that follows an on-off command.

    Parameters
    ----------
    switches
        Phases at which the command goes to 1 and to 0 in turn, ascending from 0, shape (n,) [rad].
    limits
        Of slope and jerk.

    Returns
    -------
    EventCourse
        Until the reference rests at the command's last value.
    """
    drive = RateLimited(
        accel_limit_m_s2=limits.up,
        decel_limit_m_s2=limits.down,
        speed_m_s=1.0,
        jerk_limit_m_s3=limits.jerk,
    )
    levels = [float(number % 2 == 0) for number in range(switches.size)]
    pieces = jerk_limited_pieces(switches.tolist(), levels, drive, limits.jerk)
    groups: list[Group] = []
    signs: list[int] = []
    times = [0.0]
    level = 0.0
    pieces = [piece for piece in pieces if piece[1] > ROUNDING_RAD]
    for number, (start, duration, change, _, bend) in enumerate(pieces):
        sign = int(np.sign(np.rint(bend * change * 2 / duration**2 / limits.jerk)))
        if signs and signs[-1] == sign:
            times.pop()
        else:
            signs.append(sign)
        times.append(start + duration)
        level += change
        goal = float(round(level))
        last = number == len(pieces) - 1
        still = abs(1 + bend) * abs(change) / duration < TOUCHES * max(limits.up, limits.down)
        if last or (still and abs(level - goal) < TOUCHES):
            begins = times[-1] if last else pieces[number + 1][0]
            rests = begins - times[-1] > STAYS_RAD
            groups.append(Group(signs=tuple(signs), goal=goal, rests=rests))
            signs = []
            level = goal
            if rests:
                times.append(begins)
    return EventCourse(groups=tuple(groups), limits=limits, widths=np.diff(times))
