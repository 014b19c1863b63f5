"""Whole moves over HTTP and on the command line."""

import csv
import io
from typing import Any

import httpx
import numpy as np
import pytest

from tests.conftest import CRANE
from tests.service.cli.commands import shapersmith

MOVE: dict[str, Any] = {**CRANE, "speed_m_s": 0.2, "distance_m": 0.42}


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize("distance", [0.42, -0.42, 0.05])
def test_a_move_meets_its_distance_and_leaves_nothing(
    client: httpx.Client, model: str, distance: float
) -> None:
    actuator = {**CRANE["actuator"], "model": model}
    body = client.post(
        "/v1/maneuvers", json={**MOVE, "actuator": actuator, "distance_m": distance}
    ).json()
    assert body["distance_m"] == pytest.approx(distance, abs=1e-9)
    assert body["residual"] <= 1e-9
    assert body["certificate"]["verified"] is True
    assert body["direction"] == np.sign(distance)
    assert body["joint"] is (abs(distance) < 0.1)
    levels = np.cumsum(body["command"]["amplitudes"])
    assert np.all((levels >= 0) & (levels <= 1))
    assert levels[-1] == 0


def test_the_simulated_move_stands_still_where_it_should(client: httpx.Client) -> None:
    move = client.post("/v1/maneuvers", json=MOVE).json()
    played = client.post(
        "/v1/simulations",
        json={
            "plant": CRANE["plant"],
            "actuator": CRANE["actuator"],
            "speed_m_s": 0.2,
            "command": {"kind": "impulses", "impulses": move["command"]},
            "points": 20001,
        },
    ).json()
    travelled = np.trapezoid(played["velocity_m_s"], played["times_s"])
    assert travelled == pytest.approx(0.42, abs=1e-6)  # the trapezoidal rule's own error
    assert abs(played["deflection_m"][-1]) < 1e-9


def test_the_program_replays_the_command(client: httpx.Client) -> None:
    program = client.post("/v1/maneuvers", json={**MOVE, "sample_time_s": 0.01}).json()["program"]
    steps = np.diff(program["position_m"])
    assert steps == pytest.approx(0.01 * np.array(program["velocity_m_s"][:-1]), abs=1e-15)
    assert program["position_m"][0] == 0
    assert program["velocity_m_s"][-1] == 0
    told = shapersmith("maneuver", "-", "--format", "csv", given={**MOVE, "sample_time_s": 0.01})
    rows = list(csv.DictReader(io.StringIO(told.stdout)))
    assert [float(row["position_m"]) for row in rows] == program["position_m"]


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"distance_m": None, "pulse_s": 0}, "pulse_s"),
        ({"distance_m": 0}, "distance_m"),
        ({"pulse_s": 1.0}, "pulse_s"),
        ({"distance_m": None}, "pulse_s"),
        ({"speed_m_s": 0}, "speed_m_s"),
        ({"sample_time_s": 100.0}, "sample_time_s"),
        ({"sample_time_s": 1e-9}, "sample_time_s"),
        ({"initial": {"deflection_m": 0.01, "deflection_rate_m_s": 0.0}}, "initial"),
        ({"initial": {"angle_rad": 0.01}}, "initial"),
    ],
)
def test_a_faulty_move_is_named(client: httpx.Client, change: dict[str, Any], told: str) -> None:
    answer = client.post("/v1/maneuvers", json={**MOVE, **change})
    assert answer.status_code == 422
    assert told in answer.json()["errors"][0]["pointer"]


def test_a_move_too_short_for_any_shaper_says_so(client: httpx.Client) -> None:
    answer = client.post("/v1/maneuvers", json={**MOVE, "distance_m": 1e-9})
    assert answer.status_code == 422
    assert answer.json()["type"] == "urn:shapersmith:infeasible"


@pytest.mark.parametrize("distance", [0.42, -0.42])
def test_a_swing_at_the_first_step_is_cancelled(client: httpx.Client, distance: float) -> None:
    initial = {"angle_rad": 0.02, "angle_rate_rad_s": 0.03}
    body = client.post(
        "/v1/maneuvers", json={**MOVE, "distance_m": distance, "initial": initial}
    ).json()
    assert body["residual"] <= 1e-9
    assert body["certificate"]["verified"] is True
    # Its own simulation from rest, the free swing added: still, in radians.
    played = client.post(
        "/v1/simulations",
        json={
            "plant": CRANE["plant"],
            "actuator": CRANE["actuator"],
            "speed_m_s": 0.2,
            "command": {"kind": "impulses", "impulses": body["command"]},
            "points": 2001,
        },
    ).json()
    w, times = np.sqrt(9.81 / 0.8), np.array(played["times_s"])
    free = 0.02 * np.cos(w * times) + 0.03 / w * np.sin(w * times)
    after = times > body["command"]["times_s"][-1] + 2.0  # the actuator has settled to 1e-13
    moved = body["direction"] * np.array(played["angle_rad"])
    assert np.abs((moved + free)[after]).max() < 1e-9


def test_a_move_on_request_as_one_is_faster(client: httpx.Client) -> None:
    apart, one = (
        client.post("/v1/maneuvers", json={**MOVE, "joint": joint}).json()
        for joint in (False, True)
    )
    assert one["joint"] is True
    assert one["duration_s"] < apart["duration_s"]


def test_a_peak_velocity_is_taken(client: httpx.Client) -> None:
    shaper = {"kind": "numzv", "max_velocity_ratio": 1.25}
    body = client.post("/v1/maneuvers", json={**MOVE, "distance_m": 0.8, "shaper": shaper}).json()
    assert body["command"]["amplitudes"] == [1.25, -1.25, 1.0, -1.0, 1.25, -1.25]


def test_a_swing_beyond_reach_says_how_large_it_is(client: httpx.Client) -> None:
    initial = {"angle_rad": 0.6, "angle_rate_rad_s": 0.0}
    answer = client.post(
        "/v1/maneuvers", json={**MOVE, "shaper": {"kind": "numzv"}, "initial": initial}
    )
    assert answer.status_code == 422
    assert answer.json()["type"] == "urn:shapersmith:infeasible"
    assert answer.json()["code"] == "swing_not_cancelled"
