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
from design.solvers.unity_band import search as unity_band
from design.solving.distinct_steps import distinct_steps
from design.solving.ramp_refusals import refuse_without_course
from design.solving.ramps import proven
from design.types import FloatArray

BAND_WORK = 2_000_000.0
"""Work of the search over a band for ramps that turn [units]."""


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
    for behind_one, _ in proven(problem.alike, search.candidates(problem.alike, budget), budget):
        found = fastest_from(problem, behind_one.course.switches, budget)
        if found is not None:
            _require_in_time(problem.alike.horizon_rad, found.course.end)
            yield _solution(problem, found)
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
        If the fastest found ends after the horizon, or none is found, with ramps that are over
        before the next begins neither: says how far was searched.
    """
    alike, own = problem.alike, budget.part(BAND_WORK)
    for behind_one, _ in proven(alike, band_search.candidates(alike, own), own):
        found = fastest_over_band(problem, behind_one.course.switches, own)
        if found is not None:
            _require_in_time(alike.horizon_rad, found.end)
            yield Solution(
                impulses=_command(found.switches, alike.natural_frequency_rad_s),
                solver=SolverReport(
                    name="clarabel",
                    status="solve_succeeded",
                    iterations=found.durations,
                    seed="one_lag",
                    starts=1,
                ),
            )
    budget.spend(own.done)
    yield from unity_band.solve(problem.otherwise, budget)


def _require_in_time(horizon: float, end: float) -> None:
    if end > horizon:
        raise InfeasibleDesignError(
            f"the fastest command that was found behind limits and two lags ends its last ramp "
            f"after {end / PERIOD_RAD:.6g} periods: later than max_duration_periods "
            f"and both ramps, {horizon / PERIOD_RAD:.6g} periods in all",
            code="ramps_found_exceed_duration",
        )


def _solution(problem: UnequalRampsProblem, found: UnequalOptimum) -> Solution:
    return Solution(
        impulses=_command(found.course.switches, problem.natural_frequency_rad_s),
        solver=SolverReport(
            name="slsqp",
            status="solve_succeeded",
            iterations=found.iterations,
            seed="one_lag",
            starts=found.programs,
        ),
    )


def _command(switches: FloatArray, natural_frequency_rad_s: float) -> Impulses:
    steps = np.where(np.arange(switches.size) % 2 == 0, 1.0, -1.0)
    return distinct_steps(Impulses(times_s=switches / natural_frequency_rad_s, amplitudes=steps))
