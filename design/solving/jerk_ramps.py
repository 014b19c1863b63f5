"""The fastest shapers behind a limit to the jerk, each with its bound."""

from collections.abc import Iterator

import numpy as np

from design.analysis.shortest_jerk_ramps import (
    AT_LIMIT,
    JERKS,
    RESTS,
    JerkProof,
    excluded_jerky_end_rad,
)
from design.formulations.ramped import RampedProblem
from design.model.impulses import Impulses
from design.solvers.budget import Budget
from design.solvers.jerk_ramps.events import Limits
from design.solvers.jerk_ramps.search import JerkOptimum, candidates
from design.solvers.solution import Solution, SolverReport
from design.solving.distinct_steps import distinct_steps
from design.solving.proven_courses import proven
from design.solving.ramp_refusals import refuse_without_course, require_in_time


def solve_behind_jerk_limit(
    problem: RampedProblem, jerk: float, budget: Budget
) -> Iterator[Solution]:
    """Yield the fastest shaper behind limits to acceleration and jerk.

    Parameters
    ----------
    problem, jerk
        Targets and limits, the largest rate of the slope among them [1/rad^2].
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
    rise, fall = problem.ramps_rad
    limits = Limits(up=1 / rise, down=1 / fall, jerk=jerk)
    none_found = True
    for found, bound in proven(
        candidates(problem, limits, budget),
        lambda found: excluded_jerky_end_rad(_proof(problem, limits, found)),
        problem.natural_frequency_rad_s,
        budget,
    ):
        none_found = False
        require_in_time(problem, found.end, bound)
        yield _solution(problem, found, bound)
    if none_found:
        refuse_without_course(problem, budget)


def _proof(problem: RampedProblem, limits: Limits, optimum: JerkOptimum) -> JerkProof:
    course, found = optimum.found.course, optimum.found
    stages: list[int] = []
    prices: list[float] = []
    for group, condition in zip(course.groups, course.level_conditions.tolist(), strict=True):
        stages += [JERKS if sign else AT_LIMIT for sign in group.signs]
        prices += [float(found.prices[condition])] * len(group.signs)
        if group.rests:
            stages.append(RESTS)
            prices.append(0.0)
    return JerkProof(
        poles=problem.unit_poles,
        orders=problem.orders,
        multipliers=found.multipliers,
        targets=problem.targets,
        up=limits.up,
        down=limits.down,
        jerk=limits.jerk,
        last=problem.last,
        events=course.times,
        stages=tuple(stages),
        prices=np.array(prices),
        final=1 / (limits.jerk * course.groups[-1].signs[-1]),
    )


def _solution(problem: RampedProblem, found: JerkOptimum, bound_rad: float) -> Solution:
    w, switches = problem.natural_frequency_rad_s, found.found.course.switches
    steps = np.where(np.arange(switches.size) % 2 == 0, 1.0, -1.0)
    return Solution(
        impulses=distinct_steps(Impulses(times_s=switches / w, amplitudes=steps)),
        solver=SolverReport(
            name="highs",
            status="solve_succeeded",
            iterations=found.iterations,
            seed=found.seed,
            starts=found.programs,
            lower_bound_s=bound_rad / w,
            gap=1 - bound_rad / found.end,
        ),
    )
