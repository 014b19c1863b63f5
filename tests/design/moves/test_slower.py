"""Moves too short for steps that settle: at a lower speed."""

import numpy as np
import pytest

from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.model.settling import settling_time_s
from design.moves.maneuvers import Maneuver, maneuver
from design.shapers.settle_options import SettleOptions
from tests.design.moves.cranes import MODELS, NUMZVD, travel_by_integration
from tests.integration_route import residual_by_integration

SETTLES = SettleOptions(settle=True)

MODE = Mode(natural_frequency_rad_s=2.0, damping_ratio=0.11)


def drive(model: Model) -> SecondOrder:
    return SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=9.2, damping_ratio=1.0),
        decel=SecondOrderSet(natural_frequency_rad_s=8.8, damping_ratio=1.3),
        model=model,
    )


def limited(model: Model) -> RateLimited:
    lag = SecondOrderSet(natural_frequency_rad_s=23.2, damping_ratio=0.58)
    return RateLimited(
        accel_limit_m_s2=36.0,
        decel_limit_m_s2=4.9,
        speed_m_s=0.5,
        then=SecondOrder(accel=lag, decel=lag, model=model),
    )


DRIVES = [
    pytest.param(make(model), id=f"{make.__name__}-{model}")
    for make in (drive, limited)
    for model in MODELS
]


def short_move(
    actuator: Actuator, distance_m: float | None = None, pulse_s: float | None = None
) -> Maneuver:
    return maneuver(
        MODE,
        actuator,
        NUMZVD,
        speed_m_s=0.5,
        distance_m=distance_m,
        pulse_s=pulse_s,
        options=SETTLES,
    )


def share_of(move: Maneuver) -> float:
    return float(np.cumsum(move.command.amplitudes).max())


@pytest.mark.parametrize("actuator", DRIVES)
def test_a_move_too_short_to_settle_goes_slower_and_leaves_nothing(actuator: Actuator) -> None:
    move = short_move(actuator, distance_m=0.2)
    share = share_of(move)
    assert 0 < share < 1
    levels = np.cumsum(move.command.amplitudes)
    np.testing.assert_allclose(np.minimum(levels, np.abs(levels - share)), 0, atol=1e-12)
    assert [one.code for one in move.warnings].count("lower_speed") == 1
    assert f"{100 * share:.3g} %" in " ".join(one.detail for one in move.warnings)
    assert move.certificate.verified
    assert 0.5 * travel_by_integration(move.command, actuator) == pytest.approx(0.2, abs=1e-8)
    assert residual_by_integration(move.command, MODE, actuator) < 1e-8


@pytest.mark.parametrize("actuator", DRIVES)
def test_each_step_of_a_slower_move_settles_before_the_next(actuator: Actuator) -> None:
    move = short_move(actuator, distance_m=0.2)
    ramps_s = (
        (actuator.speed_m_s / actuator.accel_limit_m_s2, 0.5 / actuator.decel_limit_m_s2)
        if isinstance(actuator, RateLimited)
        else (0.0, 0.0)
    )
    lags = (actuator.accel_lag, actuator.decel_lag)
    share = share_of(move)
    least = [
        share * ramp_s + settling_time_s(lag) for ramp_s, lag in zip(ramps_s, lags, strict=True)
    ]
    for number, gap_s in enumerate(np.diff(move.command.times_s)):
        assert gap_s >= least[number % 2] * (1 - 1e-9)


@pytest.mark.parametrize("model", MODELS)
def test_a_slower_move_is_the_move_of_that_speed(model: Model) -> None:
    move = short_move(drive(model), distance_m=0.2)
    same = maneuver(
        MODE, drive(model), NUMZVD, speed_m_s=0.5 * share_of(move), distance_m=0.2, options=SETTLES
    )
    np.testing.assert_allclose(move.command.times_s, same.command.times_s, atol=1e-9)
    assert "lower_speed" not in {one.code for one in same.warnings}


def test_a_short_pulse_stands_for_its_travel_at_the_lower_speed_too() -> None:
    asked = short_move(drive("superposed"), pulse_s=0.8)
    again = short_move(drive("superposed"), distance_m=asked.distance_m)
    np.testing.assert_allclose(asked.command.times_s, again.command.times_s, atol=1e-8)


def test_a_longer_move_goes_at_full_speed() -> None:
    move = short_move(drive("switched"), distance_m=8.0)
    assert share_of(move) == pytest.approx(1.0, abs=1e-12)
