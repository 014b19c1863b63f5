"""What is said where no shaper serves: limits that nothing meets, and the nearest."""

import math

import pytest

from design.errors import InfeasibleDesignError
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.mode import Mode
from design.recommendations.recommendation import recommend
from design.recommendations.requirements import Requirements
from tests.design.recommendations.recommended import TWO_MODES, asked
from tests.refusals import refused
from tests.shaper_table import IDEAL, THESIS


def test_a_high_mode_limit_that_unity_cannot_meet_is_named() -> None:
    with refused("none_meets_all", says="the least high-mode gain found is") as told:
        asked(sign="unity", max_high_mode_gain=1.0)
    assert isinstance(told.value, InfeasibleDesignError)
    assert set(dict(told.value.faults)) == {"sign", "max_high_mode_gain"}
    assert "with another sign than unity, si serves" in str(told.value)


def test_a_band_that_several_modes_cannot_be_kept_over_says_so() -> None:
    with refused("none_meets_all", says=r"in every mode.*smallest residual found is"):
        asked(TWO_MODES, THESIS, half_width=0.6, tolerance=0.01, sign="unity")
    served = asked(TWO_MODES, THESIS, half_width=0.6, tolerance=0.01).recommended
    assert served.name == "multi_si"


def test_where_no_single_limit_is_enough_the_nearest_is_told() -> None:
    with refused("none_meets_all", says="dropping any single limit does not help"):
        asked(half_width=0.9, tolerance=0.01, max_duration_s=0.2, max_high_mode_gain=0.1)


def test_samples_longer_than_any_shaper_leave_nothing_to_recommend() -> None:
    with refused("none_designed", says="no shaper could be designed; zv: sample_time"):
        asked(sample_time_s=30.0)


def test_what_is_offered_instead_is_of_shapers_that_miss_nothing_else() -> None:
    # A shaper of the other sign that leaves 1e-16 in the time is no bound of what can be left.
    told = r"by \w+, 0\.3\d* s; the shortest found that meets the other limits takes"
    for half_width in (0.0, 0.001):
        asked = Requirements(half_width=half_width, sign="positive", max_duration_s=0.4)
        with refused("none_meets_all", says=told):
            recommend(Mode(natural_frequency_rad_s=2 * math.pi), IDEAL, asked)


@pytest.mark.parametrize("ramp_s", [5.5, 6.2, 12.0])
def test_a_band_in_which_the_unshaped_ramp_leaves_nothing_is_served(ramp_s: float) -> None:
    drive = RateLimited(accel_limit_m_s2=1 / ramp_s, decel_limit_m_s2=1.0, speed_m_s=1.0)
    mode = Mode(natural_frequency_rad_s=1.0)
    found = recommend(mode, drive, Requirements(half_width=0.2))
    assert found.candidates
