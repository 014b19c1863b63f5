"""Designs over HTTP, from a real service."""

import json
from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest

from design.shapers.registry import SHAPERS
from tests.conftest import CRANE


def test_the_thesis_crane_is_designed_to_the_reference(client: httpx.Client) -> None:
    answer = client.post("/v1/designs", json=CRANE)
    assert answer.status_code == 200
    body = answer.json()
    # Kim 2011's crane with the exact slope; times recomputed independently to 1e-8 s.
    assert body["shaper"]["impulses"]["times_s"] == pytest.approx(
        [0, 0.18211712, 0.66033323, 1.18087995, 1.32079496], abs=1e-7
    )
    assert body["shaper"]["impulses"]["amplitudes"] == [1, -1, 1, -1, 1]
    assert body["certificate"]["verified"] is True
    assert {claim["quantity"] for claim in body["certificate"]["claims"]} == {"residual", "slope"}
    assert body["sensitivity"]["insensitivity"]["width"] == pytest.approx(0.25866, abs=1e-5)
    assert body["solver"]["name"] == "ipopt"
    assert body["fit"] is None


def test_a_shaper_that_knows_no_actuator_tells_what_it_leaves(client: httpx.Client) -> None:
    body = client.post("/v1/designs", json={**CRANE, "shaper": {"kind": "umzvd"}}).json()
    assert body["certificate"]["verified"] is True
    assert body["residual"] == pytest.approx(0.0245, abs=1e-4)


def test_equal_requests_give_equal_bytes(client: httpx.Client) -> None:
    first, second = (client.post("/v1/designs", json=CRANE) for _ in range(2))
    assert first.content == second.content
    assert first.headers["server-timing"].startswith("work;dur=")


def test_floats_survive_the_round_trip_into_a_sensitivity_request(client: httpx.Client) -> None:
    design = client.post("/v1/designs", json=CRANE).json()
    again = client.post(
        "/v1/sensitivity",
        json={
            "impulses": design["shaper"]["impulses"],
            "plant": CRANE["plant"],
            "actuator": CRANE["actuator"],
        },
    ).json()
    assert again == {
        "sensitivity": design["sensitivity"],
        "residual": design["residual"],
        "warnings": [],
    }


def test_null_leaves_the_curve_out(client: httpx.Client) -> None:
    assert (
        client.post("/v1/designs", json={**CRANE, "sensitivity": None}).json()["sensitivity"]
        is None
    )


def test_a_fit_comes_with_the_design_and_alone(client: httpx.Client) -> None:
    fit = {"over": "/plant/cable_length_m", "from": 0.3, "to": 1.4, "max_residual": 1e-6}
    together = client.post("/v1/designs", json={**CRANE, "fit": fit}).json()["fit"]
    alone = client.post("/v1/fits", json={**CRANE, "fit": fit}).json()
    assert together == alone
    assert alone["worst_residual"] <= 1e-6
    assert len(alone["coefficients"]) == 5
    assert alone["coefficients"][0] == [0.0] * (alone["degree"] + 1)
    assert alone["design"]["shaper"]["kind"] == "numzvd"


def test_concurrent_requests_get_their_own_answers(client: httpx.Client) -> None:
    lengths = [0.3 + 0.02 * n for n in range(40)]

    def duration(length: float) -> float:
        request = {**CRANE, "plant": {**CRANE["plant"], "cable_length_m": length}}
        value: float = client.post("/v1/designs", json=request).json()["shaper"]["duration_s"]
        return value

    with ThreadPoolExecutor(8) as threads:
        durations = list(threads.map(duration, lengths))
    # The duration grows with the length of the cable: an answer that was swapped shows.
    assert durations == sorted(durations)


def test_a_batch_answers_each_line_in_order(client: httpx.Client) -> None:
    slow = {**CRANE, "plant": {**CRANE["plant"], "cable_length_m": 1.6}}
    lines = [json.dumps(CRANE), '{"nonsense": 1}', "not json", "", json.dumps(slow)] + [
        json.dumps(CRANE)
    ] * 60
    answer = client.post(
        "/v1/designs/batch",
        content="\n".join(lines) + "\n",
        headers={"content-type": "application/jsonl"},
    )
    assert answer.status_code == 200
    told = [json.loads(line) for line in answer.content.splitlines()]
    assert len(told) == len(lines)
    assert told[0] == client.post("/v1/designs", json=CRANE).json()
    assert [line["status"] for line in told[1:4]] == [422, 400, 400]
    assert told[4]["shaper"]["duration_s"] > 1.4 * told[0]["shaper"]["duration_s"] * 0.95
    assert all(line == told[0] for line in told[5:])


def test_every_kind_of_the_catalogue_designs_its_own_example(client: httpx.Client) -> None:
    catalogue = client.get("/v1/shapers").json()["shapers"]
    assert [entry["kind"] for entry in catalogue] == list(SHAPERS)
    for entry in catalogue:
        body = client.post("/v1/designs", json=entry["example"]).json()
        assert body["certificate"]["verified"] is True, entry["kind"]
        assert body["shaper"]["kind"] == entry["kind"]
        assert entry["parameters"]["properties"]["kind"]["const"] == entry["kind"]


def test_the_request_id_is_taken_over_or_given(client: httpx.Client) -> None:
    given = client.get("/health/live", headers={"x-request-id": "abc-1"})
    assert given.headers["x-request-id"] == "abc-1"
    refused = client.get("/health/live", headers={"x-request-id": "a b\tc"})
    assert refused.headers["x-request-id"] not in {"", "a b\tc"}


def test_the_docs_need_no_other_server(client: httpx.Client) -> None:
    page = client.get("/docs")
    assert page.status_code == 200
    assert "//" not in page.text.replace("// `", "").replace("<!-- `", "")
    for path in ("swagger-ui-bundle.js", "swagger-ui.css"):
        assert client.get(f"/assets/swagger-ui/{path}").status_code == 200
    schema = client.get("/openapi.json").json()
    body = schema["paths"]["/v1/designs"]["post"]["requestBody"]["content"]["application/json"]
    assert body["schema"]["$ref"].endswith("/DesignRequest")
    assert "NumzvdIn" in schema["components"]["schemas"]


@pytest.mark.parametrize(("kind", "ignored"), [("umzv", True), ("numzv", False), ("ei", False)])
def test_a_shaper_that_ignores_the_actuator_says_so(
    client: httpx.Client, kind: str, ignored: bool
) -> None:
    answer = client.post("/v1/designs", json={**CRANE, "shaper": {"kind": kind}}).json()
    assert answer["certificate"]["actuator"] == ("ideal" if ignored else "given")
    told = [one["detail"] for one in answer["warnings"] if one["code"] == "actuator_ignored"]
    assert len(told) == ignored
    assert all(f"the residual is {100 * answer['residual']:.4g} %" in detail for detail in told)
    ideal = {**CRANE, "actuator": {"kind": "ideal"}, "shaper": {"kind": kind}}
    answer = client.post("/v1/designs", json=ideal).json()
    assert answer["certificate"]["actuator"] == "given"
