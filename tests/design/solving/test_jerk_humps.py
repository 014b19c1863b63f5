"""Shapers with humps behind a limit to the jerk: their curves, by integration."""

from dataclasses import replace

import numpy as np
import pytest

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.kind import ShaperKind
from design.shapers.numei import NUM_2EI, NUM_EI, HumpOptions
from design.shapers.numsi import NUM_SI, UnityBandOptions
from tests.design.solving.test_jerk_bands import MODE, STRAIGHT, end_of, left_at, limited_jerk
from tests.design.solving.test_ramped_humps import random_humps
from tests.refusals import refused

Case = tuple[Mode, RateLimited, HumpOptions]


def with_jerk(seed: int, count: int) -> list[Case]:
    """Return random cases with a limit to the jerk: its time .05 of a ramp to all of it."""
    rng = np.random.default_rng(seed)
    return [
        (mode, limited_jerk(replace(limited, then=Ideal()), rng, shortest=0.05), options)
        for mode, limited, options in random_humps(seed, count)
    ]


@pytest.mark.parametrize(("mode", "drive", "options"), with_jerk(5, 6))
def test_one_hump_has_its_height_and_peak_at_the_nominal_frequency(
    mode: Mode, drive: RateLimited, options: HumpOptions
) -> None:
    found = design(mode, drive, NUM_EI, options)
    assert found.certificate.verified
    assert not found.for_ideal
    below, nominal, above = (left_at(found, mode, drive, ratio) for ratio in (0.999, 1.0, 1.001))
    assert nominal == pytest.approx(options.tolerance, rel=1e-7)
    assert max(below, above) < nominal
    assert below == pytest.approx(above, rel=1e-4)


@pytest.mark.parametrize(("mode", "drive", "options"), with_jerk(6, 4))
def test_two_humps_lie_beside_a_zero_and_keep_their_height(
    mode: Mode, drive: RateLimited, options: HumpOptions
) -> None:
    found = design(mode, drive, NUM_2EI, options)
    assert found.certificate.verified
    assert left_at(found, mode, drive, 1.0) < 1e-8
    band = next(claim.band for claim in found.certificate.claims if claim.quantity == "band")
    assert band is not None
    curve = [left_at(found, mode, drive, one) for one in np.linspace(*band, 13).tolist()]
    assert max(curve) <= options.tolerance * (1 + 1e-7)
    assert max(curve[1:6]) > 0.8 * options.tolerance
    assert max(curve[7:12]) > 0.8 * options.tolerance


@pytest.mark.parametrize("kind", [NUM_EI, NUM_2EI])
def test_without_limit_to_the_jerk_humps_are_those_of_straight_ramps(kind: ShaperKind) -> None:
    options, smooth = HumpOptions(tolerance=0.05), replace(STRAIGHT, jerk_limit_m_s3=1e6)
    found, straight = (design(MODE, drive, kind, options) for drive in (smooth, STRAIGHT))
    np.testing.assert_allclose(found.impulses.times_s, straight.impulses.times_s, atol=3e-6)


def test_a_tolerance_over_the_band_of_a_hump_takes_no_longer() -> None:
    drive = replace(STRAIGHT, jerk_limit_m_s3=20.0)
    humps = design(MODE, drive, NUM_EI, HumpOptions(tolerance=0.05))
    band = next(claim.band for claim in humps.certificate.claims if claim.quantity == "band")
    assert band is not None
    options = UnityBandOptions(half_width=(band[1] - band[0]) / 2, tolerance=0.05)
    over = design(MODE, drive, NUM_SI, options)
    assert end_of(over, drive) <= end_of(humps, drive) * (1 + 1e-6)


def test_humps_behind_two_lags_are_refused() -> None:
    apart = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)
    with refused("jerk_not_served", "actuator.jerk_limit_m_s3"):
        design(MODE, replace(STRAIGHT, jerk_limit_m_s3=20.0, then=apart), NUM_EI)
