"""The workers of a pool: as many as are wanted, whatever they die of."""

import asyncio
import logging
from asyncio import get_running_loop
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Protocol

from service.workers.process import Outcome, Worker, prepare

START_PAUSES_S = (0.0, 0.0, 0.1, 0.5, 1.0)
"""Wait after as many workers in a row that could not be started: do not spin on it [s]."""

START_LIMIT_S = 60.0
"""How long a worker may take to be ready [s]."""

STOP_WAIT_S = 5.0
"""How long an idle worker may take to end before it is killed [s]."""

LOG = logging.getLogger("shapersmith.pool")


class Foreman(Protocol):
    """Who gives the workers their tasks."""

    def may_begin(self) -> None:
        """Hear that a worker is idle that was not."""

    def take_outcome(self, worker: Worker, outcome: Outcome, result: object) -> None:
        """Take the outcome of a busy worker; give the worker back or end it.

        Parameters
        ----------
        worker
            The worker.
        outcome
            How its task has ended.
        result
            What the task has returned, or the traceback of its error.
        """

    def forget(self, worker: Worker) -> Callable[[bool], None]:
        """Forget a busy worker that has died.

        Returned is what to call with whether the worker crashed by its own fault, once that is
        known.
        """


class Crew:
    """Keeps a number of workers alive; those that are idle can be taken.

    Parameters
    ----------
    foreman
        Who gives them their tasks.
    memory_bytes
        Memory that each may have for itself [bytes].
    """

    def __init__(self, foreman: Foreman, memory_bytes: int) -> None:
        self.idle: list[Worker] = []
        self._foreman = foreman
        self._memory_bytes = memory_bytes
        self._wanted = 0
        self._busy: set[Worker] = set()
        self._starting: dict[Worker, asyncio.TimerHandle] = {}
        self._to_start = 0
        self._failed_starts = 0
        self._closed = False
        self._starter = ThreadPoolExecutor(1, thread_name_prefix="worker-starter")
        self._tasks: set[asyncio.Task[None]] = set()

    @property
    def has_built_worker(self) -> bool:
        """Whether a worker lives whose solvers are built."""
        return bool(self.idle or self._busy)

    def keep(self, wanted: int) -> None:
        """Start workers that are missing, end idle ones that are too many.

        Parameters
        ----------
        wanted
            How many workers there should be. Busy ones are not ended.
        """
        if self._closed:
            return
        self._wanted = wanted
        there = len(self.idle) + len(self._busy) + len(self._starting) + self._to_start
        for _ in range(wanted - there):
            self._to_start += 1
            self._soon(self._start())
        # Those who have worked last stay: what they have loaded is at hand.
        for _ in range(min(there - wanted, len(self.idle))):
            self.idle.pop(0).close()

    def take(self) -> Worker:
        """Return an idle worker, who is busy from now on.

        At least one worker must be idle.
        """
        worker = self.idle.pop()
        self._busy.add(worker)
        return worker

    def give_back(self, worker: Worker) -> None:
        """Count a worker as idle that was busy."""
        self._busy.remove(worker)
        self.idle.append(worker)

    def end(self, worker: Worker) -> None:
        """Kill a busy worker; whether another takes its place is what is wanted."""
        self._busy.remove(worker)
        worker.kill()

    async def _start(self) -> None:
        pause_s = START_PAUSES_S[min(self._failed_starts, len(START_PAUSES_S) - 1)]
        worker: Worker | None = None
        try:
            if pause_s:
                await asyncio.sleep(pause_s)
            prepare()
            worker = await self._make()
        except (OSError, EOFError) as error:
            # EOFError: the fork server died while it forked; the next start begins another.
            self._failed_starts += 1
            LOG.error("no worker could be started: %r", error)
        else:
            late = get_running_loop().call_later(START_LIMIT_S, self._end_stuck, worker)
            self._starting[worker] = late
        finally:
            self._to_start -= 1
        if worker is not None:
            await worker.connect()
        self.keep(self._wanted)

    async def _make(self) -> Worker:
        """Return a new process; who is cancelled meanwhile does not forget it."""
        making = get_running_loop().run_in_executor(
            self._starter, Worker, self._memory_bytes, self._take_outcome, self._replace
        )
        try:
            return await asyncio.shield(making)
        except asyncio.CancelledError:
            (await making).kill()
            raise

    def _take_outcome(self, worker: Worker, outcome: Outcome, result: object) -> None:
        starting = self._starting.pop(worker, None)
        if starting is None:
            self._foreman.take_outcome(worker, outcome, result)
            return
        starting.cancel()
        self._failed_starts = 0
        self.idle.append(worker)
        self._foreman.may_begin()

    def _replace(self, worker: Worker) -> None:
        """Replace a worker that has died."""
        if self._closed:
            return
        where = "idle"
        bury: Callable[[bool], None] = _nothing
        if worker in self._busy:
            self._busy.remove(worker)
            where, bury = "at a task", self._foreman.forget(worker)
        elif worker in self._starting:
            self._starting.pop(worker).cancel()
            self._failed_starts += 1
            where = "at its start"
        elif worker in self.idle:
            self.idle.remove(worker)
        else:
            return  # it was one too many
        self.keep(self._wanted)
        self._soon(self._log_death(worker, where, bury))

    async def _log_death(self, worker: Worker, where: str, bury: Callable[[bool], None]) -> None:
        """Tell how a worker has died."""
        how = await worker.ending()
        LOG.error("worker %s died %s: %s; another takes its place", worker.pid, where, how)
        worker.close()
        bury(worker.by_its_own_fault)

    def _end_stuck(self, worker: Worker) -> None:
        """Replace a worker that is not ready in time."""
        del self._starting[worker]
        self._failed_starts += 1
        LOG.error("worker %s is not ready after %g s; another starts", worker.pid, START_LIMIT_S)
        worker.kill()
        self.keep(self._wanted)

    def _soon(self, work: Coroutine[Any, Any, None]) -> None:
        task = get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def close(self) -> None:
        """End the workers; nobody waits for a task."""
        self._closed = True
        for task in list(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        workers = [*self.idle, *self._busy, *self._starting]
        for timer in self._starting.values():
            timer.cancel()
        for worker in self._busy:
            worker.kill()  # nobody waits for its task
        for worker in (*self.idle, *self._starting):
            worker.close()
        await asyncio.gather(*(asyncio.to_thread(worker.join, STOP_WAIT_S) for worker in workers))
        self._starter.shutdown()


def _nothing(crashed: bool) -> None:
    """Hear of a worker that had no task."""
    del crashed
