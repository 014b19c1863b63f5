"""A cable that is hoisted while a crane is driven live: known to its end once it is asked for."""

from dataclasses import replace

import numpy as np
import pytest

from design.live.emergency_request import EmergencyRequest
from design.live.hoist import HoistRequest, gains_of
from design.live.hoist_events import hoist_of
from design.live.hoist_kernel import MAX_ARCS, PARTS, _evaluate
from design.live.machine import LiveKind, LiveMachine
from design.live.session import LiveState, Press, Request, event, init, step
from design.live.state import Plan
from design.model.actuators.rate_limited import Unlimited
from design.model.impulses import Impulses
from design.model.plants.hoisting import Hoisting, LengthCourse
from design.model.plants.mode import Mode
from design.response.hoisting_simulation import simulated_vibration
from design.response.hoisting_vibration import hoisting_vibration
from design.rig.crane import Crane
from design.rig.machine import Machine
from tests.design.live.machines import CRANE, DRIVES, KIM
from tests.refusals import refused

Events = list[tuple[float, Request]]

MACHINE = LiveMachine(plant=CRANE, actuator=KIM)
UP = HoistRequest(cable_length_m=0.5, over_s=2.0)

DRIVEN: Events = [
    (0.0, Press(x=1.0)),
    (0.4, UP),
    (0.83, Press(x=0.0)),
    (1.2, Press(x=1.0)),
    (1.9, Press(x=-1.0)),
    (2.9, Press(x=0.0)),
]
"""Presses, a release and a reversal around a hoist."""

by_drive = pytest.mark.parametrize("drive", DRIVES, ids=range(len(DRIVES)))


def played(
    machine: LiveMachine, events: Events
) -> tuple[list[LiveState], list[tuple[float, float]]]:
    """Return the states after events, and the switches of x that were sent."""
    state, states, sent = init(machine), [], []
    for at_s, request in [*events, (np.inf, None)]:
        switches = zip(state.x.plan.times_s, state.x.plan.levels, strict=True)
        sent += [one for one in switches if state.time_s <= one[0] < at_s]
        if request is not None:
            state = event(machine, state, at_s, request)
            states.append(state)
    return states, sent


def rig_swing(machine: LiveMachine, events: Events, sent: list[tuple[float, float]]) -> float:
    """Return what swings in the integrated crane in the end, over an unshaped step's."""
    crane = machine.plant
    assert not isinstance(crane, Mode)
    rig = Machine(
        Crane(
            cable_length_m=0.8,
            gravity_m_s2=9.81,
            damping_ratio=CRANE.damping_ratio,
            model="linear",
        ),
        (machine.actuator, machine.actuator),
        0.2,
    )
    end_s = 0.0
    for at_s, request in events:
        if isinstance(request, HoistRequest):
            rig.hoist(request.cable_length_m, request.over_s, at_s)
            end_s = max(end_s, at_s + request.over_s)
    for time_s, level in sent:
        rig.command("x", level, time_s)
    rest = rig.advance(max([end_s, *(time_s for time_s, _ in sent)]) + 8.0)
    return float(np.sqrt(rest.swing_energy_j[0] / (0.5 * 0.385 * 0.2**2)))


def random_events(rng: np.random.Generator) -> Events:
    """Return presses, releases and reversals with hoists among them."""
    at_s, events = 0.0, []
    for _ in range(rng.integers(3, 9)):
        at_s += float(rng.exponential(0.6))
        request: Request = Press(x=float(rng.choice([1.0, -1.0, 0.5, 0.0, 0.0])))
        if rng.random() < 0.3:
            length, over = float(rng.uniform(0.3, 1.3)), float(rng.uniform(0.8, 4.0))
            request = HoistRequest(cable_length_m=length, over_s=over)
        events.append((at_s, request))
    return [*events, (at_s + 0.3, Press(x=0.0))]


@by_drive
def test_switches_are_worth_what_the_kernel_says(drive: Unlimited) -> None:
    # The plan's coordinate against the vibration of the same command from rest.
    machine = LiveMachine(plant=CRANE, actuator=drive)
    states, sent = played(machine, [(0.0, UP), (0.3, Press(x=1.0)), (0.7, Press(x=0.5))])
    done = step(machine, replace(states[-1], x=replace(states[-1].x, plan=Plan())), 0.75)
    times, levels = zip(*[one for one in sent if one[0] < 0.7], strict=True)
    command = Impulses(times_s=np.array(times), amplitudes=np.diff(levels, prepend=0.0))
    course = LengthCourse(times_s=(0.0, 2.0), values=(0.8, 0.5))
    plant = Hoisting(cable_length_m=course, gravity_m_s2=9.81)
    known = hoisting_vibration(command, plant, drive)
    assert abs(known) > 0.1
    assert done.x.vibration[0] == pytest.approx(known, abs=1e-12)
    simulated = simulated_vibration(command, plant, drive)
    assert done.x.vibration[0] == pytest.approx(simulated, abs=1e-10)


@by_drive
@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_presses_around_a_hoist_leave_nothing(drive: Unlimited, damping: float) -> None:
    machine = LiveMachine(plant=replace(CRANE, damping_ratio=damping), actuator=drive)
    states, sent = played(machine, DRIVEN)
    for state in states:
        assert state.certificate is not None
        assert state.certificate.verified
        assert state.fallback is None
    assert {abs(level) for _, level in sent} <= {0.0, 1.0}
    if not damping:
        assert rig_swing(machine, DRIVEN, sent) < 1e-9


@pytest.mark.parametrize("drive", [DRIVES[0], DRIVES[1], replace(KIM, dead_time_s=0.15)])
def test_random_strings_with_hoists_end_at_rest(drive: Unlimited) -> None:
    machine = LiveMachine(plant=CRANE, actuator=drive)
    for seed in range(12):
        events = random_events(np.random.default_rng(seed))
        states, sent = played(machine, events)
        assert all(one.certificate is not None and one.certificate.verified for one in states)
        assert all(abs(level) <= 1.0 for _, level in sent)
        assert rig_swing(machine, events, sent) < 1e-7, seed


@by_drive
def test_derivatives_over_switch_times_are_those_of_differences(drive: Unlimited) -> None:
    machine = LiveMachine(plant=CRANE, actuator=drive)
    gains = gains_of(drive, hoist_of(machine, None, LiveKind(), 0.0, UP))
    levels, gaps = np.array([1.0, 0.0, 1.0, 0.0]), np.array([0.31, 0.23, 0.41])

    def swept(moved: np.ndarray) -> np.ndarray:
        lags, rings = np.zeros((MAX_ARCS + 2, 2)), np.zeros((MAX_ARCS + 2, 2))
        lags[0], rings[0] = (0.2, 0.0), (0.1, -0.3)
        _evaluate(
            machine.drive_row,
            gains.ends_s,
            gains.values,
            gains.slopes,
            gains.last,
            gains.pole,
            0.2,
            0.0,
            1,
            levels,
            3,
            moved,
            lags,
            rings,
            np.empty((2, 2 * PARTS)),
        )
        return rings

    found, h = swept(gaps), 1e-6
    for gap in range(3):
        shift = h * np.eye(3)[gap]
        by_difference = (swept(gaps + shift)[0] - swept(gaps - shift)[0]) / (2 * h)
        assert found[2 + gap : 5].sum(axis=0) == pytest.approx(by_difference, abs=1e-7)


def test_a_hoist_to_the_same_length_changes_nothing() -> None:
    events: Events = [(0.0, Press(x=1.0)), (0.4, Press(x=0.0)), (0.7, Press(x=1.0))]
    _, plain = played(MACHINE, events)
    same = HoistRequest(cable_length_m=0.8, over_s=2.0)
    _, held = played(MACHINE, [(0.0, same), *events])
    assert np.array(held) == pytest.approx(np.array(plain), abs=1e-10)


def test_a_hoist_that_is_asked_for_in_two_parts_is_one() -> None:
    halves: Events = [
        (0.4, HoistRequest(cable_length_m=0.65, over_s=1.0)),
        (1.4, HoistRequest(cable_length_m=0.5, over_s=1.0)),
    ]
    states, sent = played(MACHINE, [DRIVEN[0], *halves, *DRIVEN[4:]])
    _, whole = played(MACHINE, [DRIVEN[0], DRIVEN[1], *DRIVEN[4:]])
    assert rig_swing(MACHINE, [DRIVEN[0], *halves, *DRIVEN[4:]], sent) < 1e-9
    assert states[-1].hoist is not None
    assert len(sent) == len(whole)
    # Asked for anew while it lasts: the same course, and the same coordinate at its end.
    again: Events = [(1.0, HoistRequest(cable_length_m=0.5, over_s=1.4))]
    _, anew = played(MACHINE, [DRIVEN[0], DRIVEN[1], *again, *DRIVEN[4:]])
    assert np.array(anew) == pytest.approx(np.array(whole), abs=1e-9)


def test_mirrored_and_later_events_get_the_mirrored_and_later_command() -> None:
    def moved(by_s: float, sign: float) -> list[tuple[float, float]]:
        events: Events = []
        for at_s, one in DRIVEN:
            request = one
            if isinstance(one, Press) and one.x is not None:
                request = Press(x=sign * one.x)
            events.append((at_s + by_s, request))
        return played(MACHINE, events)[1]

    first = np.array(moved(0.0, 1.0))
    assert np.array(moved(0.0, -1.0)) == pytest.approx(first * [1, -1], abs=1e-9)
    assert np.array(moved(7.0, 1.0)) == pytest.approx(first + np.array([7, 0]), abs=1e-9)


def test_an_emergency_stop_during_a_hoist_is_a_release() -> None:
    stop: Events = [DRIVEN[0], DRIVEN[1], (1.3, EmergencyRequest())]
    release: Events = [*stop[:2], (1.3, Press(x=0.0, y=0.0))]
    (*_, stopped), sent = played(MACHINE, stop)
    _, known = played(MACHINE, release)
    assert sent == known
    assert stopped.certificate is not None
    assert stopped.certificate.verified


def test_a_load_at_rest_needs_no_switch() -> None:
    states, sent = played(MACHINE, [(0.0, UP)])
    assert not sent
    assert step(MACHINE, states[-1], 3.0).x.vibration == (0.0,)


def test_hoists_that_are_not_served_are_refused() -> None:
    start = init(MACHINE)
    with refused("hoisted_through_zero", "cable_length_m", says="suspension"):
        HoistRequest(cable_length_m=0.0, over_s=1.0)
    with refused("hoisted_through_zero", "cable_length_m"):
        HoistRequest(cable_length_m=float("nan"), over_s=1.0)
    with refused("course_too_wide", "cable_length_m", says="1000"):
        event(MACHINE, start, 0.0, HoistRequest(cable_length_m=1000.0, over_s=1e3))
    with refused("course_too_long", "over_s"):
        event(MACHINE, start, 0.0, HoistRequest(cable_length_m=0.5, over_s=1e5))
    for name in ("numzvd", "umzv"):
        machine = replace(MACHINE, kind=LiveKind(name=name))
        with refused("kind_not_hoisted_live", "cable_length_m", says=name):
            event(machine, init(machine), 0.0, UP)
    hoisted = event(MACHINE, start, 0.0, UP)
    with refused("kind_not_hoisted_live", "kind", says="numzvd"):
        event(MACHINE, hoisted, 0.1, LiveKind(name="numzvd"))
    limited = replace(MACHINE, deflection_limit=0.5)
    with refused("hoist_with_deflection_limit", "cable_length_m"):
        event(limited, init(limited), 0.0, UP)
    no_cable = replace(MACHINE, plant=Mode(natural_frequency_rad_s=3.5))
    with refused("hoist_not_live", "cable_length_m", says="delay line"):
        event(no_cable, init(no_cable), 0.0, UP)


def test_a_swing_too_small_for_a_pulse_is_left_and_said() -> None:
    # What the lag leaves is of the first length: on another it is a little swing.
    states, sent = played(MACHINE, [(0.0, Press(x=1.0)), (1.6, UP)])
    (claim,) = states[-1].certificate.claims if states[-1].certificate is not None else ()
    assert len(sent) == 3
    assert 1e-10 < claim.value < claim.limit == 1e-7
    assert claim.holds


def test_a_switch_that_is_due_at_once_is_sent_behind_a_dead_time() -> None:
    # 0.7 s and 0.15 s and back are not 0.7 s.
    late = replace(MACHINE, actuator=replace(KIM, dead_time_s=0.15))
    for at_s in np.linspace(0.3, 2.9, 20).tolist():
        events: Events = [(0.0, Press(x=1.0)), (at_s, Press(x=0.0))]
        _, sent = played(late, events)
        assert rig_swing(late, events, sent) < 1e-9
