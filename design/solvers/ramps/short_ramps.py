"""Courses with a very short ramp beside a long one, from those where it is longer.

No grid over a whole course shows a ramp of a hundredth of a radian. The course of a longer one is
nearly the same: each stretch changes the level as much, and only takes as long as its slope says.
"""

from dataclasses import replace

import numpy as np

from design.formulations.ramped import RampedProblem
from design.solvers.ramps.course import Course, Slopes
from design.types import FloatArray

SHOWN_RAD = 0.03
"""Ramp from whose course Newton's method finds that of any shorter one [rad]."""


def lengthened(problem: RampedProblem) -> RampedProblem | None:
    """Return the problem with its short ramp as long as a grid shows.

    Parameters
    ----------
    problem
        Targets and limits.

    Returns
    -------
    RampedProblem or None
        The same targets; None where both ramps are long, or both short, as steps nearly are.
    """
    rise, fall = problem.ramps_rad
    if not min(rise, fall) < SHOWN_RAD < max(rise, fall):
        return None
    return replace(problem, ramps_rad=(max(rise, SHOWN_RAD), max(fall, SHOWN_RAD)))


def shortened(course: Course, slopes: Slopes) -> FloatArray:
    """Return the switches of a course of the same levels with other slopes.

    Parameters
    ----------
    course
        A course.
    slopes
        The other slopes.

    Returns
    -------
    FloatArray
        Ascending from 0, shape (n,) [rad].
    """
    steep = np.where(np.arange(course.switches.size) % 2 == 0, slopes.up, -slopes.down)
    lengths = course.rises / steep
    switches = course.switches.copy()
    for number in range(1, switches.size):
        if course.groups[number] == course.groups[number - 1]:
            switches[number] = switches[number - 1] + lengths[number - 1]
    return switches
