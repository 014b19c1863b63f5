"""An actuator whose acceleration and deceleration are swapped: a stop is its start."""

from dataclasses import replace

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.rate_limited import RateLimited, Unlimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder


def swap_directions(actuator: Actuator) -> Actuator:
    """Return the actuator with its acceleration and deceleration swapped."""
    if isinstance(actuator, RateLimited):
        return replace(
            actuator,
            accel_limit_m_s2=actuator.decel_limit_m_s2,
            decel_limit_m_s2=actuator.accel_limit_m_s2,
            then=swap_sets(actuator.then),
        )
    return swap_sets(actuator)


def swap_sets(actuator: Unlimited) -> Unlimited:
    """Return an actuator without limits with its two sets swapped."""
    if isinstance(actuator, FirstOrder):
        return replace(
            actuator,
            accel_time_constant_s=actuator.decel_time_constant_s,
            decel_time_constant_s=actuator.accel_time_constant_s,
        )
    if isinstance(actuator, SecondOrder):
        return replace(actuator, accel=actuator.decel, decel=actuator.accel)
    return actuator
