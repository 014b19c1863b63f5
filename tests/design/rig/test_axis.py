"""Axes against the responses of the analysis, and against the equation of the lag."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.response.closed_form import history, travel
from design.response.simulated_history import simulated_history
from design.rig.axis import (
    AXIS_SIZE,
    CORNER,
    TIME,
    axis_motion,
    command_level,
    drive_row,
    turn_corner,
)
from design.rig.lag import lag_motion
from design.types import FloatArray
from tests.design.rig.cranes import THESIS, random_drive, random_levels

MODE = Mode(natural_frequency_rad_s=3.5)
SPEED_M_S = 0.4


def follow(row: FloatArray, times: FloatArray, levels: FloatArray, at: FloatArray) -> FloatArray:
    """Return position, velocity and acceleration at times, shape (n, 3)."""
    pending = list(zip(times.tolist(), levels.tolist(), strict=True))
    seen = []
    for now in at.tolist():
        while row[CORNER] <= now or (pending and pending[0][0] <= now):
            if pending and pending[0][0] < row[CORNER]:
                command_level(row, *pending.pop(0))
            else:
                turn_corner(row, float(row[CORNER]))
        seen.append(axis_motion(row, now - row[TIME]))
    return np.array(seen)


@pytest.mark.parametrize("seed", range(150))
def test_an_axis_moves_as_both_routes_of_the_analysis_say(seed: int) -> None:
    rng = np.random.default_rng(seed)
    drive = random_drive(rng, SPEED_M_S)
    times, levels = random_levels(rng, 6)
    at = np.sort(rng.uniform(0, 6, 80))
    found = follow(drive_row(drive, SPEED_M_S), times, levels, at)
    steps = np.diff(levels, prepend=0.0)
    command = Impulses(times_s=times[steps != 0], amplitudes=steps[steps != 0])
    for route in (history, simulated_history):
        told = route(command, MODE, drive, at)
        assert found[:, 1] == pytest.approx(SPEED_M_S * told.velocity, abs=1e-11)


@pytest.mark.parametrize("seed", range(60))
def test_position_and_acceleration_are_those_of_the_velocity(seed: int) -> None:
    rng = np.random.default_rng(1000 + seed)
    drive = random_drive(rng, SPEED_M_S)
    times, levels = random_levels(rng, 5)
    levels[-1] = 0.0
    steps = np.diff(levels, prepend=0.0)
    command = Impulses(times_s=times[steps != 0], amplitudes=steps[steps != 0])
    end = follow(drive_row(drive, SPEED_M_S), times, levels, np.array([60.0]))[0]
    assert end[0] == pytest.approx(SPEED_M_S * travel(command, drive), abs=1e-11)
    assert abs(end[2]) < 1e-9  # e^-15 of the slowest random lag
    at = np.linspace(5.0, 5.4, 401)  # after the last command, ramps may still go on
    apart = 1e-4
    before, now, after = (
        follow(drive_row(drive, SPEED_M_S), times, levels, at + shift)
        for shift in (-apart, 0.0, apart)
    )
    ramps = np.ptp(np.stack([before, now, after])[:, :, 2], axis=0) < 0.05  # no corner between
    assert ramps.sum() > 300
    differences = (after[:, :2] - before[:, :2]) / (2 * apart)
    assert differences[ramps] == pytest.approx(now[ramps, 1:], abs=1e-5)


@pytest.mark.parametrize("seed", range(40))
def test_a_lag_behind_a_bent_ramp_obeys_its_equation(seed: int) -> None:
    rng = np.random.default_rng(seed)
    second = 0.0 if seed % 4 == 0 else float(10 ** rng.uniform(-5, -1))
    first = float(2 * rng.choice([1.0, rng.uniform(0.1, 3)]) * math.sqrt(second or 0.01))
    error, rate, slope, jerk = rng.uniform(-1, 1, 4)
    elapsed = float(10 ** rng.uniform(-4, 0))
    if second == 0.0:
        rate = -error / first

    def rates(time: float, state: FloatArray) -> list[float]:
        now = state[0] - (slope * time + jerk * time**2 / 2)  # velocity less reference
        if second == 0.0:
            return [-now / first, 0.0]
        return [state[1], -(now + first * state[1]) / second]

    route = solve_ivp(rates, (0, elapsed), [error, rate], method="DOP853", rtol=1e-12, atol=1e-13)
    found = lag_motion(first, second, error, rate, slope, jerk, elapsed)
    velocity, velocity_rate = route.y[:, -1]
    scale = 1 + abs(rate) + 1 / math.sqrt(second or first**2)
    assert found[0] == pytest.approx(velocity - slope * elapsed - jerk * elapsed**2 / 2, abs=1e-10)
    if second > 0:
        assert found[1] == pytest.approx(velocity_rate, abs=1e-10 * scale)


def test_a_short_ramp_is_as_exact_as_a_step() -> None:
    # 5e7 mm/s^2 at 0.2 m/s: a ramp of 4 us before lags of 0.1 s (Kim 2011, chapter 4).
    drive = RateLimited(accel_limit_m_s2=5e4, decel_limit_m_s2=5e4, speed_m_s=0.2, then=THESIS)
    at = np.linspace(0, 2, 50)
    times, levels = np.array([0.0, 0.7]), np.array([1.0, 0.0])
    ramp, step = (follow(drive_row(one, 0.2), times, levels, at) for one in (drive, THESIS))
    assert ramp == pytest.approx(step, abs=1e-4)
    told = history(Impulses(times_s=times, amplitudes=np.array([1.0, -1.0])), MODE, drive, at)
    # The ramp's end is rounded to 1e-16 s, and the reference gains 2.5e5 in a second.
    assert ramp[:, 1] == pytest.approx(0.2 * told.velocity, abs=1e-12)


def test_a_jump_is_told() -> None:
    row = drive_row(FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.0), 0.5)
    assert row.shape == (AXIS_SIZE,)
    assert command_level(row, 0.0, 1.0) == 0.0
    # Superposed: the decelerating set answers at once, what the other is short of stays.
    assert command_level(row, 0.05, 0.0) == pytest.approx(-0.5)
    switched = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.0, model="switched")
    row = drive_row(switched, 0.5)
    command_level(row, 0.0, 1.0)
    reached = axis_motion(row, 0.05)[1]
    assert command_level(row, 0.05, 0.0) == pytest.approx(-reached)
    assert axis_motion(row, 0.0)[1] == 0.0
