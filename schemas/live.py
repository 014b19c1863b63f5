"""Wire form of live sessions: what the server sends while a crane is driven."""

from typing import Annotated

from pydantic import Field

from schemas.base import Version, Wire, leave_out_none
from schemas.certificates import CertificateOut
from schemas.problems import ProblemDocument
from schemas.runs import CommandsOut


class LiveAxisOut(Wire):
    """The motion of an axis at a moment."""

    command_m_s: Annotated[float, Field(description="Velocity commanded [m/s].")]
    velocity_m_s: Annotated[float, Field(description="Velocity of the trolley [m/s].")]
    position_m: Annotated[float, Field(description="Position of the trolley [m].")]
    deflection_m: Annotated[
        float, Field(description="Deflection of what hangs lowest against the trolley [m].")
    ]
    angle_rad: Annotated[
        float | None, Field(description="Of the cable from the vertical; null without one [rad].")
    ]


class LiveStateOut(Wire):
    """The crane at a moment."""

    at_s: Annotated[float, Field(description="Time since the first message was taken [s].")]
    x: Annotated[LiveAxisOut, Field(description="Along x.")]
    y: Annotated[LiveAxisOut, Field(description="Along y.")]
    cable_length_m: float | None = leave_out_none("Of the cable; left out without one [m].")
    swing: Annotated[
        float,
        Field(
            description="Amplitude of the swing, by the root of its energy: a share of one "
            "unshaped step at full speed, at this length [-]."
        ),
    ]


class LivePlanOut(Wire):
    """The commands from an event on."""

    at_s: Annotated[float, Field(description="When the event happened [s].")]
    event: Annotated[int, Field(description="Number of the event, from 1.")]
    command: Annotated[
        CommandsOut, Field(description="Switches that are still to come, of each axis.")
    ]
    last_switch_s: Annotated[
        float, Field(description="When the last of them is, or the hoist ends [s].")
    ]
    certificate: Annotated[
        CertificateOut | None,
        Field(description="What the plan claims, recomputed; null where it is not solved anew."),
    ]
    fallback: Annotated[
        str | None,
        Field(description="Why an older plan goes on; null where the plan is the event's own."),
    ]


class LiveMessage(Wire):
    """A message of `WS /v1/live`: one of these."""

    state: LiveStateOut | None = leave_out_none("The crane now, up to 60 times a second.")
    plan: LivePlanOut | None = leave_out_none("The commands that an event has led to.")
    problem: ProblemDocument | None = leave_out_none(
        "Why a message was refused; what was sent before it stays in force."
    )
    version: Version | None = leave_out_none("Version of the service, in the first message.")
