"""The residual where the drive is not as given."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from design.analysis.drive_sensitivity import DriveRange, drive_sensitivity, parameters_of
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.pipeline import design
from design.shapers.registry import SHAPERS
from tests.integration_route import residual_by_integration
from tests.modes_cases import PAIR
from tests.refusals import refused
from tests.shaper_table import CRANE, FIRST_ORDER, THESIS

SWITCHED = replace(THESIS, model="switched")
NUMZVD = design(CRANE, SWITCHED, SHAPERS["numzvd"]).impulses


def test_numzvd_bears_a_drive_that_is_off_by_a_tenth_and_by_a_fifth() -> None:
    found = drive_sensitivity(NUMZVD, CRANE.modes, SWITCHED, DriveRange())
    assert found.shares.tolist() == pytest.approx([0.0, 0.1, 0.2])
    assert found.residuals[0] < 1e-9
    # Figures of three digits, to one per cent.
    assert found.residuals[1:] == pytest.approx([0.0303, 0.0673], rel=0.01)
    assert found.worst == pytest.approx({
        "accel.natural_frequency_rad_s": 0.8,
        "accel.damping_ratio": 1.2,
        "decel.natural_frequency_rad_s": 1.2,
        "decel.damping_ratio": 0.8,
    })


def test_the_worst_drive_has_that_residual_by_integration_and_no_other_more() -> None:
    found = drive_sensitivity(NUMZVD, CRANE.modes, SWITCHED, DriveRange(most=0.1, points=2))
    told = []
    for a, b, c, d in product((0.9, 1.1), repeat=4):
        off = SecondOrder(
            accel=SecondOrderSet(natural_frequency_rad_s=20 * a, damping_ratio=0.8 * b),
            decel=SecondOrderSet(natural_frequency_rad_s=50 * c, damping_ratio=1.5 * d),
            model="switched",
        )
        told.append(residual_by_integration(NUMZVD, CRANE.mode, off))
    assert found.residuals[-1] == pytest.approx(max(told), rel=1e-6)


def test_positive_impulses_do_not_know_the_drive() -> None:
    """One lag is a factor of both the command and the unshaped step."""
    zvd = design(CRANE, SWITCHED, SHAPERS["zvd"]).impulses
    assert drive_sensitivity(zvd, CRANE.modes, SWITCHED, DriveRange()).residuals.max() < 1e-12


def test_of_several_modes_the_worst_counts() -> None:
    steps = Impulses(times_s=np.array([0.0, 0.1, 0.3]), amplitudes=np.array([1.0, -1.0, 1.0]))
    each = [
        drive_sensitivity(steps, (mode,), FIRST_ORDER, DriveRange()).residuals
        for mode in PAIR.modes
    ]
    both = drive_sensitivity(steps, PAIR.modes, FIRST_ORDER, DriveRange()).residuals
    assert both.tolist() == np.max(each, axis=0).tolist()


def test_behind_limits_it_is_the_drive_that_follows_them_that_is_off() -> None:
    limited = RateLimited(accel_limit_m_s2=1.6, decel_limit_m_s2=2.5, speed_m_s=0.2, then=THESIS)
    assert set(parameters_of(limited)) == {("then", *path) for path in parameters_of(THESIS)}
    found = design(CRANE, limited, SHAPERS["numzv"]).impulses
    assert drive_sensitivity(found, CRANE.modes, limited, DriveRange()).residuals[-1] > 0.01


def test_a_drive_without_parameters_and_one_out_of_bounds_are_refused_by_name() -> None:
    with refused("drive_without_parameters", "drive"):
        drive_sensitivity(NUMZVD, CRANE.modes, Ideal(), DriveRange())
    edge = SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=20, damping_ratio=0.1), decel=THESIS.decel
    )
    with refused("drive_off_bounds", "drive.to", says=r"accel\.damping_ratio must be between"):
        drive_sensitivity(NUMZVD, CRANE.modes, edge, DriveRange())
    for values in ({"most": 0.6}, {"points": 1}):
        with refused("out_of_range"):
            DriveRange(**values)


def test_a_first_order_drive_has_two_time_constants() -> None:
    assert parameters_of(FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)) == {
        ("accel_time_constant_s",): 0.1,
        ("decel_time_constant_s",): 0.05,
    }
