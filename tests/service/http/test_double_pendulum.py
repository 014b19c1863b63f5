"""A load below a hook, over HTTP: as its two modes, and its own fields where something is wrong."""

from typing import Any

import httpx
import pytest

from tests.service.http.changed_request import changed

CRANE = {
    "kind": "double_pendulum",
    "hook_mass_kg": 0.385,
    "load_mass_kg": 0.6,
    "cable_length_mm": 800,
    "load_length_mm": 250,
    "damping_ratio": 0.01,
    "gravity_m_s2": 9.81,
}


def request(shaper: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"plant": CRANE, "actuator": {"kind": "ideal"}, "shaper": shaper} | more


def test_it_is_designed_for_as_its_modes_are(client: httpx.Client) -> None:
    body = client.post("/v1/designs", json=request({"kind": "multi_umzv"})).json()
    told = [one["natural_frequency_rad_s"] for one in body["modes"]]
    assert told == pytest.approx([3.18121, 11.02933], abs=5e-6)
    listed = {
        "kind": "modes",
        "modes": [{"natural_frequency_rad_s": one, "damping_ratio": 0.01} for one in told],
    }
    same = client.post("/v1/designs", json=request({"kind": "multi_umzv"}, plant=listed)).json()
    assert body == same


def test_a_curve_and_a_recommendation_are_of_both_modes(client: httpx.Client) -> None:
    impulses = {"times_s": [0.0, 0.9876], "amplitudes": [0.5, 0.5]}
    curve = {"impulses": impulses, "plant": CRANE, "actuator": {"kind": "ideal"}}
    assert len(client.post("/v1/sensitivity", json=curve).json()["modes"]) == 2
    wanted = {"plant": CRANE, "actuator": {"kind": "ideal"}, "tolerance": 0.05}
    answer = client.post("/v1/recommendations", json=wanted)
    assert answer.status_code == 200
    assert answer.json()["recommended"]["worst_residual"] <= 0.05


@pytest.mark.parametrize(
    ("changes", "pointer", "code"),
    [
        ({"load_mass_kg": 0}, "/plant/load_mass_kg", "out_of_range"),
        ({"load_mass_kg": 1e6}, "/plant/load_mass_kg", "modes_too_far"),
        ({"load_mass_kg": 1e-9, "load_length_mm": 800}, "/plant/load_mass_kg", "modes_too_near"),
        ({"load_length_mm": -1}, "/plant/load_length_mm", "out_of_range"),
        ({"hook_length_m": 1}, "/plant/hook_length_m", "extra_forbidden"),
        (
            {"load_mass_kg": 100, "damping_ratio": 0.3},
            "/plant/damping_ratio",
            "mode_decays_too_fast",
        ),
    ],
)
def test_its_own_fields_are_named(
    client: httpx.Client, changes: dict[str, Any], pointer: str, code: str
) -> None:
    body = request({"kind": "multi_umzv"}, plant=CRANE | changes)
    answer = client.post("/v1/designs", json=body)
    assert answer.status_code == 422
    fault = answer.json()["errors"][0]
    assert (fault["pointer"], fault["code"]) == (pointer, code)


def test_what_serves_one_mode_says_so(client: httpx.Client) -> None:
    answer = client.post("/v1/designs", json=request({"kind": "numzvd"}))
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/plant/kind"
    assert answer.json()["code"] == "kind_of_one_mode"
    move = changed("/plant", CRANE) | {"speed_m_s": 0.2, "distance_m": 1.0}
    answer = client.post("/v1/maneuvers", json=move | {"shaper": {"kind": "multi_umzv"}})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/plant/kind"
    table = {
        "design": request({"kind": "zv"}),
        "axes": [{"field": "/plant/load_length_m", "values": [0.2]}],
    }
    answer = client.post("/v1/tables", json=table)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/design/plant/kind"
