"""Random strings of events for a crane driven live, and what the integrated crane makes of them."""

from collections.abc import Iterator

import numpy as np

from design.live.emergency_request import EmergencyRequest
from design.live.hoist import HoistRequest
from design.live.machine import LiveKind, LiveMachine
from design.live.session import LiveState, Press, Request, event, init
from design.rig.crane import Crane
from design.rig.machine import Machine
from tests.design.live.machines import CRANE, DRIVES

Events = list[tuple[float, Request]]
Sent = dict[str, list[tuple[float, float]]]

SPEED_M_S = 0.2
KINDS = ("numzv", "numzvd")


def _request(rng: np.random.Generator, hoists: bool) -> Request:
    """Draw what is asked for at one event."""
    chosen, level = rng.random(), float(rng.choice([1.0, -1.0, 0.5, -0.5, 0.0, 0.0]))
    if hoists and chosen < 0.25:
        length, over = float(rng.uniform(0.3, 1.3)), float(rng.uniform(0.8, 4.0))
        return HoistRequest(cable_length_m=length, over_s=over)
    if chosen < 0.1:
        return LiveKind(name=str(rng.choice(KINDS)))
    if chosen < 0.3:
        return Press(x=level, y=float(rng.choice([level, -level])))
    return Press(x=level)


def random_strings(number: int) -> Iterator[tuple[LiveMachine, Events]]:
    """Yield machines with events: presses, reversals, diagonals, kinds, stops, and some hoists."""
    for seed in range(number):
        rng = np.random.default_rng(seed)
        hoists = seed % 5 == 0
        kind = LiveKind(name="numzv" if hoists else KINDS[seed % 2])
        machine = LiveMachine(plant=CRANE, actuator=DRIVES[seed % 7 % 5], kind=kind)
        at_s, events = 0.0, []
        for _ in range(rng.integers(2, 9)):
            at_s += float(rng.exponential(0.7)) if rng.random() < 0.8 else float(rng.uniform(1, 4))
            request = _request(rng, hoists)
            if not (hoists and isinstance(request, LiveKind)):
                events.append((at_s, request))
        if not hoists and seed % 4 == 1:
            events.append((at_s + 0.2, EmergencyRequest(swing_left=0.05, within_periods=1.0)))
        yield machine, events


def played(machine: LiveMachine, events: Events) -> tuple[list[LiveState], Sent]:
    """Return the states after events, and the switches that were sent to each axis."""
    state, states = init(machine), []
    sent: Sent = {"x": [], "y": []}
    for at_s, request in [*events, (np.inf, None)]:
        for axis, switches in sent.items():
            plan = getattr(state, axis).plan
            pairs = zip(plan.times_s, plan.levels, strict=True)
            switches += [one for one in pairs if state.time_s <= one[0] < at_s]
        if request is not None:
            state = event(machine, state, at_s, request)
            states.append(state)
    return states, sent


def swing_left(machine: LiveMachine, events: Events, sent: Sent) -> float:
    """Return what swings in the integrated linear crane in the end, over an unshaped step's."""
    crane = Crane(cable_length_m=0.8, gravity_m_s2=9.81, model="linear")
    rig = Machine(crane, (machine.actuator, machine.actuator), SPEED_M_S)
    end_s = 0.0
    for at_s, request in events:
        if isinstance(request, HoistRequest):
            rig.hoist(request.cable_length_m, request.over_s, at_s)
            end_s = max(end_s, at_s + request.over_s)
    for axis, switches in sent.items():
        for time_s, level in switches:
            rig.command("x" if axis == "x" else "y", level, time_s)
            end_s = max(end_s, time_s)
    rest = rig.advance(end_s + 8.0)
    unshaped_j = 0.5 * 0.385 * SPEED_M_S**2
    return float(np.sqrt(rest.swing_energy_j[0] / unshaped_j))
