"""A limit to the jerk on the wire, on every route that takes an actuator."""

from typing import Any

import httpx
import pytest

from design.tables.interpolation import interpolant
from tests.conftest import CRANE
from tests.designed_tables import designed_table
from tests.refusals import refused

LIMITED: dict[str, Any] = {
    "kind": "rate_limited",
    "accel_limit_m_s2": 1.0,
    "decel_limit_m_s2": 2.0,
    "speed_m_s": 0.2,
    "jerk_limit_m_s3": 20.0,
}
REQUEST: dict[str, Any] = {**CRANE, "actuator": LIMITED}
AXES = {
    "x": {"field": "/actuator/jerk_limit_m_s3", "from": 5, "to": 40, "points": 3},
    "y": {"field": "/plant/cable_length_m", "from": 0.6, "to": 1, "points": 3},
}


def test_a_design_says_when_its_last_ramp_ends_and_that_none_ends_earlier(
    client: httpx.Client,
) -> None:
    answer = client.post("/v1/designs", json=REQUEST).json()
    assert answer["certificate"]["verified"]
    assert answer["residual"] < 1e-12
    end = answer["shaper"]["ramp_end_s"]
    assert end == pytest.approx(1.5595071, abs=1e-6)
    assert (1 - 1e-8) * end < answer["solver"]["lower_bound_s"] <= end
    there = {"plant": REQUEST["plant"], "impulses": answer["shaper"]["impulses"]}
    curve = client.post("/v1/sensitivity", json={**there, "actuator": LIMITED}).json()
    assert curve["residual"] == pytest.approx(answer["residual"], abs=1e-14)
    unaware = {**LIMITED, "jerk_limit_m_s3": None}
    told = client.post("/v1/sensitivity", json={**there, "actuator": unaware}).json()
    assert told["residual"] > 0.1


@pytest.mark.parametrize(("kind", "proven"), [("num_si", True), ("num_ei", False)])
def test_bands_and_humps_are_served(client: httpx.Client, kind: str, proven: bool) -> None:
    answer = client.post("/v1/designs", json={**REQUEST, "shaper": {"kind": kind}}).json()
    assert answer["certificate"]["verified"]
    assert (answer["solver"].get("lower_bound_s") is not None) is proven
    assert {"jerk"} <= {one["limit"] for one in answer["limits"]["binding"]}


@pytest.mark.parametrize(
    ("route", "more"),
    [
        ("/v1/simulations", {"command": {"kind": "pulse", "pulse_s": 0.3}, "speed_m_s": 0.2}),
        ("/v1/maneuvers", {"distance_m": 0.42, "speed_m_s": 0.2}),
        ("/v1/maneuvers", {"distance_m": -0.01, "speed_m_s": 0.2, "joint": True}),
        ("/v1/maps", AXES),
        ("/v1/designs", {"shaper": {"kind": "numzv", "sample_time_s": 0.01}}),
        ("/v1/designs", {"shaper": {"kind": "convolved", "base": "umzvd"}}),
    ],
)
def test_routes_serve_a_limit_to_the_jerk(
    client: httpx.Client, route: str, more: dict[str, Any]
) -> None:
    answer = client.post(route, json={**REQUEST, **more})
    assert answer.status_code == 200, answer.text


@pytest.mark.parametrize(
    ("route", "more"),
    [
        ("/v1/designs", {"shaper": {"kind": "num_si", "impulses": 5}}),
        ("/v1/designs", {"shaper": {"kind": "num_ei", "settle": True}}),
        ("/v1/designs", {"shaper": {"kind": "numzvd", "settle": True}}),
        (
            "/v1/fits",
            {"fit": {"over": "/plant/cable_length_m", "from": 0.7, "to": 0.9, "degree": 3}},
        ),
        ("/v1/designs", {"actuator": {**LIMITED, "then": CRANE["actuator"]}}),
    ],
)
def test_what_knows_straight_ramps_alone_names_the_jerk(
    client: httpx.Client, route: str, more: dict[str, Any]
) -> None:
    answer = client.post(route, json={**REQUEST, **more})
    assert answer.status_code == 422
    (error,) = answer.json()["errors"]
    assert (error["pointer"], error["code"]) == ("/actuator/jerk_limit_m_s3", "jerk_not_served")


@pytest.mark.parametrize(
    ("jerk", "code"),
    [
        (0, "out_of_range"),
        (-3, "out_of_range"),
        ("1", "wrong_type"),
        (1e-4, "jerk_limit_too_small"),
    ],
)
def test_a_faulty_limit_is_named(client: httpx.Client, jerk: Any, code: str) -> None:
    answer = client.post(
        "/v1/designs", json={**REQUEST, "actuator": {**LIMITED, "jerk_limit_m_s3": jerk}}
    )
    assert answer.status_code == 422
    (error,) = answer.json()["errors"]
    assert (error["pointer"], error["code"]) == ("/actuator/jerk_limit_m_s3", code)


def test_what_serves_the_drive_is_recommended(client: httpx.Client) -> None:
    asked = {
        "plant": CRANE["plant"],
        "actuator": LIMITED,
        "half_width": 0.1,
        "max_duration_s": 2.5,
    }
    body = client.post("/v1/recommendations", json=asked).json()
    assert body["recommended"]["name"] == "num_si"
    assert body["recommended"]["ramp_end_s"] > 0


def test_tables_have_rows_that_are_designs_and_no_interpolant() -> None:
    axes = {"plant.cable_length_m": [0.7, 0.8], "actuator.jerk_limit_m_s3": [10.0, 20.0]}
    head, rows = designed_table(REQUEST, axes)
    with refused("jerk_not_served", "actuator.jerk_limit_m_s3"):
        interpolant(head, rows)
