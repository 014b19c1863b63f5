"""Impulses brought to a sample grid: nearest, carried, split."""

import math

import numpy as np
import pytest

from design.model.actuators.ideal import Ideal
from design.model.plants.mode import Mode
from design.sampling.sample_grid import nearest, round_with_carry, split
from design.sampling.unity_grid import unity_on_grid
from tests.design.sampling.on_samples import EXACT, designed, percent, shaper
from tests.refusals import refused
from tests.shaper_table import CRANE

# Appendix C.


def test_carrying_the_error_is_equations_7_and_8() -> None:
    # In samples of .02 s: t2 3.3 -> 3, error .3; t3 7.4 + .3 -> 8 (nearest would be 7).
    by_hand = round_with_carry(shaper([0.0, 0.066, 0.148], [1.0, -1.0, 1.0]), 0.02)
    assert by_hand.times_s.tolist() == [0.0, 3 * 0.02, 8 * 0.02]
    # t2 3.7 -> 4, error -.3; t3 7.6 - .3 -> 7; error .6 by (8), carried on: t4 9.2 + .6 -> 10.
    four = round_with_carry(shaper([0.0, 0.074, 0.152, 0.184], [1.0, -1.0, 1.0, -1.0]), 0.02)
    assert four.times_s.tolist() == [0.0, 4 * 0.02, 7 * 0.02, 10 * 0.02]


def test_the_case_of_figure_5_is_within_its_5_percent_and_needs_no_carrying() -> None:
    # UMZV of the thesis's crane at .02 s lies at 14.95 and 29.90 samples.
    umzv = designed("umzv", CRANE, Ideal())
    digital = round_with_carry(umzv, 0.02)
    assert digital.times_s.tolist() == [0.0, 15 * 0.02, 30 * 0.02]
    assert digital.times_s.tolist() == nearest(umzv, 0.02).times_s.tolist()
    assert percent(digital, CRANE.mode) == pytest.approx(0.5787, abs=5e-5)  # as measured


def test_carrying_the_error_leaves_more_on_average_than_the_nearest_samples() -> None:
    # UMZV, undamped, periods of 40 to 400 samples. To first order t2 off by d leaves least with t3
    # off by d/2; equation 8 sends it the other way.
    rng = np.random.default_rng(5)
    squares = {"carried": 0.0, "nearest": 0.0, "search": 0.0}
    for period in rng.uniform(40, 400, 300).tolist():
        mode = Mode(natural_frequency_rad_s=2 * math.pi / period)
        umzv = shaper([0.0, period / 6, period / 3], [1.0, -1.0, 1.0])
        results = {
            "carried": round_with_carry(umzv, 1.0),
            "nearest": nearest(umzv, 1.0),
            "search": unity_on_grid(umzv, mode, Ideal(), 1.0, slope=False),
        }
        for name, result in results.items():
            # In units of the phase of half a sample, by which all of them scale.
            squares[name] += (percent(result, mode) / 100 * period / math.pi) ** 2 / 300
    # Of 200,000 periods: .999 carried, .866 nearest; of 300 within some 3 %.
    assert math.sqrt(squares["carried"]) == pytest.approx(1.0, abs=0.05)
    assert math.sqrt(squares["nearest"]) == pytest.approx(0.866, abs=0.05)
    assert squares["search"] < squares["nearest"]


def test_the_split_keeps_sum_and_mean_time() -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        impulses = shaper(sorted(rng.uniform(-1, 3, 5).tolist()), rng.uniform(-1, 1, 5).tolist())
        shared = split(impulses, 0.07)
        for power in (0, 1):
            assert shared.amplitudes @ shared.times_s**power == pytest.approx(
                impulses.amplitudes @ impulses.times_s**power, abs=EXACT
            )


def test_carrying_an_error_must_not_bring_two_impulses_together() -> None:
    # 1.5 -> 2, error -.5; 2.6 - .5 -> 2.
    with refused(
        "impulses_share_a_sample",
        "sample_time_s",
        says=r"no two impulses .* here \[0, 2, 2\], got 1\.0",
    ):
        round_with_carry(shaper([0.0, 1.5, 2.6], [1.0, -1.0, 1.0]), 1.0)
