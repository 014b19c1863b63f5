"""Shapers for large swings over HTTP: designs, tables, runs, and refusals where all is linear."""

import json
from typing import Any

import pytest

from schemas.design_request import DesignRequest
from service.operations.design_file import design_file
from tests.conftest import CRANE
from tests.refusals import refused
from tests.service.http.in_process import InProcess

DRIVE = {**CRANE["actuator"], "model": "switched"}
PLANT = {"kind": "pendulum", "cable_length_m": 0.8, "gravity_m_s2": 9.81}
LARGE = {"kind": "num_large", "speed_m_s": 1.5}
DESIGN: dict[str, Any] = {"plant": PLANT, "actuator": DRIVE, "shaper": LARGE}
RUN: dict[str, Any] = {
    "plant": PLANT,
    "actuator": DRIVE,
    "speed_m_s": 1.5,
    "model": "nonlinear",
    "shaping": {"mode": "delay_line", "shaper": LARGE},
    "events": [{"at_s": 0.0, "direction": {"x": 1}}],
    "until_s": 4.0,
    "points": 11,
}


def asked(path: str, body: dict[str, Any]) -> dict[str, Any]:
    answer = InProcess().ask("POST", f"/v1/{path}", body)
    document: dict[str, Any] = answer.json()
    return document


def fault(path: str, body: dict[str, Any]) -> tuple[str, str]:
    (first, *_) = asked(path, body)["errors"]
    return first["pointer"], first["code"]


def test_a_design_says_of_which_swing_it_is() -> None:
    made = asked("designs", {**DESIGN, "sensitivity": {"points": 3}})
    assert made["shaper"]["impulses"]["times_s"][1:] == pytest.approx(
        [0.33822728, 0.63569303], abs=6e-9
    )
    assert made["large_swing"]["speed_m_s"] == 1.5
    assert made["large_swing"]["largest_angle_rad"] == pytest.approx(0.4447, abs=1e-3)
    assert "nonlinear crane at 1.5 m/s" in made["certificate"]["method"]
    # Of the linear plant it would be 0.7347 there.
    assert made["sensitivity"]["residual"][0] == pytest.approx(0.70400, abs=1e-5)
    assert "large_swing" not in asked("designs", CRANE)


def test_a_run_of_the_nonlinear_crane_is_left_at_rest() -> None:
    assert asked("runs", RUN)["residual"] <= 1e-7
    linear = {**RUN, "shaping": {"mode": "delay_line", "shaper": {"kind": "numzv"}}}
    assert asked("runs", linear)["residual"] == pytest.approx(0.0980, abs=2e-3)


def test_a_run_at_another_speed_or_of_the_linear_model_is_refused() -> None:
    assert fault("runs", {**RUN, "speed_m_s": 1.0})[1] == "large_swing_of_other_speed"
    assert fault("runs", {**RUN, "model": "linear"})[1] == "small_swings_only"


@pytest.mark.parametrize(
    ("path", "more"),
    [
        ("designs", {"shaper": {**LARGE, "sample_time_s": 0.01}}),
        ("designs", {"fit": {"over": "/plant/cable_length_m", "from": 0.5, "to": 1, "degree": 2}}),
        ("designs", {"drive": {}}),
        ("fits", {"fit": {"over": "/plant/cable_length_m", "from": 0.5, "to": 1, "degree": 2}}),
        ("maneuvers", {"speed_m_s": 1.5, "distance_m": 5.0}),
        ("simulations", {"speed_m_s": 1.5, "command": {"kind": "pulse", "pulse_s": 2.0}}),
        (
            "maps",
            {
                "quantity": "residual",
                "x": {"field": "/plant/cable_length_m", "from": 0.7, "to": 0.9, "points": 3},
            },
        ),
    ],
)
def test_what_is_computed_of_small_swings_is_refused(path: str, more: dict[str, Any]) -> None:
    assert fault(path, {**DESIGN, **more})[1] == "small_swings_only"


def test_a_program_is_refused_and_a_curve_over_the_damping() -> None:
    request = DesignRequest.model_validate(DESIGN)
    with refused("small_swings_only", "shaper.kind"):
        design_file(request, "c")
    damped = {"points": 3, "damping": {"from": 0.0, "to": 0.1, "points": 3}}
    answer = asked("designs", {**DESIGN, "sensitivity": damped})
    assert "damping_curve_of_large_swing" in json.dumps(answer)


def test_a_batch_serves_it_and_bad_values_name_their_field() -> None:
    for shaper, pointer, code in (
        ({"kind": "num_large"}, "/shaper/speed_m_s", "large_swing_needs_speed"),
        ({"kind": "num_large", "speed_m_s": 1e-4}, "/shaper/speed_m_s", "swing_is_small"),
        ({"kind": "num_large", "speed_m_s": 4}, "/shaper/speed_m_s", "large_swing_over_60_degrees"),
    ):
        document = asked("designs", {**DESIGN, "shaper": shaper})
        assert document["errors"][0]["pointer"] == pointer
        assert code in json.dumps(document)
    mode = {"kind": "mode", "natural_frequency_rad_s": 3.5}
    assert fault("designs", {**DESIGN, "plant": mode}) == (
        "/plant/kind",
        "large_swing_needs_pendulum",
    )
