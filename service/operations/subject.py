"""What use cases share: the plant and the drive of a request."""

from typing import Protocol

from design.model.actuators.registry import Actuator
from design.model.plants.registry import Plant
from schemas.actuators import ActuatorIn
from schemas.base import name_field
from schemas.plants import PlantIn


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
