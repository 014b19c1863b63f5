"""Bodies that are no JSON, too large, of another type, or name a thing twice."""

import json
from typing import Any

import httpx
import pytest

from tests.conftest import CRANE
from tests.service.http.changed_request import JSON, NATURAL, changed


def test_an_overflowing_number_is_not_finite(client: httpx.Client) -> None:
    text = json.dumps(changed(NATURAL, 12345.5)).replace("12345.5", "1e400")
    answer = client.post("/v1/designs", content=text, headers=JSON)
    assert answer.status_code == 422
    assert answer.json()["errors"] == [
        {
            "pointer": NATURAL,
            "code": "not_finite",
            "detail": "must be a finite number, got inf",
        }
    ]


@pytest.mark.parametrize(
    "body",
    [
        pytest.param(b"", id="empty"),
        pytest.param(b"{", id="cut"),
        pytest.param(b"plant: crane", id="yaml"),
        pytest.param(b"[" * 100_000, id="deep-list"),
        pytest.param(b'{"plant":' * 100_000, id="deep-object"),
        pytest.param(b"\xff\xfe\x00", id="not-utf-8"),
        pytest.param(b'{"plant": "\xe9"}', id="latin-1"),
    ],
)
@pytest.mark.parametrize("path", ["/v1/designs", "/v1/sensitivity", "/v1/fits"])
def test_what_is_no_json_is_told_so(client: httpx.Client, path: str, body: bytes) -> None:
    answer = client.post(path, content=body, headers=JSON)
    assert (answer.status_code, answer.json()["type"]) == (400, "urn:shapersmith:not-json")


@pytest.mark.parametrize("body", [b"[]", b"3", b"null", b'"crane"'])
def test_json_that_is_no_object_is_invalid(client: httpx.Client, body: bytes) -> None:
    answer = client.post("/v1/designs", content=body, headers=JSON)
    assert (answer.status_code, answer.json()["type"]) == (422, "urn:shapersmith:invalid-input")


def test_a_body_over_its_limit_is_refused(client: httpx.Client) -> None:
    answer = client.post("/v1/designs", content=b" " * 2_000_000, headers=JSON)
    assert (answer.status_code, answer.json()["type"]) == (413, "urn:shapersmith:too-large")
    assert "1048576 bytes" in answer.json()["detail"]


def test_a_batch_over_its_lines_is_refused(client: httpx.Client) -> None:
    answer = client.post("/v1/designs/batch", content=b"{}\n" * 1001)
    assert (answer.status_code, answer.json()["type"]) == (413, "urn:shapersmith:too-large")


def test_another_media_type_is_refused(client: httpx.Client) -> None:
    answer = client.post("/v1/designs", content=b"<a/>", headers={"content-type": "text/xml"})
    assert (answer.status_code, answer.json()["type"]) == (
        415,
        "urn:shapersmith:unsupported-media-type",
    )


def test_unknown_routes_and_methods_are_problems_too(client: httpx.Client) -> None:
    missing = client.get("/v1/nothing")
    assert (missing.status_code, missing.json()["type"]) == (404, "urn:shapersmith:not-found")
    wrong = client.put("/v1/designs")
    assert (wrong.status_code, wrong.json()["type"]) == (405, "urn:shapersmith:method-not-allowed")
    assert wrong.headers["allow"] == "POST"


def test_many_faults_are_told_in_part(client: httpx.Client) -> None:
    request = {**CRANE, **{f"field_{n}": n for n in range(5000)}}
    answer = client.post("/v1/designs", json=request)
    assert len(answer.json()["errors"]) == 20
    assert "and 4980 more" in answer.json()["detail"]
    long_kind = client.post("/v1/designs", json=changed("/plant", {"kind": "x" * 100_000}))
    assert len(long_kind.content) < 3000


def test_an_empty_batch_is_no_json(client: httpx.Client) -> None:
    assert client.post("/v1/designs/batch", content=b"\n\n").status_code == 400


SENSITIVITY = {
    "plant": CRANE["plant"],
    "actuator": CRANE["actuator"],
    "impulses": {"times_s": [0, 0.9], "amplitudes": [0.5, 0.5]},
}

TABLE = {"design": CRANE, "axes": [{"field": "/plant/cable_length_m", "values": [0.7, 0.8]}]}


@pytest.mark.parametrize(
    ("path", "request_", "outer", "name", "pointer"),
    [
        ("/v1/designs", CRANE, '"shaper": {', '"kind": "umzv"', "/shaper/kind"),
        ("/v1/designs", CRANE, '"accel": {', '"damping_ratio": 1', "/actuator/accel/damping_ratio"),
        ("/v1/sensitivity", SENSITIVITY, "{", '"plant": {}', "/plant"),
        ("/v1/sensitivity", SENSITIVITY, '"impulses": {', '"times_s": 1', "/impulses/times_s"),
        ("/v1/tables", TABLE, '"axes": [{', '"field": ""', "/axes/0/field"),
    ],
)
def test_a_name_given_twice_is_refused_by_its_pointer(
    client: httpx.Client,
    path: str,
    request_: dict[str, Any],
    outer: str,
    name: str,
    pointer: str,
) -> None:
    text = json.dumps(request_)
    assert outer in text
    repeated = text.replace(outer, f"{outer}{name}, ", 1)
    assert client.post(path, content=text, headers=JSON).is_success
    answer = client.post(path, content=repeated, headers=JSON)
    assert (answer.status_code, answer.json()["type"]) == (422, "urn:shapersmith:invalid-input")
    assert answer.json()["errors"] == [
        {"pointer": pointer, "code": "name_repeated", "detail": "must be given once"}
    ]


def test_a_name_given_twice_in_a_line_of_a_batch_spoils_that_line_alone(
    client: httpx.Client,
) -> None:
    line = json.dumps(CRANE)
    twice = line.replace('"shaper": {', '"shaper": {"kind": "umzv", ', 1)
    told = client.post("/v1/designs/batch", content=f"{line}\n{twice}\n{line}\n").text.splitlines()
    problem = json.loads(told[1])
    assert problem["errors"] == [
        {"pointer": "/shaper/kind", "code": "name_repeated", "detail": "must be given once"}
    ]
    assert told[0] == told[2]


@pytest.mark.parametrize("name", ["a.b", "a/b", "~", "m~n", "", "0", "a.b/c~d"])
def test_names_of_any_letters_are_pointed_at(client: httpx.Client, name: str) -> None:
    escaped = name.replace("~", "~0").replace("/", "~1")
    answer = client.post("/v1/designs", json=changed("/plant", {**CRANE["plant"], name: 1}))
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [f"/plant/{escaped}"]
    for value in (1.0, "x"):
        table = {"design": CRANE, "designs": [{"plant": {name: value}}]}
        answer = client.post("/v1/tables", json=table)
        pointers = [fault["pointer"] for fault in answer.json()["errors"]]
        assert pointers == [f"/designs/0/plant/{escaped}"]


def test_a_number_of_many_digits_is_named(client: httpx.Client) -> None:
    text = json.dumps(changed(NATURAL, 12345.5)).replace("12345.5", "1" * 4000)
    answer = client.post("/v1/designs", content=text, headers=JSON)
    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [NATURAL]
