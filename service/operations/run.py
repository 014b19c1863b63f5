"""A run of the crane, driven by events."""

import math
from typing import TYPE_CHECKING, NamedTuple

from design.analysis.warnings import DesignWarning
from design.checks import MAX_VALUE
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import STANDARD_GRAVITY_M_S2, Pendulum
from design.model.plants.registry import Plant
from design.pipeline import design
from design.rig.crane import MAX_CABLE_M, AxisName, Crane, Stroke
from design.rig.runs import SETTLED, Run, Scenario, run
from design.rig.scenario import Drive, HoistTo, Played, pulse_of_distance
from design.rig.sensed import sensed
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.shapers.refusals import require_small_swings
from schemas.base import name_field
from schemas.run_events import EventIn
from schemas.runs import DelayLine, RunRequest, RunResponse, StrokeIn
from service.operations.found_shaper import on_samples
from service.operations.operation import Operation
from service.operations.subject import subject_of
from service.version import version

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MAX_TURN_RAD = 1e5
"""Most that the fastest mode of a run may turn: a few seconds of work [rad]."""

MAX_STEPS = 200_000
"""Most steps of a shaped command."""


def drive_crane(request: RunRequest) -> RunResponse:
    """Run the crane through events.

    Parameters
    ----------
    request
        The plant, the actuator and the events.

    Returns
    -------
    RunResponse
        The commands, the motion, and what remains.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule, or the machine cannot do it: what, where and when.
    InfeasibleDesignError
        If the shaper was not found.
    SolverFailedError
        If none of the solutions found was verified.
    TimeLimitError
        If a solver ran past its time.
    """
    case = _case_of(request)
    done = run(case.scenario, request.until_s, request.points)
    return _answer(request, case, done)


def run_picture(request: RunRequest) -> "Figure":
    """Draw the motion that `drive_crane` returns.

    Parameters
    ----------
    request
        The plant, the actuator and the events.

    Returns
    -------
    Figure
        Commands, velocities, and the swing.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule, or the machine cannot do it.
    InfeasibleDesignError
        If the shaper was not found.
    SolverFailedError
        If none of the solutions found was verified.
    TimeLimitError
        If a solver ran past its time.
    """
    from design.pictures.run_sheet import run_sheet  # noqa: PLC0415 - matplotlib takes a second

    case = _case_of(request)
    done = run(case.scenario, request.until_s, request.points)
    return run_sheet(case.plant, case.scenario, done, version())


class _Case(NamedTuple):
    """What is run, and when the last switch of each event is."""

    plant: Plant
    scenario: Scenario
    last_switches_s: list[float]
    warnings: tuple[DesignWarning, ...]


def _case_of(request: RunRequest) -> _Case:
    plant, actuator = subject_of(request)
    crane = _crane_of(request, plant)
    shaper = None
    if isinstance(request.shaping, DelayLine):
        with name_field("shaping"):
            shaper = _shaper_of(request.shaping, crane, plant, actuator, request.speed_m_s)
    with name_field("played"):
        played = _played_of(request)
    drives: list[Drive] = []
    hoists: list[HoistTo] = []
    lasts = []
    late = 0.0 if shaper is None else shaper.duration_s
    for number, event in enumerate(request.events or ()):
        with name_field(f"events.{number}"):
            event.require_one()
            ours = _drives_of(number, event, request.speed_m_s, actuator, shaper)
            if event.cable_length_m is not None and event.over_s is not None:
                hoists.append(_hoist_of(number, event, plant))
        drives += ours
        ends = [one.at_s if one.for_s is None else one.end_s for one in ours]
        over = 0.0 if event.over_s is None else event.over_s
        lasts.append(max(ends) + late if ends else event.at_s + over)
    _require_short(request, crane, actuator, lasts, played)
    _require_few(drives, played, shaper)
    scenario = Scenario(
        crane=crane,
        drive=actuator,
        speed_m_s=request.speed_m_s,
        drives=drives,
        hoists=hoists,
        played=played,
        shaper=shaper,
    )
    return _Case(plant, scenario, lasts, ())


def _crane_of(request: RunRequest, plant: Plant) -> Crane:
    """Return the crane of a request; a mode is a linear one of its frequency."""
    if isinstance(plant, Pendulum):
        length, gravity = plant.cable_length_m, plant.gravity_m_s2
    else:
        if request.model != "linear" or request.load is not None:
            raise InvalidInputError(
                "plant.kind",
                request.plant.kind,
                "pendulum for a nonlinear model or a load",
                code="run_needs_pendulum",
            )
        gravity = STANDARD_GRAVITY_M_S2
        length = gravity / plant.mode.natural_frequency_rad_s**2
    load = None
    if request.load is not None:
        with name_field("load"):
            load = request.load.to_design()
    strokes = request.strokes
    with name_field("plant"):
        return Crane(
            cable_length_m=length,
            damping_ratio=plant.mode.damping_ratio,
            gravity_m_s2=gravity,
            hook_mass_kg=request.hook_mass_kg,
            load=load,
            model=request.model,
            strokes=(
                _stroke_of("x", None if strokes is None else strokes.x),
                _stroke_of("y", None if strokes is None else strokes.y),
            ),
            max_speed_m_s=MAX_VALUE if request.max_speed_m_s is None else request.max_speed_m_s,
            max_cable_length_m=max(MAX_CABLE_M, length),
        )


def _stroke_of(axis: AxisName, stroke: StrokeIn | None) -> Stroke | None:
    if stroke is None:
        return None
    with name_field(f"strokes.{axis}"):
        return stroke.to_design()


def _require_same_swing(
    kind: ShaperKind, options: ShaperOptions, crane: Crane, speed_m_s: float
) -> None:
    """Check that a shaper for large swings is exact for the run."""
    if not kind.large_swings:
        return
    if crane.model != "nonlinear":
        require_small_swings(kind, "runs of the linear model", "kind")
    exact_at = getattr(options, "speed_m_s", None)
    if exact_at is not None and exact_at != speed_m_s:
        raise InvalidInputError(
            "speed_m_s",
            exact_at,
            f"that of the run, {speed_m_s:g}: at another the shaper is not exact",
            code="large_swing_of_other_speed",
        )


def _shaper_of(
    line: DelayLine, crane: Crane, plant: Plant, actuator: Actuator, speed_m_s: float
) -> Impulses:
    """Design the shaper of a delay line, for both modes of a hook with a load."""
    frequencies = crane.frequencies_rad_s(crane.cable_length_m)
    subject = plant
    if len(frequencies) > 1:
        slowest = frequencies[0]
        # The drag is that of the slowest mode: of a quicker one it is a smaller share.
        ratios = [crane.damping_ratio * slowest / one for one in frequencies]
        subject = Modes(
            modes=tuple(
                Mode(natural_frequency_rad_s=one, damping_ratio=ratio)
                for one, ratio in zip(frequencies, ratios, strict=True)
            )
        )
    with name_field("shaper"):
        options = line.shaper.options()
        _require_same_swing(line.shaper.shaper_kind(), options, crane, speed_m_s)
    found = design(subject, actuator, line.shaper.shaper_kind(), options)
    if line.shaper.sample_time_s is not None:
        found, _ = on_samples(found, subject, actuator, line.shaper, line.shaper.sample_time_s)
    return found.impulses


def _played_of(request: RunRequest) -> dict[AxisName, Played]:
    played: dict[AxisName, Played] = {}
    if request.played is None:
        return played
    for axis, course in (("x", request.played.x), ("y", request.played.y)):
        if course is None:
            continue
        with name_field(axis):
            made = course.to_design()
            fastest = abs(made.velocity_m_s).argmax()
            if abs(made.velocity_m_s[fastest]) > request.speed_m_s * (1 + 1e-9):
                raise InvalidInputError(
                    "velocity_m_s" if course.position_m is None else "position_m",
                    f"{made.velocity_m_s[fastest]:.6g} m/s at {made.times_s[fastest]:.9g} s",
                    f"within full speed, {request.speed_m_s:g} m/s",
                    code="played_too_fast",
                )
        played["x" if axis == "x" else "y"] = made
    return played


def _drives_of(
    number: int, event: EventIn, speed_m_s: float, actuator: Actuator, shaper: Impulses | None
) -> list[Drive]:
    """Return what an event commands of the axes."""
    made = []
    if event.direction is not None:
        for axis, level in (("x", event.direction.x), ("y", event.direction.y)):
            if level is not None:
                made.append((axis, level, event.for_s))
    if event.move is not None:
        for axis, distance in (("x", event.move.x_m), ("y", event.move.y_m)):
            if distance != 0:
                with name_field(f"move.{axis}_m"):
                    length = pulse_of_distance(abs(distance), speed_m_s, actuator, shaper)
                made.append((axis, math.copysign(1.0, distance), length))
    return [
        Drive(
            event=number,
            axis="x" if axis == "x" else "y",
            at_s=event.at_s,
            level=level,
            for_s=for_s,
        )
        for axis, level, for_s in made
    ]


def _hoist_of(number: int, event: EventIn, plant: Plant) -> HoistTo:
    if not isinstance(plant, Pendulum):
        raise InvalidInputError(
            "cable_length_m",
            event.cable_length_m,
            "left out where the plant has no cable",
            code="hoist_needs_cable",
        )
    length, over = event.cable_length_m or 0.0, event.over_s or 0.0
    return HoistTo(event=number, at_s=event.at_s, over_s=over, cable_length_m=length)


def _require_short(
    request: RunRequest,
    crane: Crane,
    actuator: Actuator,
    lasts: list[float],
    played: dict[AxisName, Played],
) -> None:
    """Check that the work of a run has an end."""
    lengths = [event.cable_length_m for event in request.events or () if event.cable_length_m]
    shortest = max(min([crane.cable_length_m, *lengths]), 1e-3)
    fastest = crane.frequencies_rad_s(shortest)[-1]
    lags = (actuator.accel_lag, actuator.decel_lag)
    settled = SETTLED * max(lag.first_s + math.sqrt(lag.second_s2) for lag in lags)
    ends = [request.until_s or 0.0, *lasts, *(float(one.times_s[-1]) for one in played.values())]
    longest = MAX_TURN_RAD / fastest
    if max(ends) + settled > longest:
        raise InvalidInputError(
            "until_s",
            f"{max(ends) + settled:.6g} s with the drive's settling",
            f"such that a run lasts at most {longest:.6g} s of this plant",
            code="run_too_long",
        )


def _require_few(
    drives: list[Drive], played: dict[AxisName, Played], shaper: Impulses | None
) -> None:
    steps = 2 * len(drives) + sum(course.times_s.size for course in played.values())
    shaped = steps * (1 if shaper is None else shaper.times_s.size)
    if shaped > MAX_STEPS:
        raise InvalidInputError(
            "played",
            f"{shaped} steps",
            f"of at most {MAX_STEPS} steps once it is shaped",
            code="too_many_shaped_steps",
        )


def _answer(request: RunRequest, case: _Case, done: Run) -> RunResponse:
    camera = None
    if request.camera is not None:
        camera = request.camera.to_design()
    encoder = None
    if request.encoder is not None:
        with name_field("encoder"):
            encoder = request.encoder.to_design()
    reports = None
    if camera is not None or encoder is not None:
        with name_field("camera"):
            seed = 0 if request.camera is None else request.camera.seed
            reports = sensed(done.track, encoder, camera, seed)
    return RunResponse.from_design(
        done,
        [
            (event.at_s, last)
            for event, last in zip(request.events or (), case.last_switches_s, strict=True)
        ],
        reports,
        has_cable=isinstance(case.plant, Pendulum),
        hoisted=bool(case.scenario.hoists),
    )


OPERATION = Operation(
    request=RunRequest,
    response=RunResponse,
    run=drive_crane,
    draw=run_picture,
)
