"""Rows of tables against single designs."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from design.claims import ZERO_LIMITS
from design.errors import DesignError
from design.fields import Axis
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.pipeline import Design, design
from design.shapers.peak_options import PeakOptions
from design.shapers.registry import SHAPERS
from design.shapers.settle_options import SettleOptions
from design.solvers.branches import spread_starts
from design.solvers.newton import roots
from design.tables import compute, kernel, starts
from design.tables.compiled import compiled
from design.tables.compute import compute_rows, compute_with_counts
from design.tables.designed_rows import empty_rows
from design.tables.rows import FAILED, INFEASIBLE, VERIFIED, VERIFIED_IDEAL
from design.tables.specification import TableSpecification
from tests.refusals import refused
from tests.shaper_table import CRANE, THESIS
from tests.table_cases import random_table

MODELS: tuple[Model, ...] = ("superposed", "switched")


SAME = 1e-10
"""Times agree to this share of the duration: IPOPT's tolerance is 1e-12."""

COMPILED = {name for name, kind in SHAPERS.items() if kind.compiled_rows is not None}


def single_design(
    table: TableSpecification, plant: Plant, actuator: Actuator, options: Any
) -> Design | str:
    """Return the design, or why there is none."""
    try:
        return design(plant, actuator, table.kind, options)
    except DesignError as error:
        return str(error)


def require_same_as_single(table: TableSpecification) -> int:
    """Compare every row; return how many are verified."""
    rows = compute_rows(table, 0, table.rows)
    for index, values in enumerate(rows.fields):
        plant, actuator, options = table.at(values)
        found = single_design(table, plant, actuator, options)
        if isinstance(found, str):
            assert rows.status[index] in {INFEASIBLE, FAILED}
            assert rows.reasons[index] == found
            assert np.isnan(rows.results[index]).all()
            continue
        if found.impulses.times_s.size != table.impulses:
            assert rows.status[index] == FAILED
            assert f"{found.impulses.times_s.size} impulses" in rows.reasons[index]
            continue
        assert rows.status[index] == status_of(found)
        times, duration = found.impulses.times_s, found.impulses.duration_s
        apart = np.abs(rows.results[index, : times.size] - times).max()
        assert apart <= SAME * duration, (index, values.tolist())
        assert rows.results[index, times.size] == pytest.approx(found.residual, abs=1e-10)
    return int(rows.designed.sum())


def status_of(found: Design) -> int:
    """Return verified where nothing is left with the actuator given."""
    return VERIFIED if found.residual <= ZERO_LIMITS["residual"] else VERIFIED_IDEAL


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("order", [1, 2])
def test_a_row_equals_the_single_design(order: int, model: Model) -> None:
    """500 random machines of each; long branches among them."""
    assert require_same_as_single(random_table(500, 11, order=order, model=model)) >= 499


@pytest.mark.parametrize("damping", [0.0, 0.5])
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("kind", sorted(COMPILED))
def test_a_row_of_any_compiled_shaper_equals_the_single_design(
    kind: str, model: Model, damping: float
) -> None:
    orders = (0, 1, 2) if "ideal" in SHAPERS[kind].actuators else (1,)
    for order in orders:
        table = random_table(20, 5, order=order, model=model, kind=kind, damping=damping)
        require_same_as_single(table)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
def test_a_row_that_lets_each_step_settle_equals_the_single_design(kind: str, model: Model) -> None:
    options = SHAPERS[kind].options(settle=True, max_duration_periods=4.0)
    require_same_as_single(
        random_table(4, 6, order=2, model=model, kind=kind, options=options, poles=(3.0, 9.0))
    )


def test_slow_drives_end_as_single_designs_do() -> None:
    """Poles at 1 to 2 w: some have no such shaper, and rows say so in the same words."""
    options = SettleOptions(max_duration_periods=1.5)
    table = random_table(12, 7, order=2, poles=(1.0, 2.0), options=options)
    assert require_same_as_single(table) < 12


def test_rows_do_not_depend_on_where_a_run_begins() -> None:
    table = random_table(60, 8, order=2)
    whole = compute_rows(table, 0, 60)
    parts = [compute_rows(table, start, start + 7) for start in range(0, 56, 7)]
    joined = np.concatenate([part.results for part in parts])
    assert joined.tobytes() == whole.results[:56].tobytes()
    assert [part.first for part in parts] == list(range(0, 56, 7))


def test_rows_designed_a_few_at_a_time_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Byte for byte, and each reason stands with its row."""
    options = SettleOptions(max_duration_periods=1.5)
    table = random_table(40, 7, order=2, poles=(1.0, 2.0), options=options)
    whole = compute_rows(table, 3, 40)
    assert len(whole.reasons) > 1
    monkeypatch.setattr(compute, "RUN_ROWS", 7)
    runs = compute_rows(table, 3, 40)
    assert runs.first == whole.first
    assert runs.reasons == whole.reasons
    for name in ("fields", "results", "status"):
        assert getattr(runs, name).tobytes() == getattr(whole, name).tobytes()


def test_almost_all_rows_are_compiled_and_some_are_guarded() -> None:
    rows, counts = compute_with_counts(random_table(4000, 9, order=1), 0, 4000)
    assert (rows.status == VERIFIED).all()
    assert counts.compiled == 4000
    assert 0 < counts.guarded < 20
    assert counts.corrected == 0


def crane_table(points: int, **other: Any) -> TableSpecification:
    return TableSpecification(
        plant=CRANE,
        actuator=other.get("actuator", THESIS),
        kind=SHAPERS[other.get("kind", "numzvd")],
        options=SHAPERS[other.get("kind", "numzvd")].options(),
        axes=(Axis(path=("plant", "cable_length_m"), values=np.linspace(0.5, 1.0, points)),),
        columns=("times_s", "amplitudes", "phases_rad", "duration_s", "residual", "slope"),
    )


@pytest.mark.parametrize("kind", ["umzv", "umzvd", "numzvd"])
def test_every_column_is_that_of_the_single_design(kind: str) -> None:
    table = crane_table(2, kind=kind)
    one = compute_rows(table, 0, 2)
    # The drive's sets are apart: what does not know them is proven for an ideal one only.
    assert one.status.tolist() == [VERIFIED if kind == "numzvd" else VERIFIED_IDEAL] * 2
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compute, "compiled_rows_of", lambda _: None)
        rows, counts = compute_with_counts(table, 0, 2)
    assert counts.single == 2
    assert one.status.tolist() == rows.status.tolist()
    np.testing.assert_allclose(one.results, rows.results, rtol=1e-9, atol=1e-9)


def test_gaps_that_solve_nothing_are_not_verified(monkeypatch: pytest.MonkeyPatch) -> None:
    """A kernel that errs by a millionth is caught; the single designs stand in."""
    table = crane_table(3)
    right = compute_rows(table, 0, 3)

    def wrong(*args: Any, **kwargs: Any) -> Any:
        gaps, ends = solve(*args, **kwargs)
        return gaps + 1e-6, ends

    solve = kernel.solve_rows
    monkeypatch.setattr(kernel, "solve_rows", wrong)
    rows, counts = compute_with_counts(table, 0, 3)
    assert counts.compiled == 0
    assert counts.single == 3
    np.testing.assert_allclose(rows.results[:, :5], right.results[:, :5], rtol=1e-9)


def test_a_wrong_branch_is_found_by_the_guard(monkeypatch: pytest.MonkeyPatch) -> None:
    """Slower roots are verified shapers: only the single design tells that they are not fastest."""
    table = crane_table(1)
    right = compute_rows(table, 0, 1)
    plant, actuator, options = table.at(table.field_values(0, 1)[0])
    problem: Any = table.kind.formulate(table.kind.case(plant.modes, actuator, options))
    ends = roots(problem.model, spread_starts(problem), problem.parameters)
    usable = ends.unknowns[ends.converged & (ends.unknowns > 1e-2).all(axis=1)]
    slower = usable[usable.sum(axis=1) > 1.1 * right.results[0, 4] * plant.mode.pole_rad_s.imag][:1]
    found = np.array([starts.FOUND], dtype=np.int8)
    monkeypatch.setattr(kernel, "solve_rows", lambda *_, **__: (slower, found))
    unguarded, counts = compute_with_counts(table, 0, 1)
    assert counts.compiled == 1
    assert unguarded.results[0, 4] > 1.05 * right.results[0, 4]
    monkeypatch.setattr(compute, "GUARDED_SHARE", 1)
    guarded, counts = compute_with_counts(table, 0, 1)
    assert (counts.guarded, counts.corrected) == (1, 1)
    assert guarded.reasons == {}
    np.testing.assert_allclose(guarded.results[:, :5], right.results[:, :5], rtol=1e-9)


def test_a_row_without_a_design_says_why() -> None:
    slow = FirstOrder(accel_time_constant_s=3.0, decel_time_constant_s=0.01)
    rows = compute_rows(crane_table(2, actuator=slow, kind="numzv"), 0, 2)
    assert rows.status.tolist() == [INFEASIBLE, INFEASIBLE]
    assert "closes only for alpha <= 2" in rows.reasons[0]
    out_of_proportion = replace(slow, accel_time_constant_s=1000.0)
    rows = compute_rows(crane_table(1, actuator=out_of_proportion), 0, 1)
    assert "times slower than the plant" in rows.reasons[0]


def test_a_function_that_cannot_be_cached_is_compiled_all_the_same() -> None:
    names: dict[str, Any] = {}
    exec("def twice(x):\n    return 2 * x\n", names)
    assert compiled(names["twice"])(21) == 42


HELPER = """
from design.tables.compiled import compiled
FACTOR = {factor}
@compiled
def helper(x):
    return FACTOR * x
"""


def test_the_machine_code_of_a_function_is_not_found_again_when_one_that_it_calls_has_changed() -> (
    None
):
    """Numba looks at the caller's file alone: the name under which it files must tell."""

    def filed(factor: float) -> str:
        names: dict[str, Any] = {}
        exec(HELPER.format(factor=factor), names)
        exec("def caller(x):\n    return helper(x)\n", names)
        return str(compiled(names["caller"]).py_func.__qualname__)

    assert filed(2.0) == filed(2.0)
    assert filed(2.0) != filed(3.0)


def test_what_the_kernel_does_not_know_runs_through_the_pipeline() -> None:
    """A peak velocity other than full speed, given or varied."""
    options = PeakOptions(max_velocity_ratio=1.2)
    table = replace(crane_table(2, kind="numzv"), options=options)
    varied = replace(
        crane_table(2, kind="numzv"),
        axes=(Axis(path=("shaper", "max_velocity_ratio"), values=np.array([1.0, 1.2])),),
    )
    for one in (table, varied):
        rows, counts = compute_with_counts(one, 0, 2)
        assert counts.single == 2
        assert (rows.status == VERIFIED).all()


def test_a_row_with_another_number_of_impulses_fails_with_both_numbers() -> None:
    # Ramps of 2 s are turned midway once they last longer than about a period.
    limits = RateLimited(accel_limit_m_s2=0.5, decel_limit_m_s2=0.5, speed_m_s=1.0)
    table = TableSpecification(
        plant=Mode(natural_frequency_rad_s=1.0),
        actuator=limits,
        kind=SHAPERS["numzv"],
        options=SHAPERS["numzv"].options(),
        axes=(Axis(path=("plant", "natural_frequency_rad_s"), values=np.array([2.0, 4.0])),),
        columns=("times_s", "residual"),
    )
    rows = compute_rows(table, 0, 2)
    assert rows.status.tolist() == [VERIFIED, FAILED]
    assert rows.reasons == {1: "the design has 5 impulses, the table's rows 3"}
    other = design(Mode(natural_frequency_rad_s=4.0), limits, SHAPERS["numzv"])
    straight = empty_rows(1, 3, ("times_s",))
    with refused("impulses_unlike_rows"):
        straight.take(0, Mode(natural_frequency_rad_s=4.0), limits, other)
    assert not straight.designed.any()
