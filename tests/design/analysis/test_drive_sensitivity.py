"""The residual where the drive is not as given."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from design.analysis.drive_sensitivity import DriveRange, drive_sensitivity, parameters_of
from design.analysis.residual import residual_vibration
from design.fields import vary
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.registry import Plant
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


LIMITS = RateLimited(accel_limit_m_s2=1.6, decel_limit_m_s2=2.5, speed_m_s=0.2, then=THESIS)
FIRST_SWITCHED = replace(FIRST_ORDER, model="switched")
DRIVES: dict[str, tuple[str, Plant, Actuator]] = {
    "first order": ("numzv", CRANE, replace(FIRST_ORDER, accel_time_constant_s=0.1)),
    "first order, switched": ("numzvd", CRANE, FIRST_SWITCHED),
    "second order": ("numzv", CRANE, THESIS),
    "two modes": ("num_multi", PAIR, FIRST_ORDER),
    "two modes, switched": ("num_multi", PAIR, FIRST_SWITCHED),
    "limits": ("numzv", CRANE, LIMITS),
    "limits, switched": ("numzv", CRANE, replace(LIMITS, then=SWITCHED)),
    "limits and one set that follows": ("numzv", CRANE, replace(LIMITS, then=FIRST_SWITCHED)),
}


def drives_off(actuator: Actuator, share: float) -> Iterator[tuple[dict[str, float], Actuator]]:
    """Yield each drive in the corners, made field by field, with its factors."""
    given = parameters_of(actuator)
    for factors in product((1 - share, 1 + share), repeat=len(given)):
        drive = actuator
        for (path, value), factor in zip(given.items(), factors, strict=True):
            drive = vary(drive, list(path), factor * value)
        yield dict(zip((".".join(path) for path in given), factors, strict=True)), drive


@pytest.mark.parametrize("name", DRIVES)
def test_each_kind_of_drive_has_the_residual_of_the_worst_one_made_field_by_field(
    name: str,
) -> None:
    kind, plant, actuator = DRIVES[name]
    found = design(plant, actuator, SHAPERS[kind]).impulses
    told = drive_sensitivity(found, plant.modes, actuator, DriveRange(most=0.1, points=2))
    assert told.residuals[0] < 1e-9
    each = [
        (max(residual_vibration(found, mode, drive) for mode in plant.modes), factors, drive)
        for factors, drive in drives_off(actuator, 0.1)
    ]
    most, factors, worst = max(each, key=lambda one: one[0])
    assert told.residuals[1] == pytest.approx(most, rel=1e-9)
    assert told.residuals[1] > 1e-3
    assert told.worst == pytest.approx(factors)
    by_integration = max(residual_by_integration(found, mode, worst) for mode in plant.modes)
    assert told.residuals[1] == pytest.approx(by_integration, rel=1e-5)


def test_behind_a_limit_to_the_jerk_it_is_as_field_by_field() -> None:
    drive = replace(LIMITS, jerk_limit_m_s3=40.0, then=SWITCHED)
    told = drive_sensitivity(NUMZVD, CRANE.modes, drive, DriveRange(most=0.2, points=2))
    each = [residual_vibration(NUMZVD, CRANE.mode, off) for _, off in drives_off(drive, 0.2)]
    assert told.residuals[1] == pytest.approx(max(each), rel=1e-9)


def test_behind_limits_it_is_the_drive_that_follows_them_that_is_off() -> None:
    assert set(parameters_of(LIMITS)) == {("then", *path) for path in parameters_of(THESIS)}


def test_a_drive_without_parameters_is_refused_by_name() -> None:
    with refused("drive_without_parameters", "drive"):
        drive_sensitivity(NUMZVD, CRANE.modes, Ideal(), DriveRange())
    for values in ({"most": 0.6}, {"points": 1}):
        with refused("out_of_range"):
            DriveRange(**values)


def test_a_drive_at_its_bounds_may_be_off_beyond_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bounds are for what is asked; a drive that is measured at one may well lie beyond it."""
    accel = SecondOrderSet(natural_frequency_rad_s=20, damping_ratio=0.1)
    edge = replace(SWITCHED, accel=accel)
    told = drive_sensitivity(NUMZVD, CRANE.modes, edge, DriveRange()).residuals
    monkeypatch.setattr("design.model.actuators.second_order.MIN_DAMPING_RATIO", 0.01)
    each = [residual_vibration(NUMZVD, CRANE.mode, off) for _, off in drives_off(edge, 0.2)]
    assert told[-1] == pytest.approx(max(each), rel=1e-9)


def test_a_first_order_drive_has_two_time_constants() -> None:
    assert parameters_of(FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)) == {
        ("accel_time_constant_s",): 0.1,
        ("decel_time_constant_s",): 0.05,
    }
