"""Where a course that meets the conditions of optimality is not the optimum: switches it lacks.

The function ``q(t) = P(t) + N`` of `optimality` is negative where the optimum rises and positive
where it falls; where it rests at 1, P does not fall, and where it rests at 0, P does not rise. A
stretch that breaks this is too short for the grid of the linear program to show. Two switches there
make the course faster.
"""

import numpy as np

from design.solvers.ramps.functionals import Functionals
from design.solvers.ramps.optimality import RampedOptimum
from design.types import BoolArray, FloatArray

POINTS_PER_TURN = 60
"""Points at which the signs are looked at, to a period of the fastest mode [-]."""

MIN_POINTS = 400

NEGLIGIBLE = 1e-7
"""Share of the largest P that breaks no rule: rounding, or a gain of nothing [-]."""


def lacking_switches(optimum: RampedOptimum, functionals: Functionals) -> FloatArray | None:
    """Return the switches of a course with those that it lacks most.

    Parameters
    ----------
    optimum
        A course and its multipliers.
    functionals
        What counts.

    Returns
    -------
    FloatArray or None
        Two switches more, ascending from 0, shape (n + 2,) [rad]; None where no rule is broken.
    """
    course = optimum.course
    turns = course.end * float(np.abs(functionals.poles).max()) / (2 * np.pi)
    times = np.linspace(0, course.end, max(MIN_POINTS, int(POINTS_PER_TURN * turns)))
    pull = _pull(optimum, functionals, times)
    slopes, level = _rules(optimum, functionals, times)
    moving = slopes != 0
    # While it rests q is 0, and the rule is one of the slope of P.
    broken = np.where(moving, slopes * (pull + level), 0.0)
    worst = NEGLIGIBLE * float(np.abs(pull).max())
    found: tuple[float, float] | None = None
    for first, last in _stretches(moving & (broken > 0)):
        if broken[first:last].max() > worst:
            worst = float(broken[first:last].max())
            found = float(times[first]), float(times[last - 1])
    resting_high = _resting_high(optimum, times)
    changes = np.gradient(pull, times)
    wrong = ~moving & (np.where(resting_high, -changes, changes) > 0)
    for first, last in _stretches(wrong):
        height = abs(float(pull[last - 1] - pull[first]))
        if height > worst:
            worst = height
            found = float(times[first]), float(times[(first + last) // 2])
    if found is None or found[0] >= found[1]:
        return None
    return np.sort(np.append(course.switches, found))


def _rules(
    optimum: RampedOptimum, functionals: Functionals, times: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the direction of the course, 0 at rest, and N, at some times."""
    course = optimum.course
    directions, levels = np.zeros(times.size), np.zeros(times.size)
    arriving = -_pull(optimum, functionals, course.arrivals)
    arriving[-1] -= 1 / course.last_slopes[-1]
    for start, end, slope, group in zip(
        course.starts, course.ends, course.slopes, course.groups, strict=True
    ):
        within = (times > start) & (times < end)
        directions[within] = np.sign(slope)
        levels[within] = arriving[group]
    return directions, levels


def _resting_high(optimum: RampedOptimum, times: FloatArray) -> BoolArray:
    """Return whether the course, if it rests, rests at 1."""
    course = optimum.course
    latest = np.searchsorted(course.arrivals, times, side="right") - 1
    high: BoolArray = np.where(latest >= 0, course.last_slopes[latest] > 0, False)
    return high


def _pull(optimum: RampedOptimum, functionals: Functionals, times: FloatArray) -> FloatArray:
    pull: FloatArray = (optimum.multipliers.conj() @ functionals.kernels(times)).real
    return pull


def _stretches(where: BoolArray) -> list[tuple[int, int]]:
    """Return first and one past last of each run of points."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], where, [False])).astype(np.int8)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
