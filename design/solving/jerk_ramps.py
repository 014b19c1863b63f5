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
from design.formulations.ramped_band import RampedBandProblem
from design.solvers.budget import Budget
from design.solvers.jerk_ramps import band_search, search
from design.solvers.jerk_ramps.events import Limits
from design.solvers.jerk_ramps.search import JerkOptimum
from design.solvers.ramps.optimality import RampedOptimum
from design.solvers.solution import Solution
from design.solving.course_solutions import solution_of
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
    limits = _limits(problem, jerk)
    found = search.candidates(problem, limits, budget)
    yield from _solutions(problem, limits, found, "highs", budget)


def solve_band_behind_jerk_limit(
    problem: RampedBandProblem,
    jerk: float,
    straight: tuple[RampedOptimum, float] | None,
    budget: Budget,
) -> Iterator[Solution]:
    """Yield the fastest shaper over a band behind limits to the jerk.

    Parameters
    ----------
    problem, jerk
        The band and the limits, the largest rate of the slope among them [1/rad^2].
    straight
        The fastest without a limit to the jerk, and an end before which there is none [rad].
    budget
        What the search may do.

    Yields
    ------
    Solution
        As of `solve_behind_jerk_limit`.

    Raises
    ------
    InfeasibleDesignError
        As of `solve_behind_jerk_limit`.
    """
    limits = _limits(problem, jerk)
    found = band_search.candidates(problem, limits, straight, budget)
    yield from _solutions(problem, limits, found, "clarabel", budget)


def _limits(problem: RampedProblem | RampedBandProblem, jerk: float) -> Limits:
    rise, fall = problem.ramps_rad
    return Limits(up=1 / rise, down=1 / fall, jerk=jerk)


def _solutions(
    problem: RampedProblem | RampedBandProblem,
    limits: Limits,
    candidates: Iterator[JerkOptimum],
    name: str,
    budget: Budget,
) -> Iterator[Solution]:
    """Yield optima that their bound proves, else the best, each in time."""
    none_found = True
    for found, bound in _proven(problem, limits, candidates, budget):
        none_found = False
        require_in_time(problem, found.end, bound)
        yield solution_of(found, problem.natural_frequency_rad_s, name, bound)
    if none_found:
        refuse_without_course(problem, budget)


def proven_jerk_ramps(
    problem: RampedProblem, jerk: float, budget: Budget
) -> Iterator[tuple[JerkOptimum, float]]:
    """Yield optima that their bound proves; the best at last, if none is.

    Parameters
    ----------
    problem, jerk
        As of `solve_behind_jerk_limit`.
    budget
        What the search may do.

    Yields
    ------
    tuple of JerkOptimum and float
        An optimum, and an end before which there is none [rad].
    """
    limits = _limits(problem, jerk)
    yield from _proven(problem, limits, search.candidates(problem, limits, budget), budget)


def _proven(
    problem: RampedProblem | RampedBandProblem,
    limits: Limits,
    candidates: Iterator[JerkOptimum],
    budget: Budget,
) -> Iterator[tuple[JerkOptimum, float]]:
    yield from proven(
        candidates,
        lambda found: excluded_jerky_end_rad(_proof(problem.last, limits, found)),
        problem.natural_frequency_rad_s,
        budget,
    )


def _proof(last: float, limits: Limits, optimum: JerkOptimum) -> JerkProof:
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
        poles=optimum.functionals.poles,
        orders=optimum.functionals.orders,
        multipliers=found.multipliers,
        targets=optimum.targets,
        tolerance=optimum.tolerance,
        up=limits.up,
        down=limits.down,
        jerk=limits.jerk,
        last=last,
        events=course.times,
        stages=tuple(stages),
        prices=np.array(prices),
        final=1 / (limits.jerk * course.groups[-1].signs[-1]),
    )
