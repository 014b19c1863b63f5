"""Rows on the samples of a controller against single designs, and against other routes."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from design.export.reading import rows_of
from design.model.impulses import Impulses
from design.tables.columns import amplitudes_of, names_of, times_of
from design.tables.compute import compute_rows, compute_with_counts
from design.tables.interpolation import interpolant
from design.tables.rows import INFEASIBLE, STATUSES, VERIFIED, VERIFIED_IDEAL, subject_of
from design.tables.sampled_rows import widened
from schemas.design_request import DesignRequest
from schemas.tables import TableRequest, with_subject
from service.jobs.plan import Plan, plan_table
from service.jobs.results import table_of, write_result
from service.jobs.store import Store
from service.operations.requested_design import requested_design
from tests.integration_route import residual_by_integration
from tests.job_stores import HOUR_S
from tests.refusals import refused
from tests.tables_in_store import add_done

MODE = {"kind": "mode", "natural_frequency_rad_s": 12.0, "damping_ratio": 0.03}
TWO = {"kind": "modes", "modes": [{**MODE}, {**MODE, "natural_frequency_rad_s": 31.0}]}
RANGE = {
    "kind": "scheduled",
    "plant": MODE,
    "over": "natural_frequency_rad_s",
    "from": 10,
    "to": 14,
}
for mode in TWO["modes"]:
    del mode["kind"]  # type: ignore[attr-defined]

IDEAL = {"kind": "ideal"}
LAG = {"kind": "first_order", "accel_time_constant_s": 0.03, "decel_time_constant_s": 0.05}
SWITCHED = {**LAG, "model": "switched"}
LIMITS = {"kind": "rate_limited", "accel_limit_m_s2": 4, "decel_limit_m_s2": 4, "speed_m_s": 0.2}

COLUMNS = ["times_s", "amplitudes", "residual", "slope", "samples", "duration_samples"]

AXES = [
    {"field": "/plant/natural_frequency_rad_s", "values": [11.0, 14.5]},
    {"field": "/shaper/sample_time_s", "values": [0.012, 0.02]},
]


def table(
    kind: str, actuator: dict[str, Any], plant: dict[str, Any] | None = None, **more: Any
) -> dict[str, Any]:
    shaper = {"kind": kind, "sample_time_s": 0.02, **more}
    design = {"plant": plant or MODE, "actuator": actuator, "shaper": shaper}
    return {"design": design, "axes": AXES, "columns": COLUMNS}


def single(spec: dict[str, Any], values: list[float]) -> dict[str, Any]:
    """Return the request of the design that a row is."""
    request: dict[str, Any] = json.loads(json.dumps(spec["design"]))
    for axis, value in zip(spec["axes"], values, strict=True):
        *path, last = axis["field"].removeprefix("/").split("/")
        inner: Any = request
        for name in path:
            inner = inner[int(name)] if isinstance(inner, list) else inner[name]
        inner[last] = value
    return request


@pytest.mark.parametrize(
    ("kind", "actuator", "more"),
    [
        ("zvd", IDEAL, {}),
        ("ei", SWITCHED, {}),
        ("si", IDEAL, {"amplitudes": "negative"}),
        ("umzv", LAG, {}),
        ("umzvd", IDEAL, {"sample_tolerance": 0.02}),
        ("numzv", LAG, {"max_duration_periods": 2.0}),
        ("numzv", SWITCHED, {}),
        ("numzvd", IDEAL, {"settle": True}),
        ("num_ei", LAG, {}),
        ("num_si", LAG, {}),
        ("sna_zvd", LAG, {}),
        ("ps_zv", LAG, {}),
        ("zv", LIMITS, {}),
    ],
)
def test_a_row_is_the_single_design(
    kind: str, actuator: dict[str, Any], more: dict[str, Any]
) -> None:
    spec = table(kind, actuator, **more)
    specification = TableRequest.model_validate(spec).to_design()
    rows = compute_rows(specification, 0, 4)
    assert_rows_are_designs(spec, rows)


def assert_rows_are_designs(spec: dict[str, Any], rows: Any) -> None:
    width = (rows.results.shape[1] - 3) // 3
    for values, numbers, status in zip(
        rows.fields.tolist(), rows.results, rows.status.tolist(), strict=True
    ):
        asked = requested_design(DesignRequest.model_validate(single(spec, values)))
        found, sampled = asked.design, asked.sampled
        assert sampled is not None
        has = found.impulses.times_s.size
        times, heights = numbers[:width], numbers[width : 2 * width]
        residual, _, *samples, duration = numbers[2 * width :]
        assert times[:has].tolist() == found.impulses.times_s.tolist()
        assert heights[:has].tolist() == found.impulses.amplitudes.tolist()
        assert np.isnan(times[has:]).all()
        assert np.isnan(heights[has:]).all()
        assert samples[:has] == sampled.samples
        assert duration == sampled.samples[-1] - sampled.samples[0]
        assert residual == found.residual
        assert status == (VERIFIED_IDEAL if found.for_ideal else VERIFIED)


@pytest.mark.parametrize(
    ("kind", "plant", "field", "more"),
    [
        ("multi_zv", TWO, "/plant/modes/1/natural_frequency_rad_s", {}),
        ("convolved", TWO, "/plant/modes/1/natural_frequency_rad_s", {"base": "zv"}),
        ("zv", RANGE, "/shaper/sample_time_s", {}),
    ],
)
def test_several_modes_and_ranges_have_rows_on_samples(
    kind: str, plant: dict[str, Any], field: str, more: dict[str, Any]
) -> None:
    values = [0.01, 0.02] if "shaper" in field else [29.0, 33.0]
    spec = {**table(kind, IDEAL, plant, **more), "axes": [{"field": field, "values": values}]}
    rows = compute_rows(TableRequest.model_validate(spec).to_design(), 0, 2)
    assert_rows_are_designs(spec, rows)


def test_a_row_has_the_residual_of_the_differential_equations() -> None:
    spec = TableRequest.model_validate(table("numzv", SWITCHED)).to_design()
    rows = compute_rows(spec, 0, 4)
    width = (rows.results.shape[1] - 3) // 3
    for values, numbers in zip(rows.fields, rows.results, strict=True):
        plant, actuator, _ = spec.at(values)
        held = ~np.isnan(numbers[:width])
        command = Impulses(
            times_s=numbers[:width][held], amplitudes=numbers[width : 2 * width][held]
        )
        residual = residual_by_integration(command, plant.modes[0], actuator)
        assert numbers[2 * width] == pytest.approx(residual, abs=1e-7)


def test_rows_do_not_depend_on_their_chunks() -> None:
    spec = TableRequest.model_validate(table("umzv", LAG)).to_design()
    whole, counts = compute_with_counts(spec, 0, 4)
    assert (counts.compiled, counts.single) == (0, 4)
    widest = (whole.results.shape[1] - 3) // 3
    for row in range(4):
        one = widened(spec.columns, compute_rows(spec, row, row + 1), widest)
        np.testing.assert_array_equal(one.results[0], whole.results[row])


def test_a_row_that_does_not_keep_its_claim_says_so() -> None:
    spec = {**table("num_ei", LAG), "axes": [{"field": "/shaper/sample_time_s", "values": [0.03]}]}
    rows = compute_rows(TableRequest.model_validate(spec).to_design(), 0, 1)
    assert rows.status.tolist() == [VERIFIED]
    assert "more than the tolerance" in rows.reasons[0]


def test_samples_too_long_for_a_row_are_its_reason() -> None:
    spec = {**table("zv", IDEAL), "axes": [{"field": "/shaper/sample_time_s", "values": [0.3]}]}
    rows = compute_rows(TableRequest.model_validate(spec).to_design(), 0, 1)
    assert rows.status.tolist() == [INFEASIBLE]
    assert rows.reasons[0].startswith("sample_time_s must be at most half the period")
    assert np.isnan(rows.results).all()


@pytest.mark.parametrize("name", ["csv", "json", "parquet", "mat"])
def test_files_are_as_wide_as_the_widest_row(tmp_path: Path, name: str) -> None:
    spec = {**table("umzv", LAG), "chunk_rows": 1}
    store = Store(f"sqlite:///{tmp_path / 'jobs.sqlite'}", stalled_s=HOUR_S)
    try:
        job = store.job(add_done(store, spec))
        assert job is not None
        head, runs = table_of(store, store.contents_of(job.id), name)
        rows = list(runs)
        write_result(store, job, name, tmp_path / "table")
    finally:
        store.close()
    counts = [int((~np.isnan(times_of(head, run)[0])).sum()) for run in rows]
    assert len(set(counts)) > 1
    assert head.impulses == max(counts)
    assert names_of(head, "result")[-2] == f"n{head.impulses}"
    with (tmp_path / "table").open("rb") as file:
        read, again = rows_of(name, file)
        found = list(again)
        times = np.vstack([times_of(read, run) for run in found])
        heights = np.vstack([amplitudes_of(read, run) for run in found])
    np.testing.assert_array_equal(times, np.vstack([times_of(head, run) for run in rows]))
    np.testing.assert_array_equal(heights, np.vstack([amplitudes_of(head, run) for run in rows]))
    assert subject_of(with_subject(read)).grid == subject_of(head).grid


def test_what_is_not_said_is_as_samples_need_it() -> None:
    spec = table("zv", IDEAL)
    del spec["columns"]
    plan = plan_table(json.dumps(spec).encode())
    assert isinstance(plan, Plan)
    kept = TableRequest.model_validate_json(plan.job.specification)
    assert kept.columns == ["times_s", "amplitudes", "residual"]
    assert kept.chunk_rows == plan.job.chunk_rows == 100
    assert plan.job.impulses is None


@pytest.mark.parametrize(
    ("spec", "code", "field"),
    [
        (
            {**table("zv", IDEAL), "columns": ["times_s", "residual"]},
            "amplitudes_missing",
            "columns",
        ),
        (
            {**table("zv", IDEAL), "fit": {"over": "/plant/damping_ratio", "from": 0, "to": 0.1}},
            "kind_not_sampled",
            "design.shaper.sample_time_s",
        ),
        (table("convolved", IDEAL, TWO, base="umzv"), "samples_of_one_mode", None),
        (
            {
                **table("zv", IDEAL),
                "design": {"plant": MODE, "actuator": IDEAL, "shaper": {"kind": "zv"}},
                "columns": ["times_s", "amplitudes"],
            },
            "samples_not_in_design",
            None,
        ),
        (
            {
                "design": {"plant": MODE, "actuator": IDEAL, "shaper": {"kind": "zv"}},
                "axes": AXES[:1],
                "columns": ["duration_samples"],
            },
            "column_without_samples",
            "columns.0",
        ),
        (
            {
                **table("zv", IDEAL),
                "axes": [{"field": "/shaper/sample_time_s", "values": [0.01, 0.0]}],
            },
            "not_positive",
            "axes.0.values",
        ),
    ],
)
def test_what_is_not_served_on_samples_is_named(
    spec: dict[str, Any], code: str, field: str | None
) -> None:
    with refused(code, field):
        TableRequest.model_validate(spec).to_design()


def test_nothing_is_interpolated_between_rows_on_samples(tmp_path: Path) -> None:
    spec = {**table("zv", IDEAL), "axes": AXES[:1]}
    store = Store(f"sqlite:///{tmp_path / 'jobs.sqlite'}", stalled_s=HOUR_S)
    try:
        head, runs = table_of(store, store.contents_of(add_done(store, spec)), "csv")
        (rows,) = runs
    finally:
        store.close()
    assert {STATUSES[code] for code in rows.status.tolist()} == {"verified"}
    with refused("samples_not_interpolated", "subject"):
        interpolant(head, rows)
