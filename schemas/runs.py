"""Wire form of runs: the crane, driven by events."""

from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from pydantic import Field

from design.checks import MAX_VALUE
from design.model.impulses import Impulses
from design.rig.camera import LENS_LINES, MARKER_M, Camera
from design.rig.crane import HOOK_MASS_KG, CraneModel, LimitSwitch, Load, Stroke
from design.rig.encoder import PULSES_PER_REVOLUTION, TRAVEL_PER_REVOLUTION_M, Encoder
from schemas.actuators import ActuatorIn
from schemas.base import OutOf, Positive, Wire, WireOf, leave_out_none
from schemas.certificates import CertificateOut
from schemas.plants import PlantIn
from schemas.run_events import Distance, EventIn, PlayedAxes, Time
from schemas.shapers import ShaperIn
from schemas.simulations import MAX_HISTORY_POINTS
from schemas.warnings import WarningOut, Warnings

if TYPE_CHECKING:  # they compile what moves the crane, and numba takes half a second
    from design.rig.runs import Run
    from design.rig.sensed import Sensed

MAX_EVENTS = 1000


class NoShaping(Wire):
    """Commands go to the drive as they are."""

    mode: Literal["none"]


class DelayLine(Wire):
    """Commands are convolved with a shaper, as a delay line in a controller does."""

    mode: Literal["delay_line"]
    shaper: ShaperIn
    cable_length_m: Annotated[
        Positive | None,
        Field(
            description="Cable that the shaper is designed for, in place of the plant's; where it "
            "is hoisted the first length if not given [m]."
        ),
    ] = None


class LiveShaping(Wire):
    """Commands are solved anew at each event, from the state of drive and payload then."""

    mode: Literal["live"]
    shaper: Annotated[
        ShaperIn,
        Field(description="What plans leave: numzv, numzvd, num_multi, or umzv for comparison."),
    ]
    sample_time_s: Annotated[
        Positive | None,
        Field(description="Buttons are read once in it; at any time if not given [s]."),
    ] = None


class LoadIn(WireOf[Load]):
    """A load that swings under the hook."""

    RECORD = Load

    mass_kg: Annotated[
        float, Field(ge=-MAX_VALUE, le=MAX_VALUE, description="Mass of the load, > 0 [kg].")
    ]
    length_m: Annotated[Positive, Field(description="From the hook to the centre of the load [m].")]


class StrokeIn(WireOf[Stroke]):
    """How far an axis can go."""

    RECORD = Stroke

    length_m: Annotated[Positive, Field(description="From end to end [m].")]
    start_m: Annotated[Time, Field(description="Where the axis stands at first [m].")]
    switch_m: Annotated[
        Time | None,
        Field(description="Limit switches are so far before the ends; none if not given [m]."),
    ] = None


class StrokesIn(Wire):
    """Strokes of the axes."""

    x: Annotated[StrokeIn | None, Field(description="Of x; endless if not given.")] = None
    y: Annotated[StrokeIn | None, Field(description="Of y; endless if not given.")] = None


class CameraIn(Wire):
    """A camera at the trolley that looks down at a marker on the hook."""

    lens: Annotated[
        Literal["6mm", "4mm"], Field(description="Its lens, as Kim (2011) calibrated two.")
    ] = "6mm"
    marker_m: Annotated[Positive, Field(description="Width of the marker [m].")] = MARKER_M
    below_m: Annotated[
        Distance, Field(description="How far the camera is below the cable's end [m].")
    ] = 0.0
    noise_pixels: Annotated[
        float, Field(ge=0, le=MAX_VALUE, description="Standard deviation of its noise [pixels].")
    ] = 0.3
    whole_pixels: Annotated[bool, Field(description="Whether it reports whole pixels.")] = True
    seed: Annotated[int, Field(ge=0, description="Of its noise: one seed replays one run.")] = 0

    def to_design(self) -> Camera:
        """Build the design record."""
        return Camera(
            line=LENS_LINES[self.lens],
            marker_m=self.marker_m,
            below_m=self.below_m,
            noise_pixels=self.noise_pixels,
            whole_pixels=self.whole_pixels,
        )


class EncoderIn(WireOf[Encoder]):
    """Absolute encoders on both axes."""

    RECORD = Encoder

    pulses_per_revolution: Annotated[
        int, Field(ge=1, le=2**31, description="Pulses of a turn of the motor.")
    ] = PULSES_PER_REVOLUTION
    travel_per_revolution_m: Annotated[
        Positive, Field(description="Travel of an axis in a turn of its motor [m].")
    ] = TRAVEL_PER_REVOLUTION_M


class RunRequest(Wire):
    """Body of `POST /v1/runs`."""

    plant: PlantIn
    actuator: ActuatorIn
    speed_m_s: Annotated[Positive, Field(description="Full speed [m/s].")]
    shaping: Annotated[
        Annotated[NoShaping | DelayLine | LiveShaping, Field(discriminator="mode")] | None,
        Field(description="What becomes of commands before the drive; nothing if null."),
    ] = None
    deflection_limit: Annotated[
        Distance | None,
        Field(
            description="In live mode: largest deflection of the payload on the way, as a share of "
            "an unshaped step's, 0.05 to 10; any if not given [-]."
        ),
    ] = None
    model: Annotated[
        CraneModel, Field(description="Whether swings count as small, or as large as they are.")
    ] = "linear"
    events: Annotated[
        list[EventIn] | None,
        Field(max_length=MAX_EVENTS, description="What happens, in any order; nothing if null."),
    ] = None
    played: Annotated[
        PlayedAxes | None, Field(description="Courses that a controller has computed or recorded.")
    ] = None
    hook_mass_kg: Annotated[
        Positive | None,
        Field(
            description=f"Mass of the hook; {HOOK_MASS_KG:g} if not given, and that of the plant "
            "where it is of kind double_pendulum [kg]."
        ),
    ] = None
    load: Annotated[
        LoadIn | None, Field(description="What swings under the hook; nothing if not given.")
    ] = None
    strokes: Annotated[
        StrokesIn | None, Field(description="How far the axes can go; endless if not given.")
    ] = None
    max_speed_m_s: Annotated[
        Positive | None,
        Field(description="Largest speed of axes and hoist; any if not given [m/s]."),
    ] = None
    camera: Annotated[
        CameraIn | None, Field(description="Looks at each time of the history; none if not given.")
    ] = None
    encoder: Annotated[
        EncoderIn | None, Field(description="Counts at each of them; none if not given.")
    ] = None
    until_s: Annotated[
        Positive | None,
        Field(description="Last time [s]; three periods after the last switch if not given."),
    ] = None
    points: Annotated[
        int, Field(ge=2, le=MAX_HISTORY_POINTS, description="Number of times, evenly spaced.")
    ] = 2001


class CourseOut(Wire):
    """A command as it is sent to a drive: a level from each time on."""

    times_s: Annotated[list[float], Field(description="Times of the switches [s].")]
    levels: Annotated[list[float], Field(description="Shares of full speed from then on [-].")]

    @classmethod
    def from_design(cls, command: Impulses) -> Self:
        """Wrap the design record."""
        return cls(times_s=command.times_s.tolist(), levels=np.cumsum(command.amplitudes).tolist())


class CommandsOut(Wire):
    """Commands of the axes."""

    x: CourseOut | None = leave_out_none("Of x; left out if it is never driven.")
    y: CourseOut | None = leave_out_none("Of y; left out if it is never driven.")


class EventOut(Wire):
    """An event, and when the last switch that it causes is over."""

    at_s: Annotated[float, Field(description="When it happens [s].")]
    last_switch_s: Annotated[
        float, Field(description="When its last switch is, or its hoist ends [s].")
    ]


class LiveEventOut(EventOut):
    """An event shaped live, and the proof of the command that it led to."""

    certificate: Annotated[
        CertificateOut,
        Field(description="Of the command until its last switch, recomputed by another route."),
    ]
    fallback: Annotated[
        str | None,
        Field(description="Why an axis keeps an older plan; null where none does."),
    ]


class AxisHistory(Wire):
    """The motion of an axis over time."""

    command_m_s: Annotated[list[float], Field(description="Velocity commanded [m/s].")]
    velocity_m_s: Annotated[list[float], Field(description="Velocity of the trolley [m/s].")]
    position_m: Annotated[list[float], Field(description="Position of the trolley [m].")]
    deflection_m: Annotated[
        list[float],
        Field(description="Deflection of what hangs lowest against the trolley [m]."),
    ]
    angle_rad: Annotated[
        list[float] | None, Field(description="Of the cable from the vertical; null without one.")
    ]


class RunHistory(AxisHistory):
    """The motion of x over time, with that of y where it is driven."""

    times_s: Annotated[list[float], Field(description="Times of the history [s].")]
    y: AxisHistory | None = leave_out_none("The motion of y; left out if it is never driven.")
    cable_length_m: list[float] | None = leave_out_none(
        "Length of the cable; left out if it is never hoisted [m]."
    )


class SensedOut(Wire):
    """What sensors report at each time of the history."""

    pulses_x: list[int] | None = leave_out_none("Of the encoder of x.")
    pulses_y: list[int] | None = leave_out_none("Of the encoder of y.")
    pixels_x: list[float] | None = leave_out_none("Centre of the marker in x [pixels].")
    pixels_y: list[float] | None = leave_out_none("Centre of the marker in y [pixels].")
    width_pixels: list[float] | None = leave_out_none("Width of the marker [pixels].")

    @classmethod
    def from_design(cls, sensed: "Sensed") -> Self:
        """Wrap the design record."""
        names = cls.model_fields
        told = {name: getattr(sensed, name) for name in names}
        return cls(**{name: None if one is None else one.tolist() for name, one in told.items()})


class SwitchOut(OutOf[LimitSwitch]):
    """A limit switch that an axis met."""

    axis: Annotated[Literal["x", "y"], Field(description="Which axis.")]
    at_s: Annotated[float, Field(description="When [s].")]
    position_m: Annotated[float, Field(description="Where [m].")]


class RunResponse(Wire):
    """Answer of `POST /v1/runs`."""

    command: Annotated[CommandsOut, Field(description="What is sent to the drives.")]
    events: Annotated[
        list[LiveEventOut | EventOut], Field(description="The events, in the order given.")
    ]
    history: Annotated[RunHistory, Field(description="The motion over time.")]
    residual: Annotated[
        float | None,
        Field(
            description="Residual vibration after the last switch, ramp and hoist, by the root of "
            "its energy: a share of one unshaped step at full speed, at the length at the end; "
            "null where it has died away before the drive has settled [-]."
        ),
    ]
    limit_switches: Annotated[
        list[SwitchOut], Field(description="Limit switches that were met, in order.")
    ]
    sensors: SensedOut | None = leave_out_none("What sensors report; left out without any.")
    warnings: Warnings

    @classmethod
    def from_design(
        cls,
        run: "Run",
        events: list[EventOut],
        sensed: "Sensed | None",
        *,
        has_cable: bool,
        hoisted: bool,
    ) -> Self:
        """Wrap the design records.

        Parameters
        ----------
        run
            What happened, at n times.
        events
            When each event happens, when its last switch is, and what is proven of it.
        sensed
            What sensors report; None without any.
        has_cable, hoisted
            Whether angles are those of a cable, and whether its length changes.

        Returns
        -------
        Self
            Lists of n numbers.
        """
        x, y = (_axis_history(run, axis, has_cable=has_cable) for axis in (0, 1))
        length = run.track.cable_length_m.tolist() if hoisted else None
        return cls(
            command=CommandsOut(**{
                axis: CourseOut.from_design(one) for axis, one in run.commands.items()
            }),
            events=list(events),
            history=RunHistory(
                times_s=run.track.times_s.tolist(),
                y=y if "y" in run.commands else None,
                cable_length_m=length,
                **dict(x),
            ),
            residual=run.residual,
            limit_switches=[SwitchOut.from_design(one) for one in run.switches],
            sensors=None if sensed is None else SensedOut.from_design(sensed),
            warnings=[WarningOut.from_design(one) for one in run.warnings],
        )


def _axis_history(run: "Run", axis: int, *, has_cable: bool) -> AxisHistory:
    track = run.track
    return AxisHistory(
        command_m_s=run.command_m_s[:, axis].tolist(),
        velocity_m_s=track.velocity_m_s[:, axis].tolist(),
        position_m=track.position_m[:, axis].tolist(),
        deflection_m=track.load_m[:, axis].tolist(),
        angle_rad=track.angle_rad[:, axis].tolist() if has_cable else None,
    )
