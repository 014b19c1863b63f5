"""Impulses on a sample grid: published figures, brute force, exactness, invariance."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from design.analysis.certificate import certify
from design.analysis.residual import residual_vibration
from design.analysis.residuals_of_many import vectors_of_many
from design.analysis.vectors import residual_vectors
from design.claims import Quantity, zeros
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.pipeline import design
from design.sampling.exact_positive import exact_positive
from design.sampling.sample_grid import nearest, round_with_carry, split
from design.sampling.sampled import Sampled, sample
from design.sampling.sampled_design import sampled_design
from design.sampling.unity_grid import unity_on_grid
from design.shapers.registry import SHAPERS
from design.types import FloatArray
from tests.refusals import refused
from tests.second_route import claims_by_formula, largest_in_band_by_formula
from tests.shaper_table import CRANE, FIRST_ORDER, THESIS

PRINTER = Mode(natural_frequency_rad_s=2 * math.pi * 7.3, damping_ratio=0.05)
SAMPLE_S = 0.01
"""The case of the published figures: 7.3 Hz, damping ratio .05, 10 ms."""

EXACT = 1e-12
"""What counts as zero: rounding of a few terms of size one, with a wide margin [-]."""

SWITCHED = replace(THESIS, model="switched")


def shaper(times: list[float], amplitudes: list[float]) -> Impulses:
    return Impulses(times_s=np.array(times), amplitudes=np.array(amplitudes))


RESIDUAL: tuple[Quantity, ...] = ("residual",)
WITH_SLOPE: tuple[Quantity, ...] = ("residual", "slope")


def positive_shaper(mode: Mode, steps: int) -> Impulses:
    """ZV (2 steps), ZVD (3), ZVDD (4), from the damped half period and its decay."""
    root = math.sqrt(1 - mode.damping_ratio**2)
    half_s = math.pi / (mode.natural_frequency_rad_s * root)
    decay = math.exp(-math.pi * mode.damping_ratio / root)
    heights = [math.comb(steps - 1, index) * decay**index for index in range(steps)]
    total = sum(heights)
    return shaper([half_s * index for index in range(steps)], [a / total for a in heights])


def designed(kind: str, plant: Plant, actuator: Actuator) -> Impulses:
    return design(plant, actuator, SHAPERS[kind]).impulses


def percent(impulses: Impulses, mode: Mode = PRINTER, actuator: Actuator | None = None) -> float:
    return 100 * residual_vibration(impulses, mode, actuator or Ideal())


def assert_on_grid(impulses: Impulses, sample_time_s: float) -> None:
    samples = np.rint(impulses.times_s / sample_time_s)
    assert impulses.times_s.tolist() == (samples * sample_time_s).tolist()
    assert np.all(np.diff(samples) >= 1)


# Published figures, to the three digits that are given.


def test_zv_on_the_grid_leaves_the_published_residuals() -> None:
    zv = positive_shaper(PRINTER, 2)
    exact = exact_positive(zv, PRINTER, Ideal(), SAMPLE_S)
    assert percent(split(zv, SAMPLE_S)) == pytest.approx(0.583, abs=5e-4)
    assert percent(nearest(zv, SAMPLE_S)) == pytest.approx(3.00, abs=5e-3)
    assert percent(exact) <= 100 * EXACT


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


def test_the_split_keeps_sum_and_mean_time() -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        impulses = shaper(sorted(rng.uniform(-1, 3, 5).tolist()), rng.uniform(-1, 1, 5).tolist())
        shared = split(impulses, 0.07)
        for power in (0, 1):
            assert shared.amplitudes @ shared.times_s**power == pytest.approx(
                impulses.amplitudes @ impulses.times_s**power, abs=EXACT
            )


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
    with refused("no_positive_on_samples", says="residual and the slope zero"):
        exact_positive(shaper([0.0], [1.0]), PRINTER, Ideal(), 0.25, slope=True)


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
@pytest.mark.parametrize("kind", ["zv", "zvd", "numzvd"])
def test_scaling_time_scales_the_times_and_nothing_else(kind: str, actuator: SecondOrder) -> None:
    mode = CRANE.mode
    impulses = (
        designed(kind, CRANE, actuator) if kind == "numzvd" else positive_shaper(mode, len(kind))
    )
    claims = RESIDUAL if kind == "zv" else WITH_SLOPE
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
    for impulses in (zv, umzv):
        with refused("not_positive", "sample_time_s"):
            sample(impulses, PRINTER, Ideal(), value, RESIDUAL)
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


def test_carrying_an_error_must_not_bring_two_impulses_together() -> None:
    # 1.5 -> 2, error -.5; 2.6 - .5 -> 2.
    with refused(
        "impulses_share_a_sample",
        "sample_time_s",
        says=r"no two impulses .* here \[0, 2, 2\], got 1\.0",
    ):
        round_with_carry(shaper([0.0, 1.5, 2.6], [1.0, -1.0, 1.0]), 1.0)


def test_a_positive_shaper_must_not_be_shorter_than_a_sample() -> None:
    zv = positive_shaper(PRINTER, 2)
    rule = r"sample_time_s must be at most the duration of the shaper, 0\.0685789, got 0\.07"
    with refused("sample_time_too_long", "sample_time_s", says=rule):
        sample(zv, PRINTER, Ideal(), 0.07, RESIDUAL)


def test_a_sample_time_must_not_drown_in_rounding() -> None:
    zv = positive_shaper(PRINTER, 2)
    with refused("sample_time_too_short", "sample_time_s", says=r"at least 6\.85789e-08"):
        sample(zv, PRINTER, Ideal(), 1e-9, RESIDUAL)


def test_amplitudes_of_both_signs_are_not_solved_for() -> None:
    umzv = designed("umzv", PRINTER, Ideal())
    with refused("signs_mixed", "amplitudes"):
        exact_positive(umzv, PRINTER, Ideal(), SAMPLE_S)


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
