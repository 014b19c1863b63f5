"""Controllers that drive the machine by what its sensors say."""

import math
from dataclasses import replace

import numpy as np
import pytest

from design.model.actuators.first_order import FirstOrder
from design.rig.camera import Camera
from design.rig.controlled import Reading, run_controlled
from design.rig.crane import Stroke
from design.rig.machine import Machine
from tests.design.rig.cranes import CRANE, THESIS
from tests.refusals import refused

QUICK = FirstOrder(accel_time_constant_s=0.02, decel_time_constant_s=0.02)


def test_a_controller_without_feedback_is_a_played_command() -> None:
    def pulse(reading: Reading) -> tuple[float, float]:
        return (1.0 if reading.at_s < 0.9995 else 0.0), -0.5

    run = run_controlled(Machine(CRANE, (THESIS, THESIS), 0.5), pulse, 0.001, 3.0)
    machine = Machine(CRANE, (THESIS, THESIS), 0.5)
    for axis, time, level in (("x", 0.0, 1.0), ("x", 1.0, 0.0), ("y", 0.0, -0.5)):
        machine.command("x" if axis == "x" else "y", level, time)
    track = machine.advance(3.0, run.track.times_s)
    assert run.track.load_m == pytest.approx(track.load_m, abs=1e-10)
    assert run.levels[:, 0].sum() == pytest.approx(1000)
    assert run.pixels is None


def test_feedback_by_the_camera_damps_a_swing() -> None:
    camera = Camera(noise_pixels=0.3)

    def controller(reading: Reading) -> tuple[float, float]:
        if reading.at_s < 0.5:
            return 1.0, 0.0
        assert reading.frame is not None
        angle = float(camera.angles_rad(reading.frame, 0.8)[0])
        # A trolley that follows the load takes the energy from it.
        return float(np.clip(0.4 * 0.8 * angle * CRANE.slowest_rad_s / 0.3, -1, 1)), 0.0

    machine = Machine(CRANE, (QUICK, QUICK), 0.3)
    run = run_controlled(machine, controller, 0.01, 12.0, camera=camera, seed=5)
    assert run.pixels is not None
    swing = np.sqrt(run.track.swing_energy_j)
    assert swing[-200:].max() < 0.1 * swing[:200].max()
    again = run_controlled(
        Machine(CRANE, (QUICK, QUICK), 0.3), lambda _: (1.0, 0.0), 0.01, 0.4, camera=camera, seed=5
    )
    assert again.pixels is not None
    assert again.pixels.tolist() == run.pixels[:41].tolist()  # the seed replays the noise


def test_a_controller_comes_to_a_place_by_its_encoder() -> None:
    crane = replace(CRANE, strokes=(Stroke(length_m=1.3, start_m=0.2), None))

    def controller(reading: Reading) -> tuple[float, float]:
        return float(np.clip((0.9 - reading.position_m[0]) * 8, -1, 1)), 0.0

    run = run_controlled(Machine(crane, (QUICK, QUICK), 0.3), controller, 0.001, 6.0)
    assert run.track.position_m[-1, 0] == pytest.approx(0.9, abs=0.1 / 512)
    told = (run.pulses[-1, 0] + 0.5) * 0.1 / 512
    assert abs(told - run.track.position_m[-1, 0]) <= 0.1 / 1024 * (1 + 1e-9)


def test_a_controller_is_told_of_a_limit_switch() -> None:
    crane = replace(CRANE, strokes=(None, Stroke(length_m=0.755, start_m=0.4, switch_m=0.1)))
    pressed = []

    def controller(reading: Reading) -> tuple[float, float]:
        pressed.append(reading.pressed[1])
        return 0.0, (-1.0 if sum(pressed) > 0 and reading.at_s > 2 else 1.0)

    machine = Machine(crane, (QUICK, QUICK), 0.3)
    run = run_controlled(machine, controller, 0.01, 3.0)
    first = pressed.index(1)
    assert run.track.position_m[first, 1] > 0.655 >= run.track.position_m[first - 1, 1]
    assert pressed[-1] == 0
    assert len(machine.switches) == 1


def test_runs_out_of_bounds_are_refused() -> None:
    machine = Machine(CRANE, (QUICK, QUICK), 0.3)
    with refused("samples_out_of_range", "sample_time_s"):
        run_controlled(machine, lambda _: (0.0, 0.0), 1e-9, 60.0)
    with refused("not_positive", "sample_time_s"):
        run_controlled(machine, lambda _: (0.0, 0.0), 0.0, 60.0)
    with refused("out_of_range", "level"):
        run_controlled(machine, lambda _: (math.nan, 0.0), 0.1, 1.0)
