"""Searches count what they do: each ends with its budget, alike every time, and says so."""

import contextlib
from typing import Any

import numpy as np
import pytest

from design.curve_fit.fit import fit
from design.curve_fit.fit_range import FitRange
from design.errors import InfeasibleDesignError
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.pipeline import design
from design.recommendations.recommendation import recommend
from design.recommendations.requirements import Requirements
from design.shapers.num_large import LargeSwingOptions
from design.shapers.numei import HumpOptions
from design.shapers.numsi import UnityBandOptions
from design.shapers.registry import SHAPERS
from design.shapers.specified_insensitivity import BandOptions
from design.solvers import newton
from design.solvers.budget import MAX_WORK_PER_DESIGN, Budget
from design.solving.solve import solve
from tests.refusals import refused
from tests.shaper_table import IDEAL, THESIS

OVERSHOOT = 1_000_000
"""What one step of a search may take beyond its budget: the largest cone program, a second."""

MODE = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.02)
SWITCHED = SecondOrder(accel=THESIS.accel, decel=THESIS.decel, model="switched")
LIMITED = RateLimited(accel_limit_m_s2=3.734, decel_limit_m_s2=34.28, speed_m_s=0.45, then=SWITCHED)
SIX = Modes(
    modes=tuple(
        Mode(natural_frequency_rad_s=w, damping_ratio=z)
        for w, z in ((1.0, 0.02), (1.9, 0.7), (3.3, 0.9), (4.9, 0.8), (6.4, 0.9), (7.6, 0.9))
    )
)
TWO = Modes(
    modes=(Mode(natural_frequency_rad_s=3.5), Mode(natural_frequency_rad_s=9.4, damping_ratio=0.02))
)
WIDE = {"half_width": 0.6, "tolerance": 1e-3, "amplitudes": "negative"}

HARD: list[tuple[str, Plant, Actuator, Any]] = [
    ("numzvd", MODE, SWITCHED, None),
    ("num_ei", MODE, LIMITED, HumpOptions(tolerance=0.4, max_duration_periods=100.0)),
    ("num_2ei", MODE, LIMITED, HumpOptions(tolerance=0.4, max_duration_periods=100.0)),
    ("num_si", MODE, LIMITED, UnityBandOptions(half_width=0.6, tolerance=0.01)),
    ("si", MODE, IDEAL, BandOptions(max_duration_periods=100.0, **WIDE)),  # type: ignore[arg-type]
    ("si", MODE, IDEAL, BandOptions(half_width=0.8, tolerance=1e-3, max_duration_periods=50.0)),
    ("multi_zv", SIX, IDEAL, None),
    ("multi_umzv", SIX, IDEAL, None),
]
"""Designs of every search, some of which there are not."""


def _work(case: tuple[str, Plant, Actuator, Any], most: float) -> tuple[Budget, str]:
    name, plant, actuator, options = case
    budget = Budget(most=most)
    refusal = ""
    try:
        design(plant, actuator, SHAPERS[name], options, budget)
    except InfeasibleDesignError as error:
        refusal = str(error)
    return budget, refusal


@pytest.mark.parametrize("case", HARD, ids=lambda case: case[0])
def test_no_search_takes_more_than_its_budget(case: tuple[str, Plant, Actuator, Any]) -> None:
    budget, _ = _work(case, MAX_WORK_PER_DESIGN)
    assert 0 < budget.done <= MAX_WORK_PER_DESIGN + OVERSHOOT


@pytest.mark.parametrize("case", HARD, ids=lambda case: case[0])
@pytest.mark.parametrize("most", [1.0, 30_000.0])
def test_a_search_that_is_cut_says_so_and_ends_alike_every_time(
    case: tuple[str, Plant, Actuator, Any], most: float
) -> None:
    budget, refusal = _work(case, most)
    assert (budget.done, refusal) == (_work(case, most)[0].done, _work(case, most)[1])
    if refusal:
        assert f"its budget of {most / 1e6:.3g} million units of work is spent" in refusal


SLOW = RateLimited(accel_limit_m_s2=0.9, decel_limit_m_s2=1.2, speed_m_s=0.45)
NO_SEED_SERVES: list[tuple[str, Plant, Actuator, Any]] = [
    (kind, MODE, SLOW, None) for kind in ("numzv", "numzvd", "num_ei", "num_2ei", "num_si")
]
"""Ramps that outlast the gaps of the seeds: all is left to the search over branches."""

LARGE = LargeSwingOptions(speed_m_s=1.5)


def _plant(kind: str) -> Plant:
    if SHAPERS[kind].large_swings:
        return Pendulum(cable_length_m=0.8)
    return TWO if SHAPERS[kind].serves_several else MODE


EASY: list[tuple[str, Plant, Actuator, Any]] = [
    (kind, _plant(kind), actuator, LARGE if SHAPERS[kind].large_swings else None)
    for kind in SHAPERS
    for actuator in (IDEAL, THESIS, SWITCHED, LIMITED)
    if actuator.kind in SHAPERS[kind].actuators
]


@pytest.mark.parametrize("most", [0.0, 3e3, 3e4, 3e5])
@pytest.mark.parametrize("case", [*HARD, *NO_SEED_SERVES, *EASY])
def test_a_budget_of_any_size_ends_in_a_design_or_a_refusal(
    case: tuple[str, Plant, Actuator, Any], most: float
) -> None:
    kind, plant, actuator, options = case
    try:
        found = design(plant, actuator, SHAPERS[kind], options, Budget(most=most))
    except InfeasibleDesignError as error:
        refusal = str(error)
        assert "budget" in refusal or "periods" in refusal
    else:
        assert found.certificate.verified


def test_a_search_of_branches_begins_no_more_starts_than_its_budget_allows() -> None:
    numzvd = SHAPERS["numzvd"]
    problem: Any = numzvd.formulate(numzvd.case((MODE,), SWITCHED))
    starts = np.tile(problem.seeds[0].gaps_rad, (1000, 1))
    some = newton.roots(problem.model, starts, problem.parameters, budget=Budget(most=2000.0))
    assert 0 < len(some.unknowns) < 1000
    assert len(some.unknowns) % newton.LANES == 0
    none = newton.roots(problem.model, starts, problem.parameters, budget=Budget(most=0.0))
    assert none.unknowns.shape == (0, 4)
    assert newton.roots(problem.model, starts, problem.parameters).converged.all()


def test_a_cut_search_tells_what_it_searched_and_what_it_did_not() -> None:
    numzvd = SHAPERS["numzvd"]
    options = numzvd.options(max_duration_periods=20.0)
    problem: Any = numzvd.formulate(numzvd.case((MODE,), SWITCHED, options))
    message = (
        r"^no ordered solution with duration <= 3 periods in \d+ starts; nearest miss: .*; "
        r"durations up to 20 periods were not searched to the end: its budget of 0\.02 million"
    )
    with refused("no_solution_found", says=message):
        for _ in solve(problem, Budget(most=20_000.0)):
            pass


@pytest.mark.parametrize(
    ("plant", "actuator", "wanted"),
    [
        (
            Mode(natural_frequency_rad_s=7.1456, damping_ratio=0.02),
            LIMITED,
            Requirements(
                tolerance=0.1, half_width=0.2, damping=(0.0, 0.08), max_high_mode_gain=1.5
            ),
        ),
        (MODE, LIMITED, Requirements(tolerance=0.003, half_width=0.2, sample_time_s=0.01)),
        (MODE, SWITCHED, Requirements(tolerance=1e-4, half_width=0.5, max_duration_s=0.5)),
        (SIX, THESIS, Requirements(tolerance=0.02, half_width=0.1)),
    ],
)
def test_a_recommendation_shares_one_budget(
    monkeypatch: pytest.MonkeyPatch, plant: Plant, actuator: Actuator, wanted: Requirements
) -> None:
    spent: list[Budget] = []

    class Watched(Budget):
        def __init__(self, most: float) -> None:
            super().__init__(most=most)
            spent.append(self)

    monkeypatch.setattr("design.recommendations.recommendation.Budget", Watched)
    with contextlib.suppress(InfeasibleDesignError):  # it ends within its budget all the same
        recommend(plant, actuator, wanted)
    (budget,) = spent
    assert 0 < budget.done <= MAX_WORK_PER_DESIGN + OVERSHOOT


def test_what_a_recommendation_has_no_budget_for_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "design.recommendations.recommendation.MAX_WORK_PER_RECOMMENDATION", 400_000
    )
    found = recommend(MODE, SWITCHED, Requirements(half_width=0.1, sample_time_s=0.01))
    left_out = [one for one in found.refused if not one.searched]
    assert left_out
    assert all("of the recommendation its budget of 0.4 million" in one.reason for one in left_out)
    assert "zv" in {one.name for one in (*found.candidates, *found.others)}


def test_a_fit_ends_with_its_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    wanted = FitRange(over="damping_ratio", start=0.0, stop=0.2, max_residual=1e-16)
    monkeypatch.setattr("design.curve_fit.exact_curve.DESIGN_WORK", MAX_WORK_PER_DESIGN / 30)
    with refused("no_degree_suffices", says=r"no degree up to \d has .*; its budget of 4"):
        fit(MODE, IDEAL, SHAPERS["umzvd"], wanted)
