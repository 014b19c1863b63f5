"""Clients: whose request it is, and whether whoever asked is still there."""

import asyncio
import functools
import ipaddress
from collections.abc import Awaitable
from types import TracebackType
from typing import Self, TypeVar

from starlette.requests import ClientDisconnect, Request
from starlette.types import Scope

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
        Its result.

    Raises
    ------
    ClientDisconnect
        If the client has left.
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
