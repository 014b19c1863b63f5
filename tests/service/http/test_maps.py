"""Maps over HTTP and on the command line."""

from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.conftest import CRANE
from tests.service.cli.commands import shapersmith

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


MOVE: dict[str, Any] = {
    **{key: value for key, value in MAP.items() if key != "y"},
    "move": {"pulse_s": 2.5},
    "x": {"field": "/move/pulse_s", "values": [1.0, 2.0, 3.0]},
}


def test_over_a_pulse_the_held_stop_is_re_timed_and_short_ones_are_null(
    client: httpx.Client,
) -> None:
    body = client.post("/v1/maps", json=MOVE).json()
    assert body["y"] is None
    assert body["residual"][0] is None  # 1 s is shorter than the start
    assert body["residual"][1:] == pytest.approx([0, 0], abs=1e-9)
    mirrored = {**MOVE, "move": {"pulse_s": 2.5, "stop": "mirrored"}}
    mirrored["x"] = {"field": "/move/pulse_s", "values": [2.5]}
    left = client.post("/v1/maps", json=mirrored).json()["residual"]
    assert left == pytest.approx([0.0056], abs=5e-5)  # docs/theory.md
    over_both = {**MOVE, "y": MAP["y"]}
    rows = client.post("/v1/maps", json=over_both).json()["residual"]
    assert [len(row) for row in rows] == [3, 3, 3]
    assert rows[1][1:] == pytest.approx([0, 0], abs=1e-9)
    assert min(rows[0][1:]) > 1e-4


@pytest.mark.parametrize(
    ("quantity", "cell"),
    [
        ("times_s", [0.0, 0.32126352, 0.60069086]),
        ("duration_s", 0.60069086),
        ("branch", [0, 0, 1]),
        ("alpha", 0.9921129437),
        ("beta_rad", -0.0732506641),
    ],
)
def test_each_quantity_has_its_own_name(client: httpx.Client, quantity: str, cell: object) -> None:
    request = {
        **{key: value for key, value in MAP.items() if key != "y"},
        "quantity": quantity,
        "x": {"field": "/plant/cable_length_m", "values": [0.8]},
        "shaper": {"kind": "numzv"},
        "design": "each",
    }
    if quantity in {"alpha", "beta_rad"}:
        del request["shaper"]
    body = client.post("/v1/maps", json=request).json()
    assert body["quantity"] == quantity
    assert body[quantity][0] == pytest.approx(cell, abs=1e-8)
    names = {"residual", "deflection_m", "times_s", "duration_s", "branch", "alpha", "beta_rad"}
    assert all(body[name] is None for name in names - {quantity})
    both = client.post("/v1/maps", json={**request, "y": {**MAP["x"], "points": 2}}).json()
    assert len(both[quantity]) == 2


def test_a_shaper_is_designed_for_one_model_and_judged_by_the_other(client: httpx.Client) -> None:
    switched = {**CRANE["actuator"], "model": "switched"}
    request = {
        **MAP, "actuator": switched, "designed_for": "superposed", "quantity": "deflection_m",
        "speed_m_s": 0.2, "x": {"field": "/plant/cable_length_m", "values": [0.8]},
    }  # fmt: skip
    del request["y"]
    swing = client.post("/v1/maps", json=request).json()["deflection_m"]
    command = {"kind": "step"}
    alone = client.post(
        "/v1/simulations",
        json={
            **{key: CRANE[key] for key in ("plant", "shaper")},
            "actuator": switched, "command": command, "speed_m_s": 0.2,
        },
    ).json()  # fmt: skip
    assert alone["residual"] < 1e-9  # designed for the switched one itself
    unshaped = client.post(
        "/v1/simulations",
        json={
            "plant": CRANE["plant"], "actuator": switched, "command": command, "speed_m_s": 0.2,
        },
    ).json()  # fmt: skip
    assert swing == pytest.approx([0.0074 * unshaped["remaining"]["deflection_m"]], rel=0.01)


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
        ({"x": MOVE["x"]}, "/x/field"),
        ({**MOVE, "x": {"field": "/move/pulse_s", "values": [0, 1]}}, "/x/values"),
        ({**MOVE, "x": {"field": "/move/pulse_s", "from": -1, "to": 1}}, "/x/values"),
        ({**MOVE, "move": {"pulse_s": 0}}, "/move/pulse_s"),
        ({**MOVE, "x": {"field": "/move/stop", "from": 1, "to": 2}}, "/x/field"),
        ({**MOVE, "y": MOVE["x"]}, "/y/field"),
        ({**MOVE, "design": "each", "x": {**MAP["x"], "points": 501}, "y": None}, "/x/points"),
        ({"x": {**MAP["x"], "points": 2000}, "y": {**MAP["y"], "values": [1.0] * 11}}, "/x/points"),
        ({"quantity": "times_s"}, "/design"),
        ({"quantity": "alpha"}, "/shaper"),
        ({"quantity": "branch", "design": "each"}, "/quantity"),
        ({"quantity": "deflection_m"}, "/speed_m_s"),
        ({"impulses": {"times_s": [0], "amplitudes": [1]}}, "/shaper"),
    ],
)
def test_a_faulty_map_is_named(client: httpx.Client, change: dict[str, Any], pointer: str) -> None:
    answer = client.post("/v1/maps", json={**MAP, **change})
    assert answer.status_code == 422
    assert pointer in [fault["pointer"] for fault in answer.json()["errors"]]


@pytest.mark.parametrize(
    ("change", "lines", "last"),
    [
        ({}, 4, 4),
        ({"x": MOVE["x"], "y": None}, 4, 2),
        ({"quantity": "times_s", "design": "each", "move": None, "y": None}, 10, 6),
        ({"quantity": "times_s", "design": "each", "move": None}, 28, 7),
    ],
)
def test_a_table_has_a_row_for_each_value_or_cell(
    change: dict[str, Any], lines: int, last: int
) -> None:
    request = {**MAP, "move": {"pulse_s": 2.5}, "x": {**MAP["x"], "points": 3}, **change}
    if "quantity" in change:
        request["x"] = MAP["x"]
    told = shapersmith("map", "-", "--format", "csv", given=request)
    assert (told.returncode, told.stderr) == (0, "")
    table = told.stdout.splitlines()
    assert (len(table), len(table[-1].split(","))) == (lines, last)


def test_a_map_is_drawn_and_printed(tmp_path: Path) -> None:
    picture = tmp_path / "map.png"
    told = shapersmith("map", "-", "--format", "csv", "--plot", str(picture), given=MAP)
    assert told.returncode == 0
    assert len(told.stdout.splitlines()) == 4
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_whole_move_is_less_robust_than_its_start(client: httpx.Client) -> None:
    # Kim 2011, figs. 3-21 and 3-27: the pulse is part of what an error in frequency costs.
    subject = {key: CRANE[key] for key in ("plant", "actuator")}
    move = client.post(
        "/v1/maneuvers",
        json={**subject, "shaper": {"kind": "numzvd"}, "speed_m_s": 0.2, "pulse_s": 2.5},
    ).json()
    widths = {}
    for part in ("start", "command"):
        curve = client.post("/v1/sensitivity", json={**subject, "impulses": move[part]}).json()
        widths[part] = curve["sensitivity"]["insensitivity"]["width"]
    assert widths["start"] == pytest.approx(0.25866, abs=1e-5)  # docs/theory.md
    assert widths["command"] == pytest.approx(0.20743, abs=1e-5)  # regression
