"""Ranges that no fit goes over, and times that no number holds."""

import numpy as np
import pytest

from design.curve_fit.fit import fit
from design.curve_fit.fit_range import FitRange
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS
from tests.refusals import refused
from tests.shaper_table import CRANE, THESIS

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


def test_fitted_times_beyond_all_numbers_are_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    module = "design.curve_fit.exact_curve.residuals_of_many"
    monkeypatch.setattr(module, lambda times, *_: np.full(len(times), np.inf))
    wanted = FitRange(over="cable_length_m", start=0.7, stop=0.9, degree=2)
    with refused("fit_overflows", says="of degree 2"):
        fit(CRANE, THESIS, SHAPERS["numzvd"], wanted)
