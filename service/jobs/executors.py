"""Where chunks are computed: processes here, or a Dask cluster given by its address."""

import multiprocessing
import os
import re
from collections.abc import Callable
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import forkserver

CONNECT_WAIT_S = 20.0
"""How long a scheduler may take to answer [s]."""

MOST_DASK_SLOTS = 256
"""Chunks that wait at a scheduler at once, however many workers it has."""


ADDRESS = re.compile(r"((tcp|tls|ws|wss)://)?[\w.\-\[\]:]+:\d+\Z")


class SchedulerError(Exception):
    """The scheduler cannot be used."""


@dataclass(frozen=True, slots=True)
class Started:
    """An executor, how many chunks it should have at once, and how to end it at once."""

    executor: Executor
    slots: int
    end: Callable[[], None]


Start = Callable[[], Started]


def prepare() -> None:
    """Start the process that workers are forked from: it imports what they need meanwhile."""
    # One thread of BLAS a worker: the workers are the parallelism.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    forkserver.set_forkserver_preload(["service.answers", "service.jobs.work"])
    forkserver.ensure_running()


def processes(workers: int) -> Started:
    """Return a pool of processes; one chunk more waits than is computed."""
    from service.jobs.work import begin  # noqa: PLC0415 - a second that `prepare` must not wait

    prepare()
    context = multiprocessing.get_context("forkserver")
    pool = ProcessPoolExecutor(workers, mp_context=context, initializer=begin)

    def end() -> None:
        running = list((pool._processes or {}).values())
        pool.shutdown(wait=False, cancel_futures=True)
        for process in running:
            process.kill()  # in the middle of a chunk, which is computed anew

    return Started(pool, workers + 1, end)


def dask(address: str) -> Started:
    """Return the executor of a Dask cluster.

    Raises
    ------
    SchedulerError
        If Dask is not installed, or the scheduler does not answer.
    """
    try:
        from distributed import Client  # noqa: PLC0415 - an extra
    except ModuleNotFoundError:
        raise SchedulerError("a scheduler needs Dask: install shapersmith[dask]") from None
    if not ADDRESS.match(address):
        # Dask's client complains for long when it is handed one that it cannot read.
        raise SchedulerError(f"a scheduler's address is tcp://HOST:PORT, got {address!r}")
    try:
        client = Client(address, timeout=CONNECT_WAIT_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise SchedulerError(f"no Dask scheduler answers at {address}: {error}") from None
    threads = sum(client.nthreads().values())
    # Not pure: a chunk that failed is computed again, not remembered.
    executor: Executor = client.get_executor(pure=False)
    return Started(executor, min(max(2 * threads, 2), MOST_DASK_SLOTS), client.close)


def starter(workers: int, scheduler: str | None) -> Start:
    """Return what starts the executor that is asked for."""
    if scheduler:
        return lambda: dask(scheduler)
    return lambda: processes(workers)
