"""Whether an actuator is in proportion to the plant, so that a residual means something."""

import math

import numpy as np

from design.errors import InvalidInputError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.plants.mode import Mode
from design.model.reference_ramps import ramp_factors

SLOWEST = 100.0
"""Largest time constant of a set times the plant's natural frequency [-]."""

MAX_RAMP_RAD = 6 * math.pi
"""Longest ramp to full speed, three periods: the formulations integrate no longer ones [rad]."""

RESONANCE = 1e-6
"""Below this ``|1/G|`` at the plant's pole, a set of the actuator rings with the plant [-]."""

LIMIT_FIELDS = ("accel_limit_m_s2", "decel_limit_m_s2")
"""Fields of the limits, in the order of the ramps that they make."""


def require_workable(mode: Mode, actuator: Actuator) -> None:
    """Check that the sets of an actuator are in proportion to the plant.

    A set with its own pole at the plant's rings with it, and a residual in units of the unshaped
    step means nothing; one a hundred times slower passes so little on that it drowns in rounding.

    Parameters
    ----------
    mode
        The plant's mode.
    actuator
        The actuator, limits included.

    Raises
    ------
    InvalidInputError
        If a set is over 100 times slower than the mode or has its pole, or a ramp to full speed
        lasts for more than three periods or for whole ones.
    """
    start, drive = "", actuator
    if isinstance(actuator, RateLimited):
        start, drive = "then.", actuator.then
    end = "_time_constant_s" if isinstance(drive, FirstOrder) else ""
    sets = (("accel", drive.accel_lag), ("decel", drive.decel_lag))
    for name, lag in ((f"{start}{one}{end}", lag) for one, lag in sets):
        slowness = mode.natural_frequency_rad_s * max(lag.first_s, lag.second_s2**0.5)
        if slowness > SLOWEST:
            raise InvalidInputError(
                f"actuator.{name}",
                f"{slowness:.3g} times slower",
                f"at most {SLOWEST:g} times slower than the plant",
                code="actuator_too_slow",
            )
        distance = abs(lag.denominator(mode.pole_rad_s))
        if distance < RESONANCE:
            raise InvalidInputError(
                f"actuator.{name}",
                f"1/G = {distance:.1e} there",
                "without a pole at the plant's pole, where the two resonate",
                code="actuator_resonant",
            )
    for name, ramp_s in zip(LIMIT_FIELDS, unit_ramps_s(actuator), strict=True):
        turn = mode.natural_frequency_rad_s * ramp_s
        if turn > MAX_RAMP_RAD:
            raise InvalidInputError(
                f"actuator.{name}",
                f"a ramp of {turn:.3g} rad of the plant's swing",
                f"such that a ramp to or from full speed takes at most {MAX_RAMP_RAD:.5g} rad",
                code="ramp_too_long",
            )
        left = abs(ramp_factors(np.array([mode.pole_rad_s]), np.array([ramp_s]))[0])
        if left < RESONANCE:
            raise InvalidInputError(
                f"actuator.{name}",
                f"a ramp of {turn:.9g} rad of the plant's swing",
                "such that a ramp does not last whole periods: by itself such a ramp has no "
                "residual",
                code="ramp_of_whole_periods",
            )
