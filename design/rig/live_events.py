"""Events of a run, shaped live: the command of each axis is solved anew at each of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from design.analysis.certificate import Certificate
from design.errors import InvalidInputError
from design.live.emergency_request import EmergencyRequest
from design.live.hoist import HoistRequest
from design.live.machine import LiveKind, LiveMachine
from design.live.session import SAME_TIME_S, LiveState, Press, event, init
from design.live.state import Plan
from design.model.impulses import Impulses
from design.rig.crane import AXES, AxisName
from design.rig.scenario import Drive, HoistTo, steps_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """An emergency stop of both axes or another kind of shaper, and when it is asked for [s]."""

    at_s: float
    request: EmergencyRequest | LiveKind


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveAnswer:
    """What an event of a run led to.

    Attributes
    ----------
    last_switch_s
        When the last switch of the plans was to be that it led to; a press for some time ends them
        by another one. Of a hoist its end, if that is later [s].
    certificate
        Of these plans, over the whole command until their end.
    ideal
        Whether they are made for an ideal drive.
    fallback
        Why an axis kept an older plan; None where none did.
    """

    last_switch_s: float
    certificate: Certificate
    ideal: bool
    fallback: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveCommands:
    """Commands of the axes that are ever driven, and what each event led to, by its number."""

    commands: dict[AxisName, Impulses]
    answers: dict[int, LiveAnswer]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Moment:
    """What is asked of both axes at a time, and by which events."""

    at_s: float
    request: Press | EmergencyRequest | HoistRequest | LiveKind
    events: frozenset[int]


def live_commands(
    machine: LiveMachine,
    drives: Sequence[Drive],
    asked: Mapping[int, Asked],
    hoists: Sequence[HoistTo] = (),
) -> LiveCommands:
    """Solve the commands of the axes, event after event.

    Parameters
    ----------
    machine
        Drive and modes of both axes.
    drives
        What events ask of the axes, in any order.
    asked
        Emergency stops and kinds of shapers among the events, by their numbers.
    hoists
        What events ask of the cable; none is known before its event.

    Returns
    -------
    LiveCommands
        All that the drives are sent.

    Raises
    ------
    InvalidInputError
        If buttons contradict each other, events come faster than the sample time, the load swings
        beyond the model, or a hoist is not served.
    """
    sent: dict[AxisName, list[tuple[float, float]]] = {axis: [] for axis in AXES}
    answers: dict[int, LiveAnswer] = {}
    state = init(machine)
    for moment in _moments(drives, asked, hoists):
        _send(sent, state, moment.at_s)
        number = min(moment.events)
        try:
            state = event(machine, state, moment.at_s, moment.request)
        except InvalidInputError as error:
            of = f"events.{number}"
            raise error.within(
                f"{of}.shaper" if isinstance(moment.request, LiveKind) else of
            ) from None
        if state.certificate is not None:
            over_s = moment.request.over_s if isinstance(moment.request, HoistRequest) else 0.0
            answer = LiveAnswer(
                last_switch_s=max(state.last_switch_s, moment.at_s + over_s),
                certificate=state.certificate,
                ideal=state.kind.ideal,
                fallback=state.fallback,
            )
            answers.update(dict.fromkeys(moment.events, answer))
    _send(sent, state, np.inf)
    commands = {axis: _steps(switches) for axis, switches in sent.items() if switches}
    return LiveCommands(commands=commands, answers=answers)


def _send(
    sent: dict[AxisName, list[tuple[float, float]]], state: LiveState, before_s: float
) -> None:
    """Note which switches of the plans are sent before a time."""
    plans: dict[AxisName, Plan] = {"x": state.x.plan, "y": state.y.plan}
    for axis, plan in plans.items():
        switches = zip(plan.times_s, plan.levels, strict=True)
        sent[axis] += [one for one in switches if state.time_s <= one[0] < before_s]


def _steps(switches: list[tuple[float, float]]) -> Impulses:
    times, levels = np.array(switches).T
    return Impulses(times_s=times, amplitudes=np.diff(levels, prepend=0.0))


def _moments(
    drives: Sequence[Drive], asked: Mapping[int, Asked], hoists: Sequence[HoistTo]
) -> list[_Moment]:
    """Return what is asked at each time, in order: hoists, kinds, presses, stops."""
    courses = {axis: dict(zip(*map(list, steps_of(drives, axis)), strict=True)) for axis in AXES}
    found: list[_Moment] = []
    for at_s in sorted({time_s for course in courses.values() for time_s in course}):
        events = frozenset(
            one.event
            for one in drives
            if min(abs(one.at_s - at_s), abs(one.end_s - at_s)) <= SAME_TIME_S
        )
        press = Press(x=courses["x"].get(at_s), y=courses["y"].get(at_s))
        found.append(_Moment(at_s=float(at_s), request=press, events=events))
    found += [
        _Moment(at_s=one.at_s, request=one.request, events=frozenset((number,)))
        for number, one in asked.items()
    ]
    for hoist in hoists:
        wanted = HoistRequest(cable_length_m=hoist.cable_length_m, over_s=hoist.over_s)
        found.append(_Moment(at_s=hoist.at_s, request=wanted, events=frozenset((hoist.event,))))
    order = (HoistRequest, LiveKind, Press, EmergencyRequest)
    return sorted(found, key=lambda one: (one.at_s, order.index(type(one.request))))
