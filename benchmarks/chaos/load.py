"""A light load whose every answer is held against that of an undisturbed service."""

import asyncio
import itertools
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from benchmarks.chaos.requests import slow_body
from benchmarks.http import request_body
from benchmarks.loops import NO_ANSWER, Outcome, open_loop, outcome
from benchmarks.wire import Answer, Client, message

DESIGNS = 8
RATE_HZ = 4.0


class Load:
    """A few designs a second, and slow ones."""

    def __init__(self, port: int) -> None:
        self._client = Client(port)
        self._small = [message("POST", "/v1/designs", request_body(n)) for n in range(DESIGNS)]
        self._next = itertools.cycle(self._small)
        self._slow = message("POST", "/v1/designs", slow_body(0))
        self._undisturbed: dict[bytes, Answer] = {}
        self._outcomes: list[Outcome] = []
        self._stopping = False
        self.wrong: list[Answer] = []

    async def learn(self) -> None:
        """Ask for each while nothing is disturbed."""
        for one in (*self._small, self._slow):
            self._undisturbed[one] = await self._client.ask(one)

    async def slow(self) -> None:
        """Ask for a slow design."""
        now = time.perf_counter()
        self._outcomes.append(await outcome(lambda: self._ask_and_check(self._slow), now))

    @asynccontextmanager
    async def small_ones(self) -> AsyncIterator[None]:
        """Ask for a few designs a second meanwhile."""
        async with asyncio.TaskGroup() as under_way:
            under_way.create_task(self._small_ones())
            try:
                yield
            finally:
                self._stopping = True

    def close(self) -> None:
        """Leave."""
        self._client.close()

    async def _small_ones(self) -> None:
        while not self._stopping:
            self._outcomes += await open_loop(
                lambda: self._ask_and_check(next(self._next)), rate_hz=RATE_HZ, seconds=1.0
            )

    async def _ask_and_check(self, asked: bytes) -> Answer:
        answer = await self._client.ask(asked)
        expected = self._undisturbed[asked]
        if answer.status == expected.status and answer.body != expected.body:
            self.wrong.append(answer)
        return answer

    @property
    def failed(self) -> list[int]:
        """The statuses that no client may see, NO_ANSWER among them."""
        return [one.status for one in self._outcomes if one.status in {500, NO_ANSWER}]

    def describe_statuses(self) -> str:
        """Return how many answers had which status."""
        statuses = sorted(one.status for one in self._outcomes)
        counts = (f"{len(list(same))} {status}" for status, same in itertools.groupby(statuses))
        return ", ".join(counts)
