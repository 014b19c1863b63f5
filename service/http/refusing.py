"""Refusals under an overload, written as soon as the head of a request is there.

Most requests of an overload are refused, and what a refusal costs is taken from those that are
served. The app refuses as well: this only spares it the task, the messages and the encoding.
"""

import functools
import time
from typing import cast

from fastapi import FastAPI
from starlette.types import Scope
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol, RequestResponseCycle

from service.http.middleware import log_request, refusal_of, request_id_of
from service.problems import Problem
from service.workers.protocol import Pool

PLACE = "{request_id}"
"""Stands for the id of a request, and in no document else."""


class RefusingProtocol(HttpToolsProtocol):
    """HTTP/1.1 by uvicorn, without the app where the pool refuses at once."""

    def _start_asgi_task(self, cycle: RequestResponseCycle, app: object) -> None:
        """Start the app for a request, or answer it here."""
        started = time.perf_counter()
        scope = cast(Scope, cycle.scope)
        problem = refusal_of(scope, self._pool)
        if problem is None:
            super()._start_asgi_task(cycle, app)  # type: ignore[arg-type]
            return
        request_id = request_id_of(scope)
        # What is yet to come of the body is dropped.
        cycle.response_started = cycle.response_complete = True
        self.transport.write(self._encode(problem, request_id, keep_alive=cycle.keep_alive))
        log_request(scope, request_id, problem.kind.http.value, started)
        if not cycle.keep_alive:
            self.transport.close()
        self.on_response_complete()

    @property
    def _pool(self) -> Pool:
        """Those who would answer."""
        pool: Pool = cast(FastAPI, self.config.app).state.pool
        return pool

    def _encode(self, problem: Problem, request_id: str, *, keep_alive: bool) -> bytes:
        """Return a problem as it goes over the wire."""
        status, before, after = _parts(problem)
        request = request_id.encode()
        head = [status, *(b"%b: %b" % row for row in self.server_state.default_headers)]
        head += [
            b"content-length: %d" % (len(before) + len(request) + len(after)),
            b"x-request-id: " + request,
        ]
        if not keep_alive:
            head.append(b"connection: close")
        return b"\r\n".join([*head, b"", before]) + request + after


@functools.lru_cache(maxsize=256)
def _parts(problem: Problem) -> tuple[bytes, bytes, bytes]:
    """Return the first lines of a refusal, and its document before and after the request's id.

    An id has no character that JSON would write otherwise. Refusals of an overload are many and of
    few kinds.
    """
    before, after = problem.document(PLACE).model_dump_json().encode().split(PLACE.encode())
    status = problem.kind.http
    head = [
        f"HTTP/1.1 {status.value} {status.phrase}",
        "content-type: application/problem+json",
        *(f"{name}: {value}" for name, value in problem.headers.items()),
    ]
    return "\r\n".join(head).encode(), before, after
