"""Wire form of the actuators."""

from typing import Annotated, Literal

from pydantic import Field

from design.actuators import (
    LARGEST_DAMPING_RATIO,
    SMALLEST_DAMPING_RATIO,
    FirstOrder,
    Ideal,
    Model,
    SecondOrder,
    SecondOrderSet,
)
from design.types import LARGEST
from schemas.base import Positive, Wire, named

TimeConstant = Annotated[
    float, Field(ge=0, le=LARGEST, description="Time constant, 0 or at least 1e-12 [s].")
]
ModelIn = Annotated[
    Model,
    Field(
        description="superposed: each step excites a response of its own; switched: one state, "
        "moved by the set of the latest change of |command|."
    ),
]


DeadTime = Annotated[
    float, Field(ge=0, le=LARGEST, description="Delay of all that the actuator does [s].")
]


class IdealIn(Wire):
    """An actuator that follows its command at once."""

    kind: Literal["ideal"]

    def to_design(self) -> Ideal:
        """Build the design record."""
        return Ideal()


class FirstOrderIn(Wire):
    """First-order lag, its time constant by direction."""

    kind: Literal["first_order"]
    accel_time_constant_s: TimeConstant
    decel_time_constant_s: TimeConstant
    model: ModelIn = "superposed"
    dead_time_s: DeadTime = 0.0

    def to_design(self) -> FirstOrder:
        """Build the design record."""
        return FirstOrder(
            accel_time_constant_s=self.accel_time_constant_s,
            decel_time_constant_s=self.decel_time_constant_s,
            model=self.model,
            dead_time_s=self.dead_time_s,
        )


class SecondOrderSetIn(Wire):
    """One direction of a second-order actuator."""

    natural_frequency_rad_s: Annotated[
        Positive, Field(description="Undamped natural frequency [rad/s].")
    ]
    damping_ratio: Annotated[
        float,
        Field(
            ge=SMALLEST_DAMPING_RATIO,
            le=LARGEST_DAMPING_RATIO,
            description="Share of critical damping [-].",
        ),
    ]

    def to_design(self) -> SecondOrderSet:
        """Build the design record."""
        return SecondOrderSet(
            natural_frequency_rad_s=self.natural_frequency_rad_s, damping_ratio=self.damping_ratio
        )


class SecondOrderIn(Wire):
    """Second-order actuator, its parameters by direction."""

    kind: Literal["second_order"]
    accel: SecondOrderSetIn
    decel: SecondOrderSetIn
    model: ModelIn = "superposed"
    dead_time_s: DeadTime = 0.0

    def to_design(self) -> SecondOrder:
        """Build the design record."""
        with named("accel"):
            accel = self.accel.to_design()
        with named("decel"):
            decel = self.decel.to_design()
        return SecondOrder(accel=accel, decel=decel, model=self.model, dead_time_s=self.dead_time_s)


ActuatorIn = Annotated[IdealIn | FirstOrderIn | SecondOrderIn, Field(discriminator="kind")]
