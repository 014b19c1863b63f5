"""Requests that break a rule on the wire, each with the code of what it breaks."""

import json
from typing import Any

import pytest

from service.dispatch import respond
from service.jobs.plan import plan_table
from service.problems import Problem
from tests.conftest import CRANE

MODE = {"kind": "mode", "natural_frequency_rad_s": 3.5}
TWO = {"kind": "modes", "modes": [{"natural_frequency_rad_s": w} for w in (1.0, 2.7)]}
RANGE = {
    "kind": "scheduled",
    "plant": CRANE["plant"],
    "over": "cable_length_m",
    "from": 0.7,
    "to": 0.9,
}
IDEAL = {"kind": "ideal"}
IMPULSES = {"times_s": [0, 0.9], "amplitudes": [0.5, 0.5]}
AXIS = {"field": "/plant/cable_length_m", "from": 0.5, "to": 1.0}
FIT = {"over": "/plant/cable_length_m", "from": 0.5, "to": 1.0, "degree": 3}
MAP = {**CRANE, "quantity": "residual", "x": AXIS}
TABLE = {"design": CRANE, "axes": [{**AXIS, "points": 4}]}
DAMPED = {"field": "/plant/modes/0/damping_ratio", "values": [0, 0.1]}


def without(request: dict[str, Any], name: str) -> dict[str, Any]:
    return {key: value for key, value in request.items() if key != name}


@pytest.mark.parametrize(
    ("operation", "request_body", "code"),
    [
        ("design", {**CRANE, "fit": without(FIT, "degree")}, "degree_or_residual"),
        ("design", {**CRANE, "fit": {**FIT, "max_residual": 0.01}}, "degree_or_residual"),
        ("design", {**CRANE, "fit": {**FIT, "to": 0.4}}, "range_not_finite"),
        ("design", {**CRANE, "fit": {**FIT, "form": "time_in_frequency"}}, "form_not_served"),
        ("design", {**CRANE, "plant": MODE, "fit": FIT}, "not_a_plant_field"),
        (
            "design",
            {**CRANE, "plant": MODE, "fit": {**FIT, "over": "/plant/modes/0/damping_ratio"}},
            "not_a_number_of_plant",
        ),
        (
            "design",
            {
                **CRANE,
                "actuator": IDEAL,
                "shaper": {"kind": "si", "tolerance": 0.05, "half_width": 0.2},
                "fit": FIT,
            },
            "fit_not_served",
        ),
        (
            "design",
            {
                **CRANE,
                "shaper": {"kind": "zv"},
                "fit": {"over": "/plant/damping_ratio", "from": 0, "to": 0.2, "degree": 3},
            },
            "fitted_amplitudes_depend",
        ),
        ("design", {**CRANE, "plant": {**RANGE, "over": "height_m"}}, "field_not_scheduled"),
        (
            "design",
            {**CRANE, "shaper": {"kind": "numzvd", "sample_time_s": 0.01}, "fit": FIT},
            "kind_not_sampled",
        ),
        (
            "design",
            {**CRANE, "shaper": {"kind": "numzvd", "sample_tolerance": 0.01}},
            "tolerance_without_samples",
        ),
        (
            "design",
            {
                **CRANE,
                "plant": TWO,
                "actuator": IDEAL,
                "shaper": {"kind": "convolved", "base": "umzv", "sample_time_s": 0.01},
            },
            "samples_of_one_mode",
        ),
        (
            "design",
            {**CRANE, "shaper": {"kind": "mzv", "t": 0.75, "tau": 1.0}},
            "duration_said_twice",
        ),
        (
            "map",
            {
                **without(MAP, "shaper"),
                "impulses": IMPULSES,
                "designed_for": "switched",
            },
            "option_beside_impulses",
        ),
        ("map", {**MAP, "impulses": IMPULSES}, "option_beside_impulses"),
        (
            "map",
            {**without(MAP, "shaper"), "impulses": IMPULSES, "design": "each"},
            "design_per_cell_of_impulses",
        ),
        ("map", {**MAP, "x": without(AXIS, "to")}, "range_half_said"),
        ("maneuver", {**CRANE, "speed_m_s": 0.2}, "pulse_or_distance"),
        (
            "maneuver",
            {**CRANE, "speed_m_s": 0.2, "pulse_s": 2.0, "distance_m": 1.0},
            "pulse_or_distance",
        ),
        ("maneuver", {**CRANE, "speed_m_s": 0.0, "pulse_s": 2.0}, "speed_out_of_range"),
        ("maneuver", {**CRANE, "speed_m_s": 0.2, "distance_m": 1e6}, "move_too_long"),
        ("maneuver", {**CRANE, "speed_m_s": 0.2, "pulse_s": 1e7}, "move_too_long"),
        (
            "simulation",
            {
                "plant": CRANE["plant"],
                "actuator": CRANE["actuator"],
                "command": {"kind": "sampled", "sample_time_s": 1e9, "velocity_m_s": [1.0] * 3000},
                "speed_m_s": 1.0,
            },
            "samples_not_served",
        ),
        ("table", {"design": CRANE, "axes": [without(AXIS, "to")]}, "range_incomplete"),
        ("table", {"design": CRANE, "axes": [AXIS]}, "range_incomplete"),
        ("table", {**TABLE, "columns": []}, "no_columns"),
        (
            "table",
            {"design": {**CRANE, "plant": TWO}, "axes": [DAMPED]},
            "kind_of_one_mode_in_table",
        ),
        (
            "table",
            {
                "design": {
                    **CRANE,
                    "plant": TWO,
                    "actuator": IDEAL,
                    "shaper": {"kind": "multi_zv"},
                },
                "axes": [DAMPED],
            },
            "joint_kind_in_table",
        ),
        (
            "table",
            {
                "design": {
                    **CRANE,
                    "plant": TWO,
                    "actuator": IDEAL,
                    "shaper": {"kind": "convolved", "base": "zv"},
                },
                "axes": [DAMPED],
                "columns": ["phases_rad", "amplitudes"],
            },
            "phases_without_frequency",
        ),
        (
            "table",
            {
                "design": {**CRANE, "plant": RANGE},
                "axes": [{"field": "/actuator/accel/damping_ratio", "values": [0.8, 0.9]}],
            },
            "range_in_many_rows",
        ),
    ],
)
def test_a_request_that_breaks_a_rule_is_refused_by_its_code(
    operation: str, request_body: dict[str, Any], code: str
) -> None:
    body = json.dumps(request_body).encode()
    refused = plan_table(body) if operation == "table" else respond(operation, body)
    assert isinstance(refused, Problem)
    assert refused.code == code
    assert [fault.code for fault in refused.errors] == [code]
