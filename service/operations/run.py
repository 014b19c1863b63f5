"""A run of the crane, driven by events."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from design.analysis.warnings import DesignWarning
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.hoisting import Hoisting
from design.model.plants.registry import Plant
from design.rig.crane import AxisName, Crane
from design.rig.hoists import require_taut
from design.rig.live_events import LiveAnswer, live_commands
from design.rig.runs import SETTLED, Run, Scenario, run
from design.rig.scenario import Drive, HoistTo, Played, pulse_of_distance
from design.rig.sensed import sensed
from design.rig.whole_moves import WholeMove
from schemas.base import name_field
from schemas.run_events import EventIn
from schemas.runs import DelayLine, LiveShaping, RunRequest, RunResponse
from service.operations.live_run import asked_live, event_outs, live_machine
from service.operations.operation import Operation
from service.operations.run_crane import (
    CRANES,
    Swinging,
    crane_of,
    one_length_warnings,
    shaper_of,
)
from service.operations.run_moves import MoveDesigner
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
    done = case.run(request)
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
    done = case.run(request)
    return run_sheet(case.plant, case.scenario, done, version())


class _Case(NamedTuple):
    """What is run, and when the last switch of each event is."""

    plant: Plant
    scenario: Scenario
    last_switches_s: list[float]
    warnings: tuple[DesignWarning, ...]
    live: dict[int, LiveAnswer] | None  # What each event led to, in live mode

    def run(self, request: RunRequest) -> Run:
        """Run it, and add what was to know before."""
        done = run(self.scenario, request.until_s, request.points)
        return replace(done, warnings=(*self.warnings, *done.warnings))


def _case_of(request: RunRequest) -> _Case:
    plant, actuator = subject_of(request)
    crane, swinging = crane_of(request, plant)
    with name_field("played"):
        played = _played_of(request)
    hoists = [*swinging.hoists]
    for number, event in enumerate(request.events or ()):
        with name_field(f"events.{number}"):
            event.require_one()
            if event.cable_length_m is not None and event.over_s is not None:
                hoists.append(_hoist_of(number, event, plant, swinging))
    if swinging.cable is not None:
        name = "plant.cable_length_m" if swinging.hoists else "events"
        require_taut(crane.cable_length_m, hoists, crane.gravity_m_s2, name)
    shaper: Impulses | None = None
    warnings: tuple[DesignWarning, ...] = ()
    if isinstance(request.shaping, DelayLine):
        with name_field("shaping"):
            shaper = shaper_of(request.shaping, crane, swinging, plant, actuator, request.speed_m_s)
        if swinging.cable is not None:
            warnings = one_length_warnings(request.shaping, swinging.cable, hoists)
    machine, asked = None, asked_live(request)
    if isinstance(request.shaping, LiveShaping):
        machine = live_machine(request, request.shaping, crane, swinging, plant, actuator)
    designer = MoveDesigner(
        plant=None if crane.load is not None else swinging.cable or swinging.held,
        hoists=hoists,
        actuator=actuator,
        speed_m_s=request.speed_m_s,
    )
    drives: list[Drive] = []
    moves: list[WholeMove] = []
    lasts = []
    late = 0.0 if shaper is None else shaper.duration_s
    for number, event in enumerate(request.events or ()):
        whole, told = designer.moves_of(number, event)
        with name_field(f"events.{number}"):
            ours = _drives_of(number, event, request.speed_m_s, actuator, shaper)
        drives += ours
        moves += whole
        warnings += told
        ends = [one.at_s if one.for_s is None else one.end_s for one in ours]
        over = 0.0 if event.over_s is None else event.over_s
        last = max(ends) + late if ends else event.at_s + over
        lasts.append(max([last, *(move.last_switch_s for move in whole)]))
    live = None if machine is None else live_commands(machine, drives, asked, hoists)
    if live is not None:
        lasts = [live.answers[number].last_switch_s for number in range(len(lasts))]
    _require_short(request, crane, actuator, hoists, lasts, played)
    _require_few(drives, played, shaper)
    scenario = Scenario(
        crane=crane,
        drive=actuator,
        speed_m_s=request.speed_m_s,
        drives=drives,
        moves=moves,
        hoists=hoists,
        played=played,
        shaper=shaper,
        solved=None if live is None else live.commands,
    )
    return _Case(plant, scenario, lasts, warnings, None if live is None else live.answers)


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
    if event.move is not None and event.shaper is None:
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


def _hoist_of(number: int, event: EventIn, plant: Plant, swinging: Swinging) -> HoistTo:
    if swinging.cable is None:
        raise InvalidInputError(
            "cable_length_m",
            event.cable_length_m,
            "left out where the plant has no cable",
            code="hoist_needs_cable",
        )
    if isinstance(plant, Hoisting):
        raise InvalidInputError(
            "cable_length_m",
            event.cable_length_m,
            "left out where the plant is of kind hoisting: it has the lengths over time",
            code="hoist_said_twice",
        )
    length, over = event.cable_length_m or 0.0, event.over_s or 0.0
    return HoistTo(event=number, at_s=event.at_s, over_s=over, cable_length_m=length)


def _require_short(
    request: RunRequest,
    crane: Crane,
    actuator: Actuator,
    hoists: list[HoistTo],
    lasts: list[float],
    played: dict[AxisName, Played],
) -> None:
    """Check that the work of a run has an end."""
    lengths = [hoist.cable_length_m for hoist in hoists]
    shortest = min([crane.cable_length_m, *lengths])
    fastest = crane.frequencies_rad_s(shortest)[-1]
    lags = (actuator.accel_lag, actuator.decel_lag)
    settled = SETTLED * max(lag.first_s + math.sqrt(lag.second_s2) for lag in lags)
    ends = [request.until_s or 0.0, *lasts, *(hoist.at_s + hoist.over_s for hoist in hoists)]
    ends += [float(one.times_s[-1]) for one in played.values()]
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
        event_outs(request, case.last_switches_s, case.live),
        reports,
        has_cable=isinstance(case.plant, CRANES),
        hoisted=bool(case.scenario.hoists),
    )


OPERATION = Operation(
    request=RunRequest,
    response=RunResponse,
    run=drive_crane,
    draw=run_picture,
)
