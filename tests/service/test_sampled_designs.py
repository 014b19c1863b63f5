"""Shapers on a controller's samples, over HTTP."""

from typing import Any

import httpx
import pytest

from tests.conftest import CRANE


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
        ("/v1/fits", {"fit": {"over": "/plant/cable_length_m", "from": 1, "to": 2, "degree": 2}}),
        (
            "/v1/designs",
            {"fit": {"over": "/plant/cable_length_m", "from": 1, "to": 2, "degree": 2}},
        ),
        ("/v1/maneuvers", {"speed_m_s": 0.2, "distance_m": 0.4}),
    ],
)
def test_where_no_grid_is_served_it_is_refused(
    client: httpx.Client, path: str, extra: dict[str, Any]
) -> None:
    answer = client.post(path, json={**with_sample_time(0.01), **extra})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/shaper/sample_time_s"


def test_a_simulation_plays_the_sampled_shaper(client: httpx.Client) -> None:
    request = {**with_sample_time(0.01), "command": {"kind": "step"}, "points": 101}
    played = client.post("/v1/simulations", json=request).json()
    design = client.post("/v1/designs", json=with_sample_time(0.01)).json()
    assert played["impulses"] == design["shaper"]["impulses"]
    assert played["residual"] == pytest.approx(design["residual"], rel=1e-9)
