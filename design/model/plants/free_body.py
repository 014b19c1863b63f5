"""A body that nothing holds, with modes of vibration, moved by a force."""

from dataclasses import dataclass
from typing import NoReturn

from design.checks import require_scale
from design.errors import InvalidInputError
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeBody:
    """A free body with modes, driven by an on-off force on itself.

    The whole moves by the force over its mass; each mode is excited by the force. A turn is the
    same with inertia, torque and angle.
    """

    mass_kg: float  # Of the whole, > 0 [kg]; for a turn its inertia [kg m^2]
    vibration: Mode | Modes  # The modes that the force excites

    def __post_init__(self) -> None:
        require_scale("mass_kg", self.mass_kg)

    @property
    def excited(self) -> tuple[Mode, ...]:
        """The modes that the force excites."""
        return self.vibration.modes

    @property
    def modes_of_moments(self) -> tuple[Mode, ...]:
        """The same, for figures about the plant."""
        return self.excited

    @property
    def mode(self) -> Mode:
        """Raise InvalidInputError: its command is a force."""
        self._refuse()

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Raise InvalidInputError: its command is a force."""
        self._refuse()

    def _refuse(self) -> NoReturn:
        raise InvalidInputError(
            "plant.kind",
            "free_body",
            "a plant whose command is a velocity. A free body is served in maneuvers, with force_n",
            code="plant_moved_by_force",
        )
