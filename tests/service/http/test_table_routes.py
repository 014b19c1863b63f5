"""Routes of tables by themselves: statuses, headers and problems, without a worker or a store."""

import asyncio
from pathlib import Path

import pytest

from service.jobs.memory import MemoryJobs
from service.jobs.records import Job
from service.problems import INVALID, OVERLOADED, Problem
from tests.service.http.in_process import InProcess, require_problem
from tests.service.http.test_tables_over_http import TABLE

ID = 32 * "0"

ROUTES = [
    ("GET", ""),
    ("DELETE", ""),
    ("POST", "/resume"),
    ("GET", "/events"),
    ("GET", "/result"),
]
"""Of one table."""

EVERY_ROUTE = [("GET", "/v1/tables"), *((way, f"/v1/tables/{ID}{end}") for way, end in ROUTES)]


@pytest.fixture
def jobs(tmp_path: Path) -> MemoryJobs:
    return MemoryJobs(tmp_path)


@pytest.fixture
def service(jobs: MemoryJobs) -> InProcess:
    return InProcess(jobs)


@pytest.fixture
def begun(service: InProcess) -> str:
    """Return the id of a table that waits."""
    answer = service.ask("POST", "/v1/tables", TABLE)
    assert answer.status_code == 202
    job: str = answer.json()["id"]
    assert answer.headers["location"] == f"/v1/tables/{job}"
    return job


def test_a_table_is_begun_listed_and_shown(service: InProcess, begun: str) -> None:
    shown = service.ask("GET", f"/v1/tables/{begun}").json()
    assert (shown["id"], shown["state"], shown["size"]["rows"]) == (begun, "waiting", 8)
    assert service.ask("GET", "/v1/tables").json()["tables"] == [shown]


def test_what_is_wrong_with_a_table_is_named(service: InProcess) -> None:
    require_problem(service.ask("POST", "/v1/tables", {}), 422, "invalid-input", "must be given")
    require_problem(service.ask("POST", "/v1/tables", b"{"), 400, "not-json")
    headers = {"content-type": "text/csv"}
    refused = service.ask("POST", "/v1/tables", b"{}", headers=headers)
    require_problem(refused, 415, "unsupported-media-type")


def test_a_specification_that_is_too_large_is_refused(jobs: MemoryJobs) -> None:
    refused = InProcess(jobs, max_table_bytes=10).ask("POST", "/v1/tables", b" " * 11)
    require_problem(refused, 413, "too-large", "at most 10 bytes")


def test_a_key_is_of_one_specification(service: InProcess) -> None:
    key = {"idempotency-key": "k"}
    first, again = (service.ask("POST", "/v1/tables", TABLE, headers=key) for _ in range(2))
    assert (again.status_code, again.json()["id"]) == (202, first.json()["id"])
    other = service.ask("POST", "/v1/tables", {**TABLE, "title": "other"}, headers=key)
    require_problem(other, 422, "invalid-input", "the header Idempotency-Key must not be one that")
    bad = service.ask("POST", "/v1/tables", TABLE, headers={"idempotency-key": "k" * 256})
    require_problem(bad, 422, "invalid-input", "1 to 255 printable ASCII characters")


@pytest.mark.parametrize(("method", "end"), ROUTES)
@pytest.mark.parametrize("job", [ID, "none", "%00", f"{ID}%0a"])
def test_a_table_that_is_none_is_not_found(
    service: InProcess, method: str, end: str, job: str
) -> None:
    missing = service.ask(method, f"/v1/tables/{job}{end}")
    require_problem(missing, 404, "not-found", "there is no table job")


@pytest.mark.parametrize(
    ("path", "methods"), [("/v1/tables", "GET, POST"), (f"/v1/tables/{ID}", "DELETE, GET")]
)
def test_a_path_of_several_routes_names_the_methods_of_all(
    service: InProcess, path: str, methods: str
) -> None:
    for method in ("PUT", "OPTIONS"):
        refused = service.ask(method, path)
        require_problem(refused, 405, "method-not-allowed", f"does not take {method}")
        assert refused.headers["allow"] == methods


@pytest.mark.parametrize(("method", "path"), [("POST", "/v1/tables"), *EVERY_ROUTE])
def test_a_store_that_does_not_answer_is_told_by_every_route(
    service: InProcess, jobs: MemoryJobs, method: str, path: str
) -> None:
    jobs.silence = "the job store does not answer: it sleeps"
    refused = service.ask(method, path, TABLE if path == "/v1/tables" else None)
    require_problem(refused, 503, "overloaded", "it sleeps")


@pytest.mark.parametrize(("method", "path"), EVERY_ROUTE)
def test_a_process_without_jobs_says_so(method: str, path: str) -> None:
    require_problem(InProcess().ask(method, path), 503, "overloaded", "has no job store")


@pytest.mark.parametrize(("method", "path"), EVERY_ROUTE)
def test_a_route_that_crashes_answers_that_the_service_failed(
    service: InProcess,
    jobs: MemoryJobs,
    method: str,
    path: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(jobs, "find", None)
    monkeypatch.setattr(jobs, "newest", None)
    answer = service.ask(method, path)
    require_problem(answer, 500, "internal", "its log has the reason")


def test_a_full_pool_begins_no_table_and_makes_no_file(
    service: InProcess, jobs: MemoryJobs, begun: str
) -> None:
    jobs.change(begun, "done", rows_done=8)
    service.pool.full = Problem(OVERLOADED, "all are busy", retry_after_s=3)
    for method, path in (("POST", "/v1/tables"), ("GET", f"/v1/tables/{begun}/result")):
        refused = service.ask(method, path, TABLE if method == "POST" else None)
        require_problem(refused, 503, "overloaded", "all are busy")
        assert refused.headers["retry-after"] == "3"
    assert len(asyncio.run(jobs.newest(10))) == 1


def test_a_table_is_cancelled_and_then_deleted(service: InProcess, begun: str) -> None:
    path = f"/v1/tables/{begun}"
    for _ in range(2):
        answer = service.ask("DELETE", path)
        assert (answer.status_code, answer.json()["state"]) == (200, "cancelled")
    require_problem(service.ask("GET", path), 404, "not-found")


def test_a_table_that_changes_meanwhile_is_a_conflict(
    service: InProcess, jobs: MemoryJobs, begun: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def too_late(_: str) -> bool:
        return False

    monkeypatch.setattr(jobs, "cancel", too_late)
    ended = service.ask("DELETE", f"/v1/tables/{begun}")
    require_problem(ended, 409, "conflict", "the same request again deletes it")
    monkeypatch.setattr(jobs, "delete", too_late)
    jobs.change(begun, "failed")
    resumed = service.ask("DELETE", f"/v1/tables/{begun}")
    require_problem(resumed, 409, "conflict", "the same request again cancels it")


def test_a_failed_table_alone_is_resumed(service: InProcess, jobs: MemoryJobs, begun: str) -> None:
    path = f"/v1/tables/{begun}/resume"
    require_problem(service.ask("POST", path), 409, "conflict", "only a failed one is resumed")
    jobs.change(begun, "failed", reason="why")
    assert service.ask("GET", f"/v1/tables/{begun}").json()["reason"] == "why"
    answer = service.ask("POST", path)
    assert (answer.status_code, answer.json()["state"]) == (202, "running")


def test_events_end_with_the_state(service: InProcess, jobs: MemoryJobs, begun: str) -> None:
    jobs.change(begun, "done", rows_done=8)
    answer = service.ask("GET", f"/v1/tables/{begun}/events")
    assert answer.headers["content-type"].startswith("text/event-stream")
    assert answer.headers["cache-control"] == "no-cache"
    assert answer.headers["x-accel-buffering"] == "no"
    state = service.ask("GET", f"/v1/tables/{begun}").text
    assert answer.text == f"event: done\ndata: {state}\n\n"


def test_a_stream_is_kept_alive_where_nothing_changes(
    service: InProcess, jobs: MemoryJobs, begun: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fastapi.routing._PING_INTERVAL", 0.05)
    looks: list[str] = []

    async def find(job: str) -> Job | None:
        looks.append(job)
        if len(looks) == 2:  # the stream has been idle for one look
            jobs.change(job, "done", rows_done=8)
        return await jobs.find(job)

    jobs.change(begun, "running")
    monkeypatch.setattr(jobs._watching, "_look", find)
    text = service.ask("GET", f"/v1/tables/{begun}/events").text
    assert text.startswith("event: progress\ndata: {")
    assert "\n\n: ping\n\n" in text
    assert text.rpartition("event: ")[2].startswith("done\n")


def test_a_file_is_made_once_and_served_whole_in_part_or_not_at_all(
    service: InProcess, jobs: MemoryJobs, begun: str
) -> None:
    path = f"/v1/tables/{begun}/result"
    require_problem(service.ask("GET", path), 409, "conflict", "it has no result yet")
    jobs.change(begun, "done", rows_done=8)
    jobs.files[begun, "csv"] = b"0123456789"
    whole = service.ask("GET", path)
    assert (whole.status_code, whole.content) == (200, b"0123456789")
    assert whole.headers["content-type"] == "text/csv; charset=utf-8"
    assert f'filename="table-{begun[:8]}.csv"' in whole.headers["content-disposition"]
    jobs.files.clear()
    part = service.ask("GET", path, headers={"range": "bytes=2-4"})
    assert (part.status_code, part.content) == (206, b"234")
    beyond = service.ask("GET", path, headers={"range": "bytes=10-"})
    require_problem(beyond, 416, "range-not-satisfiable", "the file has 10 bytes")
    assert beyond.headers["content-range"] == "bytes */10"
    held = service.ask("GET", path, headers={"if-none-match": whole.headers["etag"]})
    assert (held.status_code, held.content) == (304, b"")


def test_a_file_that_cannot_be_made_says_why(
    service: InProcess, jobs: MemoryJobs, begun: str
) -> None:
    jobs.change(begun, "done", rows_done=8)
    path = f"/v1/tables/{begun}/result"
    require_problem(service.ask("GET", f"{path}?format=xls"), 422, "invalid-input", "/format")
    for problem, status in (
        (Problem(INVALID, "row 1"), 422),
        (Problem(OVERLOADED, "the disk is full", retry_after_s=5), 503),
    ):
        jobs.files[begun, "csv"] = problem
        answer = service.ask("GET", path)
        require_problem(answer, status, problem.kind.name, problem.detail)
