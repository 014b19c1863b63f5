"""Up to which damping ratio of the plant a kind of shaper exists as numbers."""

import math
from dataclasses import dataclass

from design.errors import InvalidInputError
from design.formulations.gaps import MIN_GAP_RAD
from design.model.plants.mode import MAX_DAMPING_RATIO, Mode


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingBound:
    """Up to which damping ratio of the plant a kind of shaper exists as numbers.

    Attributes
    ----------
    most
        Largest damping ratio [-].
    beyond
        What its impulses are beyond it, in words.
    """

    most: float
    beyond: str


EVERY_PLANT = DampingBound(most=MAX_DAMPING_RATIO, beyond="there is no such plant")


def require_damping(
    name: str, damping: DampingBound, mode: Mode, field_name: str = "plant"
) -> None:
    """Check that a mode is damped no more than a kind of shaper serves.

    Parameters
    ----------
    name
        Name of the kind.
    damping
        Its bound.
    mode
        The mode.
    field_name
        Dotted path of the mode, for the error.

    Raises
    ------
    InvalidInputError
        If the damping ratio is above the bound.
    """
    if mode.damping_ratio > damping.most:
        raise InvalidInputError(
            f"{field_name}.damping_ratio",
            mode.damping_ratio,
            f"at most {damping.most:g} for {name}: beyond it {damping.beyond}",
            code="too_damped_for_kind",
        )


def require_modes_damped(name: str, damping: DampingBound, modes: tuple[Mode, ...]) -> None:
    """Check that no mode of a plant is damped more than a kind serves.

    Parameters
    ----------
    name, damping
        As of `require_damping`, which raises for the first mode that is.
    modes
        The modes of the plant.
    """
    for number, mode in enumerate(modes):
        field_name = "plant" if len(modes) == 1 else f"plant.modes.{number}"
        require_damping(name, damping, mode, field_name)


LAST_PULSE_VANISHES = f"its last pulse is shorter than impulses are kept apart, {MIN_GAP_RAD:g} rad"
"""What becomes of steps up and down in turn as damping grows: early swings decay by themselves."""


def damped_periods(mode: Mode, periods: float) -> float:
    """Return in undamped periods how long some damped ones are [-].

    Parameters
    ----------
    mode
        The mode.
    periods
        Number of damped periods [-].

    Returns
    -------
    float
        Number of undamped periods [-].
    """
    return periods / math.sqrt(1 - mode.damping_ratio**2)
