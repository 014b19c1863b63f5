"""The fastest shapers behind limits to acceleration, each with its bound."""

import math
from collections.abc import Iterator
from typing import NoReturn

import numpy as np

from design.analysis.shortest_ramps import RampedProof, excluded_end_rad
from design.errors import InfeasibleDesignError
from design.formulations.gaps import PERIOD_RAD
from design.formulations.ramped import RampedProblem
from design.model.impulses import Impulses
from design.solvers.budget import Budget
from design.solvers.ramps.optimality import RampedOptimum
from design.solvers.ramps.search import candidates
from design.solvers.solution import Solution, SolverReport
from design.solving.bounded import SMALL_GAP
from design.solving.distinct_steps import distinct_steps
from design.trace import TraceStep


def solve_behind_limits(problem: RampedProblem, budget: Budget) -> Iterator[Solution]:
    """Yield the fastest shaper behind limits.

    Parameters
    ----------
    problem
        Targets and limits.
    budget
        What the search may do.

    Yields
    ------
    Solution
        With a lower bound of the end of its last ramp; the next if one is not certified.

    Raises
    ------
    InfeasibleDesignError
        If the fastest ends after the horizon, or none is found: says how far was searched.
    """
    for found, bound in proven_courses(problem, budget):
        _require_in_time(problem, found, bound)
        yield _solution(problem, found, bound)
        if not _is_proven(found, bound):
            return
    refuse_without_course(problem, budget)


def proven_courses(problem: RampedProblem, budget: Budget) -> Iterator[tuple[RampedOptimum, float]]:
    """Yield courses that are proven to end first.

    Where none is, the one that ends first comes last.

    Parameters
    ----------
    problem
        Targets and limits.
    budget
        What the search may do.

    Yields
    ------
    tuple of RampedOptimum and float
        A course, and a time before which none ends [rad].
    """
    best: tuple[RampedOptimum, float] | None = None
    for found in candidates(problem, budget):
        bound = excluded_end_rad(_proof(problem, found))
        budget.note(
            TraceStep(
                stage="bound",
                method="proof",
                start=found.seed,
                outcome="proved",
                duration_s=bound / problem.natural_frequency_rad_s,
                detail="no reference within the limits ends as early",
            )
        )
        if best is None or found.course.end < best[0].course.end:
            best = found, bound
        if _is_proven(found, bound):
            yield found, bound
            best = None
    if best is not None:
        yield best


def _is_proven(found: RampedOptimum, bound_rad: float) -> bool:
    return bound_rad >= (1 - SMALL_GAP) * found.course.end


def refuse_without_course(problem: RampedProblem, budget: Budget) -> NoReturn:
    """Refuse a problem for which no course was found.

    Parameters
    ----------
    problem
        Targets and limits.
    budget
        What the search might do.

    Raises
    ------
    InfeasibleDesignError
        Always; says how far was searched.
    """
    raise InfeasibleDesignError(
        "no course of the reference without residual was found within the limits"
        + _how_far(problem, budget),
        code="no_ramped_command_found",
    )


def _how_far(problem: RampedProblem, budget: Budget) -> str:
    if budget.spent:
        return f": {budget.in_words}"
    if problem.farthest_rad < math.inf:
        return f" up to {problem.farthest_rad / PERIOD_RAD:.4g} periods"
    return ""


def _require_in_time(problem: RampedProblem, found: RampedOptimum, bound_rad: float) -> None:
    if found.course.end <= problem.horizon_rad:
        return
    raise InfeasibleDesignError(
        f"the fastest course of the reference within the limits ends after "
        f"{found.course.end / PERIOD_RAD:.6g} periods, and none ends before "
        f"{bound_rad / PERIOD_RAD:.6g}: later than max_duration_periods and both ramps, "
        f"{problem.horizon_rad / PERIOD_RAD:.6g} periods in all",
        code="ramps_exceed_duration",
    )


def _proof(problem: RampedProblem, found: RampedOptimum) -> RampedProof:
    course = found.course
    first = np.flatnonzero(np.diff(course.groups) > 0) + 1
    rise, fall = problem.ramps_rad
    return RampedProof(
        poles=problem.unit_poles,
        orders=problem.orders,
        multipliers=found.multipliers,
        targets=problem.targets,
        up=1 / rise,
        down=1 / fall,
        last=problem.last,
        rests=np.column_stack((course.arrivals[:-1], course.switches[first])),
        turns=course.switches,
        end=course.end,
    )


def _solution(problem: RampedProblem, found: RampedOptimum, bound_rad: float) -> Solution:
    w, course = problem.natural_frequency_rad_s, found.course
    steps = np.where(np.arange(course.switches.size) % 2 == 0, 1.0, -1.0)
    return Solution(
        impulses=distinct_steps(Impulses(times_s=course.switches / w, amplitudes=steps)),
        solver=SolverReport(
            name="highs",
            status="solve_succeeded",
            iterations=found.iterations,
            seed=found.seed,
            starts=found.programs,
            lower_bound_s=bound_rad / w,
            gap=1 - bound_rad / course.end,
        ),
    )
