"""The fastest shapers and moves found behind limits that two lags follow."""

from collections.abc import Iterator

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.gaps import PERIOD_RAD
from design.formulations.unequal_ramps import UnequalRampsProblem
from design.model.impulses import Impulses
from design.solvers.budget import Budget
from design.solvers.ramps import search
from design.solvers.ramps.unequal_search import UnequalOptimum, fastest_from
from design.solvers.solution import Solution, SolverReport
from design.solving.distinct_steps import distinct_steps
from design.solving.ramp_refusals import refuse_without_course
from design.solving.ramps import proven_ramps


def solve_behind_two_lags(problem: UnequalRampsProblem, budget: Budget) -> Iterator[Solution]:
    """Yield the fastest command found behind limits and two lags.

    Parameters
    ----------
    problem
        Targets, limits and lags.
    budget
        What the search may do.

    Yields
    ------
    Solution
        Without a bound; the next if one is not certified.

    Raises
    ------
    InfeasibleDesignError
        If the fastest found ends after the horizon, or none is found: says how far was searched.
    """
    for behind_one, _ in proven_ramps(
        problem.alike, search.candidates(problem.alike, budget), budget
    ):
        found = fastest_from(problem, behind_one.course.switches, budget)
        if found is not None:
            _require_in_time(problem, found)
            yield _solution(problem, found)
    refuse_without_course(problem.alike, budget)


def _require_in_time(problem: UnequalRampsProblem, found: UnequalOptimum) -> None:
    horizon = problem.alike.horizon_rad
    if found.course.end > horizon:
        raise InfeasibleDesignError(
            f"the fastest command that was found behind limits and two lags ends its last ramp "
            f"after {found.course.end / PERIOD_RAD:.6g} periods: later than max_duration_periods "
            f"and both ramps, {horizon / PERIOD_RAD:.6g} periods in all",
            code="ramps_found_exceed_duration",
        )


def _solution(problem: UnequalRampsProblem, found: UnequalOptimum) -> Solution:
    switches = found.course.switches
    steps = np.where(np.arange(switches.size) % 2 == 0, 1.0, -1.0)
    times = switches / problem.natural_frequency_rad_s
    return Solution(
        impulses=distinct_steps(Impulses(times_s=times, amplitudes=steps)),
        solver=SolverReport(
            name="slsqp",
            status="solve_succeeded",
            iterations=found.iterations,
            seed="one_lag",
            starts=found.programs,
        ),
    )
