"""Runs of events: commands, distances, and what remains."""

import math
from dataclasses import replace

import numpy as np
import pytest

from design.analysis.residual import residual_vibration
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.commands import convolve
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import Pendulum
from design.pipeline import design
from design.rig.crane import AxisName, Crane, Load, Stroke
from design.rig.runs import Run, Scenario, run
from design.rig.scenario import (
    Drive,
    HoistTo,
    Played,
    played_positions,
    pulse_of_distance,
    steps_of,
)
from design.shapers.registry import SHAPERS
from tests.design.rig.cranes import CRANE, THESIS, random_drive
from tests.refusals import refused

LINEAR = replace(CRANE, model="linear")
NUMZV = design(Pendulum(cable_length_m=0.8, gravity_m_s2=9.81), THESIS, SHAPERS["numzv"]).impulses
SPEED_M_S = 0.2


def press(
    at_s: float,
    level: float = 1.0,
    for_s: float | None = None,
    axis: AxisName = "x",
    event: int = 0,
) -> Drive:
    return Drive(event=event, axis=axis, at_s=at_s, level=level, for_s=for_s)


def left_of(done: Run) -> float:
    """Return the residual, where there is one."""
    assert done.residual is not None
    return done.residual


def thesis(**changes: object) -> Scenario:
    made = Scenario(crane=LINEAR, drive=THESIS, speed_m_s=SPEED_M_S)
    return replace(made, **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize("damping_ratio", [0.0, 0.05])
@pytest.mark.parametrize("seed", range(8))
def test_the_residual_of_small_swings_is_that_of_the_analysis(
    seed: int, damping_ratio: float
) -> None:
    drive = random_drive(np.random.default_rng(seed), SPEED_M_S)
    crane = replace(LINEAR, damping_ratio=damping_ratio)
    found = run(
        Scenario(
            crane=crane,
            drive=drive,
            speed_m_s=SPEED_M_S,
            drives=[press(0.0, for_s=1.3), press(2.0, -0.6, 0.7)],
            shaper=NUMZV,
        ),
        4.0,
        11,
    )
    command = Impulses(
        times_s=np.array([0.0, 1.3, 2.0, 2.7]), amplitudes=np.array([1.0, -1.0, -0.6, 0.6])
    )
    mode = Mode(natural_frequency_rad_s=crane.slowest_rad_s, damping_ratio=damping_ratio)
    told = residual_vibration(convolve(command, NUMZV), mode, drive)
    assert left_of(found) == pytest.approx(told, abs=1e-9)
    # A press of 1.3 s under a shaper of 0.6 s, then one of 0.7 s: both end before the next.
    assert found.warnings == ()


def test_a_delay_line_is_exact_for_a_start_and_not_for_a_stop() -> None:
    start = run(thesis(drives=[press(0.3)], shaper=NUMZV), 4.0, 11)
    assert left_of(start) < 1e-8
    whole = run(thesis(drives=[press(0.3, for_s=2.0)], shaper=NUMZV), 6.0, 11)
    assert 0.05 < left_of(whole) < 0.3  # a stop needs the sets swapped
    assert whole.last_switch_s == pytest.approx(2.3 + NUMZV.duration_s, abs=1e-12)
    plain = run(thesis(drives=[press(0.3)]), 4.0, 11)
    assert left_of(plain) == pytest.approx(1.0, abs=1e-9)


def test_presses_shorter_than_the_shaper_are_told() -> None:
    short = run(thesis(drives=[press(0.0, for_s=0.25), press(0.5, -1.0, 0.3)], shaper=NUMZV), 4, 11)
    (warning,) = short.warnings
    assert warning.code == "command_over_full_speed"


@pytest.mark.parametrize("shaper", [None, NUMZV], ids=["none", "numzv"])
@pytest.mark.parametrize("seed", range(10))
def test_a_move_goes_its_distance(seed: int, shaper: Impulses | None) -> None:
    rng = np.random.default_rng(seed)
    drive, distance = random_drive(rng, SPEED_M_S), float(rng.uniform(0.2, 0.9))
    pulse_s = pulse_of_distance(distance, SPEED_M_S, drive, shaper)
    found = run(
        Scenario(
            crane=LINEAR,
            drive=drive,
            speed_m_s=SPEED_M_S,
            drives=[press(0.1, -1.0, pulse_s)],
            shaper=shaper,
        ),
        30.0,
        2,
    )
    assert found.track.position_m[-1].tolist() == pytest.approx([-distance, 0.0], abs=1e-9)


def square(shaper: Impulses | None, crane: Crane) -> Run:
    """Go round 42 cm by 42 cm, a second of rest at each corner (Kim 2011, chapter 4)."""
    pulse_s = pulse_of_distance(0.42, SPEED_M_S, THESIS, shaper)
    sides: list[tuple[AxisName, float]] = [("x", 1.0), ("y", 1.0), ("x", -1.0), ("y", -1.0)]
    drives = [
        press(number * 4.0, level, pulse_s, axis) for number, (axis, level) in enumerate(sides)
    ]
    scenario = Scenario(
        crane=crane, drive=THESIS, speed_m_s=SPEED_M_S, drives=drives, shaper=shaper
    )
    return run(scenario, 20.0, 2001)


def test_the_square_of_the_thesis_closes() -> None:
    crane = replace(
        CRANE,
        strokes=(
            Stroke(length_m=1.3, start_m=0.4, switch_m=0.02),
            Stroke(length_m=0.755, start_m=0.15, switch_m=0.02),
        ),
    )
    left = []
    for shaper in (None, NUMZV):
        found = square(shaper, crane)
        left.append(left_of(found))
        place = found.track.position_m
        assert place[-1] == pytest.approx([0.4, 0.15], abs=1e-9)
        assert place.max(axis=0) == pytest.approx([0.82, 0.57], abs=1e-3)
        assert found.switches == ()
        assert set(found.commands) == {"x", "y"}
    # Eight changes of speed add up; a delay line's four stops leave some 15 % each.
    assert left[1] < 0.5 * left[0]


def test_a_run_of_the_double_pendulum_is_shaped_by_both_modes() -> None:
    crane = Crane(
        cable_length_m=0.8,
        gravity_m_s2=9.81,
        load=Load(mass_kg=0.6, length_m=0.25),
        model="linear",
    )
    frequencies = crane.frequencies_rad_s(0.8)
    assert frequencies == pytest.approx((3.18121, 11.02933), abs=5e-6)
    modes = Modes(modes=tuple(Mode(natural_frequency_rad_s=one) for one in frequencies))
    both = design(modes, THESIS, SHAPERS["multi_umzv"]).impulses
    found = run(
        Scenario(crane=crane, drive=THESIS, speed_m_s=0.2, drives=[press(0.0)], shaper=both), 5, 3
    )
    plain = run(Scenario(crane=crane, drive=THESIS, speed_m_s=0.2, drives=[press(0.0)]), 5, 3)
    assert left_of(plain) == pytest.approx(1.0, abs=1e-9)
    assert 0.05 < left_of(found) < 0.2  # 13.5 % in the first mode, 7.4 % in the second
    # Five steps that know the drive (switched): nothing is left of either mode.
    exact = Impulses(
        times_s=np.array([0, 0.2421622, 0.37058803, 0.54579808, 0.74026527]),
        amplitudes=np.array([1.0, -1, 1, -1, 1]),
    )
    scenario = Scenario(crane=crane, drive=THESIS, speed_m_s=0.2, drives=[press(0.0)], shaper=exact)
    assert left_of(run(scenario, 5.0, 3)) < 1e-6  # times of eight digits


def test_a_hoist_is_run_and_the_residual_is_of_the_length_at_the_end() -> None:
    hoist = HoistTo(event=1, at_s=0.5, over_s=2.0, cable_length_m=0.5)
    found = run(thesis(crane=CRANE, drives=[press(0.0)], hoists=[hoist]), 5.0, 51)
    lengths = found.track.cable_length_m
    assert lengths[0] == 0.8
    assert lengths[-1] == 0.5
    assert found.last_switch_s == 2.5
    # An adiabatic swing: the energy goes with the frequency, 2.5 times 1.6 periods are not slow.
    assert 0.5 < left_of(found) < 2.0


def test_played_velocities_and_positions_are_what_was_played() -> None:
    times = np.arange(0, 2.5, 0.01)
    velocity = 0.15 * np.sin(2 * math.pi * times / 2.5)
    velocity[-1] = 0.0
    played = Played(times_s=times, velocity_m_s=velocity)
    found = run(thesis(played={"x": played}), 4.0, 401)
    assert found.command_m_s[:250, 0] == pytest.approx(velocity, abs=1e-12)
    position = np.concatenate(([0.0], np.cumsum(velocity[:-1]) * 0.01))
    again = run(thesis(played={"x": played_positions(times, position)}), 4.0, 401)
    assert again.track.load_m[:, 0] == pytest.approx(found.track.load_m[:, 0], abs=1e-4)
    assert again.track.position_m == pytest.approx(found.track.position_m, abs=1e-12)
    ideal = run(thesis(drive=Ideal(), played={"x": played_positions(times, position)}), 4.0, 401)
    assert ideal.track.position_m[:250, 0] == pytest.approx(position, abs=1e-12)


def test_what_contradicts_itself_is_refused() -> None:
    with refused("contradictory_buttons", "events.1.direction.x", says="at 1 s"):
        steps_of([press(1.0, 1.0, event=0), press(1.0, -1.0, event=1)], "x")
    with refused("contradictory_buttons", "events.1.direction.x", says="beside 1 of events.0"):
        steps_of([press(0.0, 1.0, 2.0, event=0), press(1.5, -1.0, 1.0, event=1)], "x")
    steps_of([press(1.0, 1.0), press(1.0, -1.0, axis="y", event=1)], "x")
    times, levels = steps_of([press(0.0, 1.0, 1.0), press(1.0, -1.0, 1.0, event=1)], "x")
    assert times.tolist() == [0.0, 1.0, 2.0]
    assert levels.tolist() == [1.0, -1.0, 0.0]
    played = Played(times_s=np.array([0.0, 0.1, 0.2]), velocity_m_s=np.array([0.1, 0.1, 0.0]))
    with refused("played_beside_events", "played.x"):
        run(thesis(drives=[press(0.0)], played={"x": played}), 1.0, 2)


def test_a_played_course_with_a_gap_is_refused() -> None:
    times = np.delete(np.arange(100) * 0.01, slice(40, 43))
    with refused("gap_in_times", "times_s", says=r"nothing from 0\.39 to 0\.43 s"):
        Played(times_s=times, velocity_m_s=np.zeros(97))
    Played(times_s=np.delete(np.arange(100) * 0.01, 40), velocity_m_s=np.zeros(99))  # one lost
    with refused("times_not_ascending", "times_s", says=r"0\.1 after 0\.2 s"):
        Played(times_s=np.array([0.0, 0.2, 0.1]), velocity_m_s=np.zeros(3))
    with refused("too_few_samples", "times_s"):
        played_positions(np.array([0.0]), np.array([1.0]))


def test_a_distance_that_no_press_makes_is_refused() -> None:
    coasting = FirstOrder(accel_time_constant_s=0.01, decel_time_constant_s=0.5)
    with refused("distance_too_short_to_press", "distance_m"):
        pulse_of_distance(0.05, 0.2, coasting, None)
    # What it coasts is the least that it travels: 0.5 s less 0.01 s of 0.2 m/s.
    assert pulse_of_distance(0.1, 0.2, coasting, None) == pytest.approx(0.01, abs=1e-12)


def test_an_unshaped_step_above_60_degrees_is_a_measure_still() -> None:
    ideal_crane = replace(CRANE, max_speed_m_s=4.0)
    slow = [press(0.0, 0.1)]
    found = run(Scenario(crane=ideal_crane, drive=THESIS, speed_m_s=3.5, drives=slow), 3.0, 5)
    assert 0.05 < left_of(found) < 0.15


def test_a_swing_that_dies_before_the_drive_settles_has_no_residual() -> None:
    slow = FirstOrder(accel_time_constant_s=0.5, decel_time_constant_s=0.5)
    crane = replace(LINEAR, damping_ratio=0.5)
    found = run(Scenario(crane=crane, drive=slow, speed_m_s=0.2, drives=[press(0.0)]), 3.0, 5)
    assert found.residual is None
