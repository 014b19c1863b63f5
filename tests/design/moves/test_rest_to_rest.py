"""Moves solved as one, and moves with a peak."""

from dataclasses import replace

import pytest

from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.initial_state import AngleSwing
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.moves.designed_parts import designed_parts
from design.moves.maneuvers import maneuver
from design.moves.rest_to_rest import over_pulse
from design.shapers.peak_options import PeakOptions
from tests.design.moves.cranes import MODELS, NUMZV, NUMZVD, SPEED_M_S, UMZVD, levels
from tests.integration_route import residual_by_integration
from tests.refusals import refused
from tests.shaper_table import CRANE, DAMPED, THESIS


@pytest.mark.parametrize("model", MODELS)
def test_solved_as_one_on_request_a_move_takes_no_longer(model: Model) -> None:
    actuator = replace(THESIS, model=model)
    for distance_m in (0.1, 0.3, 0.42, 2.0):
        apart, one = (
            maneuver(
                CRANE, actuator, NUMZVD, speed_m_s=SPEED_M_S, distance_m=distance_m, joint=joint
            )
            for joint in (False, True)
        )
        assert one.certificate.verified
        assert one.distance_m == pytest.approx(distance_m, rel=1e-12)
        assert set(levels(one)) <= {0.0, 1.0}
        assert one.duration_s <= apart.duration_s
        if distance_m == 0.3:  # just above the overlap: half a second
            assert apart.duration_s - one.duration_s > 0.5
            assert one.joint
            assert not apart.joint


def test_a_pulse_solved_as_one_on_request_goes_as_far() -> None:
    apart, one = (
        maneuver(CRANE, THESIS, NUMZVD, speed_m_s=SPEED_M_S, pulse_s=1.5, joint=joint)
        for joint in (False, True)
    )
    assert one.distance_m == pytest.approx(apart.distance_m, rel=1e-12)
    assert one.duration_s < apart.duration_s


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("plant", [CRANE, DAMPED], ids=["undamped", "damped"])
@pytest.mark.parametrize("peak", [0.8, 1.25, 2.6])
def test_a_peak_above_or_below_the_cruise_speed_leaves_nothing(
    plant: Plant, peak: float, model: Model
) -> None:
    actuator = replace(THESIS, model=model)
    options = PeakOptions(max_velocity_ratio=peak)
    for distance_m in (0.8, -0.8):
        move = maneuver(
            plant, actuator, NUMZV, speed_m_s=SPEED_M_S, distance_m=distance_m, options=options
        )
        assert not move.joint
        assert move.start.amplitudes.tolist() == [peak, -peak, 1.0]
        assert move.stop.amplitudes.tolist() == [-1.0, peak, -peak]
        assert move.certificate.verified
        assert move.distance_m == pytest.approx(distance_m, rel=1e-12)
        assert residual_by_integration(move.command, plant.mode, actuator) < 1e-8


@pytest.mark.parametrize("model", MODELS)
def test_a_short_move_with_a_peak_is_solved_on_the_peak(model: Model) -> None:
    actuator, options = replace(THESIS, model=model), PeakOptions(max_velocity_ratio=1.25)
    move = maneuver(CRANE, actuator, NUMZV, speed_m_s=SPEED_M_S, distance_m=0.05, options=options)
    assert move.joint
    assert {round(level, 12) for level in levels(move)} == {0.0, 1.25}
    assert move.distance_m == pytest.approx(0.05, rel=1e-12)
    assert residual_by_integration(move.command, CRANE.mode, actuator) < 1e-8


@pytest.mark.parametrize("model", MODELS)
def test_a_swing_is_cancelled_with_a_peak_too(model: Model) -> None:
    move = maneuver(
        CRANE,
        replace(THESIS, model=model),
        NUMZV,
        speed_m_s=SPEED_M_S,
        distance_m=0.8,
        initial=AngleSwing(angle_rad=0.02, angle_rate_rad_s=0.03),
        options=PeakOptions(max_velocity_ratio=1.25),
    )
    assert move.start.amplitudes.tolist() == [1.25, -1.25, 1.0]
    assert move.certificate.verified


def test_as_one_on_request_and_a_peak_do_not_go_together() -> None:
    with refused("joint_beyond_unit_velocity", "joint"):
        maneuver(
            CRANE,
            THESIS,
            NUMZV,
            speed_m_s=SPEED_M_S,
            distance_m=0.8,
            joint=True,
            options=PeakOptions(max_velocity_ratio=1.25),
        )


def test_a_travel_that_corrections_do_not_meet_is_met_at_a_lower_speed() -> None:
    # UMZVD knows no drive, and behind these ramps and lags so short a pulse goes nowhere near.
    lags = [
        SecondOrderSet(natural_frequency_rad_s=corner, damping_ratio=damping)
        for corner, damping in ((35.36330870300246, 0.5724842304893382), (61.64, 0.41955))
    ]
    drive = RateLimited(
        accel_limit_m_s2=1.8945662715408,
        decel_limit_m_s2=2.5815610297326828,
        speed_m_s=0.3366490493958793,
        then=SecondOrder(accel=lags[0], decel=lags[1]),
    )
    mode = Mode(natural_frequency_rad_s=7.429486068513855)
    with refused("no_move_of_travel", says=r"whose travel is 0\.0088\d* s times its speed"):
        over_pulse(designed_parts(mode, drive, UMZVD, UMZVD.options()), 0.1369673093072221)
    move = maneuver(mode, drive, UMZVD, speed_m_s=drive.speed_m_s, pulse_s=0.1369673093072221)
    assert max(levels(move)) < 1


def test_a_move_behind_limits_that_nothing_verifies_is_a_failure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    limits = RateLimited(accel_limit_m_s2=1.0, decel_limit_m_s2=1.5, speed_m_s=SPEED_M_S)
    monkeypatch.setattr("design.moves.rest_to_rest.solve", lambda _: iter(()))
    with refused("ramped_move_not_verified"):
        maneuver(CRANE, limits, NUMZV, speed_m_s=SPEED_M_S, distance_m=0.05)
