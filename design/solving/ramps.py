"""The fastest shapers behind limits to acceleration, each with its bound."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from design.analysis.shortest_ramps import RampedProof, excluded_end_rad
from design.formulations.ramped import RampedProblem
from design.formulations.ramped_band import RampedBandProblem
from design.solvers.budget import Budget
from design.solvers.ramps import band_search, search
from design.solvers.ramps.optimality import RampedOptimum
from design.solvers.solution import Solution
from design.solving.course_solutions import solution_of
from design.solving.jerk_ramps import solve_band_behind_jerk_limit, solve_behind_jerk_limit
from design.solving.proven_courses import proven
from design.solving.ramp_refusals import (
    refuse_without_course,
    require_in_time,
    require_ramps_that_turn,
)

STRAIGHT_WORK = 400_000.0
"""What a search without a limit to the jerk may do ahead of one with it [units]."""


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
    InvalidInputError
        If none is found, or certified, and a limit makes a ramp too short to be turned.
    """
    if problem.jerk is not None:
        yield from solve_behind_jerk_limit(problem, problem.jerk, budget)
        return
    yield from _solutions(problem, search.candidates(problem, budget), "highs", budget)


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
    InvalidInputError
        If none is found, or certified, and a limit makes a ramp too short to be turned.
    """
    if problem.jerk is not None:
        alike, part = replace(problem, jerk=None), budget.part(STRAIGHT_WORK)
        straight = next(proven_ramps(alike, band_search.candidates(alike, part), part), None)
        budget.spend(part.done)
        yield from solve_band_behind_jerk_limit(problem, problem.jerk, straight, budget)
        return
    yield from _solutions(problem, band_search.candidates(problem, budget), "clarabel", budget)


def _solutions(
    problem: RampedProblem | RampedBandProblem,
    candidates: Iterator[RampedOptimum],
    name: str,
    budget: Budget,
) -> Iterator[Solution]:
    """Yield optima that their bound proves, else the best, each in time."""
    none_found = True
    for found, bound in proven_ramps(problem, candidates, budget):
        none_found = False
        require_in_time(problem, found.course.end, bound)
        yield solution_of(found, problem.natural_frequency_rad_s, name, bound)
    # Whoever asks for more has certified none of those.
    require_ramps_that_turn(problem)
    if none_found:
        refuse_without_course(problem, budget)


def proven_ramps(
    problem: RampedProblem | RampedBandProblem,
    candidates: Iterator[RampedOptimum],
    budget: Budget,
) -> Iterator[tuple[RampedOptimum, float]]:
    """Yield optima that their bound proves; the best at last, if none is.

    Parameters
    ----------
    problem, candidates
        Targets and limits, and courses that may be optimal.
    budget
        That of the search, which notes the proofs.

    Yields
    ------
    tuple of RampedOptimum and float
        An optimum, and an end before which there is none [rad].
    """
    yield from proven(
        candidates,
        lambda found: excluded_end_rad(_proof(problem, found)),
        problem.natural_frequency_rad_s,
        budget,
    )


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
