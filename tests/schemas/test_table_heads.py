"""What the head of a table's file knows of the design, for every kind of plant and actuator."""

import io
import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from design.export.reading import rows_of
from design.export.registry import EXPORTS
from design.tables.compute import compute_rows
from design.tables.interpolation import interpolant
from design.tables.rows import Rows, TableHead, subject_of
from schemas.tables import TableRequest, with_subject
from service.jobs.plan import head_of, plan_of
from tests.designed_tables import CRANE
from tests.refusals import refused

PLANTS: dict[str, tuple[dict[str, Any], str]] = {
    "mode": (
        {"kind": "mode", "natural_frequency_rad_s": 3.5, "damping_ratio": 0.02},
        "/plant/natural_frequency_rad_s",
    ),
    "modes": (
        {"kind": "modes", "modes": [{"natural_frequency_rad_s": 3.5, "damping_ratio": 0.02}]},
        "/plant/natural_frequency_rad_s",
    ),
    "pendulum": (
        {"kind": "pendulum", "cable_length_m": 3.5, "damping_ratio": 0.02},
        "/plant/cable_length_m",
    ),
    "spring_mass": (
        {"kind": "spring_mass", "mass_kg": 3.5, "stiffness_n_m": 40.0, "damping_ratio": 0.02},
        "/plant/mass_kg",
    ),
}
VALUES = [3.0, 3.3, 3.6, 3.9, 4.2]

ACTUATORS: dict[str, dict[str, Any]] = {
    "ideal": {"kind": "ideal"},
    "first_order": {
        "kind": "first_order",
        "accel_time_constant_s": 0.1,
        "decel_time_constant_s": 0.1,
        "dead_time_s": 0.02,
    },
    "second_order": CRANE["actuator"],
    "rate_limited": {
        "kind": "rate_limited",
        "accel_limit_m_s2": 30.0,
        "decel_limit_m_s2": 50.0,
        "speed_m_s": 0.2,
        "then": CRANE["actuator"],
    },
}


def table_of(plant: str, actuator: str, shaper: dict[str, Any]) -> tuple[TableHead, Rows]:
    given, field = PLANTS[plant]
    request = TableRequest.model_validate({
        "design": {"plant": given, "actuator": ACTUATORS[actuator], "shaper": shaper},
        "axes": [{"field": field, "values": VALUES}],
        "columns": ["times_s", "amplitudes", "residual"],
    })
    job = plan_of(request).job
    return head_of(job, fitted=True), compute_rows(request.to_design(), 0, len(VALUES))


@pytest.mark.parametrize("actuator", ACTUATORS)
@pytest.mark.parametrize("plant", PLANTS)
def test_every_plant_behind_every_actuator_becomes_a_file_of_every_format(
    plant: str, actuator: str
) -> None:
    head, rows = table_of(plant, actuator, {"kind": "zvd"})
    for name, export in EXPORTS.items():
        if name == "marlin":
            with refused("not_marlin_shaper", "shaper.kind"):
                export.checks(head)
            continue
        if name == "klipper" and actuator != "ideal":
            with refused("klipper_knows_no_actuator", "actuator.kind"):
                export.checks(head)
            continue
        export.checks(head)
        assert b"".join(export.write(head, [rows]))


@pytest.mark.parametrize("plant", PLANTS)
def test_a_file_that_was_read_back_interpolates_once_its_subject_is_made_anew(plant: str) -> None:
    head, rows = table_of(plant, "second_order", {"kind": "numzvd"})
    written = b"".join(EXPORTS["csv"].write(head, [rows]))
    read, runs = rows_of("csv", io.BytesIO(written))
    (run,) = runs
    with refused("subject_not_made", "subject"):
        interpolant(read, run)
    made = interpolant(with_subject(read), run)
    np.testing.assert_array_equal(made.phases, interpolant(head, rows).phases)
    points = np.array([[3.1], [3.75]])
    assert (made.residuals(points) <= made.residual_bound).all()
    assert made.residual_bound < 1e-3


def test_a_head_whose_specification_is_none_is_refused_by_its_field() -> None:
    head, _ = table_of("mode", "ideal", {"kind": "zvd"})
    wrong = json.loads(head.specification_json)
    wrong["design"]["plant"]["kind"] = "balloon"
    with refused("unreadable_specification", "specification.design.plant"):
        with_subject(replace(head, specification_json=json.dumps(wrong), subject=None))
    with refused("subject_not_made", "subject"):
        subject_of(replace(head, subject=None))


def test_rows_of_either_sign_are_refused_by_firmware_that_takes_positive_ones() -> None:
    """Some rows positive, some of unity magnitude, in columns of their own."""
    head, rows = table_of("mode", "ideal", {"kind": "zvd"})
    rows.results[2, 3:6] = [1.0, -1.0, 1.0]
    with refused(
        "amplitudes_not_shares", "amplitudes of row 2", says="above 0 and add up to 1 for RepRap"
    ):
        list(EXPORTS["rrf"].write(head, [rows]))
    with refused(
        "amplitudes_not_shares", "amplitudes of row 2", says="above 0 and add up to 1 for Klipper"
    ):
        list(EXPORTS["klipper"].write(head, [rows]))
    # Programs take any row: each has its own amplitudes there.
    assert b"SHAPERSMITH_C(-1.0)" in b"".join(EXPORTS["c"].write(head, [rows]))


def test_negative_impulses_are_refused_before_any_row_where_the_kind_says_so() -> None:
    head, _ = table_of("mode", "ideal", {"kind": "sna_zv"})
    assert head.amplitudes == ()
    with refused("shaper_not_positive", "shaper.kind"):
        EXPORTS["rrf"].checks(head)
