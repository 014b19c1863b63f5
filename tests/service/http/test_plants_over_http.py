"""Plants of several modes and of a range, over HTTP."""

from typing import Any

import httpx
import pytest

TWO_MODES = {
    "kind": "modes",
    "modes": [{"natural_frequency_rad_s": 3.5}, {"natural_frequency_rad_s": 9.4}],
}
HOIST = {
    "kind": "scheduled",
    "plant": {"kind": "pendulum", "cable_length_m": 1.0},
    "over": "cable_length_m",
    "from": 0.6,
    "to": 1.0,
}


def request(plant: dict[str, Any], shaper: str, **more: Any) -> dict[str, Any]:
    return {"plant": plant, "actuator": {"kind": "ideal"}, "shaper": {"kind": shaper}} | more


@pytest.mark.parametrize("shaper", ["multi_zv", "multi_umzv", "convolved"])
def test_an_answer_tells_of_each_mode_and_of_the_worst(client: httpx.Client, shaper: str) -> None:
    answer = client.post("/v1/designs", json=request(TWO_MODES, shaper))
    assert answer.status_code == 200
    body = answer.json()
    assert [one["natural_frequency_rad_s"] for one in body["modes"]] == [3.5, 9.4]
    assert body["residual"] == max(one["residual"] for one in body["modes"])
    assert [claim.get("mode", 0) for claim in body["certificate"]["claims"]] == [0, 1]
    worst = [
        max(pair)
        for pair in zip(*(one["sensitivity"]["residual"] for one in body["modes"]), strict=True)
    ]
    assert body["sensitivity"]["residual"] == worst
    again = client.post(
        "/v1/sensitivity",
        json={
            "impulses": body["shaper"]["impulses"],
            "plant": TWO_MODES,
            "actuator": {"kind": "ideal"},
        },
    ).json()
    assert again["modes"] == body["modes"]
    assert again["sensitivity"] == body["sensitivity"]


def test_an_answer_about_one_mode_has_neither_modes_nor_range(client: httpx.Client) -> None:
    plant = {"kind": "mode", "natural_frequency_rad_s": 3.5}
    body = client.post("/v1/designs", json=request(plant, "zv")).json()
    assert "modes" not in body
    assert "scheduled" not in body
    assert body["solver"]["lower_bound_s"] is None


def test_a_range_is_told_and_one_too_wide_refused(client: httpx.Client) -> None:
    body = client.post("/v1/designs", json=request(HOIST, "ei")).json()
    told = body["scheduled"]
    assert told["worst_residual"] == pytest.approx(0.05)
    low, high = ((9.80665 / length) ** 0.5 for length in (1.0, 0.6))
    assert told["natural_frequency_rad_s"] == pytest.approx((low + high) / 2)
    assert told["lower_ratio"] == pytest.approx(2 * low / (low + high))
    assert told["upper_ratio"] == pytest.approx(2 * high / (low + high))
    answer = client.post("/v1/designs", json=request(HOIST | {"from": 0.2}, "ei"))
    assert answer.status_code == 422
    assert answer.json()["type"] == "urn:shapersmith:infeasible"
    assert answer.json()["code"] == "range_above_tolerance"


@pytest.mark.parametrize(
    ("changes", "pointer"),
    [
        ({"over": "mass_kg"}, "/plant/over"),
        ({"over": "damping_ratio", "from": 0.1, "to": 0.2}, "/plant/over"),
        ({"to": 0.6}, "/plant/to"),
        ({"from": -1.0}, "/plant/from"),
    ],
)
def test_bad_ranges_are_named(client: httpx.Client, changes: dict[str, Any], pointer: str) -> None:
    answer = client.post("/v1/designs", json=request(HOIST | changes, "ei"))
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == pointer


def test_a_range_of_masses_and_a_curve_over_damping_are_served(client: httpx.Client) -> None:
    plant = {
        "kind": "scheduled",
        "plant": {"kind": "spring_mass", "mass_kg": 1.0, "stiffness_n_m": 100.0},
        "over": "mass_kg",
        "from": 4.0,
        "to": 6.25,
    }
    curve = {"points": 2, "damping": {"from": 0.0, "to": 0.1, "points": 3}}
    body = client.post("/v1/designs", json=request(plant, "ei", sensitivity=curve)).json()
    assert body["scheduled"]["natural_frequency_rad_s"] == pytest.approx(4.5)
    assert body["sensitivity"]["damping"]["damping_ratio"] == [0.0, 0.05, 0.1]
    assert body["sensitivity"]["damping"]["worst"] == max(
        body["sensitivity"]["damping"]["residual"]
    )


def test_tables_and_moves_refuse_what_has_no_single_frequency(client: httpx.Client) -> None:
    design = request(HOIST, "zvd")
    table = {"design": design, "axes": [{"field": "/actuator/dead_time_s", "values": [0.0]}]}
    assert client.post("/v1/tables", json=table).status_code == 422
    move = design | {"speed_m_s": 0.2, "distance_m": 1.0}
    answer = client.post("/v1/maneuvers", json=move)
    assert answer.status_code == 422
    assert answer.json()["code"] == "single_frequency_only"
