"""How far a command goes: by formula and by an integrator."""

from dataclasses import replace

import numpy as np
import pytest

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.model import Model
from design.model.impulses import Impulses
from design.moves.maneuvers import maneuver
from design.response.closed_form import travel
from tests.design.moves.cranes import (
    MODELS,
    NUMZV,
    NUMZVD,
    SPEED_M_S,
    UMZVD,
    any_actuator,
    travel_by_integration,
)
from tests.refusals import refused
from tests.shaper_table import CRANE, IDEAL, THESIS


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("seed", range(12))
def test_travel_agrees_with_an_integrator(seed: int, model: Model) -> None:
    rng = np.random.default_rng(seed)
    actuator = any_actuator(rng, 3.0, model)
    amplitudes = rng.uniform(-1, 1, 5)
    command = Impulses(
        times_s=np.sort(rng.uniform(0, 3, 6)), amplitudes=np.append(amplitudes, -amplitudes.sum())
    )
    # The integrator's tolerance is 1e-11 a step.
    assert travel(command, actuator) == pytest.approx(
        travel_by_integration(command, actuator), abs=1e-9
    )


@pytest.mark.parametrize("model", MODELS)
def test_travel_holds_where_a_set_follows_at_once(model: Model) -> None:
    actuator = FirstOrder(accel_time_constant_s=0.2, decel_time_constant_s=0.0, model=model)
    command = Impulses(
        times_s=np.array([0.0, 0.1, 0.4, 1.0]), amplitudes=np.array([1.0, -1.0, 1.0, -1.0])
    )
    assert travel(command, actuator) == pytest.approx(
        travel_by_integration(command, actuator), abs=1e-9
    )


def test_travel_does_not_depend_on_the_clock() -> None:
    command = Impulses(times_s=np.array([0.0, 1.5]), amplitudes=np.array([1.0, -1.0]))
    later = replace(command, times_s=command.times_s + 1024.0)  # exact in binary
    assert travel(later, THESIS) == travel(command, THESIS)


def test_a_command_that_does_not_end_at_rest_has_no_travel() -> None:
    step = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
    with refused("command_not_to_rest", "amplitudes", says="of sum 0: a command to rest"):
        travel(step, THESIS)


def test_a_negative_speed_with_a_pulse_moves_in_minus_x() -> None:
    there, back = (
        maneuver(CRANE, THESIS, NUMZVD, speed_m_s=speed, pulse_s=1.9)
        for speed in (SPEED_M_S, -SPEED_M_S)
    )
    assert there.command.times_s.tolist() == back.command.times_s.tolist()
    assert (back.direction, back.distance_m, back.speed_m_s) == (-1, -there.distance_m, SPEED_M_S)


def test_a_pulse_is_from_first_step_to_first_step() -> None:
    move = maneuver(CRANE, THESIS, NUMZVD, speed_m_s=SPEED_M_S, pulse_s=1.75)
    assert move.pulse_s == 1.75
    assert move.start.amplitudes.tolist() == [1, -1, 1, -1, 1]
    assert move.stop.amplitudes.tolist() == [-1, 1, -1, 1, -1]
    assert move.stop.times_s[0] == 1.75
    assert move.command.times_s.tolist() == [*move.start.times_s, *move.stop.times_s]
    assert move.duration_s == move.stop.times_s[-1]


def test_a_pulse_shorter_than_the_lag_it_loses_goes_nowhere() -> None:
    with refused("pulse_goes_nowhere", says=r"^a pulse of 0\.05 s goes nowhere"):
        maneuver(CRANE, THESIS, UMZVD, speed_m_s=SPEED_M_S, pulse_s=0.05)


def test_the_ideal_actuators_pulse_is_its_travel() -> None:
    move = maneuver(CRANE, IDEAL, NUMZVD, speed_m_s=SPEED_M_S, pulse_s=2.1)
    assert move.distance_m == pytest.approx(0.42, rel=1e-14)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("distance_m", [3.0, 100.0])
def test_a_drive_that_hardly_comes_to_rest_goes_as_far_as_asked(
    model: Model, distance_m: float
) -> None:
    slow = FirstOrder(accel_time_constant_s=3.0, decel_time_constant_s=2.0, model=model)
    for kind in (UMZVD, NUMZV):
        move = maneuver(CRANE, slow, kind, speed_m_s=SPEED_M_S, distance_m=distance_m)
        assert move.certificate.verified
        assert move.distance_m == pytest.approx(distance_m, rel=1e-12)
