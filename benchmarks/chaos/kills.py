"""Workers, and the process that forks them, are killed; a light load of clients sees nothing."""

import asyncio
import os
import signal
from collections.abc import Awaitable, Callable, Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import uvloop

from benchmarks.chaos.load import Load
from benchmarks.chaos.trial import (
    WORKERS,
    HungError,
    Trial,
    at_most,
    folder,
    none_of,
    serve,
    settle,
    until,
)
from benchmarks.measure import Figure
from tests.conftest import Running
from tests.processes import of_service, workers

FULL_WITHIN_S = 5.0

SOLVING_S = 0.15
"""Who has used so much since a slow design was asked for is at it [s]."""

ASKED_S = 1.0
"""Within this a fork server has been asked for a worker in place of one that was killed [s]."""

END_WAIT_S = 60.0
"""What may pass between SIGTERM and the end [s]."""

Kill = Callable[[Running, int, set[int], int], Awaitable[float]]
"""Is told which worker is at a slow design, which are not, and how many kills were before; kills,
and returns how long it took until as many workers lived as before [s]."""


async def _solving(service: Running, solving: int, idle: set[int], number: int) -> float:
    """Kill the worker that is at the slow design, which another takes over."""
    del idle, number
    return await _full_without(service, solving, solving)


async def _starting(service: Running, solving: int, idle: set[int], number: int) -> float:
    """Kill a worker, and the one that takes its place as soon as it is seen."""
    del number
    os.kill(min(idle), signal.SIGKILL)

    def new() -> set[int]:
        return workers(service).keys() - idle - {solving}

    await until(new, "a worker is started in place of one that was killed")
    return await _full_without(service, min(new()), solving)


async def _idle(service: Running, solving: int, idle: set[int], number: int) -> float:
    """Kill a worker that has nothing to do."""
    del number
    return await _full_without(service, min(idle), solving)


async def _fork_server(service: Running, solving: int, idle: set[int], number: int) -> float:
    """Kill what forks the workers: before it is needed, or in the middle of starting one."""
    forking = _forking(service)
    if number % 2:
        os.kill(forking, signal.SIGSTOP)
        os.kill(min(idle), signal.SIGKILL)
        await asyncio.sleep(ASKED_S)
    os.kill(forking, signal.SIGKILL)
    return await _full_without(service, min(idle), solving)


def _forking(service: Running) -> int:
    """Return the process that forks the workers: a child of the service's that says so."""
    for pid, one in of_service(service).items():
        if one.parent == service.process.pid:
            with suppress(FileNotFoundError):
                if b"forkserver" in Path(f"/proc/{pid}/cmdline").read_bytes():
                    return pid
    raise HungError("no process of the service forks its workers")


async def _full_without(service: Running, victim: int, solving: int) -> float:
    """Kill a worker, if it lives; return how long it takes until the pool is full without it.

    The one at the slow design is one more, until it is done.
    """
    with suppress(ProcessLookupError):
        os.kill(victim, signal.SIGKILL)

    def full() -> bool:
        others = workers(service).keys() - {victim}
        return len(others) >= WORKERS + (solving in others)

    return await until(full, "the pool is not full again")


KILLS: dict[str, Kill] = {
    "a solving worker": _solving,
    "a starting worker": _starting,
    "an idle worker": _idle,
    "the fork server": _fork_server,
}


def figures(trial: Trial) -> Iterator[Figure]:
    """Measure."""
    for what, kill in KILLS.items():
        with folder() as place, serve(place, job_workers=0) as service:
            yield from uvloop.run(_kill_workers(service, what, kill, trial.times))


async def _kill_workers(service: Running, what: str, kill: Kill, times: int) -> list[Figure]:
    load = Load(service.port)
    await load.learn()
    full_s: list[float] = []
    gave_up = ""
    async with load.small_ones():
        try:
            for number in range(times):
                full_s.append(await _once(service, load, kill, number))
        except HungError as error:
            gave_up = f"; given up after {len(full_s)} of {times}: {error}"
    load.close()

    service.process.send_signal(signal.SIGTERM)
    with suppress(HungError):
        await until(lambda: not of_service(service), "all end", hung_s=END_WAIT_S)
    return [
        at_most(
            f"{what} killed {times} times: longest until as many workers live",
            float("inf") if gave_up else max(full_s),
            FULL_WITHIN_S,
            "s",
            f"median {np.median(full_s or [np.inf]):.2f} s{gave_up}",
        ),
        none_of(f"{what} killed: answers 500, or none", load.failed, load.describe_statuses()),
        none_of(f"{what} killed: wrong answers", load.wrong),
        none_of(f"{what} killed: processes left after SIGTERM", of_service(service)),
    ]


async def _once(service: Running, load: Load, kill: Kill, number: int) -> float:
    """Kill while a slow design is under way, and see it answered: it must not be killed twice."""
    before = await settle(service, WORKERS)
    asked = asyncio.create_task(load.slow())

    def at_it() -> set[int]:
        used = workers(service)
        return {pid for pid in before.keys() & used if used[pid] - before[pid] > SOLVING_S}

    try:
        await until(at_it, "no worker is at work")
        solving = at_it().pop()
        return await kill(service, solving, before.keys() - {solving}, number)
    finally:
        await asked
