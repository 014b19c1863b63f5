"""Whether the limits of a drive are for the speed of a move."""

from design.errors import InvalidInputError
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator


def require_speed(actuator: Actuator, speed_m_s: float) -> None:
    """Check that the limits of a rate-limited actuator are for this speed.

    Parameters
    ----------
    actuator
        Any actuator; one without limits serves every speed.
    speed_m_s
        Full speed of a move, of either sign [m/s].

    Raises
    ------
    InvalidInputError
        If the actuator's own ``speed_m_s`` is another.
    """
    if isinstance(actuator, RateLimited) and abs(speed_m_s) != actuator.speed_m_s:
        raise InvalidInputError(
            "speed_m_s",
            speed_m_s,
            f"the actuator's own speed_m_s, {actuator.speed_m_s!r}",
            code="speed_not_actuators",
        )
