"""What use cases share: the plant and the drive of a request, and its shaper on samples."""

from collections.abc import Iterable
from itertools import zip_longest
from typing import Protocol

from design.analysis.sensitivity import Sensitivity
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from schemas.actuators import ActuatorIn
from schemas.base import name_field
from schemas.plants import PlantIn
from schemas.sensitivity import ModeOut

NO_FIT_ON_SAMPLES = "a fit is over times that change smoothly, which whole samples do not"


class Subject(Protocol):
    """A request about a plant and its actuator."""

    @property
    def plant(self) -> PlantIn:
        """What moves."""

    @property
    def actuator(self) -> ActuatorIn:
        """What drives it."""


def subject_of(request: Subject) -> tuple[Plant, Actuator]:
    """Return the plant and the actuator of a request.

    Parameters
    ----------
    request
        The request.

    Returns
    -------
    tuple of Plant and Actuator
        As the mathematics has them.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule: names the field from the request inward.
    """
    with name_field("plant"):
        plant = request.plant.to_design()
    with name_field("actuator"):
        actuator = request.actuator.to_design()
    return plant, actuator


def of_modes(
    modes: tuple[Mode, ...], residuals: Iterable[float], curves: list[Sensitivity]
) -> list[ModeOut] | None:
    """Return the residual vibration in each of several modes.

    Parameters
    ----------
    modes
        The modes of the plant.
    residuals
        Residual vibration in each of them [-].
    curves
        Sensitivity curve of each mode; empty where none was asked for.

    Returns
    -------
    list of ModeOut or None
        An entry for each mode; None for a plant of one mode, where the rest of the answer says it.
    """
    if len(modes) == 1:
        return None
    each = zip_longest(modes, residuals, curves)
    return [ModeOut.from_design(mode, residual, curve) for mode, residual, curve in each]
