"""Shapers on a sample grid: published figures, brute force, invariance."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from design.analysis.certificate import certify
from design.analysis.residual import residual_vectors, residual_vibration
from design.analysis.residuals_of_many import vectors_of_many
from design.claims import zeros
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.sampling.sample_grid import nearest, round_with_carry, split
from design.sampling.sampled import Sampled, sample
from design.sampling.sampled_design import sampled_design
from design.sampling.sampled_free import sample_free
from design.sampling.unity_grid import unity_on_grid
from design.shapers.registry import SHAPERS
from tests.design.sampling.on_samples import (
    EXACT,
    PRINTER,
    RESIDUAL,
    SAMPLE_S,
    SWITCHED,
    WITH_SLOPE,
    assert_on_grid,
    designed,
    exact,
    percent,
    positive_shaper,
    shaper,
)
from tests.refusals import refused
from tests.second_route import claims_by_formula, largest_in_band_by_formula
from tests.shaper_table import CRANE, THESIS

# Published figures, to the three digits that are given.


def test_zv_on_the_grid_leaves_the_published_residuals() -> None:
    zv = positive_shaper(PRINTER, 2)
    assert percent(split(zv, SAMPLE_S)) == pytest.approx(0.583, abs=5e-4)
    assert percent(nearest(zv, SAMPLE_S)) == pytest.approx(3.00, abs=5e-3)
    assert percent(exact(zv, PRINTER, Ideal(), SAMPLE_S)) <= 100 * EXACT


def test_umzv_on_the_grid_leaves_the_published_residuals() -> None:
    umzv = designed("umzv", PRINTER, Ideal())
    assert percent(split(umzv, SAMPLE_S)) == pytest.approx(2.24, abs=5e-3)
    assert percent(nearest(umzv, SAMPLE_S)) == pytest.approx(33.6, abs=5e-2)


def test_the_search_leaves_a_fifth_where_the_nearest_samples_leave_a_third() -> None:
    found = sample(designed("umzv", PRINTER, Ideal()), PRINTER, Ideal(), SAMPLE_S, RESIDUAL)
    assert found.method == "unity_on_grid"
    assert found.samples == (0, 3, 5)
    assert found.impulses.amplitudes.tolist() == [1.0, -1.0, 1.0]
    assert 100 * found.residual == pytest.approx(19.043, abs=5e-4)  # as measured
    assert found.continuous_residual < EXACT


# The search on whole samples.


def brute_force(
    impulses: Impulses, mode: Mode, actuator: Actuator, sample_time_s: float, weight: float
) -> float:
    """Least of residual + weight * slope over four samples on each side, one by one."""
    centres = [math.floor(time / sample_time_s + 0.5) for time in impulses.times_s.tolist()]
    least = math.inf
    for moves in itertools.product(range(-4, 5), repeat=len(centres) - 1):
        samples = [centres[0], *(a + b for a, b in zip(centres[1:], moves, strict=True))]
        if any(later <= earlier for earlier, later in itertools.pairwise(samples)):
            continue
        candidate = shaper([k * sample_time_s for k in samples], impulses.amplitudes.tolist())
        left = claims_by_formula(candidate, mode, actuator)
        least = min(least, left["residual"] + weight * left["slope"])
    return least


@pytest.mark.parametrize("sample_time_s", [0.01, 0.007, 0.003, 0.001])
def test_no_other_samples_around_leave_less(sample_time_s: float) -> None:
    for actuator in (Ideal(), FirstOrder(accel_time_constant_s=0.004, decel_time_constant_s=0.002)):
        umzv = designed("numzv", PRINTER, actuator)
        found = unity_on_grid(umzv, PRINTER, actuator, sample_time_s, slope=False)
        least = brute_force(umzv, PRINTER, actuator, sample_time_s, weight=0.0)
        assert residual_vibration(found, PRINTER, actuator) == pytest.approx(least, abs=EXACT)


def test_no_other_samples_around_leave_less_with_slope() -> None:
    numzvd = designed("numzvd", CRANE, THESIS)
    found = unity_on_grid(numzvd, CRANE.mode, THESIS, 0.01, slope=True)
    left = claims_by_formula(found, CRANE.mode, THESIS)
    least = brute_force(numzvd, CRANE.mode, THESIS, 0.01, weight=0.05)
    # The search takes the slope by a central difference, good to 1e-8.
    assert left["residual"] + 0.05 * left["slope"] == pytest.approx(least, abs=1e-8)


@pytest.mark.parametrize("actuator", [THESIS, SWITCHED], ids=["superposed", "switched"])
@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
def test_what_the_crane_s_shapers_leave_falls_with_the_sample_time(
    kind: str, actuator: Actuator
) -> None:
    impulses = designed(kind, CRANE, actuator)
    found = {
        time: sample(impulses, CRANE.mode, actuator, time, SHAPERS[kind].claims)
        for time in (0.02, 0.01, 0.005, 0.001, 0.0001)
    }
    for time, result in found.items():
        assert_on_grid(result.impulses, time)
        assert result.impulses.amplitudes.tolist() == impulses.amplitudes.tolist()
    # As measured, in percent, at 10 ms and 1 ms.
    expected = {
        ("numzv", "superposed"): (0.3822, 0.1730),
        ("numzvd", "superposed"): (0.6385, 0.0564),
        ("numzv", "switched"): (0.3610, 0.1785),
        ("numzvd", "switched"): (0.6075, 0.0170),
    }[kind, actuator.model]
    assert 100 * found[0.01].residual == pytest.approx(expected[0], abs=5e-5)
    assert 100 * found[0.001].residual == pytest.approx(expected[1], abs=5e-5)
    assert found[0.0001].residual < 2e-4
    # What was minimised. No law on every grid, but these lie one within the other.
    weight = 0.05 if kind == "numzvd" else 0.0
    each = [measured(result, actuator) for result in found.values()]
    minimised = [left["residual"] + weight * left["slope"] for left in each]
    for coarser, finer in itertools.pairwise(minimised):
        assert finer <= coarser + 1e-10  # rounding of the simulation


def measured(result: Sampled, actuator: Actuator) -> dict[str, float]:
    """Residual and slope by simulation."""
    claims = certify(result.impulses, CRANE.mode, actuator, zeros(WITH_SLOPE)).claims
    return {claim.quantity: claim.value for claim in claims}


@pytest.mark.parametrize("actuator", [THESIS, SWITCHED], ids=["superposed", "switched"])
def test_the_record_tells_the_residual_that_simulation_finds(actuator: Actuator) -> None:
    impulses = designed("numzvd", CRANE, actuator)
    found = sample(impulses, CRANE.mode, actuator, 0.01, WITH_SLOPE)
    # Of simulation by matrix exponentials, on a value of order 1e-3.
    assert measured(found, actuator)["residual"] == pytest.approx(found.residual, abs=1e-11)
    assert found.continuous_residual < 1e-10  # to which designs are solved
    assert found.sample_time_s == 0.01


def test_of_samples_that_leave_the_same_the_shorter_are_taken() -> None:
    # Period of 12 samples: +1 -1 at 0 and 12 - k leaves what 0 and k leaves; nearest to 6.5 is 7,
    # four to either side: 3 ... 11. The least is at 11, as good as 1, which is out of reach.
    mode = Mode(natural_frequency_rad_s=2 * math.pi / 12)
    least = unity_on_grid(shaper([0.0, 6.5], [1.0, -1.0]), mode, Ideal(), 1.0, slope=False)
    assert least.times_s.tolist() == [0.0, 11.0]
    # Around 6 they are 2 and 10: equal.
    equal = unity_on_grid(shaper([0.0, 6.0], [1.0, -1.0]), mode, Ideal(), 1.0, slope=False)
    assert equal.times_s.tolist() == [0.0, 2.0]


def test_more_impulses_narrow_the_search_and_too_many_are_refused() -> None:
    times = [10.3 * index for index in range(12)]
    signs = [(-1.0) ** index for index in range(12)]
    mode = Mode(natural_frequency_rad_s=0.1)
    ten = shaper(times[:10], signs[:10])
    found = unity_on_grid(ten, mode, Ideal(), 1.0, slope=False)
    assert residual_vibration(found, mode, Ideal()) <= residual_vibration(
        nearest(ten, 1.0), mode, Ideal()
    )
    with refused("too_many_to_search", "impulses", says="at most 10, got 11"):
        unity_on_grid(shaper(times[:11], signs[:11]), mode, Ideal(), 1.0, slope=False)


def test_a_single_step_stays_a_step() -> None:
    step = shaper([0.3], [1.0])
    for found in (
        nearest(step, 0.25),
        round_with_carry(step, 0.25),
        unity_on_grid(step, PRINTER, Ideal(), 0.25, slope=True),
    ):
        assert found.times_s.tolist() == [0.25]


@pytest.mark.parametrize("seed", range(40))
def test_many_commands_at_once_are_each_command_by_itself(seed: int) -> None:
    rng = np.random.default_rng(seed)
    actuator: Actuator = (
        replace(SWITCHED, accel=replace(THESIS.accel, damping_ratio=1.0)),
        THESIS,
        FirstOrder(accel_time_constant_s=0.0, decel_time_constant_s=0.1, model="switched"),
        FirstOrder(accel_time_constant_s=0.2, decel_time_constant_s=0.1, model="switched"),
    )[seed % 4]
    times = np.sort(rng.uniform(0, 3, (7, 5)), axis=1)
    amplitudes = rng.uniform(-1, 1, 5)
    poles = rng.uniform(1, 5, 7) * complex(-0.1, math.sqrt(0.99))
    each = [
        residual_vectors(
            Impulses(times_s=row, amplitudes=amplitudes), poles[index : index + 1], actuator
        )[0]
        for index, row in enumerate(times)
    ]
    together = vectors_of_many(times, amplitudes, poles, actuator)
    assert np.max(np.abs(together - np.array(each))) < 1e-13  # the same sums in another order


# Invariance.


@pytest.mark.parametrize("actuator", [THESIS, SWITCHED], ids=["superposed", "switched"])
@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
def test_scaling_time_scales_the_times_and_nothing_else(kind: str, actuator: SecondOrder) -> None:
    mode = CRANE.mode
    impulses = designed(kind, CRANE, actuator)
    claims = RESIDUAL if kind == "numzv" else WITH_SLOPE
    found = sample(impulses, mode, actuator, 0.01, claims)
    scaled = sample(
        # By a power of two, which does not round.
        Impulses(times_s=4 * impulses.times_s, amplitudes=impulses.amplitudes),
        Mode(natural_frequency_rad_s=mode.natural_frequency_rad_s / 4),
        replace(
            actuator,
            accel=replace(THESIS.accel, natural_frequency_rad_s=20.0 / 4),
            decel=replace(THESIS.decel, natural_frequency_rad_s=50.0 / 4),
        ),
        0.04,
        claims,
    )
    assert scaled.samples == found.samples
    assert scaled.method == found.method
    assert scaled.impulses.amplitudes == pytest.approx(found.impulses.amplitudes, abs=EXACT)
    assert scaled.residual == pytest.approx(found.residual, abs=EXACT)


def test_a_shaper_on_the_grid_stays_as_it_is() -> None:
    # .29 / .01 is 28.999999999999996: on a sample, but for rounding.
    impulses = shaper([0.0, 0.07, 0.29], [0.3, 0.3, 0.4])
    for found in (
        nearest(impulses, SAMPLE_S),
        round_with_carry(impulses, SAMPLE_S),
        split(impulses, SAMPLE_S),
    ):
        assert np.rint(found.times_s / SAMPLE_S).tolist() == [0, 7, 29]
        assert found.amplitudes.tolist() == [0.3, 0.3, 0.4]


# Bad input.


@pytest.mark.parametrize("value", [0.0, -0.01, math.nan, math.inf])
def test_a_sample_time_must_be_positive(value: float) -> None:
    zv = positive_shaper(PRINTER, 2)
    umzv = designed("umzv", PRINTER, Ideal())
    with refused("not_positive", "sample_time_s"):
        sample(umzv, PRINTER, Ideal(), value, RESIDUAL)
    with refused("not_positive", "sample_time_s"):
        sample_free(zv, zeros(RESIDUAL), (PRINTER,), Ideal(), value)
    with refused("not_positive", "sample_time_s"):
        nearest(zv, value)
    with refused("not_positive", "sample_time_s"):
        round_with_carry(zv, value)


def test_a_sample_time_must_leave_every_impulse_a_sample_of_its_own() -> None:
    umzv = designed("umzv", PRINTER, Ideal())
    rule = r"sample_time_s must be at most the shortest gap between two impulses, 0\.0208931"
    with refused("sample_time_too_long", "sample_time_s", says=rule):
        sample(umzv, PRINTER, Ideal(), 0.021, RESIDUAL)
    for rounding in (nearest, round_with_carry):
        with refused("sample_time_too_long", "sample_time_s", says=rule):
            rounding(umzv, 0.021)
    assert sample(umzv, PRINTER, Ideal(), 0.0208, RESIDUAL).residual < 0.5


def test_where_commands_are_searched_a_sample_may_be_half_a_period() -> None:
    umzv = designed("umzv", PRINTER, Ideal())
    found = sample(umzv, PRINTER, Ideal(), 0.021, RESIDUAL, tolerance=0.01)
    assert found.method == "search_on_off"
    assert_on_grid(found.impulses, 0.021)
    assert (found.nearest_residual, found.carried_residual) == (None, None)
    assert len(found.tried) == 1
    longer = sample(umzv, PRINTER, Ideal(), 0.068, RESIDUAL, tolerance=0.01)
    assert longer.split_residual is None  # a sample is longer than the shaper
    assert longer.residual < 1.0
    rule = r"sample_time_s must be at most half a period, 0\.0684932"
    with refused("sample_time_too_long", "sample_time_s", says=rule):
        sample(umzv, PRINTER, Ideal(), 0.07, RESIDUAL, tolerance=0.01)
    # No command fits into so few periods.
    with refused("sample_time_too_long", "sample_time_s", says="the shortest gap"):
        sample(umzv, PRINTER, Ideal(), 0.021, RESIDUAL, tolerance=0.01, max_duration_periods=0.2)


def test_a_sample_time_must_not_drown_in_rounding() -> None:
    zv = positive_shaper(PRINTER, 2)
    with refused("sample_time_too_short", "sample_time_s", says=r"at least 6\.85789e-08"):
        sample_free(zv, zeros(RESIDUAL), (PRINTER,), Ideal(), 1e-9)


@pytest.mark.parametrize("actuator", [Ideal(), THESIS], ids=["ideal", "thesis"])
@pytest.mark.parametrize("sample_time_s", [0.01, 0.04])
@pytest.mark.parametrize("kind", ["num_si", "num_ei"])
def test_of_all_samples_around_it_a_shaper_over_a_band_takes_those_that_leave_least_in_it(
    kind: str, sample_time_s: float, actuator: Actuator
) -> None:
    mode = CRANE.mode
    made = design(mode, actuator, SHAPERS[kind])
    band = made.certificate.claims[-1].band
    assert band is not None
    found, told = sampled_design(made, mode, actuator, sample_time_s, tolerance=0.01)
    assert found.certificate.verified
    over_band = found.certificate.claims[-1]
    assert over_band.band == band
    left = largest_in_band_by_formula(found.impulses, mode, actuator, band, 401)
    assert left == pytest.approx(over_band.value, rel=1e-4)
    # Any impulse but the first a sample or two earlier or later leaves more.
    for moves in itertools.product(range(-2, 3), repeat=2):
        for pair in itertools.combinations(range(1, found.impulses.times_s.size), 2):
            samples = np.array(told.samples)
            samples[list(pair)] += moves
            if (np.diff(samples) > 0).all():
                other = Impulses(
                    times_s=samples * sample_time_s, amplitudes=found.impulses.amplitudes
                )
                more = largest_in_band_by_formula(other, mode, actuator, band, 17)
                assert more >= told.tried[0].compared * (1 - 1e-9)


def test_a_tolerance_that_samples_do_not_keep_is_told() -> None:
    made = design(PRINTER, Ideal(), SHAPERS["num_si"])
    kept, _ = sampled_design(made, PRINTER, Ideal(), 0.001, tolerance=0.01)
    assert kept.certificate.claims[-1].value <= 0.05
    assert not [warning for warning in kept.warnings if warning.code == "tolerance_not_kept"]
    lost, _ = sampled_design(made, PRINTER, Ideal(), 0.005, tolerance=0.01)
    [told] = [warning for warning in lost.warnings if warning.code == "tolerance_not_kept"]
    assert lost.certificate.verified
    assert (
        f"{lost.certificate.claims[-1].value:.4g}, more than the tolerance of 0.05" in told.detail
    )


def test_a_residual_that_simulation_does_not_confirm_is_a_failure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = design(CRANE, THESIS, SHAPERS["numzv"])
    found, _ = sampled_design(made, CRANE.mode, THESIS, SAMPLE_S)
    assert found.residual > 1e-4
    monkeypatch.setattr("design.sampling.sampled_design.residual_vibration", lambda *_: 0.0)
    says = rf"differs from its formula: the residual is {found.residual:.3g}, allowed 1e-09$"
    with refused("sampled_unlike_formula", says=says):
        sampled_design(made, CRANE.mode, THESIS, SAMPLE_S)
