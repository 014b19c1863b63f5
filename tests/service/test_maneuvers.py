"""Whole moves over HTTP and on the command line."""

import csv
import io
from typing import Any

import httpx
import numpy as np
import pytest

from tests.conftest import CRANE
from tests.service.test_command_line import shapersmith

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
    ],
)
def test_a_faulty_move_is_named(client: httpx.Client, change: dict[str, Any], told: str) -> None:
    answer = client.post("/v1/maneuvers", json={**MOVE, **change})
    assert answer.status_code == 422
    assert told in answer.json()["errors"][0]["pointer"]


def test_a_move_too_short_for_any_shaper_says_so(client: httpx.Client) -> None:
    answer = client.post("/v1/maneuvers", json={**MOVE, "distance_m": 1e-9})
    assert answer.status_code == 422
    assert answer.json()["detail"]
