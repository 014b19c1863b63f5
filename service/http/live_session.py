"""A live session: events come in as they happen, states and plans go out.

The session itself is bytes that a worker has made; this event loop computes nothing. A worker looks
a little ahead, and what it has seen is sent when its time comes. An event makes it look anew.
"""

import asyncio
import contextlib
import logging
from collections import deque
from collections.abc import Callable
from typing import TypeVarTuple

from fastapi import WebSocket
from starlette.websockets import WebSocketDisconnect, WebSocketState

from service.http.bodies import BODY_WAIT_S, client_of
from service.live.session import AHEAD_S, Seen, begin, happen, look
from service.problems import TOO_LARGE, Problem, ProblemError
from service.settings import Settings
from service.workers.protocol import Pool

MAX_WAITING = 16
"""Events that wait to be taken; then the socket is read no further."""

SEND_WAIT_S = 5.0
"""A client that takes no state for so long has gone [s]."""

STOP = b'{"direction": {"x": 0, "y": 0}}'
"""What happens when the client is gone."""

NORMAL, GOING_AWAY, POLICY, TOO_BIG = 1000, 1001, 1008, 1009
"""Codes of closing (RFC 6455, section 7.4)."""

LOG = logging.getLogger("shapersmith.live")

Arguments = TypeVarTuple("Arguments")


class LiveSession:
    """One client and its crane.

    Parameters
    ----------
    socket
        Accepted.
    request_id
        Stands in problems and in the log.
    """

    def __init__(self, socket: WebSocket, request_id: str) -> None:
        self._socket = socket
        self._request_id = request_id
        self._settings: Settings = socket.app.state.settings
        self._pool: Pool = socket.app.state.pool
        self._loop = asyncio.get_running_loop()
        self._arrived: asyncio.Queue[tuple[float, bytes] | None] = asyncio.Queue(MAX_WAITING)
        self._frames: deque[tuple[float, bytes]] = deque()
        self._session = b""
        self._moving = False
        self._seen_s = self._began_s = self._last_event_s = 0.0

    async def drive(self) -> None:
        """Drive the crane until its client goes or is quiet, or the service ends."""
        reading = self._loop.create_task(self._read())
        try:
            if not await self._begin():
                return
            why = await self._go_on()
            await self._stop(why)
        finally:
            reading.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await reading

    async def _begin(self) -> bool:
        """Take the first message; return whether it is one."""
        try:
            async with asyncio.timeout(BODY_WAIT_S):
                first = await self._arrived.get()
        except TimeoutError:
            await self._close(POLICY, f"no first message within {BODY_WAIT_S:g} s")
            return False
        if first is None:
            return False
        seen = await self._work(begin, first[1])
        if isinstance(seen, Problem):
            await self._send(_problem(seen, self._request_id))
            code = TOO_BIG if seen.kind is TOO_LARGE else POLICY
            await self._close(code, "the first message was refused")
            return False
        self._began_s = self._last_event_s = self._loop.time()
        await self._take(seen)
        return True

    async def _go_on(self) -> str:
        """Send states and take events; return why that ended."""
        while True:
            if self._socket.app.state.stopping():
                return "the service ends"
            if self._loop.time() - self._last_event_s > self._settings.live_idle_s:
                return f"no event for {self._settings.live_idle_s:g} s"
            if self._seen_s - self._now_s < AHEAD_S / 2:
                seen = await self._work(look, self._session, self._seen_s + AHEAD_S)
                if isinstance(seen, Problem):
                    await self._send(_problem(seen, self._request_id))
                    return "the crane could not go on"
                await self._take(seen)
            wait = (self._frames[0][0] if self._frames else self._seen_s) - self._now_s
            try:
                async with asyncio.timeout(max(wait, 0.0)):
                    arrived = await self._arrived.get()
            except TimeoutError:
                if not await self._send_due():
                    return "the client is gone"
                continue
            if arrived is None:
                return "the client is gone"
            self._last_event_s = self._loop.time()
            await self._happen(arrived)

    async def _happen(self, arrived: tuple[float, bytes]) -> None:
        at_s = max(arrived[0] - self._began_s, 0.0)
        seen = await self._work(happen, self._session, at_s, arrived[1])
        if isinstance(seen, Problem):
            await self._send(_problem(seen, self._request_id))
            return
        self._frames.clear()
        await self._take(seen)

    async def _stop(self, why: str) -> None:
        """End in rest: whoever was driving is not there to let go."""
        seen = await self._work(happen, self._session, self._now_s, STOP) if self._moving else None
        fields: dict[str, object] = {"request_id": self._request_id, "why": why}
        if isinstance(seen, Problem):
            fields["stopped"] = seen.detail
        elif seen is not None:
            how = "without swing" if seen.proven else "let go"
            fields["stopped"] = f"{how}, last switch {seen.last_switch_s:.6g} s"
            await self._take(seen)
        LOG.info("live session ended", extra={"fields": fields})
        code = GOING_AWAY if why == "the service ends" else NORMAL
        await self._close(code, why)

    async def _work(
        self, task: Callable[[*Arguments], Seen | Problem], *arguments: *Arguments
    ) -> Seen | Problem:
        try:
            return await self._pool.run(task, *arguments, client=client_of(self._socket.scope))
        except ProblemError as error:
            return error.problem

    async def _take(self, seen: Seen) -> None:
        """Go on from what a worker has seen, and send what it says."""
        self._session, self._moving, self._seen_s = seen.session, seen.moving, seen.until_s
        self._frames.extend(seen.states)
        for message in seen.messages:
            await self._send(message)

    async def _send_due(self) -> bool:
        """Send the last state that is due; return whether the client took it."""
        due = b""
        while self._frames and self._frames[0][0] <= self._now_s:
            due = self._frames.popleft()[1]
        return not due or await self._send(due)

    async def _send(self, message: bytes) -> bool:
        if self._socket.client_state is not WebSocketState.CONNECTED:
            return False
        try:
            async with asyncio.timeout(SEND_WAIT_S):
                await self._socket.send_text(message.decode())
        except (TimeoutError, WebSocketDisconnect):
            return False
        return True

    async def _close(self, code: int, why: str) -> None:
        if self._socket.client_state is WebSocketState.CONNECTED:
            with contextlib.suppress(WebSocketDisconnect):
                await self._socket.close(code, why)

    async def _read(self) -> None:
        """Take messages in as they come, each with its time."""
        while True:
            message = await self._socket.receive()
            if message["type"] == "websocket.disconnect":
                await self._arrived.put(None)
                return
            text, data = message.get("text"), message.get("bytes")
            body = data or b"" if text is None else text.encode()
            await self._arrived.put((self._loop.time(), body))

    @property
    def _now_s(self) -> float:
        """Time since the session began [s]."""
        return self._loop.time() - self._began_s


def _problem(problem: Problem, request_id: str) -> bytes:
    document = problem.document(request_id).model_dump_json()
    return b'{"problem": ' + document.encode() + b"}"
