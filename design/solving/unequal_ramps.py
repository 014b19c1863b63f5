"""The fastest shapers and moves found behind limits that two lags follow."""

from collections.abc import Iterator

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.gaps import PERIOD_RAD
from design.formulations.unequal_band import UnequalBandProblem
from design.formulations.unequal_ramps import UnequalRampsProblem
from design.model.impulses import Impulses
from design.solvers.budget import Budget
from design.solvers.ramps import band_search, search
from design.solvers.ramps.unequal_band import fastest_over_band
from design.solvers.ramps.unequal_search import UnequalOptimum, fastest_from
from design.solvers.solution import Solution, SolverReport
from design.solving.distinct_steps import distinct_steps
from design.solving.ramp_refusals import refuse_without_course
from design.solving.ramps import proven_ramps
from design.types import FloatArray


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
            yield _in_time(problem, found, "slsqp")
    refuse_without_course(problem.alike, budget)


def solve_band_behind_two_lags(problem: UnequalBandProblem, budget: Budget) -> Iterator[Solution]:
    """Yield the fastest command found over a band behind limits and two lags.

    Parameters
    ----------
    problem
        The band, the limits and the lags.
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
    alike = problem.alike
    for behind_one, _ in proven_ramps(alike, band_search.candidates(alike, budget), budget):
        found = fastest_over_band(problem, behind_one.course.switches, budget)
        if found is not None:
            yield _in_time(problem, found, "clarabel")
    refuse_without_course(alike, budget)


def _in_time(
    problem: UnequalRampsProblem | UnequalBandProblem, found: UnequalOptimum, name: str
) -> Solution:
    """Return the solution, if it ends within the horizon."""
    end, horizon = found.course.end, problem.alike.horizon_rad
    if end > horizon:
        raise InfeasibleDesignError(
            f"the fastest command that was found behind limits and two lags ends its last ramp "
            f"after {end / PERIOD_RAD:.6g} periods: later than max_duration_periods "
            f"and both ramps, {horizon / PERIOD_RAD:.6g} periods in all",
            code="ramps_found_exceed_duration",
        )
    w = problem.alike.natural_frequency_rad_s
    return alternating_solution(
        found.course.switches, w, name, iterations=found.iterations, starts=found.programs
    )


def alternating_solution(
    switches: FloatArray, natural_frequency_rad_s: float, name: str, iterations: int, starts: int
) -> Solution:
    """Return a command behind two lags, without a bound.

    Parameters
    ----------
    switches
        Ascending from 0, shape (n,) [rad].
    natural_frequency_rad_s
        Turns phases into times [rad/s].
    name, iterations, starts
        What solved it, its iterations, and how often it was started.

    Returns
    -------
    Solution
        Steps up and down in turn.
    """
    steps = np.where(np.arange(switches.size) % 2 == 0, 1.0, -1.0)
    times = switches / natural_frequency_rad_s
    return Solution(
        impulses=distinct_steps(Impulses(times_s=times, amplitudes=steps)),
        solver=SolverReport(
            name=name,
            status="solve_succeeded",
            iterations=iterations,
            seed="one_lag",
            starts=starts,
        ),
    )
