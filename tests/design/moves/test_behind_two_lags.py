"""Moves behind limits and two lags: of any distance, both ways, from a swing, solved as one."""

import math

import numpy as np
import pytest

from design.errors import InfeasibleDesignError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.initial_state import AngleSwing
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import Maneuver, maneuver
from design.shapers.registry import SHAPERS
from tests.acceptance.random_ramps import random_drive
from tests.expm_route import end_s, outcome

LONG = Pendulum(cable_length_m=12.0, gravity_m_s2=9.81)
SLOW = {
    model: RateLimited(
        accel_limit_m_s2=0.2,
        decel_limit_m_s2=0.3,
        speed_m_s=0.5,
        then=FirstOrder(accel_time_constant_s=0.3, decel_time_constant_s=0.1, model=model),
    )
    for model in ("superposed", "switched")
}


def assert_travels(move: Maneuver, drive: Actuator, distance_m: float, speed_m_s: float) -> None:
    assert move.certificate.verified
    assert not move.for_ideal
    played = outcome(move.command, LONG.mode, drive)
    assert played.residual < 1e-9
    assert speed_m_s * played.travel == pytest.approx(abs(distance_m), abs=1e-9)
    assert move.distance_m == pytest.approx(distance_m, abs=1e-9)


@pytest.mark.parametrize("model", SLOW)
@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
@pytest.mark.parametrize("distance_m", [0.01, 0.1, -0.3, 1.0, 2.4, -12.0])
def test_moves_of_any_distance_are_certified(kind: str, distance_m: float, model: str) -> None:
    move = maneuver(LONG, SLOW[model], SHAPERS[kind], speed_m_s=0.5, distance_m=distance_m)
    assert_travels(move, SLOW[model], distance_m, 0.5)


@pytest.mark.parametrize(
    ("kind", "model"), [("numzv", "superposed"), ("numzv", "switched"), ("numzvd", "switched")]
)
def test_a_micrometre_is_travelled(kind: str, model: str) -> None:
    move = maneuver(LONG, SLOW[model], SHAPERS[kind], speed_m_s=0.5, distance_m=1e-6)
    assert_travels(move, SLOW[model], 1e-6, 0.5)
    assert move.distance_m == pytest.approx(1e-6, rel=1e-6)


@pytest.mark.parametrize("model", SLOW)
@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
def test_a_move_solved_as_one_ends_no_later(kind: str, model: str) -> None:
    apart, one = (
        maneuver(LONG, SLOW[model], SHAPERS[kind], speed_m_s=0.5, distance_m=6.0, joint=joint)
        for joint in (False, True)
    )
    assert_travels(one, SLOW[model], 6.0, 0.5)
    assert one.joint
    assert one.lower_bound_s is None
    assert end_s(one.command, SLOW[model]) < end_s(apart.command, SLOW[model])


@pytest.mark.parametrize("model", SLOW)
@pytest.mark.parametrize("angle", [-0.02, 0.01])
@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
def test_a_move_cancels_the_swing_that_it_begins_with(kind: str, angle: float, model: str) -> None:
    begun = AngleSwing(angle_rad=angle, angle_rate_rad_s=0.005)
    move = maneuver(LONG, SLOW[model], SHAPERS[kind], speed_m_s=0.5, distance_m=1.5, initial=begun)
    assert move.certificate.verified
    deflection = angle * 12 / 0.5, 0.005 * 12 / 0.5
    assert outcome(move.command, LONG.mode, SLOW[model], deflection).residual < 1e-8


@pytest.mark.parametrize("model", SLOW)
@pytest.mark.parametrize("pulse_s", [2.0, 9.0, 40.0])
def test_a_pulse_is_given_in_place_of_a_distance(pulse_s: float, model: str) -> None:
    move = maneuver(LONG, SLOW[model], SHAPERS["numzvd"], speed_m_s=-0.5, pulse_s=pulse_s)
    assert_travels(move, SLOW[model], move.distance_m, 0.5)
    assert move.direction == -1


def test_a_swing_too_large_for_the_limits_is_refused() -> None:
    begun = AngleSwing(angle_rad=0.7, angle_rate_rad_s=0.0)
    with pytest.raises(InfeasibleDesignError):
        maneuver(
            LONG, SLOW["switched"], SHAPERS["numzv"], speed_m_s=0.5, distance_m=0.1, initial=begun
        )


@pytest.mark.parametrize("number", range(30))
def test_random_moves_are_certified(number: int) -> None:
    drive, rng = random_drive(number), np.random.default_rng([77, number])
    distance = drive.mode.period_s * math.exp(rng.uniform(math.log(0.01), math.log(5)))
    move = maneuver(
        drive.mode,
        drive.limited,
        SHAPERS[drive.kind],
        speed_m_s=1.0,
        distance_m=distance,
        joint=bool(rng.random() < 0.2),
    )
    assert move.certificate.verified
    played = outcome(move.command, drive.mode, drive.limited)
    assert played.residual < 1e-9
    assert played.travel == pytest.approx(distance, abs=1e-9)
