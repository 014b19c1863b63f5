"""Live shaping: theory's figures, invariance, another route, and strings of random events."""

from dataclasses import replace

import numpy as np
import pytest

from design.live.machine import LiveKind, LiveMachine
from design.live.session import LiveState, Press, Request, event, init, step
from design.model.actuators.rate_limited import Unlimited
from design.model.actuators.second_order import SecondOrder
from design.model.plants.double_pendulum import DoublePendulum
from design.model.plants.mode import Mode
from design.rig.crane import Crane
from design.rig.machine import Machine
from tests.design.live.machines import CRANE, DRIVES, KIM
from tests.refusals import refused

MACHINE = LiveMachine(plant=CRANE, actuator=KIM)
Events = list[tuple[float, Request]]

by_drive = pytest.mark.parametrize("drive", DRIVES)


def played(machine: LiveMachine, events: Events) -> list[LiveState]:
    """Return the state after each event."""
    states = [init(machine)]
    for at_s, request in events:
        states.append(event(machine, states[-1], at_s, request))
    return states[1:]


def commands(machine: LiveMachine, events: Events) -> dict[str, tuple[list[float], list[float]]]:
    """Return the times and levels that each axis was sent in the end."""
    sent: dict[str, tuple[list[float], list[float]]] = {"x": ([], []), "y": ([], [])}
    states = played(machine, events)
    ends = [at_s for at_s, _ in events[1:]] + [np.inf]
    for state, end_s in zip(states, ends, strict=True):
        for axis, (times, levels) in sent.items():
            plan = getattr(state, axis).plan
            for time_s, level in zip(plan.times_s, plan.levels, strict=True):
                if time_s < end_s:
                    times.append(time_s)
                    levels.append(level)
    return sent


def largest(state: LiveState) -> float:
    """Return the largest share that the certificate finds."""
    assert state.certificate is not None
    return max(claim.value for claim in state.certificate.claims)


def random_events(rng: np.random.Generator, kinds: tuple[str, ...]) -> Events:
    """Return presses, releases, reversals, two speeds, diagonals and other kinds of shapers."""
    at_s, events = 0.0, []
    for _ in range(rng.integers(2, 9)):
        at_s += float(rng.exponential(0.7)) if rng.random() < 0.8 else float(rng.uniform(1, 4))
        chosen, level = rng.random(), float(rng.choice([1.0, -1.0, 0.5, -0.5, 0.0, 0.0]))
        request: Request = Press(x=level)
        if chosen < 0.1 and len(kinds) > 1:
            request = LiveKind(name=str(rng.choice(kinds)))
        elif chosen < 0.3:
            request = Press(x=level, y=float(rng.choice([level, -level])))
        events.append((at_s, request))
    return events


def test_releases_at_any_time_leave_nothing_as_theory_says() -> None:
    # THEORY section 10: .595 s (median), .897 s (most), within 1e-8 in 40 of 40.
    lasting, left = [], []
    for press_s in np.random.default_rng(1).uniform(0.05, 2.5, 40).tolist():
        released = played(MACHINE, [(0.0, Press(x=1.0)), (press_s, Press(x=0.0))])[-1]
        assert released.fallback is None
        assert set(released.x.plan.levels) <= {0.0, 1.0}
        lasting.append(released.last_switch_s - press_s)
        left.append(largest(released))
    assert max(left) < 1e-10
    assert float(np.median(lasting)) == pytest.approx(0.5954, abs=1e-4)
    assert max(lasting) == pytest.approx(0.8971, abs=1e-4)


def test_a_press_from_rest_is_the_thesis_shaper() -> None:
    superposed = LiveMachine(plant=CRANE, actuator=replace(KIM, model="superposed"))
    pressed = played(superposed, [(0.0, Press(x=1.0))])[-1]
    assert pressed.x.plan.times_s == pytest.approx((0.0, 0.32126352, 0.60069086), abs=5e-9)
    flat = replace(superposed, kind=LiveKind(name="numzvd"))
    pressed = played(flat, [(0.0, Press(x=1.0))])[-1]
    known = (0.0, 0.18211712, 0.66033323, 1.18087995, 1.32079496)
    assert pressed.x.plan.times_s == pytest.approx(known, abs=5e-9)
    switched = LiveMachine(plant=CRANE, actuator=KIM, kind=LiveKind(name="numzvd"))
    pressed = played(switched, [(0.0, Press(x=1.0))])[-1]
    known = (0.0, 0.18438833, 0.65977743, 1.17966024, 1.31812003)
    assert pressed.x.plan.times_s == pytest.approx(known, abs=5e-9)


@by_drive
@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
def test_random_strings_of_events_end_at_rest_within_range(drive: Unlimited, kind: str) -> None:
    machine = LiveMachine(plant=CRANE, actuator=drive, kind=LiveKind(name=kind))
    states = []
    for seed in range(25):
        rng = np.random.default_rng(seed)
        states += played(machine, random_events(rng, (kind, "numzv", "umzv")))
    assert all(state.certificate is not None and state.certificate.verified for state in states)
    assert sum(state.fallback is not None for state in states) <= 0.02 * len(states)
    levels = [
        abs(one) for state in states for axis in (state.x, state.y) for one in axis.plan.levels
    ]
    assert max(levels) <= 1.0


@by_drive
def test_mirrored_events_get_the_mirrored_command(drive: Unlimited) -> None:
    machine = LiveMachine(plant=CRANE, actuator=drive)
    events: Events = [(0.0, Press(x=1.0)), (0.4, Press(x=-0.5)), (0.9, Press(x=0.0))]
    mirrored: Events = [(0.0, Press(x=-1.0)), (0.4, Press(x=0.5)), (0.9, Press(x=0.0))]
    (times, levels), (others, mirror) = (commands(machine, one)["x"] for one in (events, mirrored))
    assert times == others
    assert levels == [-one for one in mirror]


def test_a_later_start_shifts_the_command() -> None:
    events: Events = [(0.0, Press(x=1.0)), (0.4, Press(x=0.0)), (0.7, Press(x=1.0))]
    later = [(at_s + 5.0, request) for at_s, request in events]
    (times, levels), (shifted, same) = (commands(MACHINE, one)["x"] for one in (events, later))
    assert shifted == pytest.approx([one + 5.0 for one in times], abs=1e-10)
    assert levels == same


def test_a_machine_of_half_the_pace_takes_twice_the_time() -> None:
    slow_drive = SecondOrder(
        accel=replace(KIM.accel, natural_frequency_rad_s=10.0),
        decel=replace(KIM.decel, natural_frequency_rad_s=25.0),
        model="switched",
    )
    mode = CRANE.mode.natural_frequency_rad_s
    slow = LiveMachine(plant=Mode(natural_frequency_rad_s=mode / 2), actuator=slow_drive)
    events: Events = [(0.0, Press(x=1.0)), (0.4, Press(x=0.0)), (0.7, Press(x=1.0))]
    times, _ = commands(MACHINE, events)["x"]
    slowly, _ = commands(slow, [(2 * at_s, request) for at_s, request in events])["x"]
    assert slowly == pytest.approx([2 * one for one in times], abs=1e-9)


def test_a_diagonal_has_the_same_switches_on_both_axes() -> None:
    events: Events = [(0.0, Press(x=1.0, y=1.0)), (0.5, Press(x=0.0, y=0.0))]
    sent = commands(MACHINE, events)
    assert sent["x"] == sent["y"]


@pytest.mark.parametrize("moved", [*DRIVES, replace(KIM, dead_time_s=0.15)])
def test_the_rig_comes_to_rest(moved: Unlimited) -> None:
    machine = LiveMachine(plant=CRANE, actuator=moved)
    for seed in range(3):
        events = random_events(np.random.default_rng(seed), ("numzv",))
        events.append((events[-1][0] + 0.3, Press(x=0.0, y=0.0)))
        rig = Machine(
            Crane(cable_length_m=0.8, gravity_m_s2=9.81, model="linear"), (moved, moved), 0.2
        )
        sent = commands(machine, events)
        for axis, (times, levels) in sent.items():
            for time_s, level in zip(times, levels, strict=True):
                rig.command("x" if axis == "x" else "y", level, time_s)
        ends = [times[-1] for times, _ in sent.values() if times]
        rest = rig.advance(max(ends, default=0.0) + 8.0)
        # One unshaped step swings with energy v^2 / 2 of a unit mass.
        unshaped_j = 0.5 * 0.385 * 0.2**2
        assert float(rest.swing_energy_j[0]) < (1e-6) ** 2 * unshaped_j


def test_a_plan_goes_on_between_events() -> None:
    pressed = played(MACHINE, [(0.0, Press(x=1.0))])[-1]
    stepped = step(MACHINE, step(MACHINE, pressed, 0.32), 0.45)
    at_once = event(MACHINE, pressed, 0.45, Press(x=0.0))
    by_steps = event(MACHINE, stepped, 0.45, Press(x=0.0))
    assert at_once.x.plan.times_s == pytest.approx(by_steps.x.plan.times_s, abs=1e-12)


def test_a_plan_is_kept_while_nothing_else_is_asked_for() -> None:
    pressed, again = played(MACHINE, [(0.0, Press(x=1.0)), (0.1, Press(x=1.0, y=0.0))])
    assert again.x.plan.times_s == pressed.x.plan.times_s[1:]


def test_a_shaper_for_an_ideal_drive_is_proven_for_that_alone() -> None:
    ideal = replace(MACHINE, kind=LiveKind(name="umzv"))
    pressed = played(ideal, [(0.0, Press(x=1.0))])[-1]
    period_s = CRANE.mode.period_s
    assert pressed.x.plan.times_s == pytest.approx((0.0, period_s / 6, period_s / 3))
    assert largest(pressed) < 1e-10
    done = step(ideal, pressed, pressed.last_switch_s)
    assert abs(done.x.vibration[0]) > 0.05


def test_another_kind_serves_the_plans_from_then_on() -> None:
    events: Events = [
        (0.0, Press(x=1.0)),
        (0.2, LiveKind(name="numzvd")),
        (2.0, Press(x=0.0)),
    ]
    pressed, changed, released = played(MACHINE, events)
    assert changed.x.plan.times_s == pressed.x.plan.times_s[1:]
    assert len(released.x.plan.times_s) == 5
    assert released.certificate is not None
    assert [claim.quantity for claim in released.certificate.claims] == ["residual", "slope"]
    assert released.certificate.verified


def test_two_modes_start_in_the_least_time_known() -> None:
    # THEORY section 11: five steps, switched.
    load = DoublePendulum(
        hook_mass_kg=0.385,
        load_mass_kg=0.6,
        cable_length_m=0.8,
        load_length_m=0.25,
        gravity_m_s2=9.81,
    )
    machine = LiveMachine(plant=load, actuator=KIM, kind=LiveKind(name="num_multi"))
    pressed, released = played(machine, [(0.0, Press(x=1.0)), (1.4, Press(x=0.0))])
    known = (0.0, 0.2421622, 0.37058803, 0.54579808, 0.74026527)
    assert pressed.x.plan.times_s == pytest.approx(known, abs=1e-7)
    assert released.fallback is None
    assert largest(released) < 1e-10


def test_what_cannot_happen_is_refused() -> None:
    pressed = played(MACHINE, [(1.0, Press(x=1.0))])[-1]
    with refused("event_in_the_past", "at_s", says="1 s"):
        event(MACHINE, pressed, 0.5, Press(x=0.0))
    with refused("event_in_the_past", "at_s"):
        step(MACHINE, pressed, float("nan"))
    with refused("out_of_range", "x", says="between -1 and 1"):
        Press(x=1.5)
    sampled = replace(MACHINE, sample_time_s=0.05)
    with refused("event_within_sample", "at_s", says="0.05 s"):
        played(sampled, [(0.0, Press(x=1.0)), (0.02, Press(x=0.0))])
    small = replace(MACHINE, largest_swing=0.5)
    with refused("swing_beyond_model", "at_s", says="0.5 unshaped steps"):
        played(small, [(0.0, Press(x=1.0)), (0.2, Press(x=0.0))])
