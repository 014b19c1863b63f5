"""Table jobs over HTTP."""

import json
import sqlite3
import time
import uuid
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.conftest import CRANE, Running, running_service
from tests.patience import PATIENT_S
from tests.processes import until

TABLE: dict[str, Any] = {
    "design": CRANE,
    "axes": [
        {"field": "/plant/cable_length_m", "from": 0.5, "to": 1.0, "points": 4},
        {"field": "/plant/damping_ratio", "values": [0, 0.01]},
    ],
    "chunk_rows": 3,
}

ENDLESS: dict[str, Any] = {
    **TABLE,
    "axes": [{"field": "/plant/cable_length_m", "from": 0.5, "to": 1.0, "points": 1_000_000}],
    "chunk_rows": 1000,
}


def ended(client: httpx.Client, location: str, state: str = "done") -> dict[str, Any]:
    deadline = time.monotonic() + 3 * PATIENT_S
    while True:
        job: dict[str, Any] = client.get(location).json()
        if job["state"] not in {"waiting", "running"}:
            assert job["state"] == state, job
            return job
        assert time.monotonic() < deadline, job
        time.sleep(0.1)


@pytest.fixture(scope="module")
def finished(service: Any) -> str:
    with service.client() as client:
        begun = client.post("/v1/tables", json=TABLE)
        assert begun.status_code == 202, begun.text
        assert begun.json()["size"] == {"rows": 8, "chunks": 3, "estimated_bytes": 8 * 65}
        location: str = begun.headers["location"]
        job = ended(client, location)
        assert (job["rows_done"], job["verified"], job["failed"]) == (8, 8, 0)
    return location


def test_a_table_holds_the_designs_that_the_service_answers(
    client: httpx.Client, finished: str
) -> None:
    text = client.get(f"{finished}/result", params={"format": "csv"}).text
    lines = [line.split(",") for line in text.splitlines() if not line.startswith("#")]
    assert lines[0][:2] == ["plant.cable_length_m", "plant.damping_ratio"]
    assert len(lines) == 9
    for row in lines[1:]:
        plant = {**CRANE["plant"], "cable_length_m": float(row[0]), "damping_ratio": float(row[1])}
        single = client.post("/v1/designs", json={**CRANE, "plant": plant}).json()
        wanted = single["shaper"]["impulses"]["times_s"]
        assert [float(cell) for cell in row[2:7]] == pytest.approx(wanted, abs=1e-10)


def test_the_events_end_with_the_state(client: httpx.Client, finished: str) -> None:
    text = client.get(f"{finished}/events").text
    event, data = text.strip().splitlines()[-2:]
    assert event == "event: done"
    assert json.loads(data.removeprefix("data: "))["rows_done"] == 8


def test_progress_is_sent_while_a_job_runs(client: httpx.Client) -> None:
    location = client.post("/v1/tables", json={**ENDLESS, "chunk_rows": 20}).headers["location"]
    states = []
    with client.stream("GET", f"{location}/events") as stream:
        for line in stream.iter_lines():
            if line.startswith("data: "):
                states.append(json.loads(line.removeprefix("data: ")))
                if states[-1]["rows_done"] > 0 and states[-1]["state"] == "running":
                    client.delete(location)
    assert states[-1]["state"] == "cancelled"
    counts = [one["rows_done"] for one in states[:-1]]
    assert counts == sorted(counts)


def test_ranges_and_tags_are_served(client: httpx.Client, finished: str) -> None:
    address = f"{finished}/result"
    whole = client.get(address)
    tag = whole.headers["etag"]
    assert whole.headers["accept-ranges"] == "bytes"

    def get(**headers: str) -> httpx.Response:
        return client.get(
            address, headers={name.replace("_", "-"): value for name, value in headers.items()}
        )

    part = get(range="bytes=10-19")
    assert (part.status_code, part.content) == (206, whole.content[10:20])
    assert part.headers["content-range"] == f"bytes 10-19/{len(whole.content)}"
    assert get(range="bytes=-7").content == whole.content[-7:]
    assert get(range="bytes=10-19", if_range=tag).status_code == 206
    assert get(range="bytes=10-19", if_range='"old"').content == whole.content
    assert get(if_none_match=tag).status_code == 304
    assert get(if_none_match='"old"').status_code == 200
    assert get(range="bytes=9-1").content == whole.content
    assert get(range="lines=1-2").content == whole.content
    beyond = get(range="bytes=9999999-")
    assert (beyond.status_code, beyond.json()["type"]) == (
        416,
        "urn:shapersmith:range-not-satisfiable",
    )
    assert beyond.headers["content-range"] == f"bytes */{len(whole.content)}"


def test_an_unknown_format_is_named(client: httpx.Client, finished: str) -> None:
    refused = client.get(f"{finished}/result", params={"format": "xls"})
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["pointer"] == "/format"


def test_a_result_asked_for_too_early_is_a_conflict_and_a_job_is_cancelled_then_deleted(
    client: httpx.Client,
) -> None:
    location = client.post("/v1/tables", json=ENDLESS).headers["location"]
    early = client.get(f"{location}/result")
    assert (early.status_code, early.json()["type"]) == (409, "urn:shapersmith:conflict")
    cancelled = client.delete(location)
    assert (cancelled.status_code, cancelled.json()["state"]) == (200, "cancelled")
    assert client.get(f"{location}/result").status_code == 409
    assert location.removeprefix("/v1/tables/") in listed(client)
    deleted = client.delete(location)
    assert (deleted.status_code, deleted.json()["state"]) == (200, "cancelled")
    require_gone(client, location)


def listed(client: httpx.Client) -> list[str]:
    return [job["id"] for job in client.get("/v1/tables").json()["tables"]]


def require_gone(client: httpx.Client, location: str) -> None:
    for method, route in [
        ("GET", ""),
        ("GET", "/events"),
        ("GET", "/result"),
        ("POST", "/resume"),
        ("DELETE", ""),
    ]:
        missing = client.request(method, f"{location}{route}")
        assert (missing.status_code, missing.json()["type"]) == (404, "urn:shapersmith:not-found")
    assert location.removeprefix("/v1/tables/") not in listed(client)


def files_of(service: Running, location: str) -> list[Path]:
    """Return the files of a table that a service keeps."""
    return list((service.data / "results").glob(f"*{location.rpartition('/')[2]}*"))


def test_a_job_that_is_done_is_deleted_with_its_files(
    service: Running, client: httpx.Client
) -> None:
    location = client.post("/v1/tables", json=TABLE).headers["location"]
    job = ended(client, location)
    for name in ("csv", "json"):
        assert client.get(f"{location}/result", params={"format": name}).status_code == 200
    assert sorted(path.suffix for path in files_of(service, location)) == [".csv", ".json"]
    deleted = client.delete(location)
    assert (deleted.status_code, deleted.json()["verified"]) == (200, job["verified"])
    require_gone(client, location)
    until(lambda: not files_of(service, location), "its files are still there")


def test_a_client_that_has_a_file_is_told_so_without_making_it(
    service: Running, client: httpx.Client
) -> None:
    location = client.post("/v1/tables", json=TABLE).headers["location"]
    ended(client, location)
    tag = client.get(f"{location}/result").headers["etag"]
    for path in files_of(service, location):
        path.unlink()
    for given in (tag, f"W/{tag}", f'"other", {tag}'):
        held = client.get(f"{location}/result", headers={"if-none-match": given})
        assert (held.status_code, held.headers["etag"]) == (304, tag)
    assert not files_of(service, location)
    held = client.get(f"{location}/result", headers={"if-none-match": "*"})
    assert held.status_code == 304


def test_a_request_that_is_sent_again_with_its_key_begins_no_second_table(
    client: httpx.Client,
) -> None:
    key = {"idempotency-key": f"the {uuid.uuid4()} ~"}
    first = client.post("/v1/tables", json=TABLE, headers=key)
    again = client.post("/v1/tables", content=json.dumps(TABLE, indent=3), headers=key)
    assert (first.status_code, again.status_code) == (202, 202)
    assert again.headers["location"] == first.headers["location"]
    assert again.json()["id"] == first.json()["id"]
    other = client.post("/v1/tables", json={**TABLE, "title": "another"}, headers=key)
    assert (other.status_code, other.json()["type"]) == (422, "urn:shapersmith:invalid-input")
    assert other.json()["code"] == "key_reused"
    without = client.post("/v1/tables", json=TABLE)
    assert without.headers["location"] != first.headers["location"]
    ended(client, first.headers["location"])
    client.delete(first.headers["location"])
    anew = client.post("/v1/tables", json=TABLE, headers=key)
    assert anew.headers["location"] != first.headers["location"]


@pytest.mark.parametrize(
    "keys", [[b""], [b"k" * 256], [b"a\tb"], [b"\xfc"], [b"one", b"two"], [b"one", b"one"]]
)
def test_a_key_that_breaks_its_rule_is_refused(client: httpx.Client, keys: list[bytes]) -> None:
    headers = [(b"idempotency-key", key) for key in keys]
    refused = client.post("/v1/tables", json=TABLE, headers=headers)
    assert (refused.status_code, refused.json()["type"]) == (422, "urn:shapersmith:invalid-input")
    assert refused.json()["code"] == "unreadable_key"


def changed(service: Any, location: str, **values: Any) -> None:
    """Change the record of a job under the service."""
    store = sqlite3.connect(service.log.parent / "data" / "jobs.sqlite", timeout=PATIENT_S)
    for name, value in values.items():
        store.execute(
            f"UPDATE jobs SET {name} = ? WHERE id = ?", (value, location.rpartition("/")[2])
        )
    store.commit()
    store.close()


def test_a_failed_table_is_resumed_and_no_other(service: Any, client: httpx.Client) -> None:
    location = client.post("/v1/tables", json=TABLE).headers["location"]
    ended(client, location)
    changed(service, location, state="failed", reason="why")
    assert client.get(location).json()["reason"] == "why"
    resumed = client.post(f"{location}/resume")
    assert (resumed.status_code, resumed.json()["state"]) == (202, "running")
    ended(client, location)
    again = client.post(f"{location}/resume")
    assert (again.status_code, again.json()["type"]) == (409, "urn:shapersmith:conflict")
    assert "is done" in again.json()["detail"]
    changed(service, location, state="failed", version="0.0.1")
    other = client.post(f"{location}/resume")
    assert (other.status_code, other.json()["type"]) == (409, "urn:shapersmith:conflict")
    assert "by version 0.0.1" in other.json()["detail"]


@pytest.mark.parametrize("id", ["none", 32 * "0", 31 * "0" + "%00", "%00", "%ff", 33 * "0", "%0a"])
def test_a_job_that_is_none_is_not_found(client: httpx.Client, id: str) -> None:
    require_gone(client, f"/v1/tables/{id}")


def axis(**changes: Any) -> dict[str, Any]:
    return {
        "axes": [{"field": "/plant/cable_length_m", "from": 0.5, "to": 1, "points": 2, **changes}]
    }


GRID = [
    {"field": "/plant/cable_length_m", "from": 0.5, "to": 1, "points": 10**6},
    {"field": "/plant/damping_ratio", "from": 0, "to": 0.1, "points": 10**6},
]


@pytest.mark.parametrize(
    ("change", "pointer", "code"),
    [
        ({"axes": GRID}, "/axes", "too_many_rows"),
        (axis(points=10**9), "/axes/0/points", "too_many_points"),
        (axis(field="/plant/mass_kg"), "/axes/0/field", "unknown_field"),
        (axis(field="/load/mass_kg"), "/axes/0/field", "wrong_form"),
        ({"axes": 2 * axis()["axes"]}, "/axes/1/field", "field_repeated"),
        (
            {"axes": [{"field": "/plant/damping_ratio", "values": []}]},
            "/axes/0/values",
            "no_values",
        ),
        ({"axes": []}, "/axes", "no_axes"),
        (axis(to=0.1), "/axes/0/to", "range_reversed"),
        (axis(values=[1.0]), "/axes/0/values", "values_and_range"),
        (axis(**{"from": -1, "spacing": "geometric"}), "/axes/0/from", "geometric_from_zero"),
        ({"columns": ["colour"]}, "/columns/0", "unknown_column"),
        ({"designs": [{"plant": {"damping_ratio": 0.1}}]}, "/axes", "axes_or_designs"),
        ({"axes": None, "designs_file": "x.csv"}, "/designs_file", "file_over_http"),
        ({"axes": None, "designs": []}, "/designs", "nothing_varies"),
        (
            {
                "axes": None,
                "designs": [{"plant": {"damping_ratio": 0.1}}, {"plant": {"mass_kg": 1}}],
            },
            "/designs/1/plant/mass_kg",
            "not_a_number",
        ),
        (
            {"axes": None, "designs": [{"plant": {"damping_ratio": "a"}}]},
            "/designs/0/plant/damping_ratio",
            "varied_not_a_number",
        ),
        (
            {"axes": None, "designs": [{"plant": {"damping_ratio": 1.5}}]},
            "/designs/0",
            "out_of_range",
        ),
        ({"chunk_rows": 0}, "/chunk_rows", "out_of_range"),
    ],
)
def test_a_faulty_table_is_named(
    client: httpx.Client, change: dict[str, Any], pointer: str, code: str
) -> None:
    answer = client.post("/v1/tables", json={**TABLE, **change})
    assert answer.status_code == 422, answer.text
    faults = {fault["pointer"]: fault["code"] for fault in answer.json()["errors"]}
    assert faults[pointer] == code


def test_listed_designs_keep_what_they_do_not_name(client: httpx.Client) -> None:
    request = {
        **TABLE,
        "axes": None,
        "designs": [
            {"plant": {"cable_length_m": 0.6}},
            {"actuator": {"decel": {"natural_frequency_rad_s": 40}}},
        ],
        "chunk_rows": 1,
    }
    location = client.post("/v1/tables", json=request).headers["location"]
    ended(client, location)
    text = client.get(f"{location}/result").text
    rows = [line.split(",") for line in text.splitlines() if not line.startswith("#")]
    assert rows[0][:2] == ["plant.cable_length_m", "actuator.decel.natural_frequency_rad_s"]
    assert [row[:2] for row in rows[1:]] == [["0.6", "50.0"], ["0.8", "40.0"]]


def test_a_service_that_is_started_again_goes_on_with_its_jobs(tmp_path: Path) -> None:
    request = {**TABLE, "axes": [{**TABLE["axes"][0], "points": 400}], "chunk_rows": 10}
    settings: dict[str, Any] = {"workers": 1, "job_workers": 1, "stalled_s": 1.0}
    with running_service(tmp_path / "log", **settings) as service, service.client() as client:
        location = client.post("/v1/tables", json=request).headers["location"]
        until(lambda: client.get(location).json()["rows_done"], "no row is done")
        service.process.kill()
    with running_service(tmp_path / "log", **settings) as service, service.client() as client:
        assert ended(client, location)["verified"] == 400


def test_the_largest_body_is_answered(tmp_path: Path) -> None:
    """With a limit of a megabyte; `tests.acceptance.test_long_forms` has the usual one."""
    require_largest_answered(tmp_path, 1_000_000)


def require_largest_answered(folder: Path, largest: int) -> None:
    """Require a service to answer the largest body that it takes, and to refuse a larger one."""
    head = json.dumps({**TABLE, "axes": None, "chunk_rows": 10_000})[:-1] + ', "designs": ['
    first, end = '{"plant": {"damping_ratio": 0.01}}', "]}"
    others = (largest - len(head + first + end)) // len(",{}")
    body = (head + first + others * ",{}" + end).ljust(largest)
    settings: dict[str, Any] = {"workers": 1, "job_workers": 0, "max_table_bytes": largest}
    json_type = {"content-type": "application/json"}
    with running_service(folder / "log", **settings) as service, service.client() as client:
        refused = client.post("/v1/tables", content=body + " ", headers=json_type)
        assert (refused.status_code, refused.json()["type"]) == (413, "urn:shapersmith:too-large")
        begun = client.post("/v1/tables", content=body, headers=json_type)
        assert begun.status_code == 202, begun.text
        assert begun.json()["size"]["rows"] == others + 1


HEAVILY_DAMPED: dict[str, Any] = {
    "design": {
        "plant": {"kind": "mode", "natural_frequency_rad_s": 250.0, "damping_ratio": 0.0},
        "actuator": {"kind": "ideal"},
        "shaper": {"kind": "two_hump_ei", "tolerance": 0.055},
    },
    "axes": [{"field": "/plant/damping_ratio", "values": [0.02, 0.35]}],
    "columns": ["times_s", "amplitudes", "residual"],
}


def test_what_a_format_finds_in_the_rows_is_refused_by_name(client: httpx.Client) -> None:
    location = client.post("/v1/tables", json=HEAVILY_DAMPED).headers["location"]
    ended(client, location)
    refused = client.get(f"{location}/result", params={"format": "klipper"})
    assert refused.status_code == 422, refused.text
    assert (
        "damping_ratio of row 1: must be at most 0.3 for Klipper's 2hump_ei, got 0.35"
        in (refused.json()["detail"])
    )
    assert [one["pointer"] for one in refused.json()["errors"]] == [""]
    assert client.get(f"{location}/result", params={"format": "rrf"}).status_code == 200


def test_rows_that_are_verified_for_an_ideal_actuator_only_are_counted_apart(
    client: httpx.Client,
) -> None:
    design = {**CRANE, "shaper": {"kind": "umzv"}}
    location = client.post("/v1/tables", json={**TABLE, "design": design}).headers["location"]
    job = ended(client, location)
    assert (job["verified"], job["verified_ideal"], job["failed"]) == (0, 8, 0)
    text = client.get(f"{location}/result").text
    assert text.count(",verified_ideal,\n") == 8
