"""All kinds of actuators: what drives the plant."""

from design.errors import InvalidInputError
from design.model.actuators.rate_limited import RateLimited, Unlimited

Actuator = Unlimited | RateLimited


def unit_ramps_s(actuator: Actuator) -> tuple[float, float]:
    """Return the time that the reference takes to full speed and from it; 0 without limits [s]."""
    return actuator.unit_ramps_s if isinstance(actuator, RateLimited) else (0.0, 0.0)


def require_speed(actuator: Actuator, speed_m_s: float) -> None:
    """Raise InvalidInputError if the limits of a rate-limited actuator are for another speed."""
    if isinstance(actuator, RateLimited) and abs(speed_m_s) != actuator.speed_m_s:
        raise InvalidInputError(
            "speed_m_s", speed_m_s, f"the actuator's own speed_m_s, {actuator.speed_m_s!r}"
        )
