"""Shapers and moves behind limits to acceleration that one lag follows, or two."""

from design.formulations.ramped import RampedProblem, ramped_problem
from design.formulations.ramped_move import ramped_move
from design.formulations.unequal_ramps import UnequalRampsProblem, unequal_ramps
from design.model.actuators.rate_limited import RateLimited, follows_one_lag
from design.model.initial_state import FreeSwing
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


def move_behind_limits(
    mode: Mode,
    actuator: RateLimited,
    *,
    derivatives: int,
    travel_s: float,
    swing: FreeSwing | None,
) -> RampedProblem | UnequalRampsProblem:
    """Formulate the fastest move behind limits, whatever follows them.

    Parameters
    ----------
    mode, actuator, derivatives, travel_s, swing
        As of `ramped_move`.

    Returns
    -------
    RampedProblem or UnequalRampsProblem
        As of `behind_limits`.
    """
    alike = ramped_move(mode, actuator, derivatives=derivatives, travel_s=travel_s, swing=swing)
    return alike if follows_one_lag(actuator) else unequal_ramps(alike, actuator)
