"""Why there is no shaper over a band within its horizon, and what can be met instead."""

import math

from design.analysis.exclusion import excludes
from design.errors import InfeasibleDesignError
from design.formulations.bands import BandProblem, Obstacle
from design.formulations.gaps import PERIOD_RAD
from design.solvers.budget import Budget
from design.solvers.convex_band.duration import EASIER, first_duration_rad
from design.solvers.convex_band.search import obstacle_at, obstacle_work
from design.solving.bounded import SMALL_GAP, Bounded
from design.trace import TraceStep

NO_FASTER = 0.01
"""Share of a wait by which nothing must be shorter [-]."""

MAX_OFFERED_TOLERANCE = 0.5
"""A tolerance above it is not worth to be offered instead: little is suppressed [-]."""

FAR_BEYOND = 1.5
"""Estimated duration over the horizon from which on it is not looked for [-]."""


def proves_exclusion(problem: BandProblem, obstacle: Obstacle, budget: Budget) -> bool:
    """Return whether an obstacle proves that no shaper is so short.

    Parameters
    ----------
    problem
        What is to be kept over the bands.
    obstacle
        Poles and vectors for a duration.
    budget
        That of the search, which notes the attempt.

    Returns
    -------
    bool
        False is no proof of the contrary.
    """
    proved = excludes(
        obstacle.unit_poles,
        obstacle.vectors,
        obstacle.duration_rad,
        problem.tolerance,
        problem.levels,
    )
    budget.note(
        TraceStep(
            stage="bound",
            method="proof",
            start="cone_program",
            outcome="proved" if proved else "not_proved",
            duration_s=obstacle.duration_rad / problem.natural_frequency_rad_s,
            detail="no shaper is as short" if proved else "",
        )
    )
    return proved


def require_long_enough(problem: BandProblem, budget: Budget) -> None:
    """Check that a horizon is not far too short, by a separate proof.

    Parameters
    ----------
    problem
        What is to be kept over the bands, and its horizon.
    budget
        That of the search.

    Raises
    ------
    InfeasibleDesignError
        If no shaper within the horizon keeps the tolerance; says which tolerance can be met.
    """
    needed = first_duration_rad(problem)
    if needed < FAR_BEYOND * problem.horizon_rad:
        return
    obstacle, least = obstacle_at(problem, problem.horizon_rad, budget)
    if not proves_exclusion(problem, obstacle, budget):
        return
    tolerance = EASIER * least
    instead = (
        f"; a tolerance of {tolerance:.4g} can be met" if tolerance < MAX_OFFERED_TOLERANCE else ""
    )
    raise InfeasibleDesignError(
        f"max_duration_periods = {problem.horizon_rad / PERIOD_RAD:g} is too short for "
        f"{problem.asked}: none is as short (proven), undamped it takes about "
        f"{needed / PERIOD_RAD:.2g} periods{instead}",
        code="duration_below_bound",
    )


def require_more_than_waiting(problem: BandProblem, budget: Budget) -> None:
    """Check that something may be faster than to wait for the mode's damping.

    Waiting is a step and one of no height after it: what rings has decayed by then.

    Parameters
    ----------
    problem
        What is to be kept over the bands.
    budget
        That of the search; where it does not do for the proof nothing is checked.

    Raises
    ------
    InfeasibleDesignError
        If it is proven that nothing is faster.
    """
    decay = min(-band.unit_pole.real * band.lower for band in problem.bands)
    if decay == 0:
        return
    wait = -math.log(problem.tolerance) / decay
    if budget.done + obstacle_work(problem, wait) > budget.most:
        return
    if proves_exclusion(problem, obstacle_at(problem, (1 - NO_FASTER) * wait, budget)[0], budget):
        raise InfeasibleDesignError(
            f"after {wait / PERIOD_RAD:.4g} periods without a shaper, damping alone keeps "
            f"{problem.asked}; no shaper is faster by more than {100 * NO_FASTER:g} % "
            "(proven): only a smaller tolerance needs one",
            code="waiting_is_as_fast",
        )


def require_in_time(problem: BandProblem, found: Bounded, budget: Budget) -> None:
    """Check that what was found is within the horizon.

    Parameters
    ----------
    problem
        What is to be kept over the bands, and its horizon.
    found
        The fastest shaper, with its bound.
    budget
        That of the search.

    Raises
    ------
    InfeasibleDesignError
        If it is longer than the horizon; says what can be met instead.
    """
    duration = float(found.times_rad[-1])
    if duration <= problem.horizon_rad:
        return
    known = (
        f"none is shorter than {found.lower_bound_rad / PERIOD_RAD:.6g} (proven)"
        if found.lower_bound_rad >= problem.horizon_rad
        else "no shorter one was found"
    )
    tolerance = EASIER * obstacle_at(problem, problem.horizon_rad, budget)[1]
    # What a grid allows is found where an optimum is found.
    offered = tolerance < MAX_OFFERED_TOLERANCE and found.gap <= SMALL_GAP
    instead = f" or a tolerance of {tolerance:.4g}" if offered else ""
    raise InfeasibleDesignError(
        f"max_duration_periods = {problem.horizon_rad / PERIOD_RAD:g} is too short for "
        f"{problem.asked}: the fastest shaper found takes {duration / PERIOD_RAD:.6g} periods, "
        f"{known}; max_duration_periods = {1.0001 * duration / PERIOD_RAD:.4f}{instead} can be met",
        code="duration_below_fastest",
    )
