"""How a service is driven: callers that wait for their answers, and a clock that does not."""

import asyncio
import time
from collections.abc import Awaitable, Callable, Iterable
from dataclasses import dataclass

import numpy as np

from benchmarks.wire import Answer

Ask = Callable[[], Awaitable[Answer]]
"""Sends a request; as often as it is called, another if it is to be."""

NO_ANSWER = 0
"""In place of a status, where the connection was lost or the wait too long."""

MAX_WAIT_S = 120.0
"""After which a request counts as not answered [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What became of one request: its status, and when it was to be sent, was, and ended [s]."""

    status: int
    told_to_retry: bool
    planned_s: float
    sent_s: float
    done_s: float


async def outcome(ask: Ask, planned_s: float) -> Outcome:
    """Send one request and tell what became of it."""
    answer = Answer(status=NO_ANSWER, sent_s=planned_s)
    try:
        async with asyncio.timeout(MAX_WAIT_S):
            answer = await ask()
    except (OSError, TimeoutError):
        pass  # told by its status
    return Outcome(
        status=answer.status,
        told_to_retry=answer.told_to_retry,
        planned_s=planned_s,
        sent_s=answer.sent_s,
        done_s=time.perf_counter(),
    )


async def closed_loop(ask: Ask, *, callers: int, seconds: float) -> list[list[Outcome]]:
    """Let callers ask, each once more when it is answered; return what became of each's requests.

    A request of the last moment that is answered after the end is told too.
    """
    end = time.perf_counter() + seconds

    async def caller() -> list[Outcome]:
        told = []
        while (now := time.perf_counter()) < end:
            told.append(await outcome(ask, now))
        return told

    return await asyncio.gather(*(caller() for _ in range(callers)))


async def open_loop(ask: Ask, *, rate_hz: float, seconds: float) -> list[Outcome]:
    """Ask at even spacing, whether answers come or not; return what became of all."""
    start = time.perf_counter()
    told: list[Outcome] = []

    async def one(planned_s: float) -> None:
        told.append(await outcome(ask, planned_s))

    async with asyncio.TaskGroup() as under_way:
        for number in range(max(round(rate_hz * seconds), 1)):
            planned_s = start + number / rate_hz
            await asyncio.sleep(max(planned_s - time.perf_counter(), 0.0))
            under_way.create_task(one(planned_s))
    return told


def with_status(outcomes: Iterable[Outcome], status: int) -> list[Outcome]:
    """Return those that were answered so."""
    return [one for one in outcomes if one.status == status]


class Latencies:
    """How long answers took [ms]; infinitely long where there are none."""

    def __init__(self, milliseconds: list[float]) -> None:
        self._ms = milliseconds or [np.inf]

    def percentile(self, percent: float) -> float:
        """Return the time within which so many per cent were answered [ms]."""
        return float(np.percentile(self._ms, percent, method="higher"))

    def __str__(self) -> str:
        """Return median, 99 % and largest."""
        p50, p99, most = (self.percentile(percent) for percent in (50, 99, 100))
        return f"p50 {p50:.1f}, p99 {p99:.1f}, max {most:.1f} ms"


def latencies(outcomes: Iterable[Outcome], *, planned: bool = True) -> Latencies:
    """Return how long answers took since they were planned, or since they were sent."""
    return Latencies([
        1e3 * (one.done_s - (one.planned_s if planned else one.sent_s)) for one in outcomes
    ])
