"""Where chunks are computed: processes here, or a Dask cluster given by its address."""

import multiprocessing
import re
import signal
import threading
from collections.abc import Callable
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, cast

from service.workers import system
from service.workers.own_path import ensure_fork_server

CONNECT_WAIT_S = 20.0
"""How long a scheduler may take to answer [s]."""

MAX_DASK_SLOTS = 256
"""Chunks that wait at a scheduler at once, however many workers it has."""

JOIN_WAIT_S = 10.0
"""How long the workers of a pool that has broken may take to end [s]."""

LOST_STATUS = 255
"""What multiprocessing makes of the status of a process whose fork server has died."""

ADDRESS = re.compile(r"((tcp|tls|ws|wss)://)?[\w.\-\[\]:]+:\d+\Z")


class SchedulerError(Exception):
    """The scheduler cannot be used."""


@dataclass(frozen=True, slots=True)
class Started:
    """An executor.

    Attributes
    ----------
    slots
        How many chunks it should have at once.
    end
        Ends it at once.
    fault
        The fault by which a worker of it died, once it has broken: as "SIGSEGV" or "exit
        status 1". Empty where none did, or nobody knows: it was killed then, by whomever.
    """

    executor: Executor
    slots: int
    end: Callable[[], None]
    fault: Callable[[], str]


Start = Callable[[], Started]


def prepare() -> None:
    """Start the process that workers are forked from, if the system can.

    It imports what they need while this process goes on.
    """
    ensure_fork_server(["service.dispatch", "service.jobs.work", "design.tables.kernel"])


def processes(workers: int) -> Started:
    """Return a pool of processes; one chunk more waits than is computed."""
    from service.jobs.work import begin  # noqa: PLC0415 - a second that `prepare` must not wait

    prepare()
    lifeline: Any  # on Windows of another class than here
    lifeline, held = multiprocessing.Pipe(duplex=False)
    pool = ProcessPoolExecutor(
        min(workers, system.MOST_OF_A_POOL),
        mp_context=system.context(),
        initializer=begin,
        initargs=(lifeline,),
    )

    def fault() -> str:
        manager = cast("threading.Thread | None", pool._executor_manager_thread)
        if manager is not None:  # it joins the workers; two that ask would spoil the exit status
            manager.join(JOIN_WAIT_S)
        codes = [process.exitcode for process in (pool._processes or {}).values()]
        return next(filter(None, map(fault_of, codes)), "")

    def end() -> None:
        held.close()
        lifeline.close()
        running = list((pool._processes or {}).values())
        pool.shutdown(wait=False, cancel_futures=True)
        for process in running:
            process.kill()  # in the middle of a chunk, which is computed anew

    return Started(pool, workers + 1, end, fault)


def thread() -> Started:
    """Return a thread, for a caller that may start no processes."""
    pool = ThreadPoolExecutor(1)
    return Started(pool, 1, lambda: pool.shutdown(wait=False, cancel_futures=True), str)


def fault_of(code: int | None) -> str:
    """Return the fault that the exit status of a process stands for.

    There is none where the process ended well or was killed, nor where its status went with its
    fork server.

    Parameters
    ----------
    code
        Exit status; minus the number of the signal that ended the process, None if it runs.

    Returns
    -------
    str
        As "SIGSEGV" or "exit status 1"; empty where there is none.
    """
    if code is None or code in {0, LOST_STATUS}:
        return ""
    if code > 0:
        return f"exit status {code}"
    return signal.Signals(-code).name if -code in system.FAULTS else ""


def dask(address: str) -> Started:
    """Return the executor of a Dask cluster.

    Parameters
    ----------
    address
        Of the scheduler, as ``tcp://HOST:PORT``.

    Returns
    -------
    Started
        An executor with two chunks for each thread of the cluster, `MAX_DASK_SLOTS` at most.

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
    return Started(executor, min(max(2 * threads, 2), MAX_DASK_SLOTS), client.close, str)


def starter(workers: int, scheduler: str | None) -> Start:
    """Return what starts the executor that is asked for.

    Parameters
    ----------
    workers
        Number of processes, where there is no scheduler.
    scheduler
        Address of a Dask scheduler; None or empty for processes here.

    Returns
    -------
    Start
        Starts the executor each time that it is called; `dask` says how that may fail.
    """
    if scheduler:
        return lambda: dask(scheduler)
    return lambda: processes(workers)
