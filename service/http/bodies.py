"""Bodies in, answers out: what all routes share."""

import asyncio
import functools
import ipaddress
from collections.abc import Awaitable
from types import TracebackType
from typing import Self, TypeVar

from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response
from starlette.types import Scope

from service.dispatch import Answer
from service.http.handlers import problem_response
from service.problems import (
    REQUEST_TIMEOUT,
    TOO_LARGE,
    UNSUPPORTED_MEDIA_TYPE,
    Problem,
    ProblemError,
)

BODY_WAIT_S = 20.0
"""Longest wait for a body [s]."""


async def read_body(request: Request, *, limit_bytes: int, media_types: tuple[str, ...]) -> bytes:
    """Return the body, read no further than its limit.

    Parameters
    ----------
    request, limit_bytes, media_types
        The request, its longest body [bytes], and values of ``content-type``, the usual one first.

    Returns
    -------
    bytes
        The whole body.

    Raises
    ------
    ProblemError
        If it is longer or late, or its ``content-type`` is not accepted.
    ClientDisconnect
        If the client is gone before the body is whole.
    """
    media_type = request.headers.get("content-type", media_types[0]).split(";")[0].strip().lower()
    if media_type not in media_types:
        accepted = " or ".join(media_types)
        raise ProblemError(
            Problem(UNSUPPORTED_MEDIA_TYPE, f"content-type must be {accepted}, got {media_type!r}")
        )
    body = bytearray()
    try:
        async with asyncio.timeout(BODY_WAIT_S):
            async for part in request.stream():
                body += part
                if len(body) > limit_bytes:
                    detail = f"the body must be at most {limit_bytes} bytes"
                    raise ProblemError(Problem(TOO_LARGE, detail))
    except TimeoutError:
        detail = f"the body did not arrive within {BODY_WAIT_S:g} s"
        raise ProblemError(Problem(REQUEST_TIMEOUT, detail)) from None
    return bytes(body)


def answer_response(answer: Answer, request_id: str | None) -> Response:
    """Return an answer as the response.

    Parameters
    ----------
    answer, request_id
        The response of an operation, or a problem; id of the request, which a problem repeats.

    Returns
    -------
    Response
        JSON, with the time of the work in the ``Server-Timing`` header [ms].
    """
    if isinstance(answer.outcome, Problem):
        response = problem_response(answer.outcome, request_id)
    else:
        response = Response(answer.outcome, media_type="application/json")
    response.headers["server-timing"] = f"work;dur={1e3 * answer.seconds:.3f}"
    return response


WATCHED_AFTER_S = 0.25
"""Work that takes longer is worth a look at whether its client is still there [s]."""

Answered = TypeVar("Answered")


def client_of(scope: Scope | Request) -> str:
    """Return whose request it is, for a fair share.

    It is the client's address, of IPv6 its network (/64): one machine has as many addresses of such
    a network as it likes. Empty where the address is not known.
    """
    client = scope["client"]
    return "" if client is None else _share_of(client[0])


@functools.lru_cache(maxsize=1024)
def _share_of(host: str) -> str:
    if ":" not in host:
        return host
    try:
        return str(ipaddress.IPv6Network((host.partition("%")[0], 64), strict=False))
    except ValueError:
        return host  # a proxy's own name for it


async def while_connected(request: Request, work: Awaitable[Answered]) -> Answered:
    """Return the result of work, which ends when the client is gone.

    Parameters
    ----------
    request, work
        The request, whose body has been read; work that is cancelled when the client is gone.

    Returns
    -------
    Answered
        Its result; ClientDisconnect is raised where the client has gone.
    """
    async with _Connection(request):
        return await work


class _Connection:
    """Cancels the task that has entered it when the client is gone; as `asyncio.timeout` does."""

    def __init__(self, request: Request) -> None:
        self._request = request
        self._left = False
        self._watcher: asyncio.Task[None] | None = None

    async def __aenter__(self) -> Self:
        self._task = asyncio.current_task()
        self._timer = asyncio.get_running_loop().call_later(WATCHED_AFTER_S, self._begin)
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._timer.cancel()
        if self._watcher is not None:
            self._watcher.cancel()
        if self._left and self._task is not None:
            self._task.uncancel()
            if kind is asyncio.CancelledError:
                raise ClientDisconnect from error

    def _begin(self) -> None:
        self._watcher = asyncio.get_running_loop().create_task(self._watch())

    async def _watch(self) -> None:
        while (await self._request.receive())["type"] != "http.disconnect":
            continue
        self._left = True
        if self._task is not None:
            self._task.cancel()
