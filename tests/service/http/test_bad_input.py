"""Nonsense in, a clear problem out."""

import json
from typing import Any

import httpx
import pytest

from tests.conftest import CRANE
from tests.service.http.changed_request import JSON, NATURAL, changed

FAULTS = [
    pytest.param("/plant/cable_length_m", -0.8, "out_of_range", id="negative"),
    pytest.param("/plant/cable_length_m", 0, "out_of_range", id="zero"),
    pytest.param("/plant/cable_length_m", True, "wrong_type", id="boolean"),
    pytest.param("/plant/cable_length_m", "0.8", "wrong_type", id="string"),
    pytest.param("/plant/cable_length_m", None, "wrong_type", id="null"),
    pytest.param("/plant/cable_length_m", [1], "wrong_type", id="list"),
    pytest.param("/plant/damping_ratio", 1, "out_of_range", id="damping-1"),
    pytest.param("/plant/damping_ratio", -1e-9, "out_of_range", id="damping-below-0"),
    pytest.param(NATURAL, float("nan"), "not_finite", id="nan"),
    pytest.param(NATURAL, float("inf"), "not_finite", id="infinity"),
    pytest.param("/actuator/decel/damping_ratio", 9, "out_of_range", id="actuator-damping"),
    pytest.param("/actuator/model", "other", "not_one_of", id="model"),
    pytest.param("/plant/colour", "red", "extra_forbidden", id="unknown-field"),
    pytest.param("/nonsense", 1, "extra_forbidden", id="unknown-top-field"),
    pytest.param("/sensitivity/points", 10**7, "out_of_range", id="points"),
    pytest.param("/sensitivity/points", 1, "out_of_range", id="one-point"),
    pytest.param("/sensitivity/to_ratio", 0.4, "ratios_reversed", id="ratios-reversed"),
    pytest.param("/sensitivity/tolerance", 1, "out_of_range", id="tolerance"),
    pytest.param("/shaper/settle", 1, "wrong_type", id="settle"),
    pytest.param("/shaper/max_duration_periods", 1e9, "out_of_range", id="horizon"),
]


@pytest.mark.parametrize(("pointer", "value", "code"), FAULTS)
def test_a_fault_is_named_by_field_and_code(
    client: httpx.Client, pointer: str, value: Any, code: str
) -> None:
    answer = client.post("/v1/designs", content=json.dumps(changed(pointer, value)), headers=JSON)
    body = answer.json()
    assert (answer.status_code, body["type"]) == (422, "urn:shapersmith:invalid-input")
    assert answer.headers["content-type"] == "application/problem+json"
    assert [fault["pointer"] for fault in body["errors"]] == [pointer]
    assert [body["code"], body["errors"][0]["code"]] == [code, code]
    assert body["request_id"] == answer.headers["x-request-id"]


@pytest.mark.parametrize(
    ("pointer", "value", "code"),
    [
        pytest.param("/plant", {"kind": "bridge"}, "unknown_kind", id="kind-of-plant"),
        pytest.param("/plant", {}, "no_kind", id="no-kind"),
        pytest.param("/actuator", {"kind": "hydraulic"}, "unknown_kind", id="kind-of-actuator"),
        pytest.param("/shaper", {"kind": "magic"}, "unknown_kind", id="kind-of-shaper"),
        pytest.param("/shaper", 3, "wrong_type", id="no-object"),
    ],
)
def test_an_unknown_kind_is_named(
    client: httpx.Client, pointer: str, value: Any, code: str
) -> None:
    answer = client.post("/v1/designs", json=changed(pointer, value))
    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [pointer]
    assert [fault["code"] for fault in answer.json()["errors"]] == [code]


def test_every_fault_of_a_request_is_told_at_once(client: httpx.Client) -> None:
    request = changed("/plant/damping_ratio", 2)
    del request["shaper"]
    faults = client.post("/v1/designs", json=request).json()["errors"]
    told = {fault["pointer"]: fault["code"] for fault in faults}
    assert told == {"/plant/damping_ratio": "out_of_range", "/shaper": "missing"}


def test_an_infeasible_design_says_which_condition_fails(client: httpx.Client) -> None:
    # One lag at the plant's own frequency, so that |G_decel/G_accel| is 2.5 there.
    actuator = {
        "kind": "second_order",
        "accel": {"natural_frequency_rad_s": 1.0, "damping_ratio": 1.25},
        "decel": {"natural_frequency_rad_s": 1000.0, "damping_ratio": 0.5},
    }
    request = {
        "plant": {"kind": "mode", "natural_frequency_rad_s": 1.0},
        "actuator": actuator,
        "shaper": {"kind": "numzv"},
    }
    answer = client.post("/v1/designs", json=request)
    assert (answer.status_code, answer.json()["type"]) == (422, "urn:shapersmith:infeasible")
    assert answer.json()["code"] == "alpha_above_two"
    assert "is 2.5" in answer.json()["detail"]


def test_a_search_without_result_says_how_far_it_went(client: httpx.Client) -> None:
    short = changed("/shaper", {"kind": "numzvd", "max_duration_periods": 0.5})
    answer = client.post("/v1/designs", json=short)
    assert (answer.status_code, answer.json()["type"]) == (422, "urn:shapersmith:infeasible")
    assert answer.json()["code"] == "no_solution_found"
    assert "0.5 periods in 1026 starts" in answer.json()["detail"]


@pytest.mark.parametrize(
    ("fit", "pointer"),
    [
        pytest.param({"from": 1, "to": 2, "degree": 2}, "/fit/over", id="no-field"),
        pytest.param(
            {"over": "/plant/natural_frequency_rad_s", "from": 1, "to": 2, "degree": 2},
            "/fit/over",
            id="not-of-this-plant",
        ),
        pytest.param(
            {"over": "/plant/cable_length_m", "from": 2, "to": 1, "degree": 2},
            "/fit/to",
            id="reversed",
        ),
        pytest.param(
            {"over": "/plant/cable_length_m", "from": 1, "to": 2}, "/fit/degree", id="none"
        ),
        pytest.param(
            {"over": "/plant/cable_length_m", "from": 1, "to": 2, "degree": 21},
            "/fit/degree",
            id="degree",
        ),
        pytest.param(
            {"over": "/plant/cable_length_m", "from": 0, "to": 2, "degree": 2},
            "/fit/from",
            id="from-zero",
        ),
        pytest.param(
            {"over": "/plant/damping_ratio", "from": 0, "to": 1, "degree": 2},
            "/fit/to",
            id="beyond-the-field",
        ),
    ],
)
@pytest.mark.parametrize("path", ["/v1/designs", "/v1/fits"])
def test_a_faulty_fit_is_named(
    client: httpx.Client, path: str, fit: dict[str, Any], pointer: str
) -> None:
    answer = client.post(path, json={**CRANE, "fit": fit})
    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [pointer]


@pytest.mark.parametrize(
    ("impulses", "pointer"),
    [
        pytest.param({"times_s": [0, 1], "amplitudes": [1]}, "/impulses/amplitudes", id="lengths"),
        pytest.param({"times_s": [0, -1], "amplitudes": [1, 1]}, "/impulses/times_s/1", id="back"),
        pytest.param({"times_s": [], "amplitudes": []}, "/impulses/times_s", id="empty"),
        pytest.param({"times_s": [0], "amplitudes": [0]}, "/impulses/amplitudes", id="all-zero"),
    ],
)
def test_faulty_impulses_are_named(
    client: httpx.Client, impulses: dict[str, Any], pointer: str
) -> None:
    request = {"impulses": impulses, "plant": CRANE["plant"], "actuator": CRANE["actuator"]}
    answer = client.post("/v1/sensitivity", json=request)
    assert answer.status_code == 422
    assert pointer in [fault["pointer"] for fault in answer.json()["errors"]]


def test_a_fit_behind_a_real_actuator_is_judged_there(client: httpx.Client) -> None:
    fit = {"over": "/plant/cable_length_m", "from": 0.75, "to": 0.85, "degree": 2}
    request = {**CRANE, "shaper": {"kind": "umzvd"}, "fit": fit}
    body = client.post("/v1/designs", json=request).json()
    # A shaper that knows no actuator leaves much there, however good its fit.
    assert body["fit"]["worst_residual"] >= body["residual"] > 0.02


def test_extremes_within_the_rules_are_finite_or_refused(client: httpx.Client) -> None:
    for amplitude, low, high in ((1e12, 1e-6, 1e6), (1e-12, 0.5, 1.5), (1.0, 1e-6, 1e-5)):
        request = {
            "impulses": {"times_s": [0, 1e-9, 5e4], "amplitudes": [amplitude, 0, amplitude]},
            "plant": CRANE["plant"],
            "actuator": CRANE["actuator"],
            "from_ratio": low,
            "to_ratio": high,
        }
        answer = client.post("/v1/sensitivity", json=request)
        assert answer.status_code == 200
        told = answer.json()
        assert None not in [told["residual"], *told["sensitivity"]["residual"]]


@pytest.mark.parametrize(
    ("then", "pointer"),
    [
        (
            {
                "kind": "first_order",
                "accel_time_constant_s": 0.1,
                "decel_time_constant_s": 1e4,
            },
            "/actuator/then/decel_time_constant_s",
        ),
        (
            {
                "kind": "second_order",
                "accel": {"natural_frequency_rad_s": 1e-3, "damping_ratio": 1},
                "decel": {"natural_frequency_rad_s": 20, "damping_ratio": 1},
            },
            "/actuator/then/accel",
        ),
    ],
)
def test_a_set_behind_limits_is_pointed_at_where_it_is(
    client: httpx.Client, then: dict[str, Any], pointer: str
) -> None:
    limited = {
        "kind": "rate_limited",
        "accel_limit_m_s2": 1.0,
        "decel_limit_m_s2": 1.0,
        "speed_m_s": 0.1,
        "then": then,
    }
    answer = client.post("/v1/designs", json={**CRANE, "actuator": limited})
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [pointer]


@pytest.mark.parametrize(
    ("command", "pointer"),
    [
        (
            {"kind": "impulses", "impulses": {"times_s": [1, 0], "amplitudes": [1, 1]}},
            "/command/impulses/times_s/1",
        ),
        (
            {"kind": "impulses", "impulses": {"times_s": [0, 0], "amplitudes": [1, -1]}},
            "/command/impulses/amplitudes",
        ),
        (
            {"kind": "list", "times_s": [0, 1], "velocity_m_s": [0.1, 1e300]},
            "/command/velocity_m_s/1",
        ),
        (
            {"kind": "list", "times_s": [0, 1e300], "velocity_m_s": [0.1, 1]},
            "/command/times_s/1",
        ),
        (
            {"kind": "list", "times_s": [0, 0], "velocity_m_s": [0.1, 0]},
            "/command/velocity_m_s",
        ),
        (
            {"kind": "sampled", "sample_time_s": 0.1, "velocity_m_s": [1e13]},
            "/command/velocity_m_s/0",
        ),
    ],
)
def test_a_faulty_command_is_named_in_the_request(
    client: httpx.Client, command: dict[str, Any], pointer: str
) -> None:
    request = {"plant": CRANE["plant"], "actuator": CRANE["actuator"], "command": command}
    answer = client.post("/v1/simulations", json=request)
    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [pointer]
