"""Ranges that no fit goes over, and times that no number holds."""

from dataclasses import replace

import pytest

from design.curve_fit.fit import fit
from design.curve_fit.fit_range import FitRange
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.pipeline import design
from design.shapers.registry import SHAPERS
from tests.refusals import refused

LIMITS = RateLimited(accel_limit_m_s2=0.5, decel_limit_m_s2=0.5, speed_m_s=1.0)


@pytest.mark.parametrize("kind", ["numzv", "umzv"])
def test_a_range_in_which_ramps_begin_to_turn_is_refused_with_both_numbers(kind: str) -> None:
    sizes = [
        design(Mode(natural_frequency_rad_s=w), LIMITS, SHAPERS[kind]).impulses.times_s.size
        for w in (2.0, 4.0)
    ]
    assert sizes == [3, 5]
    wanted = FitRange(over="natural_frequency_rad_s", start=2.0, stop=4.0, degree=1)
    with refused("fitted_impulses_change", "over", says=r"it is 3 at 0\.5 and 5 at 1, got"):
        fit(Mode(natural_frequency_rad_s=2.0), LIMITS, SHAPERS[kind], wanted)
    straight = FitRange(over="natural_frequency_rad_s", start=1.5, stop=2.0, degree=1)
    assert fit(Mode(natural_frequency_rad_s=2.0), LIMITS, SHAPERS[kind], straight).degree == 1


def test_degrees_whose_powers_leave_the_numbers_are_refused_only_where_asked_for() -> None:
    # ZVD behind limits has a residual that no degree takes away; powers of a narrow range grow.
    crane = Pendulum(
        cable_length_m=3.4669931171917274, damping_ratio=0.1002964053498723, gravity_m_s2=9.81
    )
    lag = FirstOrder(accel_time_constant_s=0.031151793314158193, decel_time_constant_s=0.0)
    drive = RateLimited(
        accel_limit_m_s2=4.198742429959858,
        decel_limit_m_s2=3.7791424224481966,
        speed_m_s=0.2875918345486509,
        then=lag,
    )
    wanted = FitRange(
        over="cable_length_m", start=3.1036942446180293, stop=3.847247435074801, degree=19
    )
    with refused("fit_overflows", says="of degree 19"):
        fit(crane, drive, SHAPERS["zvd"], wanted)
    within = replace(wanted, degree=None, max_residual=2.8e-4)
    with refused("no_degree_suffices", says=r"^no degree up to 19 has a residual"):
        fit(crane, drive, SHAPERS["zvd"], within)
