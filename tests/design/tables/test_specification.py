"""What a table is of."""

import itertools
import math
from typing import Any

import numpy as np
import pytest

from design.fields import Axis
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.pendulum import Pendulum
from design.shapers.registry import SHAPERS
from design.tables.columns import columns_of
from design.tables.compute import compute_rows
from design.tables.row_amplitudes import amplitudes_of
from design.tables.specification import TableSpecification
from tests.refusals import refused

DRIVE = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=50.0, damping_ratio=1.5),
)
CABLE = ("plant", "cable_length_m")
DAMPING = ("plant", "damping_ratio")
BRAKE = ("actuator", "decel", "natural_frequency_rad_s")


def table(**changes: Any) -> TableSpecification:
    kind = SHAPERS["numzvd"]
    given: dict[str, Any] = {
        "plant": Pendulum(cable_length_m=0.8),
        "actuator": DRIVE,
        "kind": kind,
        "options": kind.options(),
        "axes": (
            Axis(path=CABLE, values=np.array([0.5, 0.8, 1.1])),
            Axis(path=DAMPING, values=np.array([0.0, 0.05])),
        ),
    }
    return TableSpecification(**{**given, **changes})


def test_axes_multiply_and_the_last_runs_fastest() -> None:
    wanted = list(itertools.product([0.5, 0.8, 1.1], [0.0, 0.05]))
    assert table().rows == 6
    assert table().field_values(0, 6).tolist() == [list(row) for row in wanted]
    assert table().field_values(2, 5).tolist() == [list(row) for row in wanted[2:5]]


def test_chunks_cover_all_rows_once() -> None:
    cut = table(chunk_rows=4)
    assert [cut.chunk(number) for number in range(cut.chunks)] == [(0, 4), (4, 6)]


def test_a_row_is_the_design_with_its_fields_replaced() -> None:
    listed = table(axes=(), listed=np.array([[0.5, 40.0]]), listed_paths=(CABLE, BRAKE))
    plant, actuator, _ = listed.at(listed.field_values(0, 1)[0])
    assert (plant.cable_length_m, actuator.decel.natural_frequency_rad_s) == (0.5, 40.0)  # type: ignore[union-attr]
    assert actuator.accel == DRIVE.accel  # type: ignore[union-attr]


def test_columns_are_fields_results_status_and_reason() -> None:
    columns = columns_of(table(columns=("phases_rad", "duration_s")))
    assert [column.name for column in columns] == [
        "plant.cable_length_m",
        "plant.damping_ratio",
        *(f"phase{number}_rad" for number in range(1, 6)),
        "duration_s",
        "status",
        "reason",
    ]
    assert [column.unit for column in columns] == ["m", "1", *5 * ["rad"], "s", "", ""]


VARYING = {
    "si": "impulses_vary_with_band",
    "num_si": "impulses_vary_with_band",
    "multi_si": "impulses_vary_with_band",
    "multi_zv": "impulses_vary_with_plant",
    "multi_umzv": "impulses_vary_with_plant",
    "convolved": "impulses_vary_with_plant",
}
"""Shapers whose number of impulses changes with the plant or with a band, and their refusals."""


@pytest.mark.parametrize(("name", "code"), VARYING.items())
def test_shapers_that_gain_and_lose_impulses_have_no_place_in_a_table(name: str, code: str) -> None:
    with refused(code, "design.shaper.kind", says=f"got '{name}'"):
        amplitudes_of(SHAPERS[name], None)


@pytest.mark.parametrize("name", [name for name in SHAPERS if name not in VARYING])
def test_amplitudes_sum_to_one(name: str) -> None:
    assert sum(amplitudes_of(SHAPERS[name], None)) == pytest.approx(1.0, abs=1e-15)


def test_amplitudes_that_differ_from_row_to_row_need_columns() -> None:
    def of_zvd(*columns: str) -> TableSpecification:
        axis = Axis(path=DAMPING, values=np.linspace(0.0, 0.2, 3))
        return table(kind=SHAPERS["zvd"], options=None, axes=(axis,), columns=columns)

    with refused("amplitudes_missing", "columns"):
        of_zvd("times_s", "residual")
    rows = compute_rows(of_zvd("times_s", "amplitudes", "residual"), 0, 3)
    assert (rows.status == 0).all()
    for (z,), found in zip(rows.fields.tolist(), rows.results, strict=True):
        decay = math.exp(-math.pi * z / math.sqrt(1 - z * z))
        shares = np.array([1, 2 * decay, decay**2]) / (1 + decay) ** 2
        assert found[3:6] == pytest.approx(shares, abs=1e-15)


def test_amplitudes_that_a_varied_parameter_changes_need_columns() -> None:
    """The first pulse of numzv is as high as max_velocity_ratio."""

    def of_numzv(values: list[float], *columns: str) -> TableSpecification:
        axis = Axis(path=("shaper", "max_velocity_ratio"), values=np.array(values))
        options = SHAPERS["numzv"].options()
        return table(kind=SHAPERS["numzv"], options=options, axes=(axis,), columns=columns)

    for listed in ([1.0, 1.2], [0.9, 1.0, 1.1], [1.2]):
        with refused("amplitudes_missing", "columns"):
            of_numzv(listed, "times_s", "residual")
        specification = of_numzv(listed, "times_s", "amplitudes")
        assert specification.shared_amplitudes == ()
        rows = compute_rows(specification, 0, len(listed))
        assert rows.results[:, 3].tolist() == listed
    assert of_numzv([1.0], "times_s").shared_amplitudes == (1.0, -1.0, 1.0)


def huge(points: int) -> Axis:
    return Axis(path=CABLE, values=np.linspace(0.5, 1.0, points))


@pytest.mark.parametrize(
    ("changes", "field", "code"),
    [
        ({"axes": ()}, "axes", "no_axes"),
        ({"axes": 2 * (Axis(path=CABLE, values=np.ones(2)),)}, "axes.1.field", "field_repeated"),
        ({"axes": (Axis(path=CABLE, values=np.array([])),)}, "axes.0.values", "no_values"),
        (
            {"axes": (Axis(path=("plant", "mass_kg"), values=np.ones(1)),)},
            "axes.0.field",
            "unknown_field",
        ),
        (
            {"axes": (Axis(path=("load", "x"), values=np.ones(1)),)},
            "axes.0.field",
            "field_not_tabulated",
        ),
        (
            {"axes": (Axis(path=DAMPING, values=np.array([0.1, 0.995])),)},
            "axes.0.values",
            "out_of_range",
        ),
        (
            {"axes": (Axis(path=CABLE, values=np.array([1, np.nan])),)},
            "axes.0.values",
            "not_finite",
        ),
        (
            {"axes": (), "listed": np.array([[1.0], [-1.0]]), "listed_paths": (CABLE,)},
            "designs.1",
            "not_positive",
        ),
        ({"columns": ("times_s", "colour")}, "columns.1", "unknown_column"),
        ({"columns": ("residual", "residual")}, "columns.1", "unknown_column"),
        ({"chunk_rows": 0}, "chunk_rows", "out_of_range"),
        (
            {"axes": (huge(10**6), Axis(path=DAMPING, values=np.linspace(0, 0.1, 10**6)))},
            "axes",
            "too_many_rows",
        ),
        (
            {"axes": (huge(10**4), Axis(path=DAMPING, values=np.linspace(0, 0.1, 10**4)))}
            | {"chunk_rows": 10},
            "chunk_rows",
            "chunks_too_small",
        ),
        ({"kind": SHAPERS["umzvc"]}, "actuator.kind", "actuator_not_served"),
    ],
)
def test_bad_input_is_named(changes: dict[str, Any], field: str, code: str) -> None:
    with refused(code, field):
        table(**changes)


def test_a_list_without_designs_is_refused() -> None:
    with refused("no_designs", "designs"):
        table(axes=(), listed=np.empty((0, 1)), listed_paths=(CABLE,))


def test_columns_of_rows_whose_impulses_are_not_counted_are_refused() -> None:
    kind = SHAPERS["num_si"]
    axis = Axis(path=CABLE, values=np.array([0.8]))
    columns = ("times_s", "amplitudes")
    one = table(kind=kind, options=kind.options(), axes=(axis,), columns=columns)
    assert one.impulses is None
    with refused("impulses_not_counted", "impulses"):
        columns_of(one)
