"""The fastest shapers behind limits to acceleration, each with its bound."""

from collections.abc import Iterator

import numpy as np

from design.analysis.shortest_ramps import RampedProof, excluded_end_rad
from design.formulations.ramped import RampedProblem
from design.model.impulses import Impulses
from design.solvers.budget import Budget
from design.solvers.ramps.optimality import RampedOptimum
from design.solvers.ramps.search import candidates
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
        if bound >= (1 - SMALL_GAP) * found.course.end:
            require_in_time(problem, found.course.end, bound)
            yield _solution(problem, found, bound)
            best = None
    if best is None:
        refusal = none_found(problem, budget)
        raise refusal
    require_in_time(problem, best[0].course.end, best[1])
    yield _solution(problem, *best)


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
