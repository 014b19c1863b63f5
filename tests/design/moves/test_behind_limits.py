"""Whole moves behind limits to acceleration: short, long, solved as one, from a swing."""

import math

import numpy as np
import pytest

from design.errors import InfeasibleDesignError
from design.formulations.ramped_move import ramped_move
from design.model.actuators.rate_limited import RateLimited
from design.model.initial_state import AngleSwing
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import maneuver
from design.shapers.registry import SHAPERS
from design.solving.solve import solve
from tests.expm_route import outcome

SLOW = RateLimited(accel_limit_m_s2=0.2, decel_limit_m_s2=0.2, speed_m_s=0.5)
LONG = Pendulum(cable_length_m=12, gravity_m_s2=9.81)
CRANE = RateLimited(accel_limit_m_s2=0.3, decel_limit_m_s2=0.4, speed_m_s=1.0)


@pytest.mark.parametrize("kind", ["numzv", "numzvd", "umzv"])
@pytest.mark.parametrize("distance_m", [1e-6, 0.1, 0.3, -1.0, 2.4, 12.0])
def test_moves_of_any_distance_are_certified(kind: str, distance_m: float) -> None:
    move = maneuver(LONG, SLOW, SHAPERS[kind], speed_m_s=0.5, distance_m=distance_m)
    assert move.certificate.verified
    assert not move.for_ideal
    found = outcome(move.command, LONG.mode, SLOW)
    assert found.residual < 1e-9
    assert 0.5 * found.travel == pytest.approx(abs(distance_m), rel=1e-9, abs=1e-12)
    assert move.distance_m == pytest.approx(distance_m, abs=1e-9)


def test_a_short_move_is_two_triangles_half_a_period_apart() -> None:
    move = maneuver(LONG, SLOW, SHAPERS["numzv"], speed_m_s=0.5, distance_m=0.1)
    side = math.sqrt(0.05 / 0.2)
    half = LONG.mode.period_s / 2
    np.testing.assert_allclose(
        move.command.times_s, [0, side, half, half + side], rtol=0, atol=1e-12
    )


@pytest.mark.parametrize(("kind", "latest_s"), [("numzv", 15.121), ("numzvd", 16.40)])
def test_a_move_solved_as_one_ends_as_early_as_is_possible(kind: str, latest_s: float) -> None:
    crane = Pendulum(cable_length_m=9, gravity_m_s2=9.81)
    move = maneuver(crane, CRANE, SHAPERS[kind], speed_m_s=1.0, distance_m=12.0, joint=True)
    assert move.joint
    assert move.ramps is not None
    assert move.lower_bound_s is not None
    assert move.ramps.end_s <= latest_s
    assert 0.999 * move.ramps.end_s <= move.lower_bound_s <= move.ramps.end_s


@pytest.mark.parametrize("travel_s", [0.2, 0.6, 2.0, 4.8, 12.0])
@pytest.mark.parametrize("derivatives", [0, 1])
def test_moves_have_a_bound(travel_s: float, derivatives: int) -> None:
    problem = ramped_move(LONG.mode, SLOW, derivatives=derivatives, travel_s=travel_s, swing=None)
    found = next(solve(problem))
    assert found.solver.gap is not None
    assert found.solver.gap < 1e-3


@pytest.mark.parametrize("seed", range(30))
def test_random_moves_are_certified(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mode = Mode(
        natural_frequency_rad_s=float(rng.uniform(0.5, 20)),
        damping_ratio=float(rng.choice([0, rng.uniform(0, 0.2)])),
    )
    up, down = mode.period_s * np.exp(rng.uniform(math.log(0.05), math.log(3), 2))
    limits = RateLimited(accel_limit_m_s2=1 / up, decel_limit_m_s2=1 / down, speed_m_s=1.0)
    distance = mode.period_s * math.exp(rng.uniform(math.log(0.01), math.log(5)))
    kind = SHAPERS[str(rng.choice(["numzv", "numzvd"]))]
    move = maneuver(mode, limits, kind, speed_m_s=1.0, distance_m=distance)
    assert move.certificate.verified
    found = outcome(move.command, mode, limits)
    assert found.residual < 1e-8
    assert found.travel == pytest.approx(distance, abs=1e-9)


@pytest.mark.parametrize("angle", [-0.02, 0.01, 0.02])
@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
def test_a_move_cancels_the_swing_that_it_begins_with(kind: str, angle: float) -> None:
    begun = AngleSwing(angle_rad=angle, angle_rate_rad_s=0.005)
    move = maneuver(LONG, SLOW, SHAPERS[kind], speed_m_s=0.5, distance_m=1.5, initial=begun)
    assert move.certificate.verified
    deflection = angle * 12 / 0.5, 0.005 * 12 / 0.5
    assert outcome(move.command, LONG.mode, SLOW, deflection).residual < 1e-8


def test_a_swing_too_large_for_the_limits_is_refused() -> None:
    begun = AngleSwing(angle_rad=0.7, angle_rate_rad_s=0.0)
    with pytest.raises(InfeasibleDesignError):
        maneuver(LONG, SLOW, SHAPERS["numzv"], speed_m_s=0.5, distance_m=0.1, initial=begun)
