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
        longest_s = MAX_RAMP_RAD / mode.natural_frequency_rad_s
        if ramp_s <= longest_s:
            continue
        if actuator.speed_m_s / getattr(actuator, name) > longest_s:
            raise InvalidInputError(
                f"actuator.{name}",
                getattr(actuator, name),
                f"at least {actuator.speed_m_s / longest_s:.4g} m/s^2: a ramp to or from full "
                f"speed, {actuator.speed_m_s:g} m/s, may take three periods, {longest_s:.4g} s",
                code="ramp_too_long",
            )
        raise InvalidInputError(
            "actuator.jerk_limit_m_s3",
            actuator.jerk_limit_m_s3,
            f"so large that a ramp to or from full speed, {actuator.speed_m_s:g} m/s, takes at "
            f"most three periods, {longest_s:.4g} s: it takes {ramp_s:.4g} s",
            code="jerk_limit_too_small",
        )
