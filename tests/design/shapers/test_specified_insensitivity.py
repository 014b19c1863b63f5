"""Shapers over a band: published numbers, bounds that nothing beats, a formulation by CVXPY."""

import importlib
import itertools
import math
import re
from typing import Any

import numpy as np
import pytest

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.plants.mode import Mode
from design.pipeline import Design, design
from design.shapers.registry import SHAPERS
from design.shapers.specified_insensitivity import BandOptions
from design.solvers.budget import MAX_WORK_PER_DESIGN, Budget
from design.types import ComplexArray, FloatArray
from tests.refusals import refused
from tests.shaper_table import THESIS

SYMMETRIC = FirstOrder(accel_time_constant_s=0.03, decel_time_constant_s=0.03)

UNIT = Mode(natural_frequency_rad_s=2 * math.pi)
"""One undamped second: times are in periods."""


def si(mode: Mode = UNIT, actuator: Any = None, **options: Any) -> Design:
    made = BandOptions(**options)
    return design(mode, Ideal() if actuator is None else actuator, SHAPERS["si"], made)


def poles(mode: Mode, ratios: FloatArray) -> ComplexArray:
    return mode.pole_rad_s * ratios


def residuals(made: Design, mode: Mode, ratios: FloatArray) -> FloatArray:
    """|sum A exp(s (t_n - t))|: the definition, ideal actuator."""
    lags = made.impulses.times_s[-1] - made.impulses.times_s
    turned = np.exp(np.multiply.outer(poles(mode, ratios), lags))
    left: FloatArray = np.abs(turned @ made.impulses.amplitudes)
    return left


def test_the_published_three_impulses_of_a_width_of_a_third() -> None:
    made = si(half_width=0.15, tolerance=0.05)
    assert made.impulses.amplitudes == pytest.approx([0.2625, 0.475, 0.2625], abs=5e-5)
    assert made.impulses.times_s == pytest.approx([0, 0.47075, 0.9415], abs=5e-6)


def test_the_published_four_impulses_of_twice_that_width() -> None:
    made = si(half_width=0.3, tolerance=0.05)
    wanted = [0.1597972, 0.3402028, 0.3402028, 0.1597972]
    assert made.impulses.amplitudes == pytest.approx(wanted, abs=5e-8)
    assert made.impulses.times_s == pytest.approx([0, 0.4555201, 0.9110402, 1.366560], abs=5e-7)


def random_bands(count: int, seed: int) -> list[tuple[float, float, float]]:
    rng = np.random.default_rng(seed)
    halves, dampings = rng.uniform(0.05, 0.5, count), rng.uniform(0, 0.2, count)
    dampings[::5] = 0.0  # symmetric problems, whose optima are the most degenerate
    tolerances = rng.uniform(0.02, 0.1, count)
    return list(zip(halves.tolist(), dampings.tolist(), tolerances.tolist(), strict=True))


def test_200_random_bands_are_kept_at_20000_points_and_the_gap_is_small() -> None:
    rng = np.random.default_rng(11)
    gaps = []
    for half, damping, tolerance in random_bands(200, seed=3):
        mode = Mode(natural_frequency_rad_s=3.0, damping_ratio=damping)
        made = si(mode, half_width=half, tolerance=tolerance)
        assert made.certificate.verified
        assert (made.impulses.amplitudes > 0).all()
        assert made.impulses.amplitudes.sum() == pytest.approx(1, abs=1e-14)
        ratios = np.linspace(1 - half, 1 + half, 20_000)
        # A peak between two of these is higher by less than (h / 10,000)^2 (w t)^2 / 8 = 1e-7 V.
        found = residuals(made, mode, ratios)
        peak = ratios[found.argmax()]
        near = np.linspace(peak - half / 10_000, peak + half / 10_000, 2_001)
        finer = residuals(made, mode, np.clip(near, 1 - half, 1 + half))
        assert max(found.max(), finer.max()) <= tolerance * (1 + 1e-11)
        solver = made.solver
        assert solver.lower_bound_s is not None
        assert solver.gap is not None
        gaps.append(solver.gap)
        duration = made.impulses.duration_s
        assert solver.lower_bound_s == pytest.approx(duration * (1 - solver.gap), rel=1e-14)
        # The shaper squeezed below its bound must break the band: else the bound were wrong.
        squeezed = made.impulses.times_s * (solver.lower_bound_s / duration * (1 - 1e-6))
        moved = squeezed + np.r_[0, rng.normal(0, 1e-5, squeezed.size - 2), 0]
        turned = np.exp(np.multiply.outer(poles(mode, ratios), moved[-1] - moved))
        assert np.abs(turned @ made.impulses.amplitudes).max() > tolerance
    # One of these lies within 1e-6 of where two impulses merge, and the search ends beside it.
    assert min(gaps) > 0
    assert np.mean(np.array(gaps) <= 1e-4) >= 0.99
    assert max(gaps) <= 1e-3


@pytest.mark.parametrize("levels", [(0.0, 1.0), (-0.5, 1.3)])
def test_random_bands_within_limits_of_the_command(levels: tuple[float, float]) -> None:
    for half, damping, tolerance in random_bands(25, seed=5):
        mode = Mode(natural_frequency_rad_s=3.0, damping_ratio=damping)
        made = si(
            mode,
            SYMMETRIC,
            half_width=half,
            tolerance=tolerance,
            amplitudes="negative",
            lowest_command=levels[0],
            highest_command=levels[1],
        )
        command = np.cumsum(made.impulses.amplitudes)
        assert command[-1] == pytest.approx(1, abs=1e-14)
        assert command.min() >= levels[0] - 1e-14
        assert command.max() <= levels[1] + 1e-14
        ratios = np.linspace(1 - half, 1 + half, 20_000)
        assert residuals(made, mode, ratios).max() <= tolerance
        assert made.solver.gap is not None
        assert made.solver.gap <= 1e-4
        assert (
            made.impulses.duration_s
            < si(mode, half_width=half, tolerance=tolerance).impulses.duration_s
        )


def by_cvxpy(mode: Mode, band: tuple[float, float], lags: FloatArray, *, positive: bool) -> float:
    """Return the least largest residual over a grid of a band, as CVXPY is told of it."""
    cp: Any = importlib.import_module("cvxpy")  # its own types leave half of it out
    ratios = np.linspace(*band, 81)
    turned = np.exp(np.multiply.outer(poles(mode, ratios), lags))
    steps = cp.Variable(lags.size)
    limits = [cp.sum(steps) == 1]
    if positive:
        limits.append(steps >= 0)
    else:
        # The command goes from the longest lag to 0; after the last step it is 1.
        command = cp.cumsum(steps[::-1])
        limits += [command[:-1] >= 0, command[:-1] <= 1]
    parts = cp.vstack([turned.real @ steps, turned.imag @ steps])
    program = cp.Problem(cp.Minimize(cp.max(cp.norm(parts, 2, axis=0))), limits)
    program.solve(solver=cp.CLARABEL)
    return float(program.value)


@pytest.mark.parametrize("positive", [True, False])
@pytest.mark.parametrize(("half", "damping", "tolerance"), random_bands(4, seed=8))
def test_cvxpy_on_a_fine_grid_agrees(
    half: float, damping: float, tolerance: float, *, positive: bool
) -> None:
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=damping)
    made = si(
        mode,
        half_width=half,
        tolerance=tolerance,
        amplitudes="positive" if positive else "negative",
    )
    own = made.impulses.duration_s - made.impulses.times_s
    band = (1 - half, 1 + half)
    lags = np.union1d(np.linspace(0, made.impulses.duration_s, 200), own)
    # With the impulses among its points the grid reaches the tolerance, and hardly less: what
    # it gains is that its 81 frequencies miss the peaks, by (h / 80)^2 (w t)^2 / 2 at most.
    least = by_cvxpy(mode, band, lags, positive=positive)
    assert 1 - 4e-3 <= least / tolerance <= 1 + 1e-6
    # A per cent shorter it cannot.
    assert by_cvxpy(mode, band, 0.99 * lags, positive=positive) > tolerance


def test_a_wider_band_a_tighter_tolerance_or_positive_amplitudes_take_longer() -> None:
    base = si(half_width=0.2).impulses.duration_s
    assert si(half_width=0.25).impulses.duration_s > base
    assert si(half_width=0.2, tolerance=0.04).impulses.duration_s > base
    negative = [
        si(half_width=0.2, amplitudes="negative", highest_command=highest).impulses.duration_s
        for highest in (1.0, 1.5, 3.0)
    ]
    assert all(longer > shorter for longer, shorter in itertools.pairwise([base, *negative]))


def test_times_scale_with_the_period() -> None:
    slow = si(Mode(natural_frequency_rad_s=0.1, damping_ratio=0.05)).impulses
    fast = si(Mode(natural_frequency_rad_s=100.0, damping_ratio=0.05)).impulses
    assert slow.times_s == pytest.approx(1000 * fast.times_s, rel=1e-14)


def test_ends_of_the_band_and_half_width_are_two_ways_to_say_the_same() -> None:
    ends = si(lower_ratio=0.85, upper_ratio=1.15).impulses
    assert ends.times_s == pytest.approx(si(half_width=0.15).impulses.times_s, rel=1e-14)
    # A band around twice the frequency is that of a plant twice as fast.
    twice = si(lower_ratio=1.7, upper_ratio=2.3).impulses
    assert twice.times_s == pytest.approx(ends.times_s / 2, rel=1e-9)


def test_a_start_that_runs_away_is_no_warning() -> None:
    # Here one of Newton's starts overflows; two equal impulses 0.05 short of opposite serve.
    mode = Mode(natural_frequency_rad_s=math.sqrt(9.81 / 0.8))
    made = si(mode, half_width=0.03)
    assert made.impulses.amplitudes == pytest.approx([0.5, 0.5], abs=1e-9)


def test_positive_shapers_hold_behind_every_actuator() -> None:
    behind = si(actuator=THESIS)
    assert behind.impulses.times_s.tolist() == si().impulses.times_s.tolist()
    assert behind.certificate.verified


def test_both_signs_behind_an_asymmetric_actuator_are_refused() -> None:
    with refused("sets_differ", "shaper.amplitudes"):
        si(actuator=THESIS, amplitudes="negative")


@pytest.mark.parametrize(
    ("options", "code", "field", "says"),
    [
        ({"half_width": 1.0}, "out_of_range", "half_width", "between"),
        ({"half_width": 0.0}, "out_of_range", "half_width", "between"),
        ({"lower_ratio": -0.1, "upper_ratio": 1.0}, "out_of_range", "lower_ratio", "between"),
        (
            {"lower_ratio": 1.2, "upper_ratio": 0.8},
            "band_too_narrow_or_wide",
            "upper_ratio",
            "1.02 to 19 times",
        ),
        ({"lower_ratio": 0.8}, "band_half_said", "upper_ratio", None),
        ({"half_width": 0.1, "upper_ratio": 1.2}, "band_said_twice", "upper_ratio", None),
        ({"tolerance": 1.0}, "out_of_range", "tolerance", "at least 0.001 and below 1"),
        ({"tolerance": math.nan}, "out_of_range", "tolerance", "at least 0.001 and below 1"),
        (
            {"highest_command": 1.2},
            "option_of_unity_magnitude",
            "highest_command",
            "1 for positive",
        ),
        (
            {"amplitudes": "negative", "lowest_command": 0.1},
            "out_of_range",
            "lowest_command",
            "between",
        ),
        (
            {"amplitudes": "negative", "highest_command": 0.9},
            "out_of_range",
            "highest_command",
            "between",
        ),
    ],
)
def test_bands_and_limits_that_make_no_sense_are_refused(
    options: dict[str, Any], code: str, field: str, says: str | None
) -> None:
    with refused(code, field, says=says):
        BandOptions(**options)


def test_a_duration_too_short_is_named_with_what_can_be_met_instead() -> None:
    with refused("duration_below_fastest", says=r"max_duration_periods = 0\.9 is too") as caught:
        si(max_duration_periods=0.9)
    told = str(caught.value)
    assert "none is shorter than 0.941499 (proven)" in told
    instead = told.split("max_duration_periods = ")[2]
    longer, tolerance = (float(part.split()[0]) for part in instead.split("or a tolerance of "))
    assert si(max_duration_periods=longer).impulses.duration_s <= longer
    assert si(max_duration_periods=0.9, tolerance=tolerance).impulses.duration_s <= 0.9


def test_a_command_far_beyond_its_range_has_no_structure_and_steps_of_a_grid_instead() -> None:
    # Between 0.32 and 0.43 of a period the optimum may as well be anywhere between its limits.
    mode = Mode(natural_frequency_rad_s=8.8855804904264, damping_ratio=0.02173707863886174)
    made = si(
        mode,
        tolerance=0.005174127526885904,
        amplitudes="negative",
        lowest_command=-6.471094065234464,
        highest_command=7.652488777176263,
    )
    assert made.certificate.verified
    assert residuals(made, mode, np.linspace(0.85, 1.15, 20_000)).max() <= 0.005174127526885904
    command = np.cumsum(made.impulses.amplitudes)
    assert command.min() >= -6.4711
    assert command.max() <= 7.6525
    assert made.solver.gap is not None
    assert 0 < made.solver.gap <= 0.05


@pytest.mark.parametrize(
    "options",
    [
        {"half_width": 0.2764, "tolerance": 1e-3},
        {"half_width": 0.83, "tolerance": 0.0018},
        {"half_width": 0.65, "tolerance": 0.023, "amplitudes": "negative"},
        {"half_width": 0.65, "tolerance": 0.05, "amplitudes": "negative", "highest_command": 6.0},
        {"half_width": 0.9, "tolerance": 0.05},
    ],
)
def test_small_tolerances_and_wide_bands_take_a_part_of_the_budget(options: Any) -> None:
    mode, budget = Mode(natural_frequency_rad_s=3.0, damping_ratio=0.05), Budget()
    wanted = BandOptions(max_duration_periods=100.0, **options)
    made = design(mode, Ideal(), SHAPERS["si"], wanted, budget)
    assert 0 < budget.done < MAX_WORK_PER_DESIGN
    assert made.certificate.verified
    assert made.solver.gap is not None
    assert made.solver.gap <= 1e-4


def test_a_horizon_far_too_short_is_refused_by_a_proof_of_its_own() -> None:
    with refused("duration_below_bound", says=r"none is as short \(proven\)") as caught:
        si(half_width=0.6, tolerance=1e-3, max_duration_periods=2.0)
    (tolerance,) = re.findall(r"a tolerance of (0\.\d+) can be met", str(caught.value))
    met = si(half_width=0.6, tolerance=float(tolerance), max_duration_periods=2.0)
    assert met.impulses.duration_s <= 2.0


def test_where_damping_alone_keeps_the_tolerance_as_fast_there_is_no_shaper() -> None:
    damped = Mode(natural_frequency_rad_s=2 * math.pi, damping_ratio=0.1525)
    # ln(1/V)/(2 pi z r) at the lowest frequency, a tenth of the nominal one.
    with refused("waiting_is_as_fast", says=r"after 0\.3179 periods .*proven"):
        si(damped, half_width=0.9, tolerance=0.97)
    made = si(damped, half_width=0.9, tolerance=0.5)
    assert made.impulses.duration_s < math.log(2) / (2 * math.pi * 0.1525 * 0.1)


def test_more_impulses_than_can_be_solved_for_are_refused_with_a_tolerance_that_can() -> None:
    with refused("band_too_wide", says=r"the limit is 26") as caught:
        si(half_width=0.9, tolerance=1e-3, max_duration_periods=100.0)
    (tolerance,) = re.findall(r"allow a tolerance of (0\.\d+)", str(caught.value))
    # No harder than what is tested above: the default tolerance takes 23 half periods there.
    assert 0.02 < float(tolerance) < 0.05


@pytest.mark.parametrize("seed", range(4))
def test_no_random_start_of_slsqp_finds_a_shorter_one_than_the_bound(seed: int) -> None:
    from scipy.optimize import minimize

    rng = np.random.default_rng(seed)
    half, tolerance = float(rng.uniform(0.08, 0.4)), float(rng.uniform(0.03, 0.15))
    mode = Mode(natural_frequency_rad_s=2 * math.pi, damping_ratio=float(rng.uniform(0, 0.15)))
    made = si(mode, half_width=half, tolerance=tolerance)
    assert made.solver.lower_bound_s is not None
    ratios = np.linspace(1 - half, 1 + half, 60)

    def slack(x: FloatArray, count: int) -> FloatArray:
        lags = np.append(x[: count - 1], 0.0)
        turned = np.exp(np.multiply.outer(poles(mode, ratios), lags))
        left: FloatArray = tolerance**2 - np.abs(turned @ x[count - 1 :]) ** 2
        return left

    found = 0
    for start in range(8):
        count = 3 + start % 3
        lags = np.sort(rng.uniform(0, 1.5 * made.impulses.duration_s, count - 1))[::-1]
        solved = minimize(
            lambda x: x[0],
            np.concatenate((lags, np.full(count, 1 / count))),
            method="SLSQP",
            bounds=[(0, 10)] * (count - 1) + [(0, 1)] * count,
            constraints=[
                {"type": "ineq", "fun": slack, "args": (count,)},
                {"type": "eq", "fun": lambda x, n=count: x[n - 1 :].sum() - 1},
                {"type": "ineq", "fun": lambda x, n=count: -np.diff(x[: n - 1])},
            ],
            options={"maxiter": 200},
        )
        if slack(solved.x, count).min() < -1e-9 or abs(solved.x[count - 1 :].sum() - 1) > 1e-9:
            continue
        found += 1
        # It keeps 60 frequencies only: between them it may be above by (h w t / 60)^2 / 8.
        assert solved.x[0] >= made.solver.lower_bound_s * (1 - 2e-3)
    assert found > 0


def test_no_tolerance_is_offered_instead_where_no_optimum_is_found() -> None:
    with refused("duration_below_fastest", says=r"no shorter one was found") as caught:
        si(
            amplitudes="negative",
            tolerance=0.00452592590809295,
            lowest_command=-5.733654696229451,
            highest_command=11.0,
            max_duration_periods=0.907673225109539,
        )
    assert "or a tolerance" not in str(caught.value)
