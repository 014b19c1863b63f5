"""Between the rows: exact on them, within the bound between them, refused beyond."""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from design.model.plants.pendulum import Pendulum
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.tables.interpolation import Interpolant, interpolant
from design.tables.rows import INFEASIBLE, Column, Rows, TableHead
from tests.designed_tables import CRANE, designed_table
from tests.refusals import refused
from tests.second_route import claims_by_formula
from tests.shaper_table import CRANE as CRANE_PLANT
from tests.shaper_table import THESIS

RANDOM_POINTS = 1_000

AXES = {
    "plant.cable_length_m": np.geomspace(0.3, 1.4, 9).tolist(),
    "plant.damping_ratio": np.linspace(0, 0.1, 5).tolist(),
}

DRIVE_AXES = {
    "plant.natural_frequency_rad_s": np.linspace(2.5, 4.5, 7).tolist(),
    "actuator.accel.natural_frequency_rad_s": np.linspace(18.0, 30.0, 5).tolist(),
    "actuator.decel.damping_ratio": [1.2, 1.5, 1.8],
}

MODE: dict[str, Any] = {
    **CRANE,
    "plant": {"kind": "mode", "natural_frequency_rad_s": 3.5, "damping_ratio": 0.02},
}


LIMITED: dict[str, Any] = {
    **MODE,
    "actuator": {
        "kind": "rate_limited",
        "accel_limit_m_s2": 2.0,
        "decel_limit_m_s2": 3.0,
        "speed_m_s": 0.2,
        "then": CRANE["actuator"],
    },
}

LIMIT_AXES = {
    "plant.natural_frequency_rad_s": np.linspace(2.5, 4.5, 7).tolist(),
    "actuator.accel_limit_m_s2": np.linspace(1.5, 4.0, 6).tolist(),
}


@pytest.fixture(scope="module")
def limited() -> tuple[TableHead, Rows]:
    return designed_table(LIMITED, LIMIT_AXES)


@pytest.fixture(scope="module")
def torn() -> tuple[TableHead, Rows]:
    """Return a table some of whose rows must settle longer than others: two branches."""
    settled = {**LIMITED, "shaper": {"kind": "numzvd", "settle": True}}
    slower = np.linspace(2.0, 2.75, 7).tolist()
    return designed_table(settled, {**LIMIT_AXES, "plant.natural_frequency_rad_s": slower})


@pytest.fixture(scope="module")
def crane() -> tuple[TableHead, Rows]:
    return designed_table(CRANE, AXES)


@pytest.fixture(scope="module")
def drive() -> tuple[TableHead, Rows]:
    return designed_table(MODE, DRIVE_AXES)


def random_points(made: Interpolant) -> np.ndarray[Any, np.dtype[np.float64]]:
    random = np.random.default_rng(11)
    return np.column_stack([random.uniform(axis[0], axis[-1], RANDOM_POINTS) for axis in made.axes])


@pytest.mark.parametrize("which", ["crane", "drive", "limited", "torn"])
def test_the_bound_holds_at_random_points(which: str, request: pytest.FixtureRequest) -> None:
    made = interpolant(*request.getfixturevalue(which))
    residuals = made.residuals(random_points(made))
    known = residuals[~np.isnan(residuals)]
    assert known.max() <= made.residual_bound
    # A bound that is far above all that happens would tell nothing.
    assert known.max() > made.residual_bound / 4
    assert made.residual_bound < {"limited": 0.02, "torn": 0.05}.get(which, 2e-3)
    assert made.closed.any() == (which == "torn")
    assert known.size > RANDOM_POINTS * 0.6


def test_the_residuals_are_those_of_the_formula_term_by_term(
    crane: tuple[TableHead, Rows],
) -> None:
    from design.model.impulses import Impulses

    made = interpolant(*crane)
    points = random_points(made)[:20]
    residuals, times = made.residuals(points), made.times_s(points)
    for (length, damping), residual, row in zip(points, residuals, times, strict=True):
        plant = Pendulum(cable_length_m=length, damping_ratio=damping, gravity_m_s2=9.81)
        impulses = Impulses(times_s=row, amplitudes=made.amplitudes)
        claims = claims_by_formula(impulses, plant.mode, THESIS)
        assert residual == pytest.approx(claims["residual"], rel=1e-9, abs=1e-13)


def test_rows_come_back_as_they_are_in_any_order(crane: tuple[TableHead, Rows]) -> None:
    head, rows = crane
    order = np.random.default_rng(3).permutation(rows.status.size)
    shuffled = Rows(
        first=0,
        fields=rows.fields[order],
        results=rows.results[order],
        status=rows.status[order],
        reasons={},
    )
    made = interpolant(head, shuffled)
    np.testing.assert_allclose(made.times_s(rows.fields), rows.results[:, :5], rtol=1e-15)
    assert made.residual_bound == interpolant(head, rows).residual_bound


def test_between_rows_the_times_are_close_to_a_design_made_there(
    crane: tuple[TableHead, Rows],
) -> None:
    made = interpolant(*crane)
    plant = Pendulum(cable_length_m=0.67, damping_ratio=0.033, gravity_m_s2=9.81)
    exact = design(plant, THESIS, SHAPERS["numzvd"], None).impulses.times_s
    got = made.times_s(np.array([[0.67, 0.033]]))[0]
    # A residual of r takes timing errors of about r / w.
    np.testing.assert_allclose(got, exact, atol=3 * made.residual_bound / 3.5)


def test_a_finer_grid_has_a_bound_as_cubics_have() -> None:
    bounds = []
    for points in (6, 11, 21):
        axes = {"plant.cable_length_m": (9.81 / np.linspace(2.7, 5.6, points) ** 2).tolist()}
        bounds.append(interpolant(*designed_table(CRANE, axes)).residual_bound)
    ratios = [coarse / fine for coarse, fine in pairwise(bounds)]
    # Half the step, a sixteenth of the error, but for the next order on the coarsest.
    assert all(10 < ratio < 32 for ratio in ratios), bounds


def test_next_to_a_row_without_a_design_nothing_is_told(crane: tuple[TableHead, Rows]) -> None:
    head, rows = crane
    results, status = rows.results.copy(), rows.status.copy()
    results[0], status[0] = np.nan, 1
    made = interpolant(
        head, Rows(first=0, fields=rows.fields, results=results, status=status, reasons={0: "none"})
    )
    assert np.isnan(made.times_s(np.array([[0.31, 0.001]]))).all()
    assert not np.isnan(made.times_s(np.array([[1.3, 0.099], [0.3, 0.025]]))).any()
    residuals = made.residuals(random_points(made))
    assert 0 < np.isnan(residuals).sum() < RANDOM_POINTS / 2
    assert np.nanmax(residuals) <= made.residual_bound


def test_between_rows_of_two_branches_nothing_is_told(torn: tuple[TableHead, Rows]) -> None:
    _, rows = torn
    made = interpolant(*torn)
    # Some rows have settled on a longer branch: a jump of more than half a period.
    phases = rows.results[:, 4] * rows.fields[:, 0]
    assert np.ptp(phases) > np.pi
    np.testing.assert_allclose(made.times_s(rows.fields), rows.results[:, :5], rtol=1e-14)
    first, second = (axis.size - 1 for axis in made.axes)
    table = phases.reshape(first + 1, second + 1)
    corners = np.stack([table[a : first + a, b : second + b] for a in range(2) for b in range(2)])
    across = np.ptp(corners, axis=0) > np.pi
    assert across.any()
    assert made.closed[across].all()


def test_beyond_the_table_nothing_is_known(crane: tuple[TableHead, Rows]) -> None:
    made = interpolant(*crane)
    with refused("out_of_range", "plant.cable_length_m", says="between 0.3 and 1.4"):
        made.times_s(np.array([[0.8, 0.05], [1.5, 0.05]]))
    with refused("out_of_range", "plant.damping_ratio"):
        made.times_s(np.array([[0.8, np.nan]]))


def test_a_list_of_designs_is_no_grid(crane: tuple[TableHead, Rows]) -> None:
    head, rows = crane
    part = Rows(
        first=0,
        fields=rows.fields[:-1],
        results=rows.results[:-1],
        status=rows.status[:-1],
        reasons={},
    )
    with refused("not_a_grid", "rows", says="all 45 points of a grid, each once"):
        interpolant(head, part)


def test_what_cannot_be_interpolated_has_a_code_for_why(crane: tuple[TableHead, Rows]) -> None:
    head, rows = crane
    others = tuple(column for column in head.columns if column.kind != "field")
    foreign = tuple(
        replace(column, name=f"other.{column.kind}") if column.kind == "field" else column
        for column in head.columns
    )
    with refused("no_fields", "fields"):
        interpolant(replace(head, columns=others), rows)
    with refused("fields_not_interpolated", "fields"):
        interpolant(replace(head, columns=foreign), rows)
    with refused("no_verified_row", "rows"):
        interpolant(head, replace(rows, status=np.full_like(rows.status, INFEASIBLE)))


def test_several_modes_and_changing_amplitudes_are_not_interpolated() -> None:
    modes = [{"natural_frequency_rad_s": w, "damping_ratio": 0.0} for w in (3.5, 9.4)]
    several = {
        "plant": {"kind": "modes", "modes": modes},
        "actuator": {"kind": "ideal"},
        "shaper": {"kind": "convolved"},
    }
    field = "plant.modes.0.natural_frequency_rad_s"
    with refused("plant_not_interpolated", "plant"):
        interpolant(*designed_table(several, {field: [3.4, 3.5]}))
    # Heights of ZV depend on damping: rows of several dampings have them in columns.
    damped = {**CRANE, "shaper": {"kind": "zv"}}
    head, rows = designed_table(damped, {"plant.damping_ratio": [0.0, 0.1]})
    heights = np.array([
        design(replace(CRANE_PLANT, damping_ratio=z), THESIS, SHAPERS["zv"]).impulses.amplitudes
        for z in (0.0, 0.1)
    ])
    names = [Column(name=f"a{number}", unit="1", kind="result") for number in (1, 2)]
    last = next(place for place, one in enumerate(head.columns) if one.kind == "status")
    columns = (*head.columns[:last], *names, *head.columns[last:])
    with refused("amplitudes_vary", "amplitudes"):
        interpolant(
            replace(head, columns=columns, amplitudes=()),
            replace(rows, results=np.hstack((rows.results, heights))),
        )
