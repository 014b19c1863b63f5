"""Optima for several modes, and their bounds by another route."""

import math
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import linprog

from design.analysis.shortest import excluded_duration_rad
from design.model.plants.modes import Modes
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.shapers.specified_insensitivity import BandOptions
from design.solvers import clarabel
from design.solvers.budget import Budget
from design.solving.solve import solve
from design.types import FloatArray
from tests.modes_cases import LARGER, PAIR, PAIRS, left_by_formula, made, plant, random_plants
from tests.refusals import refused
from tests.shaper_table import CRANE, IDEAL


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


def test_every_subset_of_modes_takes_no_longer() -> None:
    subject = LARGER[3]
    for name in ("multi_zv", "multi_umzv"):
        whole = made(subject, name).impulses.duration_s
        for pair in combinations(subject.modes, 2):
            assert made(Modes(modes=pair), name).impulses.duration_s <= whole * (1 + 1e-9)


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


def test_a_search_that_may_do_nothing_finds_no_command() -> None:
    with refused("no_joint_command_found"):
        design(PAIR, IDEAL, SHAPERS["multi_umzv"], None, Budget(most=1.0))


def test_a_band_for_which_the_budget_is_too_small_says_so() -> None:
    si = SHAPERS["si"]
    wide = si.formulate(si.case((CRANE.mode,), IDEAL, BandOptions(half_width=0.5, tolerance=0.01)))
    says = r"within 0\.01 from 0\.5 to 1\.5 .*: its budget of 0\.001 million units"
    with refused("band_search_out_of_budget", says=says):
        list(solve(wide, Budget(most=1000.0)))


def test_a_cone_program_that_has_no_time_is_a_failure_of_its_solver(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(clarabel, "MAX_RUN_S", 0.0)
    with refused("clarabel_failed", says=r"^clarabel ended with time_limit on a band problem$"):
        design(CRANE, IDEAL, SHAPERS["si"])
