"""Simulations over HTTP."""

from typing import Any

import httpx
import pytest

from tests.conftest import CRANE

BASE: dict[str, Any] = {"plant": CRANE["plant"], "actuator": CRANE["actuator"], "speed_m_s": 0.2}


def test_a_shaped_step_leaves_nothing_and_a_plain_one_all(client: httpx.Client) -> None:
    plain = client.post("/v1/simulations", json={**BASE, "command": {"kind": "step"}}).json()
    shaped = client.post(
        "/v1/simulations",
        json={**BASE, "command": {"kind": "step"}, "shaper": {"kind": "numzvd"}},
    ).json()
    assert plain["residual"] == pytest.approx(1.0)
    assert shaped["residual"] < 1e-12
    assert shaped["impulses"]["amplitudes"] == [1, -1, 1, -1, 1]
    assert len(shaped["times_s"]) == len(shaped["deflection_m"]) == 1001
    assert abs(shaped["angle_rad"][-1]) < 1e-9
    assert plain["remaining"]["angle_rad"] == pytest.approx(plain["peaks"]["angle_rad"], rel=0.05)


def test_the_same_command_in_any_form_gives_the_same_motion(client: httpx.Client) -> None:
    forms: list[dict[str, Any]] = [
        {"kind": "pulse", "pulse_s": 1.0},
        {"kind": "impulses", "impulses": {"times_s": [0, 1.0], "amplitudes": [1, -1]}},
        {"kind": "list", "times_s": [0, 1.0], "velocity_m_s": [0.2, 0]},
        {"kind": "sampled", "sample_time_s": 0.5, "velocity_m_s": [0.2, 0.2, 0]},
    ]
    answers = [
        client.post("/v1/simulations", json={**BASE, "command": form, "until_s": 4.0}).json()
        for form in forms
    ]
    for answer in answers[1:]:
        assert answer["deflection_m"] == pytest.approx(answers[0]["deflection_m"], abs=1e-14)


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"command": {"kind": "pulse", "pulse_s": 0}}, "/command/pulse_s"),
        (
            {"command": {"kind": "list", "times_s": [0, 2, 1], "velocity_m_s": [1, 2, 0]}},
            "/command/times_s/2",
        ),
        (
            {"command": {"kind": "sampled", "sample_time_s": 1e12, "velocity_m_s": [1, 2, 1]}},
            "/command/sample_time_s",
        ),
        ({"command": {"kind": "dance"}}, "/command"),
        ({"speed_m_s": 0}, "/speed_m_s"),
        ({"actuator": {**CRANE["actuator"], "dead_time_s": -0.1}}, "/actuator/dead_time_s"),
        ({"points": 10**6}, "/points"),
    ],
)
def test_a_faulty_simulation_is_named(
    client: httpx.Client, change: dict[str, Any], pointer: str
) -> None:
    answer = client.post("/v1/simulations", json={**BASE, "command": {"kind": "step"}, **change})
    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [pointer]


def test_a_shaped_pulse_warns_that_its_stop_is_not_designed(client: httpx.Client) -> None:
    request = {**BASE, "command": {"kind": "pulse", "pulse_s": 1.5}, "shaper": {"kind": "numzv"}}
    answer = client.post("/v1/simulations", json=request).json()
    (warning,) = answer["warnings"]
    assert warning["code"] == "stop_not_designed"
    assert f"{100 * answer['residual']:.4g} %" in warning["detail"]


@pytest.mark.parametrize("route", ["simulations", "sensitivity", "maps"])
def test_amplitudes_that_add_up_to_neither_one_nor_nothing_have_a_warning(
    client: httpx.Client, route: str
) -> None:
    impulses = {"times_s": [0, 0.9], "amplitudes": [0.3, 0.3]}
    about: dict[str, Any] = {"plant": CRANE["plant"], "actuator": {"kind": "ideal"}}
    body: dict[str, dict[str, Any]] = {
        "simulations": {**about, "command": {"kind": "impulses", "impulses": impulses}},
        "sensitivity": {**about, "impulses": impulses},
        "maps": {
            **about,
            "impulses": impulses,
            "x": {"field": "/plant/cable_length_m", "values": [0.7, 0.8]},
        },
    }
    answer = client.post(f"/v1/{route}", json=body[route]).json()
    assert [one["code"] for one in answer["warnings"]] == ["sum_not_one"]
    assert "0.6" in answer["warnings"][0]["detail"]


@pytest.mark.parametrize(
    ("kind", "code"), [("zvd", "actuator_ignored"), ("numzv", "tolerance_not_kept")]
)
def test_a_shaper_on_samples_that_leaves_more_than_it_claims_has_a_warning(
    client: httpx.Client, kind: str, code: str
) -> None:
    limited = {
        "kind": "rate_limited",
        "accel_limit_m_s2": 0.5,
        "decel_limit_m_s2": 0.8,
        "speed_m_s": 0.2,
    }
    request = {
        **BASE,
        "actuator": limited if kind == "zvd" else BASE["actuator"],
        "command": {"kind": "step"},
        "shaper": {"kind": kind, "sample_time_s": 0.2, "sample_tolerance": 1e-5},
    }
    answer = client.post("/v1/simulations", json=request).json()
    assert answer["residual"] > 1e-5
    assert [one["code"] for one in answer["warnings"]] == [code]
    assert f"{100 * answer['residual']:.4g} %" in answer["warnings"][0]["detail"]
