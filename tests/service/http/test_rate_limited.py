"""Limits to acceleration on the wire, on every route that takes an actuator."""

import cmath
from typing import Any

import httpx
import pytest

from tests.conftest import CRANE

LIMITED: dict[str, Any] = {
    "kind": "rate_limited",
    "accel_limit_m_s2": 30.0,
    "decel_limit_m_s2": 5e4,
    "speed_m_s": 0.2,
    "then": CRANE["actuator"],
}
REQUEST: dict[str, Any] = {**CRANE, "actuator": LIMITED}


def test_a_design_knows_the_ramps(client: httpx.Client) -> None:
    answer = client.post("/v1/designs", json=REQUEST).json()
    assert answer["certificate"]["verified"]
    impulses = answer["shaper"]["impulses"]
    there = {"plant": REQUEST["plant"], "impulses": impulses}
    assert client.post("/v1/sensitivity", json={**there, "actuator": LIMITED}).json()[
        "residual"
    ] == pytest.approx(answer["residual"], abs=1e-14)
    # 6.7 ms of ramp are a third of a percent of the swing.
    unaware = client.post("/v1/sensitivity", json={**there, "actuator": CRANE["actuator"]}).json()
    assert 1e-4 < unaware["residual"] < 0.05


def test_an_answer_says_when_the_last_ramp_ends_and_that_none_ends_earlier(
    client: httpx.Client,
) -> None:
    drive = {
        "kind": "rate_limited",
        "accel_limit_m_s2": 1.6,
        "decel_limit_m_s2": 2.5,
        "speed_m_s": 0.4,
    }
    plant = {"kind": "mode", "natural_frequency_rad_s": 3.5, "damping_ratio": 0.01}
    request = {"plant": plant, "actuator": drive, "shaper": {"kind": "numzvd"}}
    answer = client.post("/v1/designs", json=request).json()
    shaper, solver = answer["shaper"], answer["solver"]
    assert shaper["ramp_end_s"] == pytest.approx(1.5472535, abs=1e-7)
    assert shaper["duration_s"] == pytest.approx(1.3302373, abs=1e-7)
    assert 0.999 * shaper["ramp_end_s"] < solver["lower_bound_s"] <= shaper["ramp_end_s"]
    turn = 3.5 * 0.25 * complex(-0.01, (1 - 1e-4) ** 0.5)
    alone = abs((cmath.exp(turn) - 1) / turn)  # at the end of the ramp
    assert answer["unshaped_ramp_residual"] == pytest.approx(alone, rel=1e-12)
    without = client.post("/v1/designs", json=CRANE).json()
    assert "ramp_end_s" not in without["shaper"]
    assert "unshaped_ramp_residual" not in without


def test_a_short_move_is_served_with_its_bound(client: httpx.Client) -> None:
    request = {
        "plant": {"kind": "pendulum", "cable_length_m": 12},
        "actuator": {
            "kind": "rate_limited",
            "accel_limit_m_s2": 0.2,
            "decel_limit_m_s2": 0.2,
            "speed_m_s": 0.5,
        },
        "shaper": {"kind": "numzv"},
        "speed_m_s": 0.5,
        "distance_m": -0.3,
    }
    answer = client.post("/v1/maneuvers", json=request).json()
    assert answer["joint"]
    assert answer["distance_m"] == pytest.approx(-0.3, abs=1e-9)
    assert answer["residual"] < 1e-9
    assert 0.999 * answer["ramp_end_s"] < answer["lower_bound_s"] <= answer["ramp_end_s"]


@pytest.mark.parametrize(
    ("route", "more"),
    [
        ("/v1/simulations", {"command": {"kind": "step"}, "speed_m_s": 0.2}),
        ("/v1/maneuvers", {"distance_m": 0.42, "speed_m_s": 0.2}),
        (
            "/v1/fits",
            {"fit": {"over": "/plant/cable_length_m", "from": 0.7, "to": 0.9, "degree": 3}},
        ),
        (
            "/v1/maps",
            {
                "x": {"field": "/actuator/accel_limit_m_s2", "from": 5, "to": 40, "points": 5},
                "y": {"field": "/plant/cable_length_m", "from": 0.6, "to": 1, "points": 5},
            },
        ),
    ],
)
def test_every_route_serves_limits(client: httpx.Client, route: str, more: dict[str, Any]) -> None:
    answer = client.post(route, json={**REQUEST, **more})
    assert answer.status_code == 200, answer.text


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"accel_limit_m_s2": 0}, "/actuator/accel_limit_m_s2"),
        ({"decel_limit_m_s2": -1}, "/actuator/decel_limit_m_s2"),
        ({"speed_m_s": None}, "/actuator/speed_m_s"),
        ({"then": LIMITED}, "/actuator/then"),
        ({"then": {**CRANE["actuator"], "dead_time_s": 1}}, "/actuator/then/dead_time_s"),
        ({"accel_limit_m_s2": 1e-3}, "/actuator/accel_limit_m_s2"),
    ],
)
def test_faulty_limits_are_named(
    client: httpx.Client, change: dict[str, Any], pointer: str
) -> None:
    answer = client.post("/v1/designs", json={**REQUEST, "actuator": {**LIMITED, **change}})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"].startswith(pointer)


def test_a_move_at_another_speed_names_its_speed(client: httpx.Client) -> None:
    answer = client.post("/v1/maneuvers", json={**REQUEST, "distance_m": 1.0, "speed_m_s": 0.3})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/speed_m_s"
