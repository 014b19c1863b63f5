"""All kinds of actuators: what drives the plant."""

from design.model.actuators.rate_limited import RateLimited, Unlimited

Actuator = Unlimited | RateLimited


def unit_ramps_s(actuator: Actuator) -> tuple[float, float]:
    """Return the times that the reference takes to full speed and from it [s].

    Both are 0 without limits to the rate of the command.
    """
    return actuator.unit_ramps_s if isinstance(actuator, RateLimited) else (0.0, 0.0)
