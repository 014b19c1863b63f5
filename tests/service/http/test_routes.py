"""Routes of operations by themselves: statuses, headers and problems, without a worker."""

import asyncio
import json
import logging
from collections.abc import AsyncIterator
from typing import Any

import pytest

from service.http import bodies
from service.operations.table import TABLE
from service.problems import OVERLOADED, Problem
from service.version import version
from tests.conftest import CRANE
from tests.service.http.in_process import InProcess, require_problem

OPERATIONS = [row.path for row in TABLE.values()]

POSTS = [*OPERATIONS, "/v1/designs/batch"]

FULL = Problem(OVERLOADED, "too much is waiting; try again later", retry_after_s=7)


def test_a_design_is_answered_with_its_time_and_the_id_that_was_sent() -> None:
    answer = InProcess().ask("POST", "/v1/designs", CRANE, headers={"x-request-id": "mine-1"})
    assert answer.status_code == 200
    assert answer.json()["shaper"]["kind"] == "numzvd"
    assert answer.headers["content-type"] == "application/json"
    assert answer.headers["x-request-id"] == "mine-1"
    assert answer.headers["server-timing"].startswith("work;dur=")


@pytest.mark.parametrize("path", OPERATIONS)
def test_each_operation_names_what_it_misses(path: str) -> None:
    answer = InProcess().ask("POST", path, {})
    require_problem(answer, 422, "invalid-input", "must be given")
    assert answer.json()["errors"]
    assert answer.headers["server-timing"].startswith("work;dur=")


@pytest.mark.parametrize("path", OPERATIONS)
def test_each_operation_takes_json_alone(path: str) -> None:
    service = InProcess()
    require_problem(service.ask("POST", path, b"{"), 400, "not-json")
    as_text = service.ask("POST", path, b"{}", headers={"content-type": "text/plain"})
    require_problem(as_text, 415, "unsupported-media-type", "application/json, got 'text/plain'")


@pytest.mark.parametrize("path", POSTS)
def test_a_body_that_is_too_large_is_refused(path: str) -> None:
    service = InProcess(max_body_bytes=100, max_batch_bytes=100)
    require_problem(service.ask("POST", path, b" " * 101), 413, "too-large", "at most 100 bytes")


@pytest.mark.parametrize("path", POSTS)
def test_a_body_that_comes_late_is_refused(path: str, monkeypatch: pytest.MonkeyPatch) -> None:
    async def never() -> AsyncIterator[bytes]:
        await asyncio.Event().wait()
        yield b"{}"

    monkeypatch.setattr(bodies, "BODY_WAIT_S", 0.0)
    require_problem(InProcess().ask("POST", path, never()), 408, "request-timeout")


@pytest.mark.parametrize("path", OPERATIONS)
def test_a_full_pool_refuses_and_says_when_to_ask_again(path: str) -> None:
    service = InProcess()
    service.pool.full = FULL
    refused = service.ask("POST", path, {})
    require_problem(refused, 503, "overloaded", FULL.detail)
    assert refused.headers["retry-after"] == "7"


def test_a_pool_that_is_full_only_when_it_is_asked_refuses_alike(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    service = InProcess()
    service.pool.full = FULL
    monkeypatch.setattr(service.pool, "refusal", lambda _: None)
    refused = service.ask("POST", "/v1/designs", CRANE)
    require_problem(refused, 503, "overloaded", FULL.detail)
    assert refused.headers["retry-after"] == "7"


def test_a_batch_is_answered_line_by_line() -> None:
    lines = b"\n".join([json.dumps(CRANE).encode(), b"{}", b"{", b""])
    answer = InProcess().ask("POST", "/v1/designs/batch", lines)
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "application/jsonl"
    told = [json.loads(line) for line in answer.text.splitlines()]
    assert [one.get("status", 200) for one in told] == [200, 422, 400]
    assert told[1]["request_id"] == answer.headers["x-request-id"]


def test_a_batch_for_which_no_worker_is_free_says_so_on_each_line() -> None:
    service = InProcess()
    service.pool.full = FULL
    answer = service.ask("POST", "/v1/designs/batch", b"{}\n{}")
    assert answer.status_code == 200
    told = [json.loads(line) for line in answer.text.splitlines()]
    assert [one["type"] for one in told] == 2 * ["urn:shapersmith:overloaded"]


def test_a_batch_without_lines_or_with_too_many_is_refused() -> None:
    service = InProcess(max_batch_lines=1)
    empty = service.ask("POST", "/v1/designs/batch", b"\n")
    require_problem(empty, 400, "not-json", "the batch is empty")
    long = service.ask("POST", "/v1/designs/batch", b"{}\n{}")
    require_problem(long, 413, "too-large", "at most 1 lines, got 2")


def test_health_tells_whether_there_is_room() -> None:
    service = InProcess()
    assert service.ask("GET", "/health/live").json() == {"status": "live"}
    there = service.ask("GET", "/health/ready")
    assert there.json() == {"status": "ready", "version": version()}
    service.pool.full = FULL
    assert service.ask("GET", "/health/live").status_code == 200
    require_problem(service.ask("GET", "/health/ready"), 503, "overloaded", "is starting")


def test_what_there_is_not_is_a_problem_too() -> None:
    service = InProcess()
    require_problem(service.ask("GET", "/v2"), 404, "not-found", "there is no /v2")
    wrong = service.ask("GET", "/v1/designs")
    require_problem(wrong, 405, "method-not-allowed", "/v1/designs does not take GET")
    assert wrong.headers["allow"] == "POST"
    file = service.ask("POST", "/assets/swagger-ui/swagger-ui.css")
    require_problem(file, 405, "method-not-allowed", "does not take POST")


def test_the_root_leads_to_the_documentation() -> None:
    answer = InProcess().ask("GET", "/")
    assert (answer.status_code, answer.headers["location"]) == (307, "/docs")


@pytest.mark.parametrize("path", ["/docs", "/openapi.json", "/assets/swagger-ui/swagger-ui.css"])
def test_the_documentation_is_served(path: str) -> None:
    assert InProcess().ask("GET", path).status_code == 200


def failing(*_: Any, **__: Any) -> Any:
    raise ZeroDivisionError


@pytest.mark.parametrize("path", POSTS)
def test_a_route_that_crashes_answers_that_the_service_failed_and_logs_why(
    path: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    service = InProcess()
    monkeypatch.setattr(service.pool, "run", failing)
    with caplog.at_level(logging.ERROR, "shapersmith.error"):
        answer = service.ask("POST", path, CRANE)
    require_problem(answer, 500, "internal", "its log has the reason")
    assert "ZeroDivisionError" in caplog.text


def test_a_task_that_fails_answers_that_the_service_failed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.dispatch.respond", failing)
    answer = InProcess().ask("POST", "/v1/designs", CRANE)
    require_problem(answer, 500, "internal", "its log has the reason")
