"""What is said where no course behind limits is found, or only one that is late."""

import math
from typing import NoReturn

from design.analysis.workable_ramps import LIMIT_FIELDS
from design.errors import InfeasibleDesignError, InvalidInputError
from design.formulations.gaps import PERIOD_RAD
from design.formulations.ramped import RampedProblem
from design.formulations.ramped_band import RampedBandProblem
from design.solvers.budget import Budget
from design.solvers.ramps.short_ramps import SHOWN_RAD

MIN_TURNED_RAD = 1e-5
"""Ramp that can be turned midway: a turn is off by 1e-15 rad, and the level by 1e-10 [rad]."""


def refuse_without_course(problem: RampedProblem | RampedBandProblem, budget: Budget) -> NoReturn:
    """Refuse a problem for which no course was found.

    Parameters
    ----------
    problem
        Targets and limits.
    budget
        What the search might do.

    Raises
    ------
    InfeasibleDesignError
        Says how far was searched.
    InvalidInputError
        If a limit makes a ramp too short to be turned.
    """
    require_ramps_that_turn(problem)
    raise InfeasibleDesignError(
        "no course of the reference that keeps what is asked was found within the limits"
        + _how_far(problem, budget),
        code="no_ramped_command_found",
    )


def require_ramps_that_turn(problem: RampedProblem | RampedBandProblem) -> None:
    """Check that no limit is so far above the other that doubles fail.

    They do not hold when its ramp turns.

    Parameters
    ----------
    problem
        What no certified course was found for.

    Raises
    ------
    InvalidInputError
        If a ramp is too short beside the other.
    """
    if max(problem.ramps_rad) < SHOWN_RAD:
        return
    for name, ramp_rad in zip(LIMIT_FIELDS, problem.ramps_rad, strict=True):
        if ramp_rad < MIN_TURNED_RAD:
            limit = getattr(problem.designed_for, name)
            raise InvalidInputError(
                f"actuator.{name}",
                limit,
                f"at most {limit * ramp_rad / MIN_TURNED_RAD:.4g} m/s^2 beside the other limit: "
                "the fastest command turns ramps, and doubles do not hold when a shorter one turns",
                code="ramp_too_short",
            )


def _how_far(problem: RampedProblem | RampedBandProblem, budget: Budget) -> str:
    if budget.spent:
        return f": {budget.in_words}"
    if problem.farthest_rad < math.inf:
        return f" up to {problem.farthest_rad / PERIOD_RAD:.4g} periods"
    return ""


def require_in_time(
    problem: RampedProblem | RampedBandProblem, end_rad: float, bound_rad: float
) -> None:
    """Check that the fastest course ends within the horizon.

    Parameters
    ----------
    problem
        What was looked for.
    end_rad, bound_rad
        When the fastest ends, and before what time none does [rad].

    Raises
    ------
    InfeasibleDesignError
        If it ends after the horizon.
    """
    if end_rad <= problem.horizon_rad:
        return
    raise InfeasibleDesignError(
        f"the fastest course of the reference within the limits ends after "
        f"{end_rad / PERIOD_RAD:.6g} periods, and none ends before "
        f"{bound_rad / PERIOD_RAD:.6g}: later than max_duration_periods and both ramps, "
        f"{problem.horizon_rad / PERIOD_RAD:.6g} periods in all",
        code="ramps_exceed_duration",
    )
