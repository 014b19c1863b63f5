"""Wire form of whole moves."""

from typing import Annotated, Self

from pydantic import Field

from design.model.impulses import Impulses
from design.model.initial_state import AngleSwing, DeflectionSwing
from design.moves.force_moves import ForceMove
from design.moves.hoisting_moves import Retime
from design.moves.maneuvers import Maneuver
from design.moves.programs import Program
from schemas.actuators import ActuatorIn
from schemas.base import Positive, Version, Wire, leave_out_none
from schemas.certificates import CertificateOut
from schemas.impulses import ImpulsesWire
from schemas.plants import PlantIn
from schemas.ramps import LimitsOut, OfLimits
from schemas.shapers import ShaperIn
from schemas.warnings import WarningOut, Warnings


class AngleSwingIn(Wire):
    """Swing of a pendulum at the first step, positive where the load is ahead in +x."""

    angle_rad: Annotated[float, Field(description="Angle from the vertical [rad].")]
    angle_rate_rad_s: Annotated[float, Field(description="Rate of the angle [rad/s].")]

    def to_design(self) -> AngleSwing:
        """Build the design record."""
        return AngleSwing(angle_rad=self.angle_rad, angle_rate_rad_s=self.angle_rate_rad_s)


class DeflectionSwingIn(Wire):
    """Swing of a mode at the first step, positive in +x."""

    deflection_m: Annotated[
        float, Field(description="Deflection of the payload against its support [m].")
    ]
    deflection_rate_m_s: Annotated[float, Field(description="Rate of the deflection [m/s].")]

    def to_design(self) -> DeflectionSwing:
        """Build the design record."""
        return DeflectionSwing(
            deflection_m=self.deflection_m, deflection_rate_m_s=self.deflection_rate_m_s
        )


class ManeuverRequest(Wire):
    """Body of `POST /v1/maneuvers`: `pulse_s` or `distance_m`."""

    plant: PlantIn
    actuator: ActuatorIn
    shaper: ShaperIn
    speed_m_s: Annotated[
        float | None,
        Field(
            description="Full speed; negative, with pulse_s, for a move in -x [m/s]. Required, "
            "except for a free body."
        ),
    ] = None
    force_n: Annotated[
        Positive | None,
        Field(description="For a free body, in place of speed_m_s: the largest force [N]."),
    ] = None
    duration_s: Annotated[
        Positive | None,
        Field(
            description="For a free body: time of the move, in which the force is on as shortly "
            "as may be; minimum time if not given [s]."
        ),
    ] = None
    pulse_s: Annotated[
        float | None,
        Field(description="Time from the first step of the start to that of the stop [s]."),
    ] = None
    distance_m: Annotated[
        float | None, Field(description="Distance of the move; negative in -x [m].")
    ] = None
    initial: Annotated[
        AngleSwingIn | DeflectionSwingIn | None,
        Field(description="Swing at the first step, to be cancelled: an angle for a pendulum."),
    ] = None
    joint: Annotated[
        bool, Field(description="Solve start and stop as one wherever that is faster.")
    ] = False
    retime: Annotated[
        Retime | None,
        Field(
            description="For a plant of kind hoisting: whether start and stop are solved for the "
            "cable as it is hoisted, or the stop alone, behind the start of the first length; both "
            "if not given."
        ),
    ] = None
    sample_time_s: Annotated[
        Positive | None,
        Field(description="Sample time of a program that a controller replays [s]."),
    ] = None


class ProgramOut(Wire):
    """The command as a controller replays it."""

    times_s: Annotated[list[float], Field(description="Times of the samples [s].")]
    velocity_m_s: Annotated[
        list[float], Field(description="Velocity, held over the sample that follows [m/s].")
    ]
    position_m: Annotated[
        list[float],
        Field(description="Position at each sample, linear between two of them [m]."),
    ]
    distance_m: Annotated[
        float, Field(description="Travel of the actuator as it is played, signed [m].")
    ]
    residual: Annotated[
        float,
        Field(
            description="Residual vibration of these velocities as played, each held for its "
            "sample; a share of one unshaped step [-]."
        ),
    ]

    @classmethod
    def from_design(cls, program: Program) -> Self:
        """Wrap the design record."""
        return cls(
            times_s=program.times_s.tolist(),
            velocity_m_s=program.velocity_m_s.tolist(),
            position_m=program.position_m.tolist(),
            distance_m=program.distance_m,
            residual=program.residual,
        )


class ManeuverResponse(Wire):
    """Answer of `POST /v1/maneuvers`."""

    kind: Annotated[str, Field(description="Kind of shaper, as in the request.")]
    direction: Annotated[
        int, Field(description="+1 for a move in +x; -1 for one in -x, where all is mirrored.")
    ]
    start: Annotated[
        ImpulsesWire,
        Field(
            description="Impulses of the start, shares of the speed in the direction of the move."
        ),
    ]
    stop: Annotated[
        ImpulsesWire, Field(description="Impulses of the stop, their times after its first step.")
    ]
    command: Annotated[
        ImpulsesWire,
        Field(
            description="Impulses of the whole move, shares of the speed; of a free body steps of "
            "the force."
        ),
    ]
    pulse_s: Annotated[
        float, Field(description="Time from the first step of the start to that of the stop [s].")
    ]
    duration_s: Annotated[float, Field(description="Time from the first step to the last one [s].")]
    ramp_end_s: Annotated[
        float | None,
        leave_out_none(
            "Behind limits, when the last ramp ends, after the first step; otherwise left out [s]."
        ),
    ]
    lower_bound_s: Annotated[
        float | None,
        leave_out_none(
            "Solved as one behind limits: no move ends its last ramp as early, proven; of a free "
            "body no move is as short; otherwise left out [s]."
        ),
    ]
    burn_s: Annotated[
        float | None,
        leave_out_none("Of a free body, how long the force is on; otherwise left out [s]."),
    ]
    least_burn_s: Annotated[
        float | None,
        leave_out_none(
            "With duration_s: no force of that duration is on so shortly, proven; otherwise left "
            "out [s]."
        ),
    ]
    limits: OfLimits
    distance_m: Annotated[
        float, Field(description="Travel of the actuator, signed, recomputed [m].")
    ]
    residual: Annotated[
        float,
        Field(
            description="Residual vibration of the whole move, a share of one unshaped step [-]."
        ),
    ]
    certificate: Annotated[
        CertificateOut, Field(description="Promises of the whole move, recomputed.")
    ]
    joint: Annotated[bool, Field(description="Whether start and stop were solved as one.")]
    program: Annotated[
        ProgramOut | None, Field(description="The move on samples; null without sample_time_s.")
    ]
    warnings: Warnings
    version: Version

    @classmethod
    def from_design(cls, kind: str, move: Maneuver, program: Program | None, version: str) -> Self:
        """Wrap the design records.

        Parameters
        ----------
        kind
            Name of the kind of shaper.
        move
            The move.
        program
            The move at a sample time, where it was asked for.
        version
            Of the tool.

        Returns
        -------
        Self
            Without what is None.
        """
        return cls(
            kind=kind,
            direction=move.direction,
            start=ImpulsesWire.from_design(move.start),
            stop=ImpulsesWire.from_design(move.stop),
            command=ImpulsesWire.from_design(move.command),
            pulse_s=move.pulse_s,
            duration_s=move.duration_s,
            ramp_end_s=None if move.ramps is None else move.ramps.end_s,
            lower_bound_s=move.lower_bound_s,
            limits=None if move.ramps is None else LimitsOut.from_design(move.ramps),
            distance_m=move.distance_m,
            residual=move.residual,
            certificate=CertificateOut.from_design(move.certificate, given=not move.for_ideal),
            joint=move.joint,
            burn_s=None,
            least_burn_s=None,
            program=None if program is None else ProgramOut.from_design(program),
            warnings=[
                WarningOut.from_design(one)
                for one in (*(() if program is None else program.warnings), *move.warnings)
            ],
            version=version,
        )

    @classmethod
    def from_force(cls, kind: str, move: ForceMove, version: str) -> Self:
        """Wrap the move of a free body; its halves stand for start and stop.

        Parameters
        ----------
        kind
            Name of the kind of shaper.
        move
            The move.
        version
            Of the tool.

        Returns
        -------
        Self
            Without what is None.
        """
        command = move.command
        half = (command.times_s.size // 2) | 1
        start, stop = (
            Impulses(times_s=command.times_s[part], amplitudes=command.amplitudes[part])
            for part in (slice(None, half), slice(half, None))
        )
        return cls(
            kind=kind,
            direction=move.direction,
            start=ImpulsesWire.from_design(start),
            stop=ImpulsesWire.from_design(stop),
            command=ImpulsesWire.from_design(command),
            pulse_s=float(stop.times_s[0]),
            duration_s=move.duration_s,
            lower_bound_s=move.lower_bound_s,
            burn_s=move.burn_s,
            least_burn_s=move.least_burn_s,
            distance_m=move.distance_m,
            residual=move.residual,
            certificate=CertificateOut.from_design(move.certificate, given=True),
            joint=True,
            ramp_end_s=None,
            limits=None,
            program=None,
            warnings=[],
            version=version,
        )
