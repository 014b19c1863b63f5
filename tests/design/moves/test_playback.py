"""Commands played on plants, against an integrator that shares no code."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from design.fields import Axis
from design.maps.field_map import field_map
from design.maps.map_case import MapCase
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.commands import pulse, step
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.moves.playback import motion
from design.response.simulated_history import simulated_history
from tests.design.test_switched import random_case
from tests.expm_route import end_s
from tests.integration_route import integrate
from tests.shaper_table import CRANE, THESIS

TWO_SETS = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=30.0, damping_ratio=0.7),
)
DRIVES: list[Actuator] = [
    Ideal(),
    FirstOrder(accel_time_constant_s=0.08, decel_time_constant_s=0.03),
    FirstOrder(accel_time_constant_s=0.08, decel_time_constant_s=0.03, model="switched"),
    TWO_SETS,
    replace(TWO_SETS, model="switched"),
    RateLimited(accel_limit_m_s2=2.0, decel_limit_m_s2=3.0, speed_m_s=0.3, then=TWO_SETS),
]


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize("seed", range(100))
def test_a_random_command_moves_as_an_integrator_says(seed: int, model: str) -> None:
    command, mode, actuator = random_case(seed)
    changed: Any = {"model": model}
    actuator = replace(actuator, **changed)
    end = float(command.times_s[-1]) + float(np.random.default_rng(seed).uniform(0.01, 2.0))
    told = motion(mode, actuator, command, 0.3, np.array([end]))
    deflection, _, velocity = integrate(command, mode, actuator, end)
    assert told.velocity_m_s[0] == pytest.approx(0.3 * velocity, abs=1e-8)
    assert told.deflection_m[0] == pytest.approx(0.3 * deflection, abs=1e-8)


def test_dead_time_delays_the_response_and_not_the_command() -> None:
    times = np.linspace(0, 5, 501)
    late = replace(THESIS, dead_time_s=0.1)
    shifted = motion(CRANE, late, pulse(1.0), 0.2, times)
    plain = motion(CRANE, THESIS, pulse(1.0), 0.2, times - 0.1)
    assert shifted.velocity_m_s == pytest.approx(plain.velocity_m_s, abs=1e-15)
    assert shifted.deflection_m == pytest.approx(plain.deflection_m, abs=1e-15)
    assert shifted.command_m_s[0] == 0.2
    assert shifted.residual == plain.residual


def test_the_remaining_swing_is_the_one_that_goes_on() -> None:
    times = np.linspace(20, 22, 4001)  # transients are long over, a period is 1.8 s
    played = motion(CRANE, THESIS, step(), 0.2, times)
    assert played.remaining is not None
    assert played.remaining.deflection_m == pytest.approx(played.peak.deflection_m, rel=1e-6)
    assert played.residual == pytest.approx(1.0)
    assert played.peak.angle_rad == pytest.approx(played.peak.deflection_m / 0.8)


@pytest.mark.parametrize("damping_ratio", [0.0, 0.05, 0.2, 0.5])
@pytest.mark.parametrize("drive", DRIVES, ids=lambda drive: f"{drive.kind} {drive.model}")
def test_what_remains_is_the_amplitude_of_the_free_swing_by_integration(
    drive: Actuator, damping_ratio: float
) -> None:
    mode = Mode(natural_frequency_rad_s=2.0, damping_ratio=damping_ratio)
    command = Impulses(times_s=np.array([0.0, 0.9, 2.0]), amplitudes=np.array([1.0, -0.6, 0.3]))
    ended = end_s(command, drive)
    later = 3.5  # the slowest set, 12 /s, has e^-42 left then, the payload e^-3.5 at least
    deflection, rate, _ = integrate(command, mode, drive, ended + later)
    # d = a exp(-z w t) cos(wd t + phase): amplitude from the state, then back to the end.
    decay, turn = -mode.pole_rad_s.real, mode.pole_rad_s.imag
    amplitude = math.hypot(deflection, (rate + decay * deflection) / turn) * math.exp(decay * later)
    played = motion(mode, drive, command, 0.3, np.array([0.0]))
    assert played.remaining is not None
    assert played.remaining.deflection_m == pytest.approx(0.3 * amplitude, rel=1e-8)
    case = MapCase(
        plant=mode, actuator=drive, shaper=command, quantity="deflection_m", speed_m_s=0.3
    )
    over = Axis(path=("plant", "damping_ratio"), values=np.array([damping_ratio]))
    assert field_map(case, over, None).values.item() == pytest.approx(0.3 * amplitude, rel=1e-8)


def test_an_ideal_step_swings_by_speed_over_frequency() -> None:
    times = np.linspace(0, 3, 3001)
    played = motion(Mode(natural_frequency_rad_s=4.0), Ideal(), step(), 0.2, times)
    assert played.peak.deflection_m == pytest.approx(0.2 / 4.0, rel=1e-6)
    assert played.angle_rad is None


def test_an_actuator_that_rings_with_the_plant_is_still_played() -> None:
    mode = Mode(natural_frequency_rad_s=3.0, damping_ratio=0.2)
    twin = SecondOrderSet(natural_frequency_rad_s=3.0, damping_ratio=0.2)
    actuator = SecondOrder(accel=twin, decel=twin)
    times = np.linspace(0, 4, 50)
    played = motion(mode, actuator, pulse(1.0), 1.0, times)
    again = simulated_history(pulse(1.0), mode, actuator, times)
    assert played.residual is None
    assert played.remaining is None
    assert played.velocity_m_s == pytest.approx(again.velocity)
    deflection, _, _ = integrate(pulse(1.0), mode, actuator, 4.0)
    assert played.deflection_m[-1] == pytest.approx(deflection, abs=1e-8)


def test_a_first_order_actuator_follows_its_exponential() -> None:
    actuator = FirstOrder(accel_time_constant_s=0.5, decel_time_constant_s=0.1)
    times = np.linspace(0, 2, 21)
    played = motion(CRANE, actuator, step(), 2.0, times)
    assert played.velocity_m_s == pytest.approx(2 * (1 - np.exp(-times / 0.5)))
