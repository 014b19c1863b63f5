"""Shapers with humps behind limits that two lags follow."""

from collections.abc import Iterator

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.unequal_humps import UnequalHumpsProblem
from design.solvers.budget import Budget
from design.solvers.ramps.unequal_humps import follow_humps
from design.solvers.solution import Solution
from design.solving.ramped_humps import require_humps_in_time, spread
from design.solving.unequal_ramps import alternating_solution


def solve_humps_behind_two_lags(problem: UnequalHumpsProblem, budget: Budget) -> Iterator[Solution]:
    """Yield the shaper with humps behind limits and two lags.

    It is that which the one behind one lag is led to. No bound is said.

    Parameters
    ----------
    problem
        The humps, the limits and the lags.
    budget
        What the search may do.

    Yields
    ------
    Solution
        The shaper.

    Raises
    ------
    InfeasibleDesignError
        If none is found behind one lag or two, or it ends after the horizon.
    """
    alike = problem.alike
    behind_one, zeros = spread(alike, budget)
    found = follow_humps(problem, behind_one.course.switches, np.array(zeros), budget)
    if found is None:
        raise InfeasibleDesignError(
            f"the humps of {alike.tolerance:g} behind one lag cannot be followed to two: "
            "num_si keeps a tolerance over a band of frequencies behind any limits",
            code="ramped_humps_not_followed",
        )
    require_humps_in_time(alike, found.course.end)
    yield alternating_solution(
        found.course.switches, alike.natural_frequency_rad_s, "newton", found.steps, found.stages
    )
