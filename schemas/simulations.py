"""Wire form of simulations."""

from collections.abc import Iterable
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from design.analysis.warnings import DesignWarning
from design.checks import MAX_VALUE
from design.errors import InvalidInputError
from design.model import commands
from design.model.impulses import Impulses
from design.moves.playback import Motion, Swing
from design.types import FloatArray
from schemas.actuators import ActuatorIn
from schemas.base import Positive, Wire, name_field
from schemas.impulses import ImpulsesWire
from schemas.plants import PlantIn
from schemas.shapers import ShaperIn
from schemas.warnings import WarningOut, Warnings

MAX_HISTORY_POINTS = 20_001

Velocities = Annotated[
    list[float],
    Field(min_length=1, max_length=MAX_HISTORY_POINTS, description="Velocities, each held [m/s]."),
]


class StepCommand(Wire):
    """Full speed from time 0 on."""

    kind: Literal["step"]

    def to_design(self, speed_m_s: float) -> Impulses:  # noqa: ARG002 - others need the speed
        """Build the design record."""
        return commands.step()


class PulseCommand(Wire):
    """Full speed for some time."""

    kind: Literal["pulse"]
    pulse_s: Annotated[Positive, Field(description="Time from start to stop [s].")]

    def to_design(self, speed_m_s: float) -> Impulses:  # noqa: ARG002
        """Build the design record."""
        return commands.pulse(self.pulse_s)


class ImpulsesCommand(Wire):
    """Steps as shares of full speed."""

    kind: Literal["impulses"]
    impulses: Annotated[
        ImpulsesWire, Field(description="Steps of the command, shares of full speed.")
    ]

    def to_design(self, speed_m_s: float) -> Impulses:  # noqa: ARG002
        """Build the design record."""
        with name_field("impulses"):
            return self.impulses.to_design()


class SampledCommand(Wire):
    """Velocities at a sample time."""

    kind: Literal["sampled"]
    sample_time_s: Annotated[Positive, Field(description="Time between samples [s].")]
    velocity_m_s: Velocities

    def to_design(self, speed_m_s: float) -> Impulses:
        """Build the design record.

        Parameters
        ----------
        speed_m_s
            Full speed, of which the velocities become shares [m/s].

        Returns
        -------
        Impulses
            The changes of velocity.

        Raises
        ------
        InvalidInputError
            If the last sample is too late, or the velocities are no command.
        """
        times = self.sample_time_s * np.arange(len(self.velocity_m_s))
        if times[-1] > MAX_VALUE:
            rule = f"such that the last sample is at {MAX_VALUE:g} s at most"
            raise InvalidInputError(
                "sample_time_s", self.sample_time_s, rule, code="samples_not_served"
            )
        return commands.command_of_velocities(times, _shares(self.velocity_m_s, speed_m_s))


class ListCommand(Wire):
    """Velocities at times."""

    kind: Literal["list"]
    times_s: Annotated[
        list[float],
        Field(
            min_length=1,
            max_length=MAX_HISTORY_POINTS,
            description="Times, not decreasing; of velocities at one time the last counts [s].",
        ),
    ]
    velocity_m_s: Velocities

    def to_design(self, speed_m_s: float) -> Impulses:
        """Build the design record."""
        return commands.command_of_velocities(
            np.array(self.times_s), _shares(self.velocity_m_s, speed_m_s)
        )


def _shares(velocity_m_s: list[float], speed_m_s: float) -> FloatArray:
    """Return velocities as shares of full speed; infinite where no number holds them."""
    with np.errstate(over="ignore"):
        shares: FloatArray = np.array(velocity_m_s) / speed_m_s
    return shares


CommandIn = Annotated[
    StepCommand | PulseCommand | ImpulsesCommand | SampledCommand | ListCommand,
    Field(discriminator="kind", description="Command of the velocity, before it is shaped."),
]


class SimulationRequest(Wire):
    """Body of `POST /v1/simulations`."""

    plant: PlantIn
    actuator: ActuatorIn
    command: CommandIn
    shaper: Annotated[
        ShaperIn | None,
        Field(description="Shaper of the command, designed for plant and actuator."),
    ] = None
    speed_m_s: Annotated[Positive, Field(description="Full speed [m/s].")] = 1.0
    until_s: Annotated[
        Positive | None,
        Field(description="Last time [s]; three periods after the last step if not given."),
    ] = None
    points: Annotated[
        int, Field(ge=2, le=MAX_HISTORY_POINTS, description="Number of times, evenly spaced.")
    ] = 1001


class SwingOut(Wire):
    """A swing of the payload against its support."""

    deflection_m: Annotated[
        float, Field(description="Deflection of the payload against its support [m].")
    ]
    angle_rad: Annotated[float | None, Field(description="For a pendulum, else null.")]

    @classmethod
    def from_design(cls, swing: Swing) -> Self:
        """Wrap the design record."""
        return cls(deflection_m=swing.deflection_m, angle_rad=swing.angle_rad)


class PeaksOut(SwingOut):
    """Largest magnitudes at the times given."""

    velocity_m_s: Annotated[float, Field(description="Largest speed of the actuator [m/s].")]


class SimulationResponse(Wire):
    """Answer of `POST /v1/simulations`."""

    times_s: Annotated[list[float], Field(description="Times of the history [s].")]
    command_m_s: Annotated[list[float], Field(description="Command at each time [m/s].")]
    velocity_m_s: Annotated[
        list[float], Field(description="Velocity of the actuator at each time [m/s].")
    ]
    deflection_m: Annotated[
        list[float], Field(description="Deflection of the payload at each time [m].")
    ]
    angle_rad: Annotated[list[float] | None, Field(description="For a pendulum, else null.")]
    peaks: Annotated[PeaksOut, Field(description="Largest magnitudes at these times.")]
    residual: Annotated[
        float | None,
        Field(
            description="Residual vibration after the last step or ramp, a share of one unshaped "
            "step; null where the actuator resonates with the plant [-]."
        ),
    ]
    remaining: Annotated[
        SwingOut | None,
        Field(
            description="Amplitude of that vibration, extrapolated back to the end of the last "
            "step or ramp."
        ),
    ]
    impulses: Annotated[ImpulsesWire, Field(description="The command as it was played.")]
    warnings: Warnings

    @classmethod
    def from_design(
        cls, motion: Motion, played: Impulses, warnings: Iterable[DesignWarning]
    ) -> Self:
        """Wrap the design records.

        Parameters
        ----------
        motion
            What happens, n times.
        played
            The command that was played.
        warnings
            What to know of it.

        Returns
        -------
        Self
            Lists of n numbers, and the remaining vibration.
        """
        peak, remaining = motion.peak, motion.remaining
        return cls(
            times_s=motion.times_s.tolist(),
            command_m_s=motion.command_m_s.tolist(),
            velocity_m_s=motion.velocity_m_s.tolist(),
            deflection_m=motion.deflection_m.tolist(),
            angle_rad=None if motion.angle_rad is None else motion.angle_rad.tolist(),
            peaks=PeaksOut(
                deflection_m=peak.deflection_m,
                angle_rad=peak.angle_rad,
                velocity_m_s=motion.peak_velocity_m_s,
            ),
            residual=motion.residual,
            remaining=None if remaining is None else SwingOut.from_design(remaining),
            impulses=ImpulsesWire.from_design(played),
            warnings=[WarningOut.from_design(one) for one in warnings],
        )
