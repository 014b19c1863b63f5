"""The fastest shapers behind limits to acceleration, each with its bound."""

from collections.abc import Iterator

import numpy as np

from design.analysis.shortest_ramps import RampedProof, excluded_end_rad
from design.formulations.ramped import RampedProblem
from design.formulations.ramped_band import RampedBandProblem
from design.model.impulses import Impulses
from design.solvers.budget import Budget
from design.solvers.ramps import band_search, search
from design.solvers.ramps.optimality import RampedOptimum
from design.solvers.solution import Solution, SolverReport
from design.solving.bounded import SMALL_GAP
from design.solving.distinct_steps import distinct_steps
from design.solving.jerk_ramps import solve_behind_jerk_limit
from design.solving.ramp_refusals import none_found, require_in_time
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
    if problem.jerk is not None:
        yield from solve_behind_jerk_limit(problem, problem.jerk, budget)
        return
    yield from _proven(problem, search.candidates(problem, budget), "highs", budget)


def solve_band_behind_limits(problem: RampedBandProblem, budget: Budget) -> Iterator[Solution]:
    """Yield the fastest shaper over a band behind limits.

    Parameters
    ----------
    problem
        The band, and the limits.
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
    yield from _proven(problem, band_search.candidates(problem, budget), "clarabel", budget)


def _proven(
    problem: RampedProblem | RampedBandProblem,
    candidates: Iterator[RampedOptimum],
    name: str,
    budget: Budget,
) -> Iterator[Solution]:
    """Yield optima that their bound proves, else the best, each in time."""
    best: RampedOptimum | None = None
    bound = 0.0  # each proof is about the problem, whatever the course that led to it
    for found in candidates:
        bound = max(bound, excluded_end_rad(_proof(problem, found)))
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
        if best is None or found.course.end < best.course.end:
            best = found
        if bound >= (1 - SMALL_GAP) * best.course.end:
            require_in_time(problem, best.course.end, bound)
            yield _solution(problem, best, bound, name)
            best = None
    if best is None:
        refusal = none_found(problem, budget)
        raise refusal
    require_in_time(problem, best.course.end, bound)
    yield _solution(problem, best, bound, name)


def _proof(problem: RampedProblem | RampedBandProblem, found: RampedOptimum) -> RampedProof:
    course = found.course
    first = np.flatnonzero(np.diff(course.groups) > 0) + 1
    rise, fall = problem.ramps_rad
    return RampedProof(
        poles=found.functionals.poles,
        orders=found.functionals.orders,
        multipliers=found.multipliers,
        targets=found.targets,
        tolerance=found.tolerance,
        up=1 / rise,
        down=1 / fall,
        last=problem.last,
        rests=np.column_stack((course.arrivals[:-1], course.switches[first])),
        turns=course.switches,
        end=course.end,
    )


def _solution(
    problem: RampedProblem | RampedBandProblem, found: RampedOptimum, bound_rad: float, name: str
) -> Solution:
    w, course = problem.natural_frequency_rad_s, found.course
    steps = np.where(np.arange(course.switches.size) % 2 == 0, 1.0, -1.0)
    return Solution(
        impulses=distinct_steps(Impulses(times_s=course.switches / w, amplitudes=steps)),
        solver=SolverReport(
            name=name,
            status="solve_succeeded",
            iterations=found.iterations,
            seed=found.seed,
            starts=found.programs,
            lower_bound_s=bound_rad / w,
            gap=1 - bound_rad / course.end,
        ),
    )
