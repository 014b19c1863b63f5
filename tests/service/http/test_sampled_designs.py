"""Shapers on a controller's samples, over HTTP."""

from typing import Any

import httpx
import pytest

from tests.conftest import CRANE

FIT = {"over": "/plant/cable_length_m", "from": 1, "to": 2, "degree": 2}
AXES = {
    "x": {"field": "/plant/cable_length_m", "values": [0.8, 0.9]},
    "y": {"field": "/plant/damping_ratio", "values": [0.0, 0.05]},
}
PRINTER = {
    "plant": {
        "kind": "mode",
        "natural_frequency_rad_s": 45.867252742410976,  # 7.3 Hz
        "damping_ratio": 0.05,
    },
    "actuator": {"kind": "ideal"},
}


def with_sample_time(sample_time_s: Any) -> dict[str, Any]:
    return {**CRANE, "shaper": {"kind": "numzvd", "sample_time_s": sample_time_s}}


def test_a_sampled_design_tells_what_it_leaves_and_proves_that(client: httpx.Client) -> None:
    plain = client.post("/v1/designs", json=CRANE).json()
    body = client.post("/v1/designs", json=with_sample_time(0.01)).json()
    times = body["shaper"]["impulses"]["times_s"]
    assert times == pytest.approx([0.01 * sample for sample in body["sampled"]["samples"]])
    assert 1e-4 < body["residual"] < 0.01
    (claim,) = body["certificate"]["claims"]
    assert claim["value"] == pytest.approx(body["residual"], rel=1e-6)
    assert body["certificate"]["verified"] is True
    assert body["sampled"]["method"] == "unity_on_grid"
    assert body["sampled"]["continuous_times_s"] == plain["shaper"]["impulses"]["times_s"]
    assert body["sampled"]["continuous_residual"] == plain["residual"]
    assert plain["sampled"] is None
    nominal = body["sensitivity"]["residual"][100]
    assert nominal == pytest.approx(body["residual"], rel=1e-9)


def test_a_finer_grid_leaves_less(client: httpx.Client) -> None:
    left = [
        client.post("/v1/designs", json=with_sample_time(step)).json()["residual"]
        for step in (0.02, 0.005, 0.0005)
    ]
    assert left == sorted(left, reverse=True)


@pytest.mark.parametrize("sample_time", [0, -0.01, 5.0, "0.01"])
def test_a_faulty_sample_time_is_named(client: httpx.Client, sample_time: Any) -> None:
    answer = client.post("/v1/designs", json=with_sample_time(sample_time))
    assert answer.status_code == 422
    assert [one["pointer"] for one in answer.json()["errors"]] == ["/shaper/sample_time_s"]


@pytest.mark.parametrize(
    ("path", "extra"),
    [
        ("/v1/fits", {"fit": FIT}),
        ("/v1/designs", {"fit": FIT}),
        ("/v1/maneuvers", {"speed_m_s": 0.2, "distance_m": 0.4}),
        ("/v1/maps", {**AXES, "design": "each"}),
    ],
)
def test_where_no_grid_is_served_it_is_refused(
    client: httpx.Client, path: str, extra: dict[str, Any]
) -> None:
    answer = client.post(path, json={**with_sample_time(0.01), **extra})
    assert answer.status_code == 422
    (error,) = answer.json()["errors"]
    assert error["pointer"] == "/shaper/sample_time_s"
    assert error["code"] == "kind_not_sampled"


def test_a_simulation_plays_the_sampled_shaper(client: httpx.Client) -> None:
    request = {**with_sample_time(0.01), "command": {"kind": "step"}, "points": 101}
    played = client.post("/v1/simulations", json=request).json()
    design = client.post("/v1/designs", json=with_sample_time(0.01)).json()
    assert played["impulses"] == design["shaper"]["impulses"]
    assert played["residual"] == pytest.approx(design["residual"], rel=1e-9)


def test_impulses_are_added_until_unity_magnitude_leaves_less_than_the_split(
    client: httpx.Client,
) -> None:
    shaper = {"kind": "umzv", "sample_time_s": 0.01, "sample_tolerance": 0.0024}
    request: dict[str, Any] = {**PRINTER, "shaper": shaper}
    body = client.post("/v1/designs", json=request).json()
    told = body["sampled"]
    assert told["method"] == "search_on_off"
    left = told["tried"][-1]["compared"]
    assert told["search"]["bound"] == pytest.approx(left, rel=1e-9)
    assert (told["search"]["searched_samples"], told["search"]["complete"]) == (18, True)
    assert body["shaper"]["impulses"]["amplitudes"] == [1, -1, 1, -1, 1, -1, 1]
    assert [one["impulses"] for one in told["tried"]] == [3, 7]
    assert body["residual"] == told["tried"][-1]["residual"] < 0.0025
    assert told["split_residual"] == pytest.approx(0.0224, abs=5e-5)
    assert told["nearest_residual"] == pytest.approx(0.336, abs=5e-4)
    assert told["carried_residual"] == pytest.approx(0.336, abs=5e-4)
    assert body["certificate"]["verified"] is True
    request["shaper"]["sample_tolerance"] = 0.2
    kept = client.post("/v1/designs", json=request).json()
    assert kept["sampled"]["samples"] == [0, 3, 5]
    assert kept["sampled"]["search"] is None
    # Where none is within the tolerance, the warning has what is proven of all.
    request["shaper"] = {**shaper, "kind": "numzv", "sample_time_s": 0.02}
    request["shaper"] |= {"max_duration_periods": 1, "sample_tolerance": 0.001}
    warned = client.post("/v1/designs", json=request).json()
    [told] = [one for one in warned["warnings"] if one["code"] == "tolerance_not_kept"]
    least = 100 * warned["sampled"]["search"]["bound"]
    assert (
        f"proven: no command of unity magnitude of up to 6 samples has less than {least:.4g} %"
        in told["detail"]
    )


def test_with_settle_no_impulses_are_added(client: httpx.Client) -> None:
    shaper = {"kind": "numzv", "sample_time_s": 0.1, "settle": True}
    body = client.post("/v1/designs", json={**CRANE, "shaper": shaper}).json()
    assert body["residual"] > 0.01
    assert len(body["sampled"]["tried"]) == 1


def test_warnings_are_of_the_impulses_on_the_samples(client: httpx.Client) -> None:
    shaper = {"kind": "numzvd", "sample_time_s": 0.08}
    plain = client.post("/v1/designs", json=CRANE).json()
    kept = {**CRANE, "shaper": {**shaper, "sample_tolerance": 1}}
    # Between the samples, and on their own ones, all settle; but .08 s is less than .11 s.
    numzv = {**CRANE, "shaper": {**shaper, "kind": "numzv"}}
    assert plain["warnings"] == client.post("/v1/designs", json=kept).json()["warnings"] == []
    warned = client.post("/v1/designs", json=numzv).json()["warnings"]
    assert [one["code"] for one in warned] == ["actuator_not_settled", "longer_on_samples"]
    assert "3 impulses have " in warned[1]["detail"]


def test_a_tolerance_without_a_sample_time_is_refused(client: httpx.Client) -> None:
    shaper = {"kind": "umzv", "sample_tolerance": 0.1}
    answer = client.post("/v1/designs", json={**PRINTER, "shaper": shaper})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/shaper/sample_tolerance"


def test_a_map_holds_the_impulses_on_the_samples(client: httpx.Client) -> None:
    request = with_sample_time(0.01)
    design = client.post("/v1/designs", json=request).json()
    mapped = client.post("/v1/maps", json={**request, **AXES}).json()
    assert mapped["residual"][0][0] == pytest.approx(design["residual"], rel=1e-9)


@pytest.mark.parametrize("shaper", [{"kind": "convolved"}, {"kind": "multi_zv"}])
def test_several_modes_are_shaped_on_samples(client: httpx.Client, shaper: dict[str, Any]) -> None:
    modes = [
        {"natural_frequency_rad_s": 2.513274122871834, "damping_ratio": 0.02},  # .4 Hz
        {"natural_frequency_rad_s": 8.168140899333462, "damping_ratio": 0.015},  # 1.3 Hz
    ]
    request = {
        "plant": {"kind": "modes", "modes": modes},
        "actuator": {"kind": "ideal"},
        "shaper": {**shaper, "sample_time_s": 0.1},
    }
    body = client.post("/v1/designs", json=request).json()
    assert body["sampled"]["method"] == "free_amplitudes"
    assert [claim["value"] < 1e-12 for claim in body["certificate"]["claims"]] == [True, True]
    assert body["sampled"]["samples"][-1] <= 18
    (narrower,) = body["warnings"]  # the zeros are kept, the width around them is not
    assert narrower["code"] == "narrower_on_samples"
    assert "in mode 1 is within 5 %" in narrower["detail"]


def test_a_range_is_kept_on_samples(client: httpx.Client) -> None:
    plant = {
        "kind": "scheduled",
        "plant": {"kind": "pendulum", "cable_length_m": 1.0},
        "over": "cable_length_m",
        "from": 0.7,
        "to": 1.0,
    }
    for shaper in ({"kind": "si"}, {"kind": "si", "amplitudes": "negative"}):
        request = {
            "plant": plant,
            "actuator": {"kind": "ideal"},
            "shaper": {**shaper, "sample_time_s": 0.05},
        }
        body = client.post("/v1/designs", json=request).json()
        over_range = body["certificate"]["claims"][-1]
        assert over_range["value"] <= 0.05
        assert body["sampled"]["bound"] == pytest.approx(over_range["value"], rel=1e-4)
        assert body["sampled"]["shorter_bound"] > 0.05
    unity = client.post(
        "/v1/designs", json={**request, "shaper": {"kind": "umzv", "sample_time_s": 0.05}}
    )
    assert unity.json()["sampled"]["method"] in ("unity_on_grid", "search_on_off")


@pytest.mark.parametrize(
    ("sample_time_s", "code"), [(0.07, "sample_time_too_long"), (1e-9, "sample_time_too_short")]
)
def test_a_sample_time_is_between_a_millionth_of_the_shaper_and_half_the_period(
    client: httpx.Client, sample_time_s: float, code: str
) -> None:
    shaper = {"kind": "zvd", "sample_time_s": sample_time_s}
    answer = client.post("/v1/designs", json={**PRINTER, "shaper": shaper})
    (error,) = answer.json()["errors"]
    assert (error["pointer"], error["code"]) == ("/shaper/sample_time_s", code)
