"""Amplitudes on samples: exact where they can be, the least over a band, on the fewest samples."""

import math
from dataclasses import replace

import cvxpy as cp
import numpy as np
import pytest

from design.analysis.certificate import certify
from design.analysis.residual import residual_vibration
from design.claims import Promise, within, zeros
from design.errors import InfeasibleDesignError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.sampling.free_amplitudes import FreeAmplitudes, free_on_samples
from design.sampling.sample_grid import split
from design.sampling.sampled_design import promise_of, sampled_design
from design.shapers.registry import SHAPERS
from tests.design.sampling.on_samples import (
    EXACT,
    PRINTER,
    RESIDUAL,
    SAMPLE_S,
    SWITCHED,
    WITH_SLOPE,
    assert_on_grid,
    exact,
    percent,
    positive_shaper,
    shaper,
)
from tests.expm_route import outcome
from tests.refusals import refused
from tests.second_route import claims_by_formula, largest_in_band_by_formula
from tests.shaper_table import CRANE, FIRST_ORDER, THESIS


def mode_of(hertz: float, damping_ratio: float) -> Mode:
    return Mode(natural_frequency_rad_s=2 * math.pi * hertz, damping_ratio=damping_ratio)


def found_for(
    kind: str, mode: Mode, actuator: Actuator, sample_time_s: float, **options: object
) -> FreeAmplitudes:
    """Return the amplitudes of a kind on samples, by what its design promises."""
    entry = SHAPERS[kind]
    made = design(mode, actuator, entry, entry.options(**options))
    promises = [promise_of(claim) for claim in made.certificate.claims]
    drive = Ideal() if made.for_ideal else actuator
    return free_on_samples(made.impulses, promises, (mode,), drive, sample_time_s)


# Zeros.


@pytest.mark.parametrize("seed", range(60))
def test_a_positive_shaper_is_exact_on_any_grid(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mode = Mode(
        natural_frequency_rad_s=float(rng.uniform(1, 50)), damping_ratio=float(rng.uniform(0, 0.3))
    )
    steps = 2 + seed % 3
    claims = RESIDUAL if steps == 2 else WITH_SLOPE
    continuous = positive_shaper(mode, steps)
    # From one sample in the half period upwards.
    sample_time_s = float(continuous.times_s[1] / rng.uniform(1, 100))
    found = exact(continuous, mode, Ideal(), sample_time_s, claims)
    left = claims_by_formula(found, mode, Ideal())
    assert left["residual"] <= EXACT
    assert "slope" not in claims or left["slope"] <= 20 * EXACT  # terms grow with the phase
    assert found.amplitudes.min() > 0
    assert found.amplitudes.sum() == pytest.approx(1.0, abs=EXACT)
    assert_on_grid(found, sample_time_s)
    assert found.times_s.size <= 1 + 2 * len(claims)  # as many as there are equations


@pytest.mark.parametrize("actuator", [FIRST_ORDER, THESIS, SWITCHED])
def test_a_positive_shaper_is_exact_behind_any_actuator(actuator: Actuator) -> None:
    mode = replace(CRANE, damping_ratio=0.05).mode
    for steps, claims in ((2, RESIDUAL), (3, WITH_SLOPE)):
        found = exact(positive_shaper(mode, steps), mode, actuator, 0.04, claims)
        assert certify(found, mode, actuator, zeros(claims)).verified


@pytest.mark.parametrize("half_period", [3.0, 3.5, 6.5, 20.0, 20.5, 50.0 + 1e-8, 50.5 - 1e-8])
def test_no_share_is_so_small_that_it_counts_as_a_step_that_does_not_accelerate(
    half_period: float,
) -> None:
    # Where some or all impulses fall on samples, amplitudes beside them come out as rounding.
    mode = Mode(natural_frequency_rad_s=math.pi / half_period)
    actuator = FirstOrder(accel_time_constant_s=1.0, decel_time_constant_s=0.3, model="switched")
    for steps in (2, 3, 4):
        claims = RESIDUAL if steps == 2 else WITH_SLOPE
        found = exact(positive_shaper(mode, steps), mode, actuator, 1.0, claims)
        assert found.accelerates.all()
        assert residual_vibration(found, mode, actuator) <= EXACT


def test_a_robust_shaper_stays_near_its_impulses_where_only_the_residual_is_asked() -> None:
    zvd = positive_shaper(PRINTER, 3)
    found = exact(zvd, PRINTER, Ideal(), SAMPLE_S)
    near = split(zvd, SAMPLE_S)
    assert set(found.times_s.tolist()) <= set(near.times_s.tolist())
    assert percent(found) <= 100 * EXACT


def test_a_shaper_of_negative_steps_is_the_mirror_image() -> None:
    zv = positive_shaper(PRINTER, 2)
    mirrored = Impulses(times_s=zv.times_s, amplitudes=-zv.amplitudes)
    found = exact(zv, PRINTER, THESIS, SAMPLE_S)
    mirror = exact(mirrored, PRINTER, THESIS, SAMPLE_S)
    assert mirror.amplitudes.tolist() == (-found.amplitudes).tolist()


def test_what_so_few_samples_cannot_make_zero_takes_more() -> None:
    # Two steps a tenth of a period apart cannot cancel: half a period does.
    near = shaper([0.0, 0.0137], [0.5, 0.5])
    found = exact(near, PRINTER, Ideal(), 0.001)
    assert percent(found) <= 100 * EXACT
    assert found.duration_s == pytest.approx(0.069)  # half a damped period is 68.6 ms


CASES_OF_BOTH_SIGNS = [
    ("sna_zv", 60, 0.0, 0.002),
    ("sna_zv", 1, 0.0, 0.010),
    ("sna_zvd", 5, 0.0, 0.010),
    ("ps_zv", 5, 0.02, 0.010),
    ("ps_zv", 0.3, 0.0, 0.100),
    ("ps_zvd", 5, 0.02, 0.010),
]


@pytest.mark.parametrize(("kind", "hertz", "damping", "sample_time_s"), CASES_OF_BOTH_SIGNS)
def test_amplitudes_of_both_signs_are_solved_for_within_what_the_kind_allows(
    kind: str, hertz: float, damping: float, sample_time_s: float
) -> None:
    mode = mode_of(hertz, damping)
    found = found_for(kind, mode, Ideal(), sample_time_s)
    command = found.impulses
    assert claims_by_formula(command, mode, Ideal())["residual"] <= EXACT
    assert outcome(command, mode, Ideal()).residual <= 1e-11
    assert certify(command, mode, Ideal(), zeros(SHAPERS[kind].claims)).verified
    levels = np.cumsum(command.amplitudes)
    assert levels[-1] == pytest.approx(1.0, abs=EXACT)
    lowest = -1.0 if kind.startswith("ps") else 0.0
    assert lowest - EXACT <= levels.min()
    assert levels.max() <= 1 + EXACT
    if kind.startswith("sna"):  # each negative step is shared, no more
        count = len(SHAPERS[kind].claims)
        assert command.amplitudes[command.amplitudes < 0].sum() == pytest.approx(-0.5 * count)
    # The duration is that between the samples, rounded up.
    between = design(mode, Ideal(), SHAPERS[kind]).impulses.duration_s
    assert command.duration_s < between + sample_time_s * (1 + 1e-9)
    assert found.shorter_bound is not None
    assert found.shorter_bound > 1e-3


@pytest.mark.parametrize("actuator", [FIRST_ORDER, THESIS, SWITCHED])
@pytest.mark.parametrize("kind", ["sna_zv", "sna_zvd"])
def test_steps_down_are_exact_behind_sets_that_differ(kind: str, actuator: Actuator) -> None:
    mode = mode_of(0.5, 0.05)
    found = found_for(kind, mode, actuator, 0.05).impulses
    assert outcome(found, mode, actuator).residual <= 1e-11
    assert certify(found, mode, actuator, zeros(SHAPERS[kind].claims)).verified


def test_several_modes_are_made_zero_at_once() -> None:
    modes = (mode_of(0.4, 0.02), mode_of(1.3, 0.015))
    first, second = (positive_shaper(mode, 2) for mode in modes)
    order = np.argsort(np.add.outer(first.times_s, second.times_s).ravel())
    both = Impulses(
        times_s=np.add.outer(first.times_s, second.times_s).ravel()[order],
        amplitudes=np.multiply.outer(first.amplitudes, second.amplitudes).ravel()[order],
    )
    asked = [replace(one, mode=number) for number in (0, 1) for one in zeros(RESIDUAL)]
    found = free_on_samples(both, asked, modes, Ideal(), 0.1).impulses
    for mode in modes:
        assert claims_by_formula(found, mode, Ideal())["residual"] <= EXACT
    assert found.duration_s <= both.duration_s + 0.1


# Tolerances.


@pytest.mark.parametrize(
    ("hertz", "damping", "sample_time_s", "samples", "most"),
    [(180, 0.05, 0.001, 7, 0.022), (11, 0.03, 0.008, 12, 0.040)],
)
def test_a_band_is_kept_on_the_fewest_samples_with_the_least_residual(
    hertz: float, damping: float, sample_time_s: float, samples: int, most: float
) -> None:
    mode = mode_of(hertz, damping)
    found = found_for("si", mode, Ideal(), sample_time_s, half_width=0.15, tolerance=0.05)
    assert round(found.impulses.duration_s / sample_time_s) + 1 == samples
    left = largest_in_band_by_formula(found.impulses, mode, Ideal(), (0.85, 1.15), 2001)
    assert left <= most
    assert found.bound is not None
    assert found.bound <= left * (1 + 1e-9)
    assert found.bound == pytest.approx(left, rel=1e-5)
    assert found.shorter_bound is not None
    assert found.shorter_bound > 0.05


@pytest.mark.parametrize("amplitudes", ["positive", "negative"])
def test_a_dense_cone_program_finds_the_same_least_residual(amplitudes: str) -> None:
    mode, sample_time_s = mode_of(11, 0.03), 0.008
    found = found_for(
        "si", mode, Ideal(), sample_time_s, half_width=0.15, tolerance=0.05, amplitudes=amplitudes
    )
    last = round(found.impulses.duration_s / sample_time_s)
    ratios = np.linspace(0.85, 1.15, 401)
    until = sample_time_s * np.arange(last, -1, -1)
    swings = np.exp(np.multiply.outer(mode.pole_rad_s * ratios, until))
    steps = cp.Variable(last + 1)
    levels = cp.cumsum(steps)
    rules = [cp.sum(steps) == 1, levels >= 0, levels <= 1]
    if amplitudes == "positive":
        rules.append(steps >= 0)
    parts = cp.vstack([swings.real @ steps, swings.imag @ steps])
    problem = cp.Problem(cp.Minimize(cp.max(cp.norm(parts, 2, axis=0))), rules)
    assert found.bound == pytest.approx(problem.solve(solver="CLARABEL"), rel=1e-4)


@pytest.mark.parametrize("seed", range(10))
def test_no_random_amplitudes_go_below_the_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mode = mode_of(float(rng.uniform(1, 20)), float(rng.uniform(0, 0.2)))
    sample_time_s = mode.period_s / float(rng.uniform(5, 15))
    found = found_for("si", mode, Ideal(), sample_time_s, half_width=0.1)
    last = round(found.impulses.duration_s / sample_time_s)
    assert found.bound is not None
    held = np.rint(found.impulses.times_s / sample_time_s).astype(int)
    best = np.zeros(last + 1)
    best[held] = found.impulses.amplitudes
    for width in (0.3, 0.1, 0.03):
        for _ in range(20):
            amplitudes = best + width * rng.dirichlet(np.ones(last + 1))
            other = Impulses(
                times_s=sample_time_s * np.arange(last + 1), amplitudes=amplitudes / (1 + width)
            )
            left = largest_in_band_by_formula(other, mode, Ideal(), (0.9, 1.1), 201)
            assert left >= found.bound * (1 - 1e-9)


@pytest.mark.parametrize("kind", ["ei", "two_hump_ei", "three_hump_ei"])
@pytest.mark.parametrize(("hertz", "damping", "sample_time_s"), [(7.3, 0.05, 0.01), (11, 0, 0.008)])
def test_humps_stay_within_the_tolerance(
    kind: str, hertz: float, damping: float, sample_time_s: float
) -> None:
    mode = mode_of(hertz, damping)
    made = design(mode, Ideal(), SHAPERS[kind])
    promises = [promise_of(claim) for claim in made.certificate.claims]
    found = free_on_samples(made.impulses, promises, (mode,), Ideal(), sample_time_s)
    assert certify(found.impulses, mode, Ideal(), tuple(promises)).verified
    assert found.impulses.duration_s < made.impulses.duration_s + sample_time_s
    assert found.shorter_bound is not None
    assert found.shorter_bound > 0.05


def test_a_tolerance_that_no_samples_keep_is_refused_with_the_least_that_they_can() -> None:
    # At twice the sample rate a mode swings whole turns between samples: it sees one step.
    mode = mode_of(1, 0.0)
    promises = (within(0.05, (0.5, 2.5)),)
    continuous = positive_shaper(mode, 4)
    with refused("tolerance_not_on_samples", says=r"least residual that they can have is 100 %"):
        free_on_samples(continuous, promises, (mode,), Ideal(), 0.4)


def test_zeros_that_no_steps_down_of_that_size_make_are_refused() -> None:
    # All steps are on one sample or the next, of a fiftieth of a period.
    mode = mode_of(1, 0.0)
    near = shaper([0.0, 0.02, 0.04], [0.9, -0.5, 0.6])
    asked: tuple[Promise, ...] = (
        *zeros(RESIDUAL),
        *(replace(one, mode=1) for one in zeros(WITH_SLOPE)),
        *(replace(one, mode=2) for one in zeros(WITH_SLOPE)),
    )
    modes = (mode, mode_of(1.7, 0.0), mode_of(2.9, 0.0))
    with pytest.raises(InfeasibleDesignError) as caught:
        free_on_samples(near, asked, modes, Ideal(), 0.16)
    assert caught.value.code == "no_amplitudes_on_samples"


@pytest.mark.parametrize("amplitudes", [[0.5, 0.5], [0.9, -0.5, 0.6]])
def test_zeros_that_no_amplitudes_make_are_refused_with_a_proof(amplitudes: list[float]) -> None:
    """A mode at the sample rate sees all steps as one."""
    mode = mode_of(12.5, 0.0)
    start = shaper([0.04 * number for number in range(len(amplitudes))], amplitudes)
    with refused("proven_none_on_samples", says=r"^proven: no command on up .* is 100 % or more"):
        free_on_samples(start, zeros(RESIDUAL), (mode,), Ideal(), 0.08)


@pytest.mark.parametrize(
    ("hertz", "damping", "sample_time_s", "negative"),
    [
        (0.9259417724392129 / 2 / math.pi, 0.1007, 2.8892600702, 0.5),  # few samples: all ways
        (1.0, 0.1646, 0.05339, 0.8654),  # impulses of both signs are less than a sample apart
        (1.0, 0.65, 0.015466, 0.5),  # on three times as many samples
    ],
)
def test_steps_that_take_turns_are_sought_on_many_numbers_of_samples(
    hertz: float, damping: float, sample_time_s: float, negative: float
) -> None:
    """Where the samples nearest to the impulses have no amplitudes, longer commands do."""
    mode = mode_of(hertz, damping)
    kind = SHAPERS["sna_zvd"]
    made = design(mode, Ideal(), kind, kind.options(negative_amplitude=negative))
    promises = [promise_of(claim) for claim in made.certificate.claims]
    found = free_on_samples(made.impulses, promises, (mode,), Ideal(), sample_time_s)
    amplitudes = found.impulses.amplitudes
    assert certify(found.impulses, mode, Ideal(), tuple(promises)).verified
    assert_on_grid(found.impulses, sample_time_s)
    assert amplitudes[amplitudes < 0].sum() == pytest.approx(-2 * negative, abs=1e-9)
    turns = np.sign(amplitudes[:-1]) != np.sign(amplitudes[1:])
    assert turns.sum() <= 4


def test_zeros_hold_at_the_last_step_that_there_is() -> None:
    """What a strongly damped mode has left decays: behind the last step it is nearly nothing.

    The last impulse of this shaper is 1.7e-10 of all: without it zeros would hold at its sample
    alone, and the third derivative at the last step be 1.7e-4.
    """
    mode = Mode(natural_frequency_rad_s=1.9747136831908185, damping_ratio=0.8728926023156949)
    made = design(mode, Ideal(), SHAPERS["zvddd"])
    promises = tuple(promise_of(claim) for claim in made.certificate.claims)
    with refused("no_amplitudes_on_samples"):
        free_on_samples(made.impulses, promises, (mode,), Ideal(), 0.017773782856923156)


def test_more_samples_than_a_program_can_have_are_refused_before_any_is_made() -> None:
    """The unknowns of 15,625 impulses would ask for 26 GB."""
    mode = mode_of(1.0, 0.01)
    many = shaper([0.01 * number for number in range(15_625)], [1 / 15_625] * 15_625)
    with refused("too_many_samples_to_solve", "sample_time_s", says="15625 impulses"):
        free_on_samples(many, zeros(RESIDUAL), (mode,), Ideal(), 0.001)


def test_many_samples_are_searched_around_the_impulses() -> None:
    mode = mode_of(1, 0.05)
    found = found_for("si", mode, Ideal(), 0.001, half_width=0.15, tolerance=0.05)
    left = largest_in_band_by_formula(found.impulses, mode, Ideal(), (0.85, 1.15), 2001)
    assert left <= 0.05
    assert found.bound is None
    assert found.impulses.duration_s == pytest.approx(0.926)


def test_impulses_below_rounding_are_refused_on_samples() -> None:
    mode = mode_of(1.0, 0.97)
    between = design(mode, Ideal(), SHAPERS["zvd"])
    assert 0 < between.impulses.amplitudes[-1] < 1e-10
    with refused("impulse_below_rounding"):
        sampled_design(between, mode, Ideal(), 0.05)
