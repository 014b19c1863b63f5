"""Shapers for several modes: theory, published numbers, and bounds by another route."""

import math
from itertools import combinations, product

import numpy as np
import pytest
from scipy.optimize import linprog

from design.analysis.sensitivity import sensitivity
from design.analysis.sensitivity_range import SensitivityRange
from design.analysis.shortest import excluded_duration_rad
from design.errors import InfeasibleDesignError
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.pipeline import Design, design
from design.shapers.registry import SHAPERS
from design.shapers.several_modes import BASES, ConvolvedOptions
from design.types import FloatArray
from tests.refusals import refused
from tests.second_route import (
    claims_by_formula,
    curve_by_formula,
    largest_in_band_by_formula,
    residual_by_integration,
)
from tests.shaper_table import IDEAL, LIMITED, THESIS

HERTZ = 2 * math.pi


def plant(*modes: tuple[float, float]) -> Modes:
    """Return the plant of modes of these frequencies [Hz] and damping ratios."""
    return Modes(
        modes=tuple(
            Mode(natural_frequency_rad_s=HERTZ * frequency, damping_ratio=damping)
            for frequency, damping in modes
        )
    )


def random_plants(count: int, modes: int, seed: int) -> list[Modes]:
    rng = np.random.default_rng(seed)
    plants: list[Modes] = []
    while len(plants) < count:
        frequencies = [1.0, *rng.uniform(1.1, 6, modes - 1).tolist()]
        plants.append(plant(*zip(frequencies, rng.uniform(0, 0.1, modes).tolist(), strict=True)))
    return plants


PAIR = plant((1.0, 0.0), (2.7, 0.0))
PAIRS = [PAIR, *random_plants(40, 2, seed=1)]
LARGER = [one for modes in (3, 4, 5, 6) for one in random_plants(3, modes, seed=modes)]


def made(subject: Modes, name: str, options: object = None, actuator: Actuator = IDEAL) -> Design:
    return design(subject, actuator, SHAPERS[name], options)


def left_by_formula(found: Design, subject: Modes, actuator: Actuator = IDEAL) -> float:
    return max(
        claims_by_formula(found.impulses, mode, actuator)["residual"] for mode in subject.modes
    )


def test_the_direct_two_mode_zv_has_its_known_numbers() -> None:
    found = made(PAIR, "multi_zv").impulses
    assert found.amplitudes == pytest.approx([0.443648708, 0.112702583, 0.443648708], abs=6e-10)
    assert found.times_s == pytest.approx([0, 0.27027027, 0.54054054], abs=6e-9)


def least_violation(subject: Modes, duration_s: float, *, positive: bool) -> float:
    """Return how far a command on a fine grid of times is from leaving nothing in all modes."""
    w = subject.modes[0].natural_frequency_rad_s
    points = max(240, int(duration_s * max(m.natural_frequency_rad_s for m in subject.modes) * 24))
    edges = np.linspace(0, duration_s, points + 1)
    rows, right = [], []
    for mode in subject.modes:
        swings = np.exp(mode.pole_rad_s * (duration_s - edges))
        if positive:
            columns, side = swings, 0j
        else:
            # The level u over a cell is a step of u at its start and back at its end.
            columns, side = swings[:-1] - swings[1:], -swings[-1]
        rows += [columns.real, columns.imag]
        right += [side.real, side.imag]
    # A command that is 1 at the end: steps of the levels, and a last one up to 1.
    matrix, sides = np.array(rows), np.array(right)
    count = len(sides)
    slack = np.hstack((np.eye(count), -np.eye(count)))
    equations = np.hstack((matrix, slack))
    if positive:
        total = np.concatenate((np.ones(matrix.shape[1]), np.zeros(2 * count)))
        equations, sides = np.vstack((equations, total)), np.append(sides, 1.0)
    assert w > 0
    bounds = [(0, None if positive else 1)] * matrix.shape[1] + [(0, None)] * (2 * count)
    cost = np.concatenate((np.zeros(matrix.shape[1]), np.ones(2 * count)))
    solved = linprog(cost, A_eq=equations, b_eq=sides, bounds=bounds, method="highs-ipm")
    assert solved.status == 0
    return float(solved.fun)


@pytest.mark.parametrize("number", range(len(PAIRS)))
def test_the_fastest_command_of_unity_magnitude_meets_its_bound(number: int) -> None:
    subject = PAIRS[number]
    found = made(subject, "multi_umzv")
    assert left_by_formula(found, subject) <= 1e-11  # Newton ends at 1e-12
    levels = np.cumsum(found.impulses.amplitudes)
    assert set(levels.tolist()) == {0.0, 1.0}
    assert np.diff(found.impulses.times_s).min() > 0
    bound, gap = found.solver.lower_bound_s, found.solver.gap
    assert bound is not None
    assert gap is not None
    assert bound <= found.impulses.duration_s * (1 + 1e-12)
    assert gap <= 2e-3
    # A linear program of the test's own finds nothing that is 0.2 % shorter, and something as long.
    duration = found.impulses.duration_s
    assert least_violation(subject, (1 - 2e-3) * duration, positive=False) > 1e-4
    assert least_violation(subject, (1 + 2e-3) * duration, positive=False) < 1e-9


@pytest.mark.parametrize("number", range(12))
def test_the_fastest_positive_command_meets_its_bound(number: int) -> None:
    subject = PAIRS[number]
    found = made(subject, "multi_zv")
    assert left_by_formula(found, subject) <= 1e-11
    assert found.impulses.amplitudes.min() > 0
    assert found.impulses.amplitudes.sum() == pytest.approx(1, abs=1e-14)
    assert found.solver.gap is not None
    assert 0 <= found.solver.gap <= 1e-4
    assert least_violation(subject, (1 - 2e-3) * found.impulses.duration_s, positive=True) > 1e-6


@pytest.mark.parametrize("name", ["multi_zv", "multi_umzv"])
@pytest.mark.parametrize("number", range(len(LARGER)))
def test_up_to_six_modes_are_shaped_within_0_2_percent_of_the_bound(name: str, number: int) -> None:
    subject = LARGER[number]
    found = made(subject, name)
    assert left_by_formula(found, subject) <= 1e-11
    assert found.certificate.verified
    assert [claim.mode for claim in found.certificate.claims] == list(range(len(subject.modes)))
    levels = np.cumsum(found.impulses.amplitudes)
    assert levels.min() >= -1e-12
    assert levels.max() <= 1 + 1e-12
    assert found.solver.gap is not None
    assert found.solver.gap <= 2e-3


@pytest.mark.parametrize("positive", [True, False])
def test_a_bound_is_that_of_a_dense_grid_whatever_the_function(positive: bool) -> None:
    rng = np.random.default_rng(3)
    checked = 0
    for _ in range(60):
        modes = int(rng.integers(1, 5))
        poles = rng.uniform(1, 6, modes) * np.exp(1j * (math.pi / 2 + rng.uniform(0, 0.2, modes)))
        vectors = rng.normal(size=modes) + 1j * rng.normal(size=modes)
        until = float(rng.uniform(1, 6))
        times = np.linspace(0, until, 400_001)
        pull = (vectors.conj() @ np.exp(-poles[:, None] * times)).real
        found = excluded_duration_rad(poles, vectors, until, positive=positive)
        if pull[0] <= 0:
            assert found == 0
            continue
        if positive:
            passed = np.flatnonzero(pull <= 0)
        else:
            passed = np.flatnonzero(np.cumsum(np.maximum(-np.diff(pull), 0)) >= pull[0])
        exact = float(times[passed[0]]) if passed.size else until
        assert found <= exact + 2 * until / 400_000
        # P passes steeply or not: a slope of 1e-2 within rounding of the finest cells.
        assert found >= exact - 1e-3 * until
        checked += 1
    assert checked > 20


def test_one_mode_of_several_is_the_shaper_of_one() -> None:
    for damping in (0.0, 0.1, 0.3):
        mode = Mode(natural_frequency_rad_s=3.0, damping_ratio=damping)
        for joint, single in (("multi_zv", "zv"), ("multi_umzv", "umzv")):
            wanted = design(mode, IDEAL, SHAPERS[single]).impulses
            found = design(mode, IDEAL, SHAPERS[joint]).impulses
            assert found.times_s == pytest.approx(wanted.times_s, abs=1e-10)
            assert found.amplitudes == pytest.approx(wanted.amplitudes, abs=1e-10)


def test_a_mode_of_three_times_the_frequency_costs_a_positive_shaper_nothing() -> None:
    found = made(plant((1.0, 0.0), (3.0, 0.0)), "multi_zv").impulses
    assert found.duration_s == pytest.approx(0.5, abs=1e-9)


@pytest.mark.parametrize("name", ["multi_zv", "multi_umzv", "convolved"])
def test_neither_the_order_of_modes_nor_the_unit_of_time_matters(name: str) -> None:
    subject = PAIRS[3]
    wanted = made(subject, name).impulses
    turned = made(Modes(modes=subject.modes[::-1]), name).impulses
    slower = made(
        Modes(
            modes=tuple(
                Mode(
                    natural_frequency_rad_s=mode.natural_frequency_rad_s / 8,
                    damping_ratio=mode.damping_ratio,
                )
                for mode in subject.modes
            )
        ),
        name,
    ).impulses
    assert turned.times_s == pytest.approx(wanted.times_s, abs=1e-10)
    assert turned.amplitudes == pytest.approx(wanted.amplitudes, abs=1e-10)
    assert slower.times_s == pytest.approx(8 * wanted.times_s, abs=1e-9)


def test_positive_shapers_are_exact_behind_every_actuator_that_follows_steps() -> None:
    switched = SecondOrder(accel=THESIS.accel, decel=THESIS.decel, model="switched")
    subject = plant((0.55, 0.01), (1.3, 0.02))
    for name, actuator in product(("multi_zv", "convolved"), (THESIS, switched)):
        found = made(subject, name, actuator=actuator)
        assert max(found.residuals) < 1e-12
        for mode in subject.modes:
            # The integrator is asked for 1e-11.
            assert residual_by_integration(found.impulses, mode, actuator) < 1e-8
    limited = made(subject, "multi_zv", actuator=LIMITED)
    assert limited.certificate.verified
    assert limited.residual > 1e-6


def test_what_is_left_behind_an_actuator_is_told_of_each_mode() -> None:
    subject = plant((0.55, 0.01), (1.3, 0.02))
    found = made(subject, "multi_umzv", actuator=THESIS)
    told = [claims_by_formula(found.impulses, mode, THESIS)["residual"] for mode in subject.modes]
    assert found.residuals == pytest.approx(told, abs=1e-12)
    assert found.residual == max(found.residuals) > 1e-3


@pytest.mark.parametrize("base", [name for name in BASES if not name.startswith("umzv")])
def test_convolved_positive_shapers_keep_what_each_claims(base: str) -> None:
    subject = PAIRS[4]
    found = made(subject, "convolved", ConvolvedOptions(base=base))  # type: ignore[arg-type]
    assert found.impulses.amplitudes.sum() == pytest.approx(1, abs=1e-14)
    for claim in found.certificate.claims:
        mode = subject.modes[claim.mode]
        if claim.quantity == "band":
            assert claim.band is not None
            value = largest_in_band_by_formula(found.impulses, mode, Ideal(), claim.band, 300)
        elif claim.quantity in {"residual", "slope"}:
            value = claims_by_formula(found.impulses, mode, Ideal())[claim.quantity]
        else:
            continue
        assert value <= claim.limit * (1 + 1e-9)
    parts = [design(mode, IDEAL, SHAPERS[base]).impulses for mode in subject.modes]
    assert found.impulses.duration_s == pytest.approx(sum(part.duration_s for part in parts))
    assert found.impulses.times_s.size == parts[0].times_s.size * parts[1].times_s.size


def test_steps_of_convolved_shapers_at_the_same_time_are_one() -> None:
    found = made(plant((1.0, 0.0), (2.0, 0.0)), "convolved", ConvolvedOptions(base="zvd")).impulses
    assert found.times_s == pytest.approx([0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5])
    assert 16 * found.amplitudes == pytest.approx([1, 2, 3, 4, 3, 2, 1])


def levels_of_both(first: FloatArray, second: FloatArray) -> tuple[float, float]:
    """Return the range of two commands of unity magnitude convolved, from their times alone."""
    steps = sorted(
        (float(a + b), (-1) ** (i + j))
        for (i, a), (j, b) in product(enumerate(first), enumerate(second))
    )
    levels = np.cumsum([step for _, step in steps])
    return float(levels.min()), float(levels.max())


def test_convolved_negative_shapers_are_served_within_range_and_refused_beyond() -> None:
    served = beyond = 0
    for subject in PAIRS:
        parts = [design(mode, IDEAL, SHAPERS["umzv"]).impulses.times_s for mode in subject.modes]
        low, high = levels_of_both(parts[0], parts[1])
        if low < 0 or high > 1:
            with refused(
                "convolved_beyond_full_speed",
                says=f"from {low:g} to {high:g} of full speed, beyond 0 to 1",
            ):
                made(subject, "convolved", ConvolvedOptions(base="umzv"))
            beyond += 1
        else:
            found = made(subject, "convolved", ConvolvedOptions(base="umzv"))
            assert left_by_formula(found, subject) <= 1e-11
            # The joint one is never slower.
            assert made(subject, "multi_umzv").impulses.duration_s < found.impulses.duration_s
            served += 1
    assert served > 0
    assert beyond > 0


@pytest.mark.parametrize("name", ["umzv", "numzvd", "zv", "ei"])
def test_a_shaper_of_one_mode_refuses_two_by_name(name: str) -> None:
    with refused(
        "kind_of_one_mode", "plant.modes", says=f"{name} serves a single mode.*got '2 modes'"
    ):
        made(PAIR, name)


def test_equal_modes_too_many_and_too_far_ones_are_refused_by_name() -> None:
    with refused("modes_too_near", "modes.2", says=r"another mode than modes\.0"):
        plant((1.0, 0.1), (2.0, 0.1), (1.0, 0.1))
    with refused("wrong_count_of_modes", "modes", says="2 to 6 here, got '7 modes'"):
        plant(*((1.0 + number, 0.0) for number in range(7)))
    with refused("modes_too_far", "modes.1.natural_frequency_rad_s"):
        plant((1.0, 0.0), (1001.0, 0.0))
    with refused("single_mode_only", "plant.modes"):
        _ = PAIR.mode


def test_a_tolerance_is_refused_for_a_base_without_and_an_unknown_base_by_name() -> None:
    with refused("base_takes_no_tolerance", "tolerance"):
        ConvolvedOptions(base="zv", tolerance=0.1)
    with refused("base_not_served", "base"):
        ConvolvedOptions(base="numzv")  # type: ignore[arg-type]
    tight = made(PAIR, "convolved", ConvolvedOptions(base="ei", tolerance=0.02))
    assert {claim.limit for claim in tight.certificate.claims} == {0.02}


def test_every_subset_of_modes_takes_no_longer() -> None:
    subject = LARGER[3]
    for name in ("multi_zv", "multi_umzv"):
        whole = made(subject, name).impulses.duration_s
        for pair in combinations(subject.modes, 2):
            assert made(Modes(modes=pair), name).impulses.duration_s <= whole * (1 + 1e-9)


def test_a_band_of_too_many_convolved_impulses_is_refused() -> None:
    six = LARGER[-1]
    with refused("too_many_convolved", "shaper.base", says="of fewer .* they are 15625"):
        made(six, "convolved", ConvolvedOptions(base="three_hump_ei"))
    # As many that claim zeros are no matter.
    assert made(six, "convolved", ConvolvedOptions(base="zvddd")).impulses.times_s.size == 15625


def test_bands_of_hundreds_of_convolved_impulses_are_proven() -> None:
    four = LARGER[3]
    found = made(four, "convolved", ConvolvedOptions(base="three_hump_ei"))
    assert found.impulses.times_s.size == 625
    for claim in found.certificate.claims:
        if claim.band is not None:
            mode = four.modes[claim.mode]
            ratios = np.linspace(*claim.band, 700)
            told = float(curve_by_formula(found.impulses, mode, IDEAL, ratios).max())
            # Peaks of a turn of 100 rad or so lie within 1e-3 of one of 700 ratios.
            assert told <= claim.value * (1 + 1e-9)
            assert told == pytest.approx(claim.value, rel=2e-2)


def test_five_heavily_damped_modes_are_shaped_by_a_few_linear_programs() -> None:
    modes = [(1.0, 0.194), (3.18, 0.16), (2.93, 0.188), (1.505, 0.188), (2.796, 0.188)]
    found = made(plant(*modes), "multi_zv")
    assert found.certificate.verified
    assert found.solver.gap is not None
    assert found.solver.gap <= 1e-4
    assert found.solver.starts <= 20


@pytest.mark.parametrize("seed", range(3))
def test_no_random_start_of_slsqp_is_shorter_than_the_bound_of_two_modes(seed: int) -> None:
    from scipy.optimize import minimize

    rng = np.random.default_rng(seed)
    (subject,) = random_plants(1, 2, seed=100 + seed)
    found = made(subject, "multi_zv")
    assert found.solver.lower_bound_s is not None

    def vectors(x: FloatArray, count: int) -> FloatArray:
        lags, amplitudes = np.append(x[: count - 1], 0.0), x[count - 1 :]
        left = [np.exp(mode.pole_rad_s * lags) @ amplitudes for mode in subject.modes]
        return np.array([part for one in left for part in (one.real, one.imag)])

    solutions = 0
    for start in range(12):
        count = 3 + start % 3
        lags = np.sort(rng.uniform(0, 1.5 * found.impulses.duration_s, count - 1))[::-1]
        solved = minimize(
            lambda x: x[0],
            np.concatenate((lags, np.full(count, 1 / count))),
            method="SLSQP",
            bounds=[(0, 10)] * (count - 1) + [(0, 1)] * count,
            constraints=[
                {"type": "eq", "fun": vectors, "args": (count,)},
                {"type": "eq", "fun": lambda x, n=count: x[n - 1 :].sum() - 1},
                {"type": "ineq", "fun": lambda x, n=count: -np.diff(x[: n - 1])},
            ],
            options={"maxiter": 200},
        )
        if np.abs(vectors(solved.x, count)).max() > 1e-7:
            continue
        solutions += 1
        # What it leaves, over the slope of what is left in time.
        assert solved.x[0] >= found.solver.lower_bound_s * (1 - 1e-5)
    assert solutions > 0


WIDE = [
    ((1.0, 1000.0), 0.0),
    ((1.0, 30.0, 1000.0), 0.002),
    ((1.0, 4.0, 9.0, 16.0, 25.0, 36.0), 0.05),
    ((0.5, 1.1, 7.0, 40.0, 300.0), 0.001),
]
"""Frequencies [rad/s], damping ratio."""


@pytest.mark.parametrize("name", ["convolved", "multi_zv", "multi_umzv"])
@pytest.mark.parametrize(("frequencies", "damping"), WIDE, ids=str)
def test_modes_far_apart_are_shaped(
    name: str, frequencies: tuple[float, ...], damping: float
) -> None:
    """Residuals by formula, beside the frequency too, and a bound that is below the duration."""
    subject = Modes(
        modes=tuple(Mode(natural_frequency_rad_s=w, damping_ratio=damping) for w in frequencies)
    )
    found = made(subject, name)
    assert found.certificate.verified
    assert left_by_formula(found, subject) < 1e-9
    if name == "convolved":
        assert found.impulses.times_s.size == 2 ** len(frequencies)
    else:
        assert found.solver.gap is not None
        assert 0 <= found.solver.gap < 0.01
    wanted = SensitivityRange(from_ratio=0.99, to_ratio=1.01, points=101)
    for mode in subject.modes:
        curve = sensitivity(found.impulses, mode, IDEAL, wanted)
        told = curve_by_formula(found.impulses, mode, IDEAL, curve.frequency_ratios)
        assert np.abs(told - curve.residuals).max() < 1e-10


def test_modes_too_far_apart_for_doubles_are_refused_in_words() -> None:
    rng = np.random.default_rng(11)
    words = []
    for base in sorted(BASES) * 20:
        ratio = 10 ** rng.uniform(1, 3)
        subject = plant((1.0, rng.uniform(0, 0.1)), (ratio, rng.choice([0.0, 0.02])))
        try:
            found = made(subject, "convolved", ConvolvedOptions(base=base))  # type: ignore[arg-type]
        except InfeasibleDesignError as error:
            words.append((ratio, str(error)))
            continue
        assert found.certificate.verified
    beyond = [(ratio, text) for ratio, text in words if "cannot be proven zero" in text]
    assert beyond
    assert all(ratio > 30 and "rounding of double precision" in text for ratio, text in beyond)
