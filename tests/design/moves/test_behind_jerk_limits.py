"""Whole moves behind a limit to the jerk: short, long, solved as one, from a swing."""

import math
from dataclasses import replace

import numpy as np
import pytest

from design.formulations.jerk_move import highest_level, smooth_pulses, whole_ramp_rad
from design.formulations.ramped_move import ramped_move
from design.model.actuators.rate_limited import RateLimited
from design.model.commands import pulse
from design.model.initial_state import AngleSwing
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import maneuver
from design.response.closed_form import travel
from design.shapers.registry import SHAPERS
from design.solving.solve import solve
from tests.jerk_route import integrate_jerk_limited
from tests.refusals import refused

SLOW = RateLimited(accel_limit_m_s2=0.2, decel_limit_m_s2=0.2, speed_m_s=0.5, jerk_limit_m_s3=0.3)
CRANE = RateLimited(accel_limit_m_s2=0.3, decel_limit_m_s2=0.4, speed_m_s=1.0, jerk_limit_m_s3=0.5)
LONG = Pendulum(cable_length_m=12, gravity_m_s2=9.81)


@pytest.mark.parametrize("kind", ["numzv", "numzvd", "umzv"])
@pytest.mark.parametrize("distance_m", [1e-6, 0.1, 0.3, -1.0, 2.4, 12.0])
def test_moves_of_any_distance_are_certified(kind: str, distance_m: float) -> None:
    move = maneuver(LONG, SLOW, SHAPERS[kind], speed_m_s=0.5, distance_m=distance_m)
    assert move.certificate.verified
    assert not move.for_ideal
    assert move.distance_m == pytest.approx(distance_m, abs=1e-9)
    end = float(move.command.times_s[-1]) + sum(SLOW.unit_ramps_s)
    deflection, rate, velocity, level = integrate_jerk_limited(move.command, LONG.mode, SLOW, end)
    w = LONG.mode.natural_frequency_rad_s
    assert math.hypot(w * deflection, rate) < 1e-8
    assert abs(velocity) + abs(level) < 1e-8


@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
@pytest.mark.parametrize("distance_m", [0.1, 2.4, 12.0])
def test_a_move_solved_as_one_has_a_bound(kind: str, distance_m: float) -> None:
    drive = CRANE
    crane = Pendulum(cable_length_m=9, gravity_m_s2=9.81)
    move = maneuver(crane, drive, SHAPERS[kind], speed_m_s=1.0, distance_m=distance_m, joint=True)
    assert move.joint
    assert move.ramps is not None
    assert move.lower_bound_s is not None
    assert (1 - 1e-6) * move.ramps.end_s <= move.lower_bound_s <= move.ramps.end_s
    free = maneuver(
        crane,
        replace(drive, jerk_limit_m_s3=None),
        SHAPERS[kind],
        speed_m_s=1.0,
        distance_m=distance_m,
        joint=True,
    )
    assert free.lower_bound_s is not None
    assert free.lower_bound_s < move.lower_bound_s


def test_a_swing_at_the_first_step_is_cancelled() -> None:
    swing = AngleSwing(angle_rad=0.02, angle_rate_rad_s=0.0)
    move = maneuver(LONG, SLOW, SHAPERS["numzv"], speed_m_s=0.5, distance_m=4.0, initial=swing)
    assert move.certificate.verified
    assert move.residual < 1e-9


def test_a_jerk_beyond_reach_gives_the_moves_without() -> None:
    fast, free = (
        maneuver(
            LONG,
            replace(SLOW, jerk_limit_m_s3=jerk),
            SHAPERS["numzv"],
            speed_m_s=0.5,
            distance_m=0.3,
        )
        for jerk in (1e4, None)
    )
    np.testing.assert_allclose(fast.command.times_s, free.command.times_s, atol=1e-4)


@pytest.mark.parametrize("jerk", [0.5, 3.0, 400.0])
def test_the_highest_level_is_that_of_a_move_that_never_cruises(jerk: float) -> None:
    drive = RateLimited(
        accel_limit_m_s2=1 / 0.7, decel_limit_m_s2=1 / 1.9, speed_m_s=1.0, jerk_limit_m_s3=jerk
    )
    level = highest_level(0.4, (0.7, 1.9), jerk)
    ramps = [whole_ramp_rad(level * one, jerk / level) for one in (0.7, 1.9)]
    assert level * sum(ramps) / 2 == pytest.approx(0.4, rel=1e-12)
    made = smooth_pulses(np.zeros(1), np.array([0.4]), (0.7, 1.9), jerk)
    assert made is not None
    (_, off), (end,) = made
    assert travel(pulse(off), drive) == pytest.approx(0.4, rel=1e-12)
    # Told to go back before its slope is gone, the pulse has the same course.
    assert end == pytest.approx(sum(ramps), rel=1e-9)
    assert whole_ramp_rad(0.7, jerk) == pytest.approx(drive.unit_ramps_s[0], rel=1e-14)
    assert highest_level(1e3, (0.7, 1.9), jerk) == 1.0


@pytest.mark.parametrize("derivatives", [0, 1])
@pytest.mark.parametrize("travel_s", [0.2, 2.0, 6.0])
def test_the_first_solution_of_a_move_is_proven(travel_s: float, derivatives: int) -> None:
    problem = ramped_move(LONG.mode, SLOW, derivatives=derivatives, travel_s=travel_s, swing=None)
    found = next(solve(problem))
    assert found.solver.gap is not None
    assert 0 <= found.solver.gap < 1e-6


def test_a_move_that_has_to_settle_is_refused() -> None:
    options = SHAPERS["numzvd"].options(settle=True)
    with refused("jerk_not_served", "actuator.jerk_limit_m_s3"):
        maneuver(LONG, SLOW, SHAPERS["numzvd"], speed_m_s=0.5, distance_m=4.0, options=options)
