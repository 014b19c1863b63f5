"""Refusals of an overload are written by the protocol: the app does not hear of the request."""

import http.client
import json
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, BinaryIO

import pytest
import uvicorn

from service.http.app import create_app
from service.http.middleware import RequestMiddleware
from service.http.refusing import RefusingProtocol
from service.problems import OVERLOADED, Problem
from service.settings import Settings
from service.workers.inline import InlinePool
from tests.conftest import CRANE
from tests.patience import PATIENT_S

BODY = json.dumps(CRANE).encode()
HEAD = (
    "POST /v1/designs HTTP/1.1\r\nhost: here\r\nx-request-id: mine\r\n"
    f"content-type: application/json\r\ncontent-length: {len(BODY)}\r\n\r\n"
).encode()
FULL = Problem(OVERLOADED, "too much is waiting", retry_after_s=7)
READ = b"GET /health/live HTTP/1.1\r\nhost: here\r\n\r\n"


@contextmanager
def serve(pool: InlinePool) -> Iterator[socket.socket]:
    """Serve with a pool in this process, and connect."""
    listener = socket.create_server(("127.0.0.1", 0))
    app = create_app(Settings(), pool=pool)
    server = uvicorn.Server(uvicorn.Config(app, http=RefusingProtocol, log_config=None))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
    thread.start()
    try:
        with socket.create_connection(listener.getsockname()[:2], timeout=PATIENT_S) as connection:
            yield connection
    finally:
        server.should_exit = True
        thread.join(PATIENT_S)


@pytest.fixture
def heard(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return the paths of the requests that the app hears of."""
    paths: list[str] = []
    whole = RequestMiddleware.__call__

    async def call(self: RequestMiddleware, scope: Any, receive: Any, send: Any) -> None:
        if scope["type"] == "http":
            paths.append(scope["path"])
        await whole(self, scope, receive, send)

    monkeypatch.setattr(RequestMiddleware, "__call__", call)
    return paths


def one_answer(answers: BinaryIO) -> tuple[int, http.client.HTTPMessage, bytes]:
    """Read one answer."""
    status = int(answers.readline().split()[1])
    headers = http.client.parse_headers(answers)
    return status, headers, answers.read(int(headers["content-length"]))


def full_pool() -> InlinePool:
    pool = InlinePool()
    pool.full = FULL
    return pool


@pytest.mark.parametrize("given", ["mine", "a", "0_.-" * 16, "not taken over", "x" * 65])
def test_a_refusal_is_the_problem_that_the_app_would_send(heard: list[str], given: str) -> None:
    with serve(full_pool()) as connection:
        connection.sendall(HEAD.replace(b"mine", given.encode()) + BODY)
        status, headers, body = one_answer(connection.makefile("rb"))
    assert heard == []
    assert status == 503
    assert headers["content-type"] == "application/problem+json"
    assert headers["retry-after"] == "7"
    assert "date" in headers
    request_id = headers["x-request-id"]
    assert (request_id == given) == (len(given) < 65 and " " not in given)
    assert body.decode() == FULL.document(request_id).model_dump_json()


def test_a_refused_body_is_dropped_and_its_connection_serves_on(heard: list[str]) -> None:
    with serve(full_pool()) as connection:
        answers = connection.makefile("rb")
        connection.sendall(HEAD)
        assert one_answer(answers)[0] == 503  # before the body is sent
        connection.sendall(BODY[:10])
        connection.sendall(BODY[10:])
        connection.sendall(READ)
        assert one_answer(answers)[0] == 200
        connection.sendall(2 * (HEAD + BODY) + READ)
        assert [one_answer(answers)[0] for _ in range(3)] == [503, 503, 200]
    assert heard == ["/health/live"] * 2


def test_a_connection_that_is_not_to_be_kept_is_closed() -> None:
    with serve(full_pool()) as connection:
        connection.sendall(HEAD.replace(b"\r\n\r\n", b"\r\nconnection: close\r\n\r\n") + BODY)
        answers = connection.makefile("rb")
        status, headers, _ = one_answer(answers)
        assert (status, headers["connection"]) == (503, "close")
        assert answers.read() == b""


def test_a_pool_with_room_answers_by_the_app(heard: list[str]) -> None:
    with serve(InlinePool()) as connection:
        connection.sendall(HEAD + BODY)
        status, _, body = one_answer(connection.makefile("rb"))
    assert (status, heard) == (200, ["/v1/designs"])
    assert json.loads(body)["certificate"]["verified"]
