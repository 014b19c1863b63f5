"""The search over branches: its starts, its order, its words when nothing is found."""

import math
from contextlib import suppress

import numpy as np
import pytest

from design.errors import InfeasibleDesignError
from design.formulations.equations import GapProblem
from design.formulations.unity_magnitude import (
    ZERO_VIBRATION,
    ZERO_VIBRATION_DERIVATIVE,
    UnityMagnitude,
)
from design.formulations.unity_magnitude_problem import unity_magnitude_problem
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.solvers import ipopt
from design.solvers.branches import BRANCH_STARTS, spread_starts
from design.solvers.outcome import Outcome, Status
from design.solvers.search import candidates
from design.types import FloatArray
from tests.refusals import refused
from tests.second_route import gain_and_slope
from tests.shaper_table import IDEAL, THESIS

MODE = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.05)


def formulate(
    actuator: Actuator,
    model: UnityMagnitude = ZERO_VIBRATION_DERIVATIVE,
    mode: Mode = MODE,
    *,
    settle: bool = False,
    periods: float = 3.0,
) -> GapProblem:
    return unity_magnitude_problem(
        model, mode, actuator, settle=settle, max_duration_periods=periods
    )


def second_order(w1: float, z1: float, w2: float, z2: float) -> SecondOrder:
    return SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=w1, damping_ratio=z1),
        decel=SecondOrderSet(natural_frequency_rad_s=w2, damping_ratio=z2),
    )


def fastest_of_random_starts(problem: GapProblem, mode: Mode, actuator: Actuator) -> float:
    """Least duration of the ordered roots that SciPy finds of the textbook's own equations."""
    from scipy.optimize import root

    s = mode.pole_rad_s
    (up, up_slope), (down, down_slope) = (
        gain_and_slope(actuator, s, accel=accel) for accel in (True, False)
    )
    count = problem.shortest_gaps_rad.size
    signs = problem.amplitudes
    gains = np.where(signs > 0, up, down) / up
    slopes = np.where(signs > 0, up_slope, down_slope) / up

    def equations(gaps: FloatArray) -> list[float]:
        times = np.concatenate(([0.0], np.cumsum(gaps)))
        turns = signs * np.exp(s * (times[-1] - times))
        rows = [(turns * gains).sum(), (turns * (slopes - times * gains)).sum()]
        return [part for row in rows[: count // 2] for part in (row.real, row.imag)]

    random = np.random.default_rng(11)
    best = math.inf
    for _ in range(250):
        start = np.diff(np.sort(random.uniform(0, problem.horizon_rad, count)), prepend=0.0)
        with np.errstate(over="ignore", invalid="ignore"):
            end = root(equations, start)
        ordered = (end.x >= problem.shortest_gaps_rad).all()
        if end.success and ordered and np.abs(equations(end.x)).max() < 1e-9:
            best = min(best, float(end.x.sum()))
    return best


OFF_THE_USUAL_BRANCH = second_order(2.0, 1.5, 3.0, 0.5)
"""Slow sets behind which the usual branch has no ordered solution."""

MULTISTART_CASES: dict[str, tuple[Actuator, bool]] = {
    "ideal": (IDEAL, False),
    "thesis, at a tenth of its speed": (second_order(5.7, 0.8, 14.3, 1.5), False),
    "slow": (second_order(3.0, 0.7, 2.5, 1.2), False),
    "slow and settled": (second_order(6.0, 1.0, 9.0, 0.8), True),
    "first order": (FirstOrder(accel_time_constant_s=0.3, decel_time_constant_s=0.05), False),
}


@pytest.mark.parametrize("case", MULTISTART_CASES)
@pytest.mark.parametrize("model", [ZERO_VIBRATION, ZERO_VIBRATION_DERIVATIVE])
def test_random_starts_find_nothing_faster(case: str, model: UnityMagnitude) -> None:
    actuator, settle = MULTISTART_CASES[case]
    problem = formulate(actuator, model, settle=settle)
    first = next(candidates(problem))
    best = fastest_of_random_starts(problem, MODE, actuator)
    assert math.isfinite(best)
    assert first.impulses.duration_s <= best + 1e-6  # SciPy ends at 1e-8 or so


def test_settled_steps_of_a_damped_plant_take_the_fastest_branch_too() -> None:
    # As the closed form does without damping.
    actuator = second_order(2.06, 0.84, 2.47, 1.18)
    problem = formulate(actuator, ZERO_VIBRATION, settle=True)
    best = fastest_of_random_starts(problem, MODE, actuator)
    assert next(candidates(problem)).impulses.duration_s <= best + 1e-6  # SciPy ends at 1e-8 or so


def test_the_usual_seed_needs_one_start() -> None:
    first = next(candidates(formulate(THESIS, mode=Mode(natural_frequency_rad_s=3.5))))
    assert (first.solver.seed, first.solver.starts) == ("umzvd_polynomials", 1)


def test_where_seeds_fail_the_branches_are_searched() -> None:
    first = next(candidates(formulate(OFF_THE_USUAL_BRANCH)))
    assert first.solver.seed == "branch_search"
    assert first.solver.starts == BRANCH_STARTS + 2
    assert first.impulses.duration_s > 0.85 * 2 * math.pi  # beyond the usual branch


def test_candidates_come_fastest_first_once_branches_are_searched() -> None:
    durations = []
    with suppress(InfeasibleDesignError):  # the end of every search
        for candidate in candidates(formulate(OFF_THE_USUAL_BRANCH)):
            durations.append(candidate.impulses.duration_s)
    assert len(durations) > 1
    # The seeds themselves, tried again last, may lead to roots found before.
    distinct = durations[: durations.index(max(durations)) + 1]
    assert distinct == pytest.approx(sorted(distinct), abs=1e-9)  # the solver's accuracy


def test_starts_are_ordered_within_the_horizon_and_long_enough() -> None:
    problem = formulate(second_order(6.0, 1.0, 9.0, 0.8), settle=True)
    starts = spread_starts(problem)
    assert starts.shape == (BRANCH_STARTS, 4)
    assert (starts >= problem.shortest_gaps_rad).all()
    assert (starts.sum(axis=1) <= problem.horizon_rad).all()


def test_starts_are_spread_evenly_and_the_same_every_time() -> None:
    problem = formulate(IDEAL)
    starts = spread_starts(problem)
    assert (starts == spread_starts(problem)).all()
    # The k-th of n sorted uniform numbers has mean k / (n + 1); a lattice keeps to a per cent.
    means = np.cumsum(starts, axis=1).mean(axis=0) / problem.horizon_rad
    assert means == pytest.approx([0.2, 0.4, 0.6, 0.8], abs=0.01)


def test_a_fruitless_search_says_how_far_it_went_and_what_came_nearest() -> None:
    message = (
        r"^no ordered solution with duration <= 0\.5 periods in 1026 starts; nearest miss: "
        r"the solution with switches at 0, [-\d., ]+ periods$"
    )
    with refused("no_solution_found", says=message):
        list(candidates(formulate(IDEAL, periods=0.5)))


def test_a_search_without_any_root_says_how_far_off_the_nearest_is() -> None:
    # At no damping |G_decel/G_accel| = 3.3 closes no triangle.
    actuator = second_order(1.0, 1.6, 60.0, 0.5)
    undamped = Mode(natural_frequency_rad_s=1.0)
    message = r"in 1026 starts; nearest miss: an equation off by [\d.e-]+$"
    with refused("no_solution_found", says=message) as caught:
        list(candidates(formulate(actuator, ZERO_VIBRATION, undamped)))
    # What is told is the larger of two components of 3.2 less the two other vectors.
    left = float(str(caught.value).split("off by ")[1])
    assert left >= 1.2 / math.sqrt(2) - 1e-3


def answer(problem: GapProblem, status: Status) -> Outcome:
    return Outcome(status=status, unknowns=problem.seeds[0].gaps_rad, iterations=1)


def test_a_solver_out_of_time_ends_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = formulate(THESIS)
    monkeypatch.setattr(ipopt, "solve", lambda *_: answer(problem, Status.TIME_LIMIT))
    with refused("seed_past_time", says=r"^ipopt ran past its time from seed 'umzvd_poly"):
        next(candidates(problem))


@pytest.mark.parametrize("status", [Status.FAILED, Status.INFEASIBLE])
def test_a_solver_without_success_yields_no_candidate(
    status: Status, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = formulate(THESIS)
    monkeypatch.setattr(ipopt, "solve", lambda *_: answer(problem, status))
    with refused("no_solution_found", says=r"^no ordered solution"):
        next(candidates(problem))


def test_an_answer_beyond_the_horizon_is_no_candidate(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = formulate(THESIS)
    late = Outcome(status=Status.SOLVE_SUCCEEDED, unknowns=np.full(4, 5.0), iterations=1)
    monkeypatch.setattr(ipopt, "solve", lambda *_: late)
    with pytest.raises(InfeasibleDesignError):
        next(candidates(problem))


@pytest.mark.parametrize("periods", [6.0, 20.0, 100.0])
def test_a_longer_horizon_never_loses_a_solution(periods: float) -> None:
    # Found by the search over branches only, in a horizon of three periods.
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.07248)
    actuator = second_order(3.0825, 0.5928, 2.5538, 1.5639)
    short, long = (
        next(
            candidates(
                unity_magnitude_problem(
                    ZERO_VIBRATION_DERIVATIVE,
                    mode,
                    actuator,
                    settle=False,
                    max_duration_periods=horizon,
                )
            )
        )
        for horizon in (3.0, periods)
    )
    assert short.solver.seed == "branch_search"
    assert long.impulses.times_s == pytest.approx(short.impulses.times_s, abs=1e-9)


@pytest.mark.parametrize("size", [1e12, 1e6])
def test_equations_of_any_size_stop_no_lane(size: float) -> None:
    # A set that follows at once beside one a million times slower: Jacobians of 1e12.
    actuator = FirstOrder(accel_time_constant_s=size, decel_time_constant_s=0.0)
    problem = unity_magnitude_problem(
        ZERO_VIBRATION_DERIVATIVE,
        Mode(natural_frequency_rad_s=1.0),
        actuator,
        settle=False,
        max_duration_periods=3.0,
    )
    with suppress(InfeasibleDesignError):
        next(candidates(problem))


def test_starts_at_nearly_one_time_stop_no_lane_with_a_singular_matrix() -> None:
    # Of one in 7,000 random designs: what keeps a lane from being singular made it so.
    mode = Mode(natural_frequency_rad_s=2.867163710933035, damping_ratio=0.045023914989145354)
    with refused("no_solution_found", says=r"duration <= 0\.1 periods in 1026 starts"):
        next(candidates(formulate(IDEAL, mode=mode, periods=0.1)))
