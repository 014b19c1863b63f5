"""What kinds of shapers refuse, and what refuses kinds for large swings."""

from typing import TYPE_CHECKING, NoReturn

from design.errors import InvalidInputError

if TYPE_CHECKING:
    from design.model.actuators.registry import Actuator
    from design.shapers.kind import ShaperKind


def refuse_several(name: str, modes: int) -> NoReturn:
    """Refuse a plant of several modes.

    Parameters
    ----------
    name, modes
        Name of the kind of shaper, and how many modes the plant has.

    Raises
    ------
    InvalidInputError
        Always.
    """
    raise InvalidInputError(
        "plant.modes",
        f"{modes} modes",
        f"of one mode: {name} serves a single mode; multi_zv, multi_umzv, num_multi, multi_si and "
        "convolved serve several",
        code="kind_of_one_mode",
    )


def refuse_actuator(kind: "ShaperKind", actuator: "Actuator") -> NoReturn:
    """Refuse an actuator that a kind of shaper does not serve.

    Parameters
    ----------
    kind, actuator
        The kind of shaper and the actuator.

    Raises
    ------
    InvalidInputError
        Always.
    """
    raise InvalidInputError(
        "actuator.kind",
        actuator.kind,
        f"one that {kind.name} serves: {', '.join(kind.actuators)}",
        code="actuator_not_served",
    )


def require_small_swings(kind: "ShaperKind", what: str, at: str = "shaper.kind") -> None:
    """Refuse a kind for large swings where all is computed of small ones.

    Parameters
    ----------
    kind
        Kind of the shaper.
    what
        What is asked for, in the plural.
    at
        Field that the error names.

    Raises
    ------
    InvalidInputError
        If the kind is for large swings.
    """
    if kind.large_swings:
        raise InvalidInputError(
            at,
            kind.name,
            f"a kind for small swings: {what} are computed of the linear plant, of which "
            f"{kind.name} is not exact",
            code="small_swings_only",
        )
