"""On samples a shaper of humps keeps its band, or a warning has what is lost."""

import numpy as np
import pytest

from design.analysis.insensitivity import insensitivity
from design.errors import DesignError
from design.model.actuators.ideal import Ideal
from design.model.plants.mode import Mode
from design.pipeline import design
from design.sampling.sampled_design import sampled_design
from design.shapers.ei import ToleranceOptions
from design.shapers.registry import SHAPERS
from tests.second_route import largest_in_band_by_formula

PERIOD_S = 0.7


def mode_of(damping_ratio: float) -> Mode:
    return Mode(natural_frequency_rad_s=2 * np.pi / PERIOD_S, damping_ratio=damping_ratio)


@pytest.mark.parametrize("kind", ["ei", "two_hump_ei", "three_hump_ei"])
@pytest.mark.parametrize("damping_ratio", [0.0, 0.05, 0.15])
@pytest.mark.parametrize("tolerance", [0.03, 0.1])
@pytest.mark.parametrize("samples_a_period", [7.3, 31.7])
def test_positive_humps_keep_their_band_within_two_samples_of_their_duration(
    kind: str, damping_ratio: float, tolerance: float, samples_a_period: float
) -> None:
    mode, sample_s = mode_of(damping_ratio), PERIOD_S / samples_a_period
    between = design(mode, Ideal(), SHAPERS[kind], ToleranceOptions(tolerance=tolerance))
    band = insensitivity(between.impulses, mode, Ideal(), tolerance)
    assert band is not None
    assert band.lower_ratio is not None
    assert band.upper_ratio is not None
    on_samples, _ = sampled_design(between, mode, Ideal(), sample_s)
    edges = (band.lower_ratio, band.upper_ratio)
    largest = largest_in_band_by_formula(on_samples.impulses, mode, Ideal(), edges, 301)
    assert largest <= tolerance * (1 + 1e-4)
    assert on_samples.impulses.duration_s <= between.impulses.duration_s + 2 * sample_s
    assert "narrower_on_samples" not in {warning.code for warning in on_samples.warnings}


@pytest.mark.parametrize(
    "kind", ["um_ei", "um_2ei", "umzv", "umzvd", "zv", "zvd", "mzv", "sna_zvd"]
)
@pytest.mark.parametrize("samples_a_period", [5, 10, 20, 33.3, 100])
def test_insensitivity_that_is_lost_is_told(kind: str, samples_a_period: float) -> None:
    mode = mode_of(0.05)
    between = design(mode, Ideal(), SHAPERS[kind])
    try:
        on_samples, _ = sampled_design(between, mode, Ideal(), PERIOD_S / samples_a_period)
    except DesignError:
        return
    tolerance = 0.05
    before = insensitivity(between.impulses, mode, Ideal(), tolerance)
    after = insensitivity(on_samples.impulses, mode, Ideal(), tolerance)
    assert before is not None
    codes = {warning.code for warning in on_samples.warnings}
    if after is None:
        assert "tolerance_not_kept" in codes
        return
    lost = 1 - after.searched_from_ratio < 0.9 * (1 - before.searched_from_ratio)
    lost = lost or after.searched_to_ratio - 1 < 0.9 * (before.searched_to_ratio - 1)
    assert ("narrower_on_samples" in codes) == lost


def test_a_slope_that_unity_magnitude_loses_is_told_with_both_bands() -> None:
    mode = mode_of(0.05)
    between = design(mode, Ideal(), SHAPERS["umzvd"])
    on_samples, _ = sampled_design(between, mode, Ideal(), PERIOD_S / 10, tolerance=0.01)
    (told,) = [one.detail for one in on_samples.warnings if one.code == "narrower_on_samples"]
    assert "within 5 % from 0.9615 to 1.038 of the frequency" in told
    assert "between them from 0.8599 to 1.134" in told
