"""What the parts share: how long they take, the service they are done to, how it is told."""

import asyncio
import itertools
import tempfile
import time
from collections.abc import Callable, Iterator, Sized
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.http import request_body
from benchmarks.loops import Ask
from benchmarks.measure import Figure
from benchmarks.wire import Client, message
from tests.conftest import Running, running_service
from tests.processes import workers

WORKERS = 3
"""Of a service, where nothing else is said: the usual number on two processors."""

HUNG_S = 120.0
"""After which what is waited for counts as never coming [s]."""

LOOK_S = 0.25
"""Between two looks at what processes have used [s]."""

IDLE_S = 0.12 * LOOK_S
"""Who uses more between two looks is at a long design, or builds its solvers [s]."""


class HungError(Exception):
    """What was waited for did not come."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """How long and how often; ``seconds`` is None where it is as the promise says [s]."""

    seconds: float | None
    times: int

    def span_s(self, seconds: float) -> float:
        """Return how long to do what the promise says is done for so long [s]."""
        return seconds if self.seconds is None else min(seconds, self.seconds)


@contextmanager
def folder() -> Iterator[Path]:
    """Return a folder for the time being."""
    with tempfile.TemporaryDirectory(
        prefix="shapersmith-chaos-", ignore_cleanup_errors=True
    ) as name:
        yield Path(name)


@contextmanager
def serve(place: Path, *, workers: int = WORKERS, **settings: Any) -> Iterator[Running]:  # noqa: ANN401
    """Serve, all workers ready, until done with; the end is sudden."""
    with running_service(place / "log", workers=workers, **settings) as service:
        try:
            asyncio.run(settle(service, workers))
            yield service
        finally:
            service.process.kill()


async def settle(service: Running, count: int) -> dict[int, float]:
    """Wait until there are so many workers, all started, and none at work.

    Returns
    -------
    dict
        The processor time that each has used, by its id [s].

    Raises
    ------
    HungError
        If that never is.
    """
    before = workers(service)
    start = time.perf_counter()
    while True:
        await asyncio.sleep(LOOK_S)
        now = workers(service)
        at_work = [pid for pid, used in now.items() if used - before.get(pid, 0.0) > IDLE_S]
        if len(now) >= count and now.keys() <= before.keys() and not at_work:
            return now
        if time.perf_counter() - start > HUNG_S:
            raise HungError(f"{len(now)} of {count} workers, {len(at_work)} at work")
        before = now


async def until(found: Callable[[], object], what: str, *, hung_s: float = HUNG_S) -> float:
    """Wait until something is so; return how long that took [s].

    Raises
    ------
    HungError
        If it is not in time.
    """
    start = time.perf_counter()
    while not found():
        if time.perf_counter() - start > hung_s:
            raise HungError(what)
        await asyncio.sleep(0.02)
    return time.perf_counter() - start


def request_bodies() -> Iterator[bytes]:
    """Yield small designs, all different."""
    return map(request_body, itertools.count())


def designs(client: Client) -> Ask:
    """Return what asks for small designs, all different."""
    bodies = request_bodies()
    return lambda: client.ask(message("POST", "/v1/designs", next(bodies)))


def at_most(what: str, value: float, limit: float, unit: str = "", told: str = "") -> Figure:
    """Return a figure that must not be above its limit; ``told`` stands beside it."""
    return _figure(what, value, f"<= {limit:g} {unit}", unit, told, met=value <= limit)


def at_least(what: str, value: float, limit: float, unit: str = "", told: str = "") -> Figure:
    """Return a figure that must not be below its limit; ``told`` stands beside it."""
    return _figure(what, value, f">= {limit:g} {unit}", unit, told, met=value >= limit)


def none_of(what: str, found: Sized, told: str = "") -> Figure:
    """Return the number of what there must not be."""
    return at_most(what, len(found), 0, told=told)


def _figure(what: str, value: float, limit: str, unit: str, told: str, *, met: bool) -> Figure:
    text = f"{value:.4g} {unit}".strip() + (f"; {told}" if told else "")
    return Figure(what=what, value=text, limit=limit.strip(), met=met)
