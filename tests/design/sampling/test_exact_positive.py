"""Positive shapers on a sample grid: exact on any, behind any actuator, or shared."""

import math
from dataclasses import replace

import numpy as np
import pytest

from design.analysis.certificate import certify
from design.analysis.residual import residual_vibration
from design.claims import zeros
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.sampling.exact_positive import exact_positive
from design.sampling.sample_grid import split
from design.sampling.sampled import sample
from design.types import FloatArray
from tests.design.sampling.on_samples import (
    EXACT,
    PRINTER,
    RESIDUAL,
    SAMPLE_S,
    SWITCHED,
    WITH_SLOPE,
    assert_on_grid,
    designed,
    percent,
    positive_shaper,
    shaper,
)
from tests.refusals import refused
from tests.second_route import claims_by_formula
from tests.shaper_table import CRANE, FIRST_ORDER, THESIS

# Exactness of positive shapers.


@pytest.mark.parametrize("seed", range(60))
def test_a_positive_shaper_is_exact_on_any_grid(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mode = Mode(
        natural_frequency_rad_s=float(rng.uniform(1, 50)), damping_ratio=float(rng.uniform(0, 0.3))
    )
    steps = 2 + seed % 3
    slope = steps > 2
    continuous = positive_shaper(mode, steps)
    # From three samples in the half period upwards.
    sample_time_s = float(continuous.times_s[1] / rng.uniform(3, 100))
    exact = exact_positive(continuous, mode, Ideal(), sample_time_s, slope=slope)
    left = claims_by_formula(exact, mode, Ideal())
    assert left["residual"] <= EXACT
    assert not slope or left["slope"] <= 20 * EXACT  # terms grow with the phase, up to 10 rad
    assert exact.amplitudes.min() > 0
    assert exact.amplitudes.sum() == pytest.approx(1.0, abs=EXACT)
    assert_on_grid(exact, sample_time_s)


@pytest.mark.parametrize("actuator", [FIRST_ORDER, THESIS, SWITCHED])
def test_a_positive_shaper_is_exact_behind_any_actuator(actuator: Actuator) -> None:
    mode = replace(CRANE, damping_ratio=0.05).mode
    for steps in (2, 3):
        claims = certify(
            exact_positive(positive_shaper(mode, steps), mode, actuator, 0.04, slope=steps == 3),
            mode,
            actuator,
            zeros(WITH_SLOPE),
        ).claims
        assert claims[0].holds
        assert claims[1].holds == (steps == 3)


@pytest.mark.parametrize("half_period", [3.0, 3.5, 6.5, 20.0, 20.5, 50.0 + 1e-8, 50.5 - 1e-8])
def test_no_share_is_so_small_that_it_counts_as_a_step_that_does_not_accelerate(
    half_period: float,
) -> None:
    # Where some or all impulses fall on samples, amplitudes beside them come out as rounding.
    mode = Mode(natural_frequency_rad_s=math.pi / half_period)
    actuator = FirstOrder(accel_time_constant_s=1.0, decel_time_constant_s=0.3, model="switched")
    for steps in (2, 3, 4):
        exact = exact_positive(positive_shaper(mode, steps), mode, actuator, 1.0, slope=steps > 2)
        assert exact.accelerates.all()
        assert residual_vibration(exact, mode, actuator) <= EXACT


def test_a_robust_shaper_keeps_its_impulses_where_only_the_residual_is_asked() -> None:
    zvd = positive_shaper(PRINTER, 3)
    exact = exact_positive(zvd, PRINTER, Ideal(), SAMPLE_S)
    near = split(zvd, SAMPLE_S)
    assert exact.times_s.tolist() == near.times_s.tolist()
    assert np.max(np.abs(exact.amplitudes - near.amplitudes)) < 0.01  # the split leaves .4 %
    assert percent(exact) <= 100 * EXACT


def test_a_shaper_of_negative_steps_is_the_mirror_image() -> None:
    zv = positive_shaper(PRINTER, 2)
    mirrored = replace_amplitudes(zv, -zv.amplitudes)
    exact = exact_positive(zv, PRINTER, THESIS, SAMPLE_S)
    mirror = exact_positive(mirrored, PRINTER, THESIS, SAMPLE_S)
    assert mirror.amplitudes.tolist() == (-exact.amplitudes).tolist()


def replace_amplitudes(impulses: Impulses, amplitudes: FloatArray) -> Impulses:
    return Impulses(times_s=impulses.times_s, amplitudes=amplitudes)


def test_what_no_amplitudes_make_zero_is_shared_and_says_what_it_leaves() -> None:
    # Two steps a tenth of a period apart cannot cancel.
    near = shaper([0.0, 0.0137], [0.5, 0.5])
    with refused("no_positive_on_samples", says=r"one sign on 4 samples .* 0\.001 s"):
        exact_positive(near, PRINTER, Ideal(), 0.001)
    found = sample(near, PRINTER, Ideal(), 0.001, RESIDUAL)
    assert found.method == "split"
    assert found.residual == residual_vibration(found.impulses, PRINTER, Ideal())
    assert found.residual == pytest.approx(found.continuous_residual, rel=0.01)
    assert found.residual > 0.5


def test_a_shaper_that_claims_nothing_is_shared() -> None:
    zv = positive_shaper(PRINTER, 2)
    found = sample(zv, PRINTER, Ideal(), SAMPLE_S, ())
    assert found.method == "split"
    assert 100 * found.residual == pytest.approx(0.583, abs=5e-4)


def test_a_positive_shaper_must_not_be_shorter_than_a_sample() -> None:
    zv = positive_shaper(PRINTER, 2)
    rule = r"sample_time_s must be at most the duration of the shaper, 0\.0685789, got 0\.07"
    with refused("sample_time_too_long", "sample_time_s", says=rule):
        sample(zv, PRINTER, Ideal(), 0.07, RESIDUAL)


def test_amplitudes_of_both_signs_are_not_solved_for() -> None:
    umzv = designed("umzv", PRINTER, Ideal())
    with refused("signs_mixed", "amplitudes"):
        exact_positive(umzv, PRINTER, Ideal(), SAMPLE_S)
