"""The fastest course behind limits: structure by a linear program, then Newton's method.

A linear program over a time grid, at a duration that is too short, finds the course that misses
the targets least. Its slopes are at their limits in most cells, and those between show where the
command switches. From there Newton's method solves for the switches off the grid. The next duration
is where the misses of the last two come to nothing; what is possible on the grid bounds it from
above.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

from design.formulations.ramped import RampedProblem
from design.solvers.budget import Budget
from design.solvers.ramps.course import Slopes
from design.solvers.ramps.exchange import lacking_switches
from design.solvers.ramps.functionals import Functionals
from design.solvers.ramps.optimality import NEWTON_STEPS, RampedOptimum, solve_conditions
from design.solvers.ramps.short_ramps import lengthened, shortened
from design.solvers.ramps.structure import GridCourse, nearest_course, switches_of, work_of
from design.trace import TraceStep
from design.types import FloatArray

MAX_PROGRAMS = 60
"""Linear programs until the search is given up; two or three do for one mode."""

MIN_STEP, USUAL_STEP, MAX_STEP = 1.02, 1.1, 1.3
"""Quotient of two durations tried in turn: at least, where nothing says more, and at most [-]."""

SHARE_OF_STEP = 0.9
"""Share of the way to where the misses come to nothing [-]."""

CLOSED = 1e-2
"""Quotient of the durations around the optimum less 1, on the first grid, at which it is made finer
[-]."""

FINER, FINEST = 3.0, 27.0
"""How many times finer each grid is than the one before, and the last than the first [-]."""

BACK = 0.99
"""Share of the longest duration known to be too short at which a finer grid begins [-]."""

MAX_LONGER = 2
"""Courses of longer ramps from which very short ones are sought."""

MAX_EXCHANGES = 6
"""How often two switches are added to a course that lacks them."""

NEWTON_WORK = 150.0
"""Work of a step of Newton's method [units]."""


def candidates(problem: RampedProblem, budget: Budget) -> Iterator[RampedOptimum]:
    """Yield courses that meet the targets and the conditions of optimality.

    Parameters
    ----------
    problem
        Targets and limits. Its horizon is not heeded: what is beyond it is refused with its bound.
    budget
        What the search may do.

    Yields
    ------
    RampedOptimum
        As reported by Newton's method; the caller stops at one that is proven.
    """
    search = _Search(problem, budget)
    for seed in () if budget.spent else problem.seeds:
        yield from search.optima(seed, problem.seed_name)
    longer = lengthened(problem)
    for found in () if longer is None else islice(candidates(longer, budget), MAX_LONGER):
        yield from search.optima(search.shortened(found), "longer_ramps")
    fineness = 1.0
    first = MIN_STEP * problem.earliest_rad
    while fineness <= FINEST:
        low, high, before = first, math.inf, None
        duration = first
        while high > low * (1 + CLOSED / fineness):
            late = duration > problem.farthest_rad
            if late or budget.spent or search.programs >= MAX_PROGRAMS:
                return
            course = search.nearest_course(duration, fineness)
            if course is not None and course.is_possible:
                high = duration
            else:
                low = duration
                violation = math.inf
                if course is not None:
                    violation = course.violation
                    yield from search.optima(search.switches_of(course), "linear_program")
                duration = next_duration(low, violation, before)
                before = (low, violation)
            if duration >= high:
                duration = (low + high) / 2
        first, fineness = BACK * low, FINER * fineness


def next_duration(duration: float, violation: float, before: tuple[float, float] | None) -> float:
    """Return the duration to try after one that is too short.

    Parameters
    ----------
    duration, violation
        The duration, and by how much its course misses the targets [rad], [-].
    before
        Both of the one before; None at first.

    Returns
    -------
    float
        Longer: about where the misses come to nothing [rad].
    """
    following = USUAL_STEP * duration
    if before is not None and violation < before[1] < math.inf:
        shrinks = (before[1] - violation) / (duration - before[0])
        following = duration + SHARE_OF_STEP * violation / shrinks
    return min(max(following, MIN_STEP * duration), MAX_STEP * duration)


def program_step(duration_s: float, fineness: float, *, possible: bool) -> TraceStep:
    """Return what is noted of a linear program.

    Parameters
    ----------
    duration_s, fineness
        Length of its grid, and how many times finer than the first that is [s], [-].
    possible
        Whether its course meets the targets.

    Returns
    -------
    TraceStep
        Of a bound.
    """
    return TraceStep(
        stage="bound",
        method="highs",
        start="linear_program",
        outcome="may_be_possible" if possible else "too_short",
        duration_s=duration_s,
        detail=f"grid {fineness:g} times as fine as the first",
    )


class _Search:
    """The parts of one search, which count their work and note their steps."""

    def __init__(self, problem: RampedProblem, budget: Budget) -> None:
        self.programs = 0
        self._problem, self._budget = problem, budget
        self._functionals = Functionals(problem.unit_poles, problem.orders)
        self._slopes = Slopes(up=1 / problem.ramps_rad[0], down=1 / problem.ramps_rad[1])

    def nearest_course(self, duration: float, fineness: float) -> GridCourse | None:
        """Return the course of a duration that misses the targets least."""
        problem, budget = self._problem, self._budget
        self.programs += 1
        budget.spend(work_of(self._functionals, duration, fineness))
        course = nearest_course(
            self._functionals, problem.targets, self._slopes, problem.last, duration, fineness
        )
        possible = course is not None and course.is_possible
        w = problem.natural_frequency_rad_s
        budget.note(program_step(duration / w, fineness, possible=possible))
        return course

    def switches_of(self, course: GridCourse) -> FloatArray:
        """Return the switches of a command that a course on a grid follows."""
        return switches_of(course, self._slopes)

    def shortened(self, longer: RampedOptimum) -> FloatArray:
        """Return the switches of a course with ramps as short as these limits make them."""
        return shortened(longer.course, self._slopes)

    def optima(self, switches: FloatArray, start: str) -> Iterator[RampedOptimum]:
        """Yield what Newton's method makes of switches near the optimum's, if anything."""
        found = self._solve(switches, start) if switches.size else None
        if found is None:
            return
        for _ in range(MAX_EXCHANGES):
            more = lacking_switches(found, self._functionals)
            better = None if more is None else self._solve(more, start)
            if better is None or better.course.end > found.course.end:
                break
            found = better
        yield replace(found, programs=self.programs, seed=start)

    def _solve(self, switches: FloatArray, start: str) -> RampedOptimum | None:
        problem = self._problem
        found = solve_conditions(switches, self._functionals, problem.targets, self._slopes)
        iterations = NEWTON_STEPS if found is None else found.iterations
        self._budget.spend(NEWTON_WORK * iterations)
        self._budget.note(
            TraceStep(
                stage="solve",
                method="newton",
                start=start,
                outcome="failed" if found is None else "solve_succeeded",
                iterations=iterations,
                duration_s=float(switches[-1] if found is None else found.course.end)
                / problem.natural_frequency_rad_s,
                detail=f"{switches.size} switches",
            )
        )
        return found
