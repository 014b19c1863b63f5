"""The fastest course behind a limit to the jerk: structure by a linear program, then Newton.

A linear program over a time grid, at a duration that is too short, finds the course that misses the
targets least, and how its command switches. The drive's own course under that command has a
structure, of which Newton's method finds the stationary course. Rules that it breaks say which
structure to try next. Durations go up until one is possible on the grid; then the grid gets finer.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from design.formulations.ramped import RampedProblem
from design.solvers.budget import Budget
from design.solvers.jerk_ramps.events import EventCourse, Group, Limits
from design.solvers.jerk_ramps.exchange import next_structures, shortest_rad, without_touches
from design.solvers.jerk_ramps.following import course_following
from design.solvers.jerk_ramps.grid import GridCourse, nearest_course, switches_of, work_of
from design.solvers.jerk_ramps.optimality import NEWTON_STEPS, Stationary, solve_structure
from design.solvers.jerk_ramps.rules import entering_pieces, targets_of
from design.solvers.ramps.functionals import Functionals
from design.solvers.ramps.search import (
    CLOSED,
    FINER,
    FINEST,
    MAX_PROGRAMS,
    MIN_STEP,
    next_duration,
    program_step,
)
from design.solvers.ramps.search import candidates as straight_candidates
from design.trace import TraceStep
from design.types import ComplexArray, FloatArray

SHORT_RAD = 0.03
"""Time to the steepest slope within which the course is nearly that without a limit to the jerk
[rad]."""

STRAIGHT_WORK = 400_000.0
"""What the search without that limit may do [units]."""

MAX_EXCHANGES = 20
"""Structures that are tried from one start."""

NEWTON_WORK = 600.0
"""Work of a step of Newton's method [units]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class JerkOptimum:
    """A course that meets its targets and keeps every rule of the optimum.

    Attributes
    ----------
    found
        The course, its multipliers and prices.
    functionals, targets, tolerance
        F, g, shape (m,), and how far each may miss: 0 where targets are met exactly [-].
    iterations
        Steps of Newton's method, of all structures.
    programs
        Linear programs until then.
    seed
        Name of the start.
    """

    found: Stationary
    functionals: Functionals
    targets: ComplexArray
    tolerance: float
    iterations: int
    programs: int
    seed: str

    @property
    def course(self) -> EventCourse:
        """The course."""
        return self.found.course

    @property
    def end(self) -> float:
        """When the last ramp ends [rad]."""
        return self.course.end


def candidates(problem: RampedProblem, limits: Limits, budget: Budget) -> Iterator[JerkOptimum]:
    """Yield courses that meet the targets and the conditions of optimality.

    Parameters
    ----------
    problem
        Targets. Its horizon is not heeded: what is beyond it is refused with its bound.
    limits
        Of slope and jerk.
    budget
        What the search may do.

    Yields
    ------
    JerkOptimum
        As reported by Newton's method; the caller stops at one that is proven.
    """
    search = _Search(problem, limits, budget)
    for seed in () if budget.spent else problem.seeds:
        yield from search.optima(seed, problem.seed_name)
    if max(limits.up, limits.down) / limits.jerk < SHORT_RAD:
        part = budget.part(STRAIGHT_WORK)
        straight = next(straight_candidates(replace(problem, jerk=None), part), None)
        budget.spend(part.done)
        if straight is not None:
            yield from search.optima(straight.course.switches, "without_jerk_limit")
    fineness = 1.0
    high = math.inf
    duration = MIN_STEP * problem.earliest_rad
    while fineness <= FINEST:
        # What is too short on a grid may not be on a finer one.
        low, back = problem.earliest_rad, CLOSED / fineness
        before: tuple[float, float] | None = None
        while high > low * (1 + CLOSED / fineness):
            late = duration > problem.farthest_rad
            if late or budget.spent or search.programs >= MAX_PROGRAMS:
                return
            course = search.nearest_course(duration, fineness)
            if course is not None and course.is_possible:
                high = duration
                if low > problem.earliest_rad:
                    duration = (low + high) / 2
                else:
                    duration = max((1 - back) * high, low)
                    back *= 2
            else:
                low = duration
                violation = math.inf
                if course is not None:
                    violation = course.violation
                    yield from search.optima(switches_of(course, limits), "linear_program")
                duration = next_duration(low, violation, before)
                before = (low, violation)
            if duration >= high:
                duration = (low + high) / 2
        fineness *= FINER
        duration = max((1 - CLOSED / fineness) * low, problem.earliest_rad)


class _Search:
    """The parts of one search, which count their work and note their steps."""

    def __init__(self, problem: RampedProblem, limits: Limits, budget: Budget) -> None:
        self.programs = 0
        self._problem, self._limits, self._budget = problem, limits, budget
        self._functionals = Functionals(problem.unit_poles, problem.orders)

    def nearest_course(self, duration: float, fineness: float) -> GridCourse | None:
        """Return the course of a duration that misses the targets least."""
        problem, budget = self._problem, self._budget
        self.programs += 1
        budget.spend(work_of(self._functionals, duration, fineness))
        course = nearest_course(
            self._functionals, problem.targets, self._limits, problem.last, duration, fineness
        )
        possible = course is not None and course.is_possible
        w = problem.natural_frequency_rad_s
        budget.note(program_step(duration / w, fineness, possible=possible))
        return course

    def optima(self, switches: FloatArray, start: str) -> Iterator[JerkOptimum]:
        """Yield what Newton's method makes of switches near the optimum's, if anything."""
        if not switches.size or switches.size % 2 != self._problem.last:
            return
        waiting = [course_following(switches, self._limits)]
        tried: set[tuple[Group, ...]] = set()
        iterations = 0
        while waiting and len(tried) < MAX_EXCHANGES and not self._budget.spent:
            course = waiting.pop(0)
            if course.groups in tried:
                continue
            tried.add(course.groups)
            found = self._solve(course, start)
            iterations += NEWTON_STEPS if found is None else found.iterations
            if found is None:
                weighed = targets_of(course, self._functionals)
                waiting += entering_pieces(course, self._functionals, weighed)
                waiting += without_touches(course)
                continue
            better = [*next_structures(found, self._functionals)]
            if not better and found.course.widths.min() >= shortest_rad(found.course):
                yield JerkOptimum(
                    found=found,
                    functionals=self._functionals,
                    targets=self._problem.targets,
                    tolerance=0.0,
                    iterations=iterations,
                    programs=self.programs,
                    seed=start,
                )
                return
            waiting = [*better, *waiting]

    def _solve(self, course: EventCourse, start: str) -> Stationary | None:
        problem = self._problem
        found = solve_structure(course, self._functionals, problem.targets)
        iterations = NEWTON_STEPS if found is None else found.iterations
        self._budget.spend(NEWTON_WORK * iterations)
        end = course.end if found is None else found.course.end
        self._budget.note(
            TraceStep(
                stage="solve",
                method="newton",
                start=start,
                outcome="failed" if found is None else "solve_succeeded",
                iterations=iterations,
                duration_s=end / problem.natural_frequency_rad_s,
                detail=f"{course.times.size} changes of the jerk",
            )
        )
        return found
