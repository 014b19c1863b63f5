"""What is not served while a cable is hoisted."""

from design.errors import InvalidInputError
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator


def require_while_hoisting(name: str, value: object, served: str, *, holds: bool) -> None:
    """Check a field of which a hoisted cable does not take every value.

    Parameters
    ----------
    name, value
        Field that the error names, and what it is.
    served
        What the field must be, to be read after "must be".
    holds
        Whether it is.

    Raises
    ------
    InvalidInputError
        If it is not.
    """
    if not holds:
        raise InvalidInputError(
            name, value, f"{served} while a cable is hoisted", code="not_while_hoisting"
        )


def require_no_limits(actuator: Actuator) -> None:
    """Check that a drive has no limits to acceleration.

    Raises
    ------
    InvalidInputError
        If it has.
    """
    require_while_hoisting(
        "actuator.kind",
        actuator.kind,
        "ideal, first_order or second_order",
        holds=not isinstance(actuator, RateLimited),
    )
