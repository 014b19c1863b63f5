"""A shaper behind limits to acceleration: of one lag for both directions, or of two."""

from design.formulations.ramped import RampedProblem, ramped_problem
from design.formulations.unequal_ramps import UnequalRampsProblem, unequal_ramps
from design.model.actuators.rate_limited import RateLimited, follows_one_lag
from design.model.plants.mode import Mode


def behind_limits(
    modes: tuple[Mode, ...],
    actuator: RateLimited,
    *,
    derivatives: int,
    max_duration_periods: float,
) -> RampedProblem | UnequalRampsProblem:
    """Formulate the fastest shaper behind limits, whatever follows them.

    Parameters
    ----------
    modes, actuator, derivatives, max_duration_periods
        As of `ramped_problem`.

    Returns
    -------
    RampedProblem or UnequalRampsProblem
        Over all courses of the reference behind one lag, over those of so many switches behind two.
    """
    alike = ramped_problem(
        modes, actuator, derivatives=derivatives, max_duration_periods=max_duration_periods
    )
    return alike if follows_one_lag(actuator) else unequal_ramps(alike, actuator)
