"""A ramp that nearly lasts whole periods needs one notch: as theory has it, and as designed."""

import math

import numpy as np
import pytest

from design.analysis.ramp_figures import end_of_reference
from design.formulations.notches import notched_ramps
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS
from tests.expm_route import outcome

PERIOD = 2 * math.pi


@pytest.mark.parametrize("short", [1e-7, 1e-5, 1e-3, 1e-2])
@pytest.mark.parametrize("ratio", [1.0, 0.25, 2.5])
def test_a_notch_half_way_makes_up_for_half_of_what_lacks(short: float, ratio: float) -> None:
    # V = -u e T + (u + f) d (1 - exp(-s t)) is 0 at t = T/2 and (u + f) d = u e T / 2.
    mode = Mode(natural_frequency_rad_s=1.0)
    rise = PERIOD * (1 - short)
    drive = RateLimited(
        accel_limit_m_s2=1 / rise, decel_limit_m_s2=1 / (ratio * rise), speed_m_s=1.0
    )
    found = design(mode, drive, SHAPERS["numzv"])
    assert end_of_reference(found.impulses, drive) == pytest.approx(
        PERIOD * (1 - short / 2), abs=PERIOD * short**2
    )
    notch = short * PERIOD / 2 / (1 + 1 / ratio)
    assert np.diff(found.impulses.times_s)[1] == pytest.approx(notch, rel=0.05 + 3 * short)
    assert found.impulses.times_s[1] == pytest.approx(PERIOD / 2, abs=PERIOD * short)
    assert outcome(found.impulses, mode, drive).residual < 1e-9


@pytest.mark.parametrize("wholes", [1, 2])
@pytest.mark.parametrize("damping", [0.0, 1e-4, 0.02])
@pytest.mark.parametrize("kind", ["numzv", "numzvd", "umzv"])
def test_no_ramp_near_whole_periods_is_refused(wholes: int, damping: float, kind: str) -> None:
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=damping)
    for off in (-1e-2, -1e-6, 0.0, 1e-4):
        rise = PERIOD * wholes * (1 + off)
        drive = RateLimited(accel_limit_m_s2=1 / rise, decel_limit_m_s2=1.3 / rise, speed_m_s=1.0)
        found = design(mode, drive, SHAPERS[kind])
        assert found.certificate.verified
        assert found.solver.gap is not None
        assert found.solver.gap < 1e-3


def test_a_notch_cancels_the_ramp_to_first_order() -> None:
    pole = complex(-0.01, math.sqrt(1 - 1e-4))
    rise, fall = 0.99 * PERIOD, 3.0
    seeds = notched_ramps(pole, rise, fall)
    assert seeds
    for seed in seeds:
        level = (seed[1] / rise) - (seed[2] - seed[1]) / fall
        ends = [0.0, float(seed[1]), float(seed[2]), float(seed[2]) + (1 - level) * rise]
        left = sum(
            slope * (np.exp(-pole * start) - np.exp(-pole * end)) / pole
            for slope, start, end in zip(
                (1 / rise, -1 / fall, 1 / rise), ends, ends[1:], strict=False
            )
        )
        alone = (1 - np.exp(-pole * rise)) / (pole * rise)
        assert abs(left) < 0.1 * abs(alone)


def test_a_ramp_that_swings_much_has_no_notch() -> None:
    assert notched_ramps(1j, 0.9 * PERIOD, 3.0) != ()  # 0.11 of a step
    assert notched_ramps(1j, 0.5 * PERIOD, 3.0) == ()  # 0.64 of a step


@pytest.mark.parametrize("rise", [1e3, 1e9, 1e15])
def test_a_ramp_too_long_for_any_design_costs_no_memory(rise: float) -> None:
    # Formulated before it is refused: with a point for every part of it gigabytes would go.
    assert notched_ramps(complex(-0.01, 1.0), rise, 1.0) == ()
