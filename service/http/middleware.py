"""Around every request: an id, one log line, and errors as problem documents."""

import logging
import random
import re
import time

from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.http.bodies import client_of
from service.http.handlers import send_problem
from service.operations.table import TABLE
from service.problems import INTERNAL, Problem
from service.workers.protocol import Pool

REQUEST_ID = re.compile(rb"[A-Za-z0-9._-]{1,64}\Z")
"""Ids of clients that are taken over; others are replaced."""

PATHS = {row.path for row in TABLE.values()}
"""Paths whose requests a worker answers, most of them small."""

CLIENT_CLOSED_REQUEST = 499
"""Logged, as nginx does, for a client that left before its body was here."""

ACCESS = logging.getLogger("shapersmith.access")
ERRORS = logging.getLogger("shapersmith.error")


def request_id_of(scope: Scope) -> str:
    """Return the id that the client gave its request, or a new one."""
    given: bytes = dict(scope["headers"]).get(b"x-request-id", b"")
    if REQUEST_ID.match(given):
        return given.decode()
    return f"{random.getrandbits(128):032x}"  # no secret, so that it may be quick


def refusal_of(scope: Scope, pool: Pool) -> Problem | None:
    """Return why a request is refused before its body is read.

    Routes would refuse it after that. Under an overload refusals are most of what there is to do.

    Parameters
    ----------
    scope, pool
        The request, as ASGI has it, and those who would answer it.

    Returns
    -------
    Problem or None
        None where the request is not refused, or is none that a worker answers.
    """
    if scope["method"] != "POST" or scope["path"] not in PATHS:
        return None
    return pool.refusal(client_of(scope))


def log_request(scope: Scope, request_id: str, status: int, started_s: float) -> None:
    """Write the line of one request.

    Parameters
    ----------
    scope, request_id, status, started_s
        The request, its id, the status of its answer, and when it began by `time.perf_counter` [s].
    """
    ACCESS.info(
        "request",
        extra={
            "fields": {
                "request_id": request_id,
                "method": scope["method"],
                "path": scope["path"],
                "status": status,
                "duration_ms": round(1e3 * (time.perf_counter() - started_s), 3),
            }
        },
    )


class RequestMiddleware:
    """Gives each request an id, logs it in one line, and turns a crash into a problem document."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        started = time.perf_counter()
        request_id = request_id_of(scope)
        scope.setdefault("state", {})["request_id"] = request_id
        status = 0

        async def send_with_id(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                message["headers"] = [*message["headers"], (b"x-request-id", request_id.encode())]
            await send(message)

        try:
            problem = refusal_of(scope, scope["app"].state.pool)
            if problem is not None:
                await send_problem(problem, request_id, send_with_id)
            else:
                await self._app(scope, receive, send_with_id)
        except ClientDisconnect:
            status = CLIENT_CLOSED_REQUEST
        except Exception:  # noqa: BLE001 - the last resort, logged with its traceback
            ERRORS.exception("request failed", extra={"fields": {"request_id": request_id}})
            if status == 0:
                await send_problem(
                    Problem(INTERNAL, "the service failed; its log has the reason"),
                    request_id,
                    send_with_id,
                )
        finally:
            log_request(scope, request_id, status, started)
