"""Moves whose start, or stop, does not exist without vibration."""

import numpy as np
import pytest

from design.errors import InfeasibleDesignError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.swapped import swap_directions
from design.model.initial_state import DeflectionSwing
from design.model.plants.mode import Mode
from design.moves.maneuvers import maneuver
from design.pipeline import design
from design.shapers.peak_options import PeakOptions
from tests.design.moves.cranes import NUMZV, NUMZVD, levels, travel_by_integration
from tests.integration_route import residual_by_integration
from tests.refusals import refused

SETTLES = PeakOptions(settle=True)

HEAVY = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.55)

SLOW_UP = FirstOrder(accel_time_constant_s=0.236, decel_time_constant_s=0.0999, model="superposed")
"""Its steps down are too weak, at the pole of the payload, for a start; for a stop they do."""


def test_the_payload_has_a_stop_and_no_start() -> None:
    assert design(HEAVY, swap_directions(SLOW_UP), NUMZV, SETTLES).certificate.verified
    with pytest.raises(InfeasibleDesignError):
        design(HEAVY, SLOW_UP, NUMZV, SETTLES)


@pytest.mark.parametrize("distance_m", [4.0, -12.0])
def test_without_a_start_the_stop_cancels_what_one_step_leaves(distance_m: float) -> None:
    move = maneuver(HEAVY, SLOW_UP, NUMZV, speed_m_s=0.2, distance_m=distance_m, options=SETTLES)
    assert move.start.amplitudes.tolist() == [1.0]
    assert move.stop.amplitudes.tolist()[0] == -1.0
    assert not move.joint
    assert [one.code for one in move.warnings].count("start_swings") == 1
    assert move.certificate.verified
    assert 0.2 * travel_by_integration(move.command, SLOW_UP) == pytest.approx(
        abs(distance_m), abs=1e-8
    )
    assert residual_by_integration(move.command, HEAVY, SLOW_UP) < 1e-8


def test_without_a_start_the_pulse_is_the_one_asked() -> None:
    move = maneuver(HEAVY, SLOW_UP, NUMZV, speed_m_s=0.2, pulse_s=15.0, options=SETTLES)
    assert move.pulse_s == pytest.approx(15.0, rel=1e-12)
    assert residual_by_integration(move.command, HEAVY, SLOW_UP) < 1e-8


def test_after_a_long_cruise_the_stop_is_that_of_a_payload_at_rest() -> None:
    # Of the step e^(-0.55 * 60) is left when the stop begins.
    move = maneuver(HEAVY, SLOW_UP, NUMZV, speed_m_s=0.2, pulse_s=60.0, options=SETTLES)
    alone = design(HEAVY, swap_directions(SLOW_UP), NUMZV, SETTLES).impulses
    np.testing.assert_allclose(move.stop.times_s - move.stop.times_s[0], alone.times_s, atol=1e-9)


def test_without_a_start_a_swing_is_cancelled_by_the_stop_too() -> None:
    swing = DeflectionSwing(deflection_m=0.02, deflection_rate_m_s=-0.01)
    move = maneuver(
        HEAVY, SLOW_UP, NUMZV, speed_m_s=0.2, distance_m=2.0, initial=swing, options=SETTLES
    )
    assert move.certificate.verified
    assert move.start.amplitudes.tolist() == [1.0]


def test_without_start_and_stop_a_move_is_refused() -> None:
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.95)
    with refused("no_solution_found"):
        maneuver(mode, Ideal(), NUMZVD, speed_m_s=0.2, distance_m=2.0, options=SETTLES)


def test_without_a_stop_the_move_is_one_or_refused_with_both_reasons() -> None:
    # The start of the mirrored drive is the stop: neither serves a move that cruises.
    drive = swap_directions(SLOW_UP)
    with refused("no_move_found", says="the start exists, the stop does not: .*no move on levels"):
        maneuver(HEAVY, drive, NUMZV, speed_m_s=0.2, distance_m=4.0, options=SETTLES)


def test_start_and_stop_of_different_numbers_of_steps_are_told_apart() -> None:
    mode = Mode(natural_frequency_rad_s=2.0, damping_ratio=0.11)
    drive = FirstOrder(accel_time_constant_s=0.15, decel_time_constant_s=0.05, model="superposed")
    move = maneuver(mode, drive, NUMZVD, speed_m_s=0.5, pulse_s=30.0, options=SETTLES)
    assert move.pulse_s == pytest.approx(30.0, rel=1e-12)
    assert levels(move)[move.start.times_s.size - 1] == 1.0
