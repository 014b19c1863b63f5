"""A session from message to message: `begin`, `happen` and `look`.

A session is bytes: the crane, its commands and a few snapshots of it. Whoever holds them may give
them to any worker, and nothing is lost with one. A worker looks a little ahead; an event that comes
before what has been seen goes back to the snapshot before it.
"""

import math
import pickle
from dataclasses import dataclass, field, replace

import numpy as np
from pydantic import ValidationError

from design.errors import DesignError, InvalidInputError
from design.live.hoist import HoistRequest
from design.live.session import Press, init
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.rig.crane import AXES, require_cable
from design.rig.machine import Machine
from design.rig.runs import unshaped_energy_j
from design.rig.track import Track
from schemas.base import name_field
from schemas.certificates import CertificateOut
from schemas.live import LiveAxisOut, LiveMessage, LivePlanOut, LiveStateOut
from schemas.run_events import HappeningIn
from schemas.runs import CommandsOut, CourseOut, DelayLine, LiveShaping, RunRequest
from service.live.commands import Commands, Convolved, Planned, Resolved, Switch
from service.operations.live_run import live_machine, next_kind, refuse_without_live
from service.operations.run_crane import crane_of, shaper_of
from service.operations.subject import subject_of
from service.problems import (
    Problem,
    problem_of_design,
    problem_of_repetition,
    problem_of_validation,
)
from service.repeated_names import RepeatedNameError
from service.strict_json import loads
from service.version import version

AHEAD_S = 1.0
"""How far a look ahead goes [s]."""

STATES_HZ = 60
"""How many states are sent in a second [Hz]."""

SNAPSHOTS = 3
"""How many are kept: an event comes within the last looks [-]."""

NOT_LIVE = ("events", "played", "camera", "encoder", "until_s", "points")
"""Fields of a run that a live session has no use for."""

NOT_NOW = ("for_s", "move")
"""Events of a run that last: live, a release comes when it comes."""


@dataclass(frozen=True)
class Seen:
    """What a worker has made of a session.

    Attributes
    ----------
    session
        The session, for the next call.
    states
        Messages by the time at which each is to be sent [s].
    messages
        Messages to be sent at once.
    until_s
        How far the states go [s].
    moving
        Whether a command is on, or still to come.
    last_switch_s
        When the last switch is [s].
    proven
        Whether nothing swings from then on, by a certificate for the drive given.
    """

    session: bytes
    states: tuple[tuple[float, bytes], ...]
    messages: tuple[bytes, ...]
    until_s: float
    moving: bool
    last_switch_s: float
    proven: bool


@dataclass(frozen=True, kw_only=True)
class _Session:
    """Snapshots are by time, the last one as far as was seen."""

    actuator: Actuator
    commands: Commands
    has_cable: bool
    snapshots: tuple[tuple[float, Machine], ...]
    levels: tuple[float, float] = (0.0, 0.0)  # Before the first of the switches that come
    coming: tuple[Switch, ...] = ()
    last_switch_s: float = 0.0
    proven: bool = False
    events: int = 0
    unshaped_j: dict[float, float] = field(default_factory=dict)


def begin(body: bytes) -> Seen | Problem:
    """Begin a session.

    Parameters
    ----------
    body
        A run without events, as JSON.

    Returns
    -------
    Seen or Problem
        The crane at rest, or what is wrong with the run.
    """
    try:
        request = RunRequest.model_validate_json(body)
        loads(body)  # every name stands once
        session = _begun(request)
    except ValidationError as error:
        return problem_of_validation(error, body, RunRequest)
    except RepeatedNameError as error:
        return problem_of_repetition(error)
    except DesignError as error:
        return problem_of_design(error, body)
    hello = LiveMessage(version=version()).model_dump_json().encode()
    return _looked(session, 0.0, AHEAD_S, (hello,))


def look(session: bytes, until_s: float) -> Seen | Problem:
    """Look ahead.

    Parameters
    ----------
    session
        As of `Seen`.
    until_s
        How far [s].

    Returns
    -------
    Seen or Problem
        The states until then; or what the crane met, a stroke's end for one.
    """
    held: _Session = pickle.loads(session)
    try:
        return _looked(held, held.snapshots[-1][0], until_s, ())
    except DesignError as error:
        return problem_of_design(error)


def happen(session: bytes, at_s: float, body: bytes) -> Seen | Problem:
    """Take an event.

    Parameters
    ----------
    session
        As of `Seen`.
    at_s
        When it happens: now [s].
    body
        An event of a run without its time, as JSON.

    Returns
    -------
    Seen or Problem
        The commands that it leads to, and the states from then on; or why it is refused.
    """
    held: _Session = pickle.loads(session)
    try:
        happening = HappeningIn.model_validate_json(body)
        loads(body)  # every name stands once
        happening.require_one()
        return _happened(held, at_s, happening)
    except ValidationError as error:
        return problem_of_validation(error, body, HappeningIn)
    except RepeatedNameError as error:
        return problem_of_repetition(error)
    except DesignError as error:
        return problem_of_design(error, body)


def _begun(request: RunRequest) -> _Session:
    for name in NOT_LIVE:
        if name in request.model_fields_set and getattr(request, name) is not None:
            raise InvalidInputError(
                name,
                "a value",
                "left out in a live session, whose events come one by one",
                code="not_in_live_session",
            )
    plant, actuator = subject_of(request)
    crane, swinging = crane_of(request, plant)
    if swinging.hoists:
        raise InvalidInputError(
            "plant.kind",
            request.plant.kind,
            "one whose cable is hoisted by events in a live session",
            code="course_in_live_session",
        )
    commands: Commands
    if request.deflection_limit is not None and not isinstance(request.shaping, LiveShaping):
        refuse_without_live("deflection_limit", request.deflection_limit)
    if isinstance(request.shaping, LiveShaping):
        machine = live_machine(request, request.shaping, crane, swinging, plant, actuator)
        commands = Resolved(machine, init(machine))
    elif isinstance(request.shaping, DelayLine):
        with name_field("shaping"):
            shaper = shaper_of(request.shaping, crane, swinging, plant, actuator, request.speed_m_s)
            commands = Convolved(shaper)
    else:
        commands = Convolved(Impulses(times_s=np.zeros(1), amplitudes=np.ones(1)))
    return _Session(
        actuator=actuator,
        commands=commands,
        has_cable=swinging.cable is not None,
        snapshots=((0.0, Machine(crane, (actuator, actuator), request.speed_m_s)),),
    )


def _happened(held: _Session, at_s: float, happening: HappeningIn) -> Seen:
    for name in NOT_NOW:
        if getattr(happening, name) is not None:
            raise InvalidInputError(
                name,
                "a value",
                "left out in a live session, whose events come one by one",
                code="not_in_live_session",
            )
    at_s, machine = _machine_at(held, at_s)
    direction = happening.direction
    press = Press() if direction is None else Press(x=direction.x, y=direction.y)
    stop, hoist = happening.emergency(), _hoist_of(happening, machine)
    kind = next_kind(happening, live=isinstance(held.commands, Resolved))
    commands: Commands
    if isinstance(held.commands, Resolved):
        commands, planned = held.commands.pressed(at_s, stop or hoist or kind or press)
    elif stop is not None:
        refuse_without_live("stop", happening.stop)
    else:
        commands, planned = held.commands.pressed(at_s, press)
    for axis in AXES:
        machine.withdraw(axis)
    for switch in planned.switches:
        machine.command(switch.axis, switch.level, switch.at_s)
    last = max([at_s, *(switch.at_s for switch in planned.switches)])
    if hoist is not None:
        machine.hoist(hoist.cable_length_m, hoist.over_s)
        last = max(last, at_s + hoist.over_s)
    session = replace(
        held,
        commands=commands,
        snapshots=((at_s, machine),),
        levels=_levels_at(held, at_s),
        coming=planned.switches,
        last_switch_s=last,
        proven=planned.certificate is not None
        and planned.certificate.verified
        and not planned.ideal,
        events=held.events + 1,
    )
    plan = LivePlanOut(
        at_s=at_s,
        event=session.events,
        command=_commands_out(planned),
        last_switch_s=last,
        certificate=None
        if planned.certificate is None
        else CertificateOut.from_design(planned.certificate, given=not planned.ideal),
        fallback=planned.fallback,
    )
    message = LiveMessage(plan=plan).model_dump_json().encode()
    return _looked(session, at_s, at_s + AHEAD_S, (message,))


def _hoist_of(happening: HappeningIn, machine: Machine) -> HoistRequest | None:
    if happening.cable_length_m is None or happening.over_s is None:
        return None
    require_cable(happening.cable_length_m, machine.crane.max_cable_length_m)
    return HoistRequest(cable_length_m=happening.cable_length_m, over_s=happening.over_s)


def _machine_at(held: _Session, at_s: float) -> tuple[float, Machine]:
    """Return the crane at a time, from the snapshot before it, and the time."""
    at_s = max(at_s, held.snapshots[0][0])
    before_s, machine = max(
        (one for one in held.snapshots if one[0] <= at_s), key=lambda one: one[0]
    )
    if at_s > before_s:
        machine.advance(at_s)
    return at_s, machine


def _levels_at(held: _Session, at_s: float) -> tuple[float, float]:
    levels = dict(zip(AXES, held.levels, strict=True))
    for switch in held.coming:
        if switch.at_s < at_s:
            levels[switch.axis] = switch.level
    return levels["x"], levels["y"]


def _commands_out(planned: Planned) -> CommandsOut:
    courses = {}
    for axis in AXES:
        ours = [one for one in planned.switches if one.axis == axis]
        if ours:
            courses[axis] = CourseOut(
                times_s=[one.at_s for one in ours], levels=[one.level for one in ours]
            )
    return CommandsOut(**courses)


def _looked(held: _Session, from_s: float, until_s: float, messages: tuple[bytes, ...]) -> Seen:
    """Go on from the last snapshot, and keep one of where that was."""
    until_s = max(until_s, from_s)
    first = math.floor(from_s * STATES_HZ) + 1
    times = np.arange(first, math.floor(until_s * STATES_HZ) + 1) / STATES_HZ
    until_s = float(times[-1]) if times.size else from_s
    snapshots = held.snapshots
    ahead: Machine = pickle.loads(pickle.dumps(snapshots[-1][1]))
    track = ahead.advance(until_s, times)
    snapshots = (*snapshots, (until_s, ahead))[-SNAPSHOTS:]
    states = _states(held, track)
    session = replace(held, snapshots=snapshots)
    return Seen(
        session=pickle.dumps(session),
        states=tuple(zip(times.tolist(), states, strict=True)),
        messages=messages,
        until_s=until_s,
        moving=_moving(session),
        last_switch_s=session.last_switch_s,
        proven=session.proven,
    )


def _moving(held: _Session) -> bool:
    return held.last_switch_s > held.snapshots[0][0] or any(_levels_at(held, math.inf))


def _states(held: _Session, track: Track) -> list[bytes]:
    speed = held.snapshots[0][1].speed_m_s
    position, velocity = track.position_m.tolist(), track.velocity_m_s.tolist()
    deflection, angle = track.load_m.tolist(), track.angle_rad.tolist()
    lengths, energy = track.cable_length_m.tolist(), track.swing_energy_j.tolist()
    states = []
    for row, at_s in enumerate(track.times_s.tolist()):
        levels = _levels_at(held, math.nextafter(at_s, math.inf))
        axes = [
            LiveAxisOut.model_construct(
                command_m_s=speed * levels[which],
                velocity_m_s=velocity[row][which],
                position_m=position[row][which],
                deflection_m=deflection[row][which],
                angle_rad=angle[row][which] if held.has_cable else None,
            )
            for which in range(len(AXES))
        ]
        state = LiveStateOut.model_construct(
            at_s=at_s,
            x=axes[0],
            y=axes[1],
            cable_length_m=lengths[row] if held.has_cable else None,
            swing=math.sqrt(max(energy[row], 0.0) / _unshaped_j(held, lengths[row])),
        )
        states.append(LiveMessage.model_construct(state=state).model_dump_json().encode())
    return states


def _unshaped_j(held: _Session, cable_length_m: float) -> float:
    """Return the energy after an unshaped step, of a cable as long within a hundredth [J]."""
    length = math.exp(round(math.log(cable_length_m), 2))
    if length not in held.unshaped_j:
        machine = held.snapshots[0][1]
        crane = replace(machine.crane, cable_length_m=length)
        held.unshaped_j[length] = unshaped_energy_j(crane, held.actuator, machine.speed_m_s)
    return held.unshaped_j[length]
