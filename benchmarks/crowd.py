"""Many clients in one process, which cost little beside what they measure: no task a request."""

import asyncio
import gc
import itertools
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import cast

from benchmarks.loops import MAX_WAIT_S, NO_ANSWER, Outcome
from benchmarks.wire import END_OF_HEAD, LENGTH, MAX_IDLE_S

RETRY = b"\r\nretry-after:"
CLOSES = b"\r\nconnection: close"

TICK_S = 0.002
"""How long requests are gathered before they are sent: each wait costs as much as one of them."""


class Crowd:
    """Clients of one port that all send from the same requests, one after the other.

    Parameters
    ----------
    port
        On the loopback.
    requests
        As they go over the wire.
    """

    def __init__(self, port: int, requests: Iterator[bytes]) -> None:
        self._port = port
        self._requests = requests
        self._idle: list[_Connection] = []
        self._connecting: set[asyncio.Task[None]] = set()
        self._again = 0.0
        self._under_way = 0
        self.told: list[Outcome] = []

    async def closed_loop(self, *, clients: int, seconds: float) -> list[Outcome]:
        """Let each client ask once more when it is answered; return what became of all."""
        with self._collect() as told:
            self._again = time.perf_counter() + seconds
            for _ in range(clients):
                self._ask(time.perf_counter(), next(self._requests))
            await self._wait_for_all(seconds)
        return told

    async def open_loop(self, *, rate_hz: float, seconds: float) -> list[Outcome]:
        """Ask at even spacing, whether answers come or not; return what became of all.

        What is planned within a tick is sent at its end, and counts as late by that.
        """
        count = max(round(rate_hz * seconds), 1)
        requests = list(itertools.islice(self._requests, count))
        with self._collect() as told:
            start = time.perf_counter()
            for number, request in enumerate(requests):
                planned_s = start + number / rate_hz
                wait_s = planned_s - time.perf_counter()
                if wait_s > 0:
                    await asyncio.sleep(max(wait_s, TICK_S))
                self._ask(planned_s, request)
            await self._wait_for_all(0.0)
        return told

    def close(self) -> None:
        """Leave."""
        for one in self._idle:
            one.abort()
        self._idle.clear()

    @contextmanager
    def _collect(self) -> Iterator[list[Outcome]]:
        """Collect outcomes meanwhile, and no garbage."""
        self.told, self._again = [], 0.0
        gc.collect()
        gc.disable()
        try:
            yield self.told
        finally:
            gc.enable()

    async def _wait_for_all(self, seconds: float) -> None:
        """Wait for what is under way.

        Raises
        ------
        TimeoutError
            If some is not answered long after.
        """
        deadline = time.perf_counter() + seconds + MAX_WAIT_S
        while self._under_way:
            if time.perf_counter() > deadline:
                raise TimeoutError(f"{self._under_way} requests are not answered")
            await asyncio.sleep(0.005)

    def _ask(self, planned_s: float, request: bytes) -> None:
        self._under_way += 1
        now = time.perf_counter()
        while self._idle:
            connection = self._idle.pop()
            if connection.is_fresh(now):
                connection.send(planned_s, request)
                return
            connection.abort()
        task = asyncio.get_running_loop().create_task(self._connect(planned_s, request))
        self._connecting.add(task)
        task.add_done_callback(self._connecting.discard)

    async def _connect(self, planned_s: float, request: bytes) -> None:
        loop = asyncio.get_running_loop()
        try:
            _, connection = await loop.create_connection(
                lambda: _Connection(self), "127.0.0.1", self._port
            )
        except OSError:
            self.take_outcome(NO_ANSWER, planned_s, planned_s, told_to_retry=False)
            return
        connection.send(planned_s, request)

    def take_outcome(
        self, status: int, planned_s: float, sent_s: float, *, told_to_retry: bool
    ) -> None:
        """Take what became of a request, and ask once more in a closed loop."""
        now = time.perf_counter()
        self._under_way -= 1
        self.told.append(
            Outcome(
                status=status,
                told_to_retry=told_to_retry,
                planned_s=planned_s,
                sent_s=sent_s,
                done_s=now,
            )
        )
        if now < self._again:
            self._ask(now, next(self._requests))

    def rests(self, connection: "_Connection") -> None:
        """Keep a connection for the next request."""
        self._idle.append(connection)


class _Connection(asyncio.Protocol):
    """A keep-alive connection: one request at a time."""

    def __init__(self, crowd: Crowd) -> None:
        self._crowd = crowd
        self._transport: asyncio.Transport | None = None
        self._read = b""
        self._size = -1
        self._planned_s = self._sent_s = self._since_s = 0.0
        self._busy = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin."""
        self._transport = cast(asyncio.Transport, transport)  # uvloop's are no subclass of it

    def is_fresh(self, now: float) -> bool:
        """Whether the server keeps it open for another request."""
        transport = self._transport
        open_yet = transport is not None and not transport.is_closing()
        return open_yet and now - self._since_s < MAX_IDLE_S

    def send(self, planned_s: float, request: bytes) -> None:
        """Send a request."""
        self._busy, self._read, self._size = True, b"", -1
        self._planned_s, self._sent_s = planned_s, time.perf_counter()
        if self._transport is not None:
            self._transport.write(request)

    def abort(self) -> None:
        """Close it at once."""
        if self._transport is not None:
            self._transport.abort()

    def data_received(self, data: bytes) -> None:
        """Read on; an answer names its length."""
        self._read = read = self._read + data if self._read else data
        if self._size < 0:
            end = read.find(END_OF_HEAD)
            if end < 0:
                return
            length = LENGTH.search(read, 0, end + 2)
            self._size = end + len(END_OF_HEAD) + (0 if length is None else int(length[1]))
        if len(read) < self._size or not self._busy:
            return
        self._busy = False
        self._since_s = time.perf_counter()
        head = read[: read.find(END_OF_HEAD)].lower()
        if CLOSES in head:
            self.abort()
        else:
            self._crowd.rests(self)
        self._crowd.take_outcome(
            int(read[9:12]), self._planned_s, self._sent_s, told_to_retry=RETRY in head
        )

    def connection_lost(self, error: Exception | None) -> None:  # noqa: ARG002
        """Say that a request is not answered, if one is under way."""
        if self._busy:
            self._busy = False
            self._crowd.take_outcome(NO_ANSWER, self._planned_s, self._sent_s, told_to_retry=False)
