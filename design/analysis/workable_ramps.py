"""Whether the ramps that limits make are in proportion to the plant."""

import math

from design.errors import InvalidInputError
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.mode import Mode

MAX_RAMP_RAD = 6 * math.pi
"""Longest ramp to full speed, three periods: the formulations integrate no longer ones [rad]."""

LIMIT_FIELDS = ("accel_limit_m_s2", "decel_limit_m_s2")
"""Fields of the limits, in the order of the ramps that they make."""


def require_workable_ramps(mode: Mode, actuator: RateLimited) -> None:
    """Check that ramps to full speed are in proportion to the plant.

    Parameters
    ----------
    mode
        The plant's mode.
    actuator
        The limits.

    Raises
    ------
    InvalidInputError
        If a ramp lasts for more than three periods.
    """
    for name, ramp_s in zip(LIMIT_FIELDS, actuator.unit_ramps_s, strict=True):
        turn = mode.natural_frequency_rad_s * ramp_s
        if turn > MAX_RAMP_RAD:
            straight_s = actuator.speed_m_s / getattr(actuator, name)
            alone = mode.natural_frequency_rad_s * straight_s > MAX_RAMP_RAD
            raise InvalidInputError(
                f"actuator.{name if alone else 'jerk_limit_m_s3'}",
                f"a ramp of {turn:.3g} rad of the plant's swing",
                f"such that a ramp to or from full speed takes at most {MAX_RAMP_RAD:.5g} rad",
                code="ramp_too_long",
            )
