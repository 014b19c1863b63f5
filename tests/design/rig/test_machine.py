"""The machine as it is commanded: its steps, its bounds, and what it refuses."""

import math
from dataclasses import replace

import numpy as np
import pytest

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.rig.crane import Crane, Load, Stroke
from design.rig.machine import Machine
from design.rig.march import ROW_SIZE
from tests.design.rig.cranes import CRANE, THESIS, command_all, played, random_drive, random_levels
from tests.refusals import refused

PULSE = Impulses(times_s=np.array([0.0, 1.5]), amplitudes=np.array([1.0, -1.0]))
SLOW_STOP = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.5)


@pytest.mark.parametrize("seed", range(20))
def test_going_on_sample_by_sample_is_going_on_at_once(seed: int) -> None:
    rng = np.random.default_rng(seed)
    drives = random_drive(rng, 0.5), random_drive(rng, 0.5)
    crane = Crane(cable_length_m=0.9, load=Load(mass_kg=0.4, length_m=0.3) if seed % 2 else None)
    commands = [
        (axis, float(level), float(time))
        for axis in ("x", "y")
        for time, level in zip(*random_levels(rng, 8), strict=True)
    ]
    times = np.sort(np.append(rng.uniform(0, 4, 200), 4.0))
    whole = Machine(crane, drives, 0.5)
    for axis, level, time in commands:
        whole.command("x" if axis == "x" else "y", level, time)
    whole.hoist(0.6, 1.7, at_s=0.8)
    rows = whole.advance(4.0, times).rows
    stepped = Machine(crane, drives, 0.5)
    stepped.hoist(0.6, 1.7, at_s=0.8)
    found = np.empty((0, ROW_SIZE))
    commands.sort(key=lambda command: command[2])
    for time in times.tolist():
        while commands and commands[0][2] <= time:
            axis, level, at = commands.pop(0)
            stepped.advance(at)
            stepped.command("x" if axis == "x" else "y", level)
        found = np.concatenate((found, stepped.advance(time).rows))
    smooth = [column for column in range(ROW_SIZE) if column not in (15, 16, 19, 20, 23)]
    assert found[:, smooth] == pytest.approx(rows[:, smooth], abs=1e-10)


def test_a_dead_time_shifts_everything() -> None:
    late = replace(THESIS, dead_time_s=0.25)
    times = np.linspace(0, 4, 81)
    prompt = played(CRANE, THESIS, PULSE, 0.5, times)
    shifted = played(CRANE, late, PULSE, 0.5, times + 0.25)
    assert shifted.load_m == pytest.approx(prompt.load_m, abs=1e-12)
    assert shifted.velocity_m_s == pytest.approx(prompt.velocity_m_s, abs=1e-14)


def test_a_stroke_exceeded_is_told_with_what_where_and_when() -> None:
    crane = replace(CRANE, strokes=(Stroke(length_m=1.3, start_m=0.65), None))
    machine = Machine(crane, (Ideal(), Ideal()), 0.5)
    machine.command("x", 1.0, 0.2)
    with refused("stroke_exceeded", "events", says=r"x = 1\.3 m at 1\.5 s") as caught:
        machine.advance(3.0)
    assert "0 to 1.3 m" in str(caught.value)
    machine = Machine(crane, (Ideal(), Ideal()), 0.5)
    machine.command("x", -1.0)
    with refused("stroke_exceeded", "events", says=r"at 1\.3 s"):
        machine.advance(3.0)


def test_an_overshoot_past_an_end_between_two_looks_is_seen() -> None:
    ringing = SecondOrderSet(natural_frequency_rad_s=20, damping_ratio=0.2)
    drive = SecondOrder(accel=ringing, decel=ringing, model="switched")
    free = Machine(CRANE, (drive, drive), 0.5)
    command_all(free, PULSE)
    reached = free.advance(4.0, np.linspace(0, 4, 40001)).position_m[:, 0]
    assert reached.max() > reached[-1] + 1e-3
    for margin, exceeded in ((1e-6, False), (-1e-6, True)):
        stroke = Stroke(length_m=float(reached.max()) + margin, start_m=0.0)
        machine = Machine(replace(CRANE, strokes=(stroke, None)), (drive, drive), 0.5)
        command_all(machine, PULSE)
        if exceeded:
            with refused("stroke_exceeded"):
                machine.advance(4.0)
        else:
            machine.advance(4.0)


def test_a_limit_switch_stops_the_drive_and_lets_it_back_only() -> None:
    stroke = Stroke(length_m=1.3, start_m=0.65, switch_m=0.3)
    machine = Machine(replace(CRANE, strokes=(stroke, None)), (SLOW_STOP, SLOW_STOP), 0.2)
    machine.command("x", 1.0)
    machine.command("x", 0.5, 4.0)  # toward the end still: not taken
    track = machine.advance(6.0, np.linspace(0, 6, 61))
    (switch,) = machine.switches
    # 0.35 m at 0.2 m/s behind 0.1 s of lag; then 0.2 m/s dies away within 0.5 s.
    lagged = switch.at_s - 0.1 * (1 - math.exp(-switch.at_s / 0.1))
    assert switch.axis == "x"
    assert 0.2 * lagged == pytest.approx(0.35, abs=1e-12)
    assert switch.position_m == pytest.approx(1.0, abs=1e-12)
    # Superposed sets: what the accelerating one is short of is made good still, 1e-8 of it here.
    assert track.position_m[-1, 0] == pytest.approx(1.1, abs=1e-4)
    assert track.velocity_m_s[-1, 0] == pytest.approx(0.0, abs=1e-4)
    machine.command("x", -1.0)
    machine.command("x", 1.0, 8.0)
    machine.advance(9.0)
    assert len(machine.switches) == 1
    machine.advance(10.5)
    assert len(machine.switches) == 2


def test_a_stop_too_slow_for_what_is_behind_the_switch_exceeds_the_stroke() -> None:
    stroke = Stroke(length_m=1.3, start_m=0.65, switch_m=0.05)
    machine = Machine(replace(CRANE, strokes=(None, stroke)), (SLOW_STOP, SLOW_STOP), 0.2)
    machine.command("y", -1.0)
    with refused("stroke_exceeded", says="y = "):
        machine.advance(6.0)
    assert [(one.axis, round(one.position_m, 9)) for one in machine.switches] == [("y", 0.05)]


def test_commands_and_hoists_out_of_bounds_are_refused() -> None:
    machine = Machine(replace(CRANE, max_cable_length_m=1.4), (THESIS, THESIS), 0.2)
    with refused("out_of_range", "level"):
        machine.command("x", 7.51)
    with refused("out_of_range", "level"):
        machine.command("x", math.nan)
    with refused("unknown_axis", "axis"):
        machine.command("z", 1.0)  # type: ignore[arg-type]
    for length in (0.0, -0.2, math.nan):
        with refused("cable_through_zero", "cable_length_m"):
            machine.hoist(length, 1.0)
    with refused("out_of_range", "cable_length_m", says="1.4"):
        machine.hoist(1.5, 1.0)
    with refused("not_positive", "over_s"):
        machine.hoist(0.5, 0.0)
    machine.advance(1.0)
    with refused("out_of_range", "at_s"):
        machine.command("x", 1.0, 0.5)
    with refused("out_of_range", "until_s"):
        machine.advance(0.5)
    machine.hoist(0.5, 0.1, at_s=2.0)
    with refused("hoist_too_fast", "events", says=r"3 m/s at 2 s"):
        machine.advance(3.0)


def test_a_swing_above_60_degrees_ends_the_run() -> None:
    # An ideal step of v lifts by v^2 / 2g: 60 degrees are L (1 - cos 60) at sqrt(g L) = 2.80 m/s.
    edge = math.sqrt(9.81 * 0.8)
    crane = replace(CRANE, max_speed_m_s=3.0)
    for speed, within in ((0.999 * edge, True), (1.001 * edge, False)):
        machine = Machine(crane, (Ideal(), Ideal()), speed)
        machine.command("x", 1.0)
        if within:
            machine.advance(5.0)
        else:
            with refused("swing_over_60_degrees", "events", says="at 0"):
                machine.advance(5.0)


def test_machines_out_of_bounds_are_refused() -> None:
    with refused("faster_than_axis", "speed_m_s", says="1.5"):
        Machine(CRANE, (THESIS, THESIS), 1.6)
    limited = RateLimited(accel_limit_m_s2=1.0, decel_limit_m_s2=1.0, speed_m_s=0.3)
    with refused("speed_not_actuators", "speed_m_s"):
        Machine(CRANE, (limited, limited), 0.2)
    quick = FirstOrder(accel_time_constant_s=1e-7, decel_time_constant_s=0.1)
    with refused("drive_not_resolved", "actuator.accel"):
        Machine(CRANE, (quick, quick), 0.2)
    for mass in (0.0, -1.0, math.nan):
        with refused("load_without_mass", "mass_kg"):
            Load(mass_kg=mass, length_m=0.2)
    with refused("out_of_range", "length_m"):
        Load(mass_kg=1.0, length_m=0.0)
    with refused("out_of_range", "cable_length_m"):
        Crane(cable_length_m=2.0, max_cable_length_m=1.4)
    with refused("out_of_range", "start_m"):
        Stroke(length_m=1.3, start_m=0.02, switch_m=0.05)
    with refused("out_of_range", "switch_m"):
        Stroke(length_m=1.3, start_m=0.65, switch_m=0.7)
