"""Workers, and the process that forks them, are killed; a light load of clients sees nothing."""

import asyncio
import os
import signal
from collections.abc import Awaitable, Callable, Iterator
from contextlib import suppress

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
    served,
    settled,
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

Kill = Callable[[Running, Load, int], Awaitable[float]]
"""Waits for its moment, kills, and returns how long it took until the pool was full again [s]."""


async def _solving(service: Running, load: Load, number: int) -> float:
    """Kill the worker that is at a slow design, which another takes over."""
    del number
    before = (await settled(service, WORKERS)).used_s
    asked = asyncio.create_task(load.slow())

    def at_it() -> list[int]:
        return [pid for pid, used in workers(service).items() if used - before[pid] > SOLVING_S]

    await until(at_it, "a worker is at work")
    full_s = await _full_without(service, at_it()[0])
    await asked
    return full_s


async def _starting(service: Running, load: Load, number: int) -> float:
    """Kill a worker, and the one that takes its place as soon as it is seen."""
    del load, number
    before = await settled(service, WORKERS, busy=1)
    os.kill(before.idle, signal.SIGKILL)

    def new() -> set[int]:
        return workers(service).keys() - before.used_s.keys()

    await until(new, "a worker is started in place of one that was killed")
    return await _full_without(service, min(new()))


async def _idle(service: Running, load: Load, number: int) -> float:
    """Kill a worker that has nothing to do."""
    del load, number
    return await _full_without(service, (await settled(service, WORKERS, busy=1)).idle)


async def _fork_server(service: Running, load: Load, number: int) -> float:
    """Kill what forks the workers: before it is needed, or in the middle of starting one."""
    del load
    worker = (await settled(service, WORKERS, busy=1)).idle
    forking = next(
        one.parent
        for pid, one in of_service(service).items()
        if pid in workers(service) and one.parent in of_service(service)
    )
    if number % 2:
        os.kill(forking, signal.SIGSTOP)
        os.kill(worker, signal.SIGKILL)
        await asyncio.sleep(ASKED_S)
    os.kill(forking, signal.SIGKILL)
    return await _full_without(service, worker)


async def _full_without(service: Running, victim: int) -> float:
    """Kill a worker, if it lives; return how long it takes until all others and one more do."""
    with suppress(ProcessLookupError):
        os.kill(victim, signal.SIGKILL)
    return await until(
        lambda: len(workers(service).keys() - {victim}) >= WORKERS, "the pool is full again"
    )


KILLS: dict[str, Kill] = {
    "a solving worker": _solving,
    "a starting worker": _starting,
    "an idle worker": _idle,
    "the fork server": _fork_server,
}


def figures(trial: Trial) -> Iterator[Figure]:
    """Measure."""
    for what, kill in KILLS.items():
        with folder() as place, served(place, job_workers=0) as service:
            yield from uvloop.run(_killed(service, what, kill, trial.times))


async def _killed(service: Running, what: str, kill: Kill, times: int) -> list[Figure]:
    load = Load(service.port)
    await load.learn()
    full_s: list[float] = []
    gave_up = ""
    async with load.running(slow=kill is not _solving):
        try:
            for number in range(times):
                full_s.append(await kill(service, load, number))
        except HungError as error:
            gave_up = f"; given up after {len(full_s)} of {times}: {error}"

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
        none_of(f"{what} killed: answers 500, or none", load.failed, load.told()),
        none_of(f"{what} killed: wrong answers", load.wrong),
        none_of(f"{what} killed: processes left after SIGTERM", of_service(service)),
    ]
