"""Worker processes: CasADi crashes when threads share it, and a process can be ended in time."""

import asyncio
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import TimeoutError as FutureTimeoutError
from multiprocessing.connection import wait
from typing import Any

from pebble import ProcessExpired, ProcessPool

from design.actuators import Ideal
from design.pipeline import design
from design.plants import Mode
from design.shapers.registry import SHAPERS
from service.problems import INTERNAL, OVERLOADED, TIME_LIMIT, Problem

RETRIES = 1
"""How often a task is given to another worker when its own dies."""


class TaskError(Exception):
    """A task that has no answer."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem.detail)
        self.problem = problem


class WorkerPool:
    """A fixed number of workers, each with its solvers built; dead ones are replaced.

    Parameters
    ----------
    workers
        Number of processes.
    time_limit_s
        Longest run of one task; the worker is ended then [s].
    max_pending
        Tasks running and waiting beyond which new ones are refused.
    """

    def __init__(self, *, workers: int, time_limit_s: float, max_pending: int) -> None:
        self.time_limit_s = time_limit_s
        self.max_pending = max_pending
        self.pending = 0
        # One thread of BLAS a worker: the workers are the parallelism.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(["service.answers", "service.pool", "casadi"])
        self._pool = ProcessPool(max_workers=workers, initializer=_start_worker, context=context)

    async def run(self, task: Callable[..., Any], *arguments: Any) -> Any:  # noqa: ANN401
        """Run a task in a worker.

        Raises
        ------
        TaskError
            If too much is waiting, the time limit ends it, or its worker dies twice.
        """
        if self.pending >= self.max_pending:
            raise TaskError(
                Problem(OVERLOADED, f"{self.pending} tasks are running or waiting; try again later")
            )
        self.pending += 1
        try:
            for _ in range(1 + RETRIES):
                try:
                    return await asyncio.wrap_future(
                        self._pool.schedule(task, args=arguments, timeout=self.time_limit_s)
                    )
                except FutureTimeoutError:
                    raise TaskError(
                        Problem(TIME_LIMIT, f"the work was ended after {self.time_limit_s:g} s")
                    ) from None
                except ProcessExpired:
                    continue
            raise TaskError(Problem(INTERNAL, "the worker died at this request, twice"))
        finally:
            self.pending -= 1

    def close(self) -> None:
        """End the workers; what runs is finished first."""
        self._pool.close()
        self._pool.join()


def _start_worker() -> None:
    """Prepare a worker: end with the parent, leave signals to it, build every solver."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()
    warm_solvers()


def _end_with(sentinel: int) -> None:
    wait([sentinel])
    os._exit(0)


def warm_solvers() -> None:
    """Build the solvers of every shaper by designing each once."""
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.05)
    for kind in SHAPERS.values():
        if Ideal().kind in kind.actuators:
            design(mode, Ideal(), kind)
