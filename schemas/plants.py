"""Wire form of the plants."""

from typing import Annotated, Literal

from pydantic import Field

from design.plants import MOST_MODES, STANDARD_GRAVITY_M_S2, Mode, Modes, Pendulum
from schemas.base import PlantDamping, Positive, Wire, named


class BareMode(Wire):
    """One vibration mode in a list of them."""

    natural_frequency_rad_s: Annotated[
        Positive, Field(description="Undamped natural frequency [rad/s].")
    ]
    damping_ratio: PlantDamping = 0.0

    def to_design(self) -> Mode:
        """Build the design record."""
        return Mode(
            natural_frequency_rad_s=self.natural_frequency_rad_s, damping_ratio=self.damping_ratio
        )


class ModeIn(BareMode):
    """One vibration mode."""

    kind: Literal["mode"]


class ModesIn(Wire):
    """Several vibration modes of one plant, or one."""

    kind: Literal["modes"]
    modes: Annotated[
        list[BareMode],
        Field(min_length=1, max_length=MOST_MODES, description="No two of them alike."),
    ]

    def to_design(self) -> Mode | Modes:
        """Build the design record."""
        built = []
        for number, one in enumerate(self.modes):
            with named(f"modes.{number}"):
                built.append(one.to_design())
        return built[0] if len(built) == 1 else Modes(modes=tuple(built))


class PendulumIn(Wire):
    """A load on a cable, at small angles."""

    kind: Literal["pendulum"]
    cable_length_m: Annotated[Positive, Field(description="From suspension to centre of load [m].")]
    damping_ratio: PlantDamping = 0.0
    gravity_m_s2: Annotated[Positive, Field(description="Free fall [m/s^2].")] = (
        STANDARD_GRAVITY_M_S2
    )

    def to_design(self) -> Pendulum:
        """Build the design record."""
        return Pendulum(
            cable_length_m=self.cable_length_m,
            damping_ratio=self.damping_ratio,
            gravity_m_s2=self.gravity_m_s2,
        )


PlantIn = Annotated[ModeIn | ModesIn | PendulumIn, Field(discriminator="kind")]
