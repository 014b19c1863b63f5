"""HTTP/1.1 on bare sockets: a client must cost little beside what it measures."""

import asyncio
import re
import time
from dataclasses import dataclass

LENGTH = re.compile(rb"\r\ncontent-length: *(\d+)", re.IGNORECASE)
END_OF_HEAD = b"\r\n\r\n"

MAX_IDLE_S = 2.0
"""A connection that was idle for longer is not used again: the server closes it at 5 s [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What came back, and when its request was written to the socket [s]."""

    status: int
    sent_s: float
    head: bytes = b""
    body: bytes = b""

    @property
    def told_to_retry(self) -> bool:
        """Whether it says when to come again."""
        return b"\r\nretry-after:" in self.head.lower()


def message(method: str, path: str, body: bytes = b"") -> bytes:
    """Return a request as it goes over the wire.

    All have one id: equal requests get equal bytes then, of problems too, which name it.
    """
    head = f"{method} {path} HTTP/1.1\r\nhost: bench\r\nx-request-id: bench\r\n"
    if body:
        head += f"content-type: application/json\r\ncontent-length: {len(body)}\r\n"
    return head.encode() + b"\r\n" + body


class _Reader(asyncio.Protocol):
    """Reads answers that name their length, one at a time."""

    def __init__(self) -> None:
        self.told: asyncio.Future[bytes] = asyncio.get_running_loop().create_future()
        self.head = b""
        self._read = bytearray()
        self._size = -1

    def next(self) -> "asyncio.Future[bytes]":
        """Return the body to come; its head stands in ``head`` by then."""
        self.told = asyncio.get_running_loop().create_future()
        self._size = -1
        return self.told

    def data_received(self, data: bytes) -> None:
        """Read on."""
        self._read += data
        if self._size < 0:
            end = self._read.find(END_OF_HEAD)
            if end < 0:
                return
            self.head = bytes(self._read[:end])
            length = LENGTH.search(self.head)
            self._size = 0 if length is None else int(length[1])
            del self._read[: end + len(END_OF_HEAD)]
        if len(self._read) >= self._size and not self.told.done():
            body = bytes(self._read)
            self._read.clear()
            self.told.set_result(body)

    def connection_lost(self, error: Exception | None) -> None:
        """Tell who waits."""
        if not self.told.done():
            self.told.set_exception(ConnectionError(f"the connection was lost: {error}"))
            self.told.exception()  # who has left meanwhile need not hear it


class Client:
    """Keep-alive connections to a port: as many as there are requests under way.

    Parameters
    ----------
    port
        On the loopback.
    source
        Address that it comes from, in 127.0.0.0/8.
    """

    def __init__(self, port: int, source: str = "127.0.0.1") -> None:
        self._port = port
        self._source = source
        self._idle: list[tuple[asyncio.Transport, _Reader, float]] = []
        self._busy: set[asyncio.Transport] = set()

    async def ask(self, message: bytes) -> Answer:
        """Send a request and return its answer.

        Raises
        ------
        OSError
            If there is no connection, or it is lost before the answer.
        """
        transport, reader = await self._connection()
        self._busy.add(transport)
        answered = False
        try:
            told = reader.next()
            sent_s = time.perf_counter()
            transport.write(message)
            body = await told
            answered = b"connection: close" not in reader.head.lower()
        finally:
            # One that was given up would hand its late answer to the next request.
            self._busy.discard(transport)
            if answered:
                self._idle.append((transport, reader, time.perf_counter()))
            else:
                transport.abort()
        return Answer(status=int(reader.head[9:12]), sent_s=sent_s, head=reader.head, body=body)

    async def _connection(self) -> tuple[asyncio.Transport, _Reader]:
        while self._idle:
            transport, reader, since_s = self._idle.pop()
            if not transport.is_closing() and time.perf_counter() - since_s < MAX_IDLE_S:
                return transport, reader
            transport.abort()
        return await asyncio.get_running_loop().create_connection(
            _Reader, "127.0.0.1", self._port, local_addr=(self._source, 0)
        )

    def close(self) -> None:
        """Close all connections at once, under whatever waits for an answer too."""
        for transport in [*self._busy, *(transport for transport, _, _ in self._idle)]:
            transport.abort()
