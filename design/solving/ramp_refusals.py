"""What is said where no course behind limits is found, or only one that is late."""

import math

from design.errors import InfeasibleDesignError
from design.formulations.gaps import PERIOD_RAD
from design.formulations.ramped import RampedProblem
from design.formulations.ramped_band import RampedBandProblem
from design.solvers.budget import Budget


def none_found(problem: RampedProblem | RampedBandProblem, budget: Budget) -> InfeasibleDesignError:
    """Return the refusal where no course was found.

    It says how far was searched.

    Parameters
    ----------
    problem, budget
        What was looked for, and what the search might do.

    Returns
    -------
    InfeasibleDesignError
        To be raised.
    """
    how_far = f" up to {problem.farthest_rad / PERIOD_RAD:.4g} periods"
    if budget.spent:
        how_far = f": {budget.in_words}"
    elif problem.farthest_rad == math.inf:
        how_far = ""
    return InfeasibleDesignError(
        f"no course of the reference that keeps what is asked was found within the limits{how_far}",
        code="no_ramped_command_found",
    )


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
