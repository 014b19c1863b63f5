"""Maps over HTTP and on the command line."""

from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.conftest import CRANE
from tests.service.test_command_line import shapersmith

MAP: dict[str, Any] = {
    **CRANE,
    "x": {"field": "/actuator/accel/natural_frequency_rad_s", "from": 10, "to": 60, "points": 9},
    "y": {"field": "/plant/cable_length_m", "values": [0.7, 0.8, 0.9]},
}


def test_a_map_has_a_row_for_each_value_of_y(client: httpx.Client) -> None:
    body = client.post("/v1/maps", json=MAP).json()
    assert len(body["residual"]) == 3
    assert all(len(row) == 9 for row in body["residual"])
    assert body["x"]["values"][0] == 10
    # Nominal: 20 rad/s is no point of the axis, so nothing is zero, and the best is near it.
    best = min(range(9), key=lambda column: body["residual"][1][column])
    assert body["x"]["values"][best] == pytest.approx(20, abs=5)


def test_held_impulses_and_geometric_spacing_are_served(client: httpx.Client) -> None:
    request = {key: value for key, value in MAP.items() if key != "shaper"}
    request["impulses"] = {"times_s": [0, 0.9], "amplitudes": [0.5, 0.5]}
    request["x"] = {**MAP["x"], "spacing": "geometric"}
    body = client.post("/v1/maps", json=request).json()
    ratios = [b / a for a, b in zip(body["x"]["values"], body["x"]["values"][1:], strict=False)]
    assert ratios == pytest.approx([6 ** (1 / 8)] * 8)


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"x": {"field": "/plant/mass_kg", "from": 1, "to": 2}}, "/x/field"),
        ({"x": {"field": "/shaper/settle", "from": 1, "to": 2}}, "/x/field"),
        ({"x": {"field": "/plant/damping_ratio"}}, "/x/from"),
        ({"x": {"field": "/plant/damping_ratio", "from": 0.2, "to": 0.1}}, "/x/to"),
        ({"x": {"field": "/plant/damping_ratio", "from": 0, "to": 2}}, "/x/values"),
        ({"x": MAP["y"]}, "/y/field"),
        ({"shaper": None}, "/shaper"),
        ({"x": {**MAP["x"], "points": 10**7}}, "/x/points"),
    ],
)
def test_a_faulty_map_is_named(client: httpx.Client, change: dict[str, Any], pointer: str) -> None:
    answer = client.post("/v1/maps", json={**MAP, **change})
    assert answer.status_code == 422
    assert pointer in [fault["pointer"] for fault in answer.json()["errors"]]


def test_a_map_is_drawn_and_printed(tmp_path: Path) -> None:
    picture = tmp_path / "map.png"
    told = shapersmith("map", "-", "--format", "csv", "--plot", str(picture), given=MAP)
    assert told.returncode == 0
    assert len(told.stdout.splitlines()) == 4
    assert picture.read_bytes().startswith(b"\x89PNG")
