"""Wire form of the actuators."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from design.checks import MAX_VALUE
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.second_order import (
    MAX_DAMPING_RATIO,
    MIN_DAMPING_RATIO,
    SecondOrder,
    SecondOrderSet,
)
from schemas.base import Positive, WireOf

Example = dict[str, Any]
"""A request's value, as JSON has it."""

TimeConstant = Annotated[
    float, Field(ge=0, le=MAX_VALUE, description="Time constant, 0 or at least 1e-12 [s].")
]
ModelIn = Annotated[
    Model,
    Field(
        description="superposed: each step excites a separate response; switched: one velocity "
        "state, governed by the set of the latest change in the command's "
        "magnitude."
    ),
]


DeadTime = Annotated[
    float,
    Field(
        ge=0,
        le=MAX_VALUE,
        description="Delay between the command and all that the actuator does [s].",
    ),
]


class IdealIn(WireOf[Ideal]):
    """An actuator that follows its command at once."""

    ALSO: ClassVar[tuple[str, ...]] = (
        "none",
        "perfect",
        "no_lag",
    )

    RECORD = Ideal

    EXAMPLE: ClassVar[Example] = {"kind": "ideal"}

    kind: Literal["ideal"]


class FirstOrderIn(WireOf[FirstOrder]):
    """First-order lag, its time constant by direction."""

    ALSO: ClassVar[tuple[str, ...]] = (
        "pt1",
        "lag",
        "time_constant",
        "drive",
        "motor",
    )

    RECORD = FirstOrder

    EXAMPLE: ClassVar[Example] = {
        "kind": "first_order",
        "accel_time_constant_s": 0.1,
        "decel_time_constant_s": 0.05,
        "model": "switched",
    }

    kind: Literal["first_order"]
    accel_time_constant_s: TimeConstant
    decel_time_constant_s: TimeConstant
    model: ModelIn = "superposed"
    dead_time_s: DeadTime = 0.0


class SecondOrderSetIn(WireOf[SecondOrderSet]):
    """One direction of a second-order actuator."""

    RECORD = SecondOrderSet

    natural_frequency_rad_s: Annotated[
        Positive, Field(description="Undamped natural frequency [rad/s].")
    ]
    damping_ratio: Annotated[
        float,
        Field(
            ge=MIN_DAMPING_RATIO,
            le=MAX_DAMPING_RATIO,
            description="Share of critical damping [-].",
        ),
    ]


class SecondOrderIn(WireOf[SecondOrder]):
    """Second-order actuator, its parameters by direction."""

    ALSO: ClassVar[tuple[str, ...]] = (
        "pt2",
        "servo",
    )

    RECORD = SecondOrder

    EXAMPLE: ClassVar[Example] = {
        "kind": "second_order",
        "accel": {"natural_frequency_rad_s": 20, "damping_ratio": 0.8},
        "decel": {"natural_frequency_rad_s": 50, "damping_ratio": 1.5},
        "model": "switched",
    }

    kind: Literal["second_order"]
    accel: Annotated[
        SecondOrderSetIn,
        Field(description="Set of the actuator while the magnitude of the command grows."),
    ]
    decel: Annotated[
        SecondOrderSetIn,
        Field(description="Set of the actuator while the magnitude of the command falls."),
    ]
    model: ModelIn = "superposed"
    dead_time_s: DeadTime = 0.0


class RateLimitedIn(WireOf[RateLimited]):
    """Limits to acceleration, deceleration and jerk, and what follows the limited command."""

    ALSO: ClassVar[tuple[str, ...]] = (
        "ramp",
        "limits",
        "trapezoid",
        "acceleration_limited",
    )

    RECORD = RateLimited

    EXAMPLE: ClassVar[Example] = {
        "kind": "rate_limited",
        "accel_limit_m_s2": 30.0,
        "decel_limit_m_s2": 5e4,
        "speed_m_s": 0.2,
        "then": SecondOrderIn.EXAMPLE,
    }

    kind: Literal["rate_limited"]
    accel_limit_m_s2: Annotated[
        Positive, Field(description="Limit while the magnitude of the command grows [m/s^2].")
    ]
    decel_limit_m_s2: Annotated[
        Positive, Field(description="Limit while the magnitude of the command falls [m/s^2].")
    ]
    speed_m_s: Annotated[Positive, Field(description="Speed that a command of 1 stands for [m/s].")]
    then: Annotated[
        IdealIn | FirstOrderIn | SecondOrderIn,
        Field(discriminator="kind", description="Actuator that follows the rate-limited command."),
    ] = IdealIn(kind="ideal")
    jerk_limit_m_s3: Annotated[
        Positive | None,
        Field(
            description="Limit to the rate of the reference's acceleration; null for none [m/s^3].",
            examples=[3000.0],
        ),
    ] = None
    dead_time_s: DeadTime = 0.0


ActuatorIn = Annotated[
    IdealIn | FirstOrderIn | SecondOrderIn | RateLimitedIn,
    Field(discriminator="kind", description="How the drive follows its command."),
]
