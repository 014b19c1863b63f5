"""A pool of worker processes: who waits is served in turn, what is slow makes way, what dies heals.

Small work has as many workers as the pool is given. Work that takes longer than a slice is large:
it goes on in its worker, which then counts as one of the few for large work, while a fresh worker
takes its place. Where all places for large work are taken it is ended and waits for one. To end a
worker costs little: the fork server has the solvers built, so that another is born within
milliseconds.
"""

import asyncio
import logging
import math
import time
from collections.abc import Callable, Coroutine, Hashable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from service.problems import INTERNAL, OVERLOADED, TIME_LIMIT, TOO_LARGE, Problem
from service.workers.costs import SLICE_S, Costs
from service.workers.patience import Patience
from service.workers.process import Outcome, Worker, prepare
from service.workers.queue import FairQueue, Flow, Kind, Ticket

MOST_CRASHES = 2
"""Workers that a task may crash: it is the task's fault then."""

MOST_DEATHS = 10
"""Workers of a task that may be killed from outside: then it may be the system, short of memory."""

LONGEST_WAIT_S = 30.0
"""How long a task may wait for a worker, or be expected to [s]."""

START_PAUSES_S = (0.0, 0.0, 0.1, 0.5, 1.0)
"""Wait after as many workers in a row that could not be started: do not spin on it [s]."""

START_LIMIT_S = 60.0
"""How long a worker may take to be ready [s]."""

STOP_WAIT_S = 5.0
"""How long an idle worker may take to end before it is killed [s]."""

LOG = logging.getLogger("shapersmith.pool")


class TaskError(Exception):
    """A task that has no answer."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem.detail)
        self.problem = problem


class SplitError(Exception):
    """A task of several parts that takes longer than a slice: its parts are to be run apart."""


@dataclass(eq=False, slots=True, kw_only=True)
class _Run:
    """One task on its way: waiting, or in a worker.

    Attributes
    ----------
    shape
        What tasks share that cost alike.
    splits
        Whether it is given up where it is large, for its parts to be run apart.
    callers
        How many wait for it.
    large, overdue
        Whether it has one of the places for large work; whether it should.
    """

    task: Callable[..., Any]
    arguments: tuple[Any, ...]
    client: str
    kind: Kind
    shape: Hashable
    key: Hashable | None
    limit_s: float
    splits: bool
    done: "asyncio.Future[Any]"
    ticket: Ticket
    callers: int = 0
    crashes: int = 0
    deaths: int = 0
    large: bool = False
    overdue: bool = False
    worker: Worker | None = None
    begun: float = 0.0
    timers: list[asyncio.TimerHandle] = field(default_factory=list)

    def stop_timers(self) -> None:
        for timer in self.timers:
            timer.cancel()
        self.timers.clear()


class WorkerPool:
    """Workers, each with its solvers built; those that die are replaced.

    Parameters
    ----------
    workers
        Number of processes for small work; there are up to as many more for large work, less one.
    time_limit_s
        Longest run of one task; its worker is ended then [s].
    max_pending
        Tasks running and waiting beyond which new ones are refused.
    memory_bytes
        What a worker may have of memory of its own [bytes].
    """

    def __init__(
        self, *, workers: int, time_limit_s: float, max_pending: int, memory_bytes: int
    ) -> None:
        self.workers = workers
        self.costs = Costs()
        self._large_places = max(1, workers - 1)
        self._time_limit_s = time_limit_s
        self._max_pending = max_pending
        self._memory_bytes = memory_bytes
        self._small, self._large = FairQueue(), FairQueue()
        self._patience = Patience()
        self._runs: dict[Ticket, _Run] = {}
        self._shared: dict[Hashable, _Run] = {}
        self._idle: list[Worker] = []
        self._busy: dict[Worker, _Run] = {}
        self._starting: dict[Worker, asyncio.TimerHandle] = {}
        self._to_start = 0
        self._failed_starts = 0
        self._closed = False
        self._loop = asyncio.get_running_loop()
        self._starter = ThreadPoolExecutor(1, thread_name_prefix="worker-starter")
        self._tasks: set[asyncio.Task[None]] = set()
        prepare()
        self._fill()

    async def run(
        self,
        task: Callable[..., Any],
        *arguments: Any,  # noqa: ANN401
        client: str = "",
        kind: Kind = "single",
        shape: Hashable = None,
        key: Hashable = None,
        limit_s: float | None = None,
        splits: bool = False,
    ) -> Any:  # noqa: ANN401
        """Run a task in a worker; if the last of its callers is cancelled, it ends.

        Parameters
        ----------
        task, arguments
            A function of a module and what it takes, both as pickle has it.
        client, kind
            Whose work it is, and of what kind: those share the workers fairly.
        shape
            What tasks share that cost alike; None where that is not known.
        key
            Tasks of equal keys that are on their way at once are run once; None for each its own.
        limit_s
            Longest run, where not that of the pool [s].
        splits
            Whether it is given up where it takes longer than a slice.

        Raises
        ------
        TaskError
            If it would wait too long, or does; if the time limit or its memory ends it, its worker
            crashes twice, or it fails.
        SplitError
            If it ``splits`` and takes longer than a slice.
        """
        run = self._shared.get(key) if key is not None else None
        if run is None:
            limit_s = self._time_limit_s if limit_s is None else limit_s
            run = _Run(
                task=task, arguments=arguments, client=client, kind=kind,
                shape=shape if shape is not None else task.__qualname__, key=key,
                limit_s=limit_s, splits=splits,
                done=self._loop.create_future(), ticket=Ticket(Flow(), 0.0),
            )  # fmt: skip
            self._admit(run)
        run.callers += 1
        try:
            return await asyncio.shield(run.done)
        finally:
            run.callers -= 1
            if run.callers == 0 and not run.done.done():
                self._give_up(run)

    @property
    def pending(self) -> int:
        """Tasks running and waiting."""
        return len(self._runs)

    @property
    def ready(self) -> bool:
        """Whether a worker lives whose solvers are built, and there is room for a task."""
        built = bool(self._idle or self._busy)
        return built and self.pending < self._max_pending

    # Waiting.

    def _admit(self, run: _Run) -> None:
        """Let a task wait, or refuse it at once where it would wait too long."""
        cost_s = self.costs.of(run.shape)
        large = cost_s > SLICE_S and not run.splits
        flow = Flow(run.client, run.kind, large)
        wait_s = self._wait_s(flow, cost_s)
        if self.pending >= self._max_pending:
            raise _refused(f"{self.pending} tasks are running or waiting", wait_s)
        if run.kind != "batch":
            admitted = (
                wait_s <= LONGEST_WAIT_S
                if large
                else self._patience.admits(self._loop.time(), wait_s, cost_s)
            )
            if not admitted:
                raise _refused(f"a worker is expected to be free in {wait_s:.2g} s only", wait_s)
        self._wait(run, flow, cost_s)
        if run.key is not None:
            self._shared[run.key] = run
        self._dispatch()

    def _wait_s(self, flow: Flow, cost_s: float) -> float:
        if flow.large:
            return self._large.wait_s(flow, cost_s, self._large_places)
        return 0.0 if self._idle else self._small.wait_s(flow, cost_s, self.workers)

    def _wait(self, run: _Run, flow: Flow, cost_s: float, start: float | None = None) -> None:
        run.ticket = Ticket(flow, cost_s)
        self._runs[run.ticket] = run
        (self._large if flow.large else self._small).add(run.ticket, start)
        if run.kind != "batch":
            late = f"no worker was free within {LONGEST_WAIT_S:g} s"
            refuse = partial(self._fail, run, _refused(late, LONGEST_WAIT_S))
            run.timers.append(self._loop.call_later(LONGEST_WAIT_S, refuse))

    def _leave(self, run: _Run) -> None:
        """Take a task out of the queue and the books."""
        run.stop_timers()
        (self._large if run.ticket.flow.large else self._small).remove(run.ticket)
        self._runs.pop(run.ticket, None)
        if run.key is not None and self._shared.get(run.key) is run:
            del self._shared[run.key]

    # Running.

    def _dispatch(self) -> None:
        """Give workers that are idle to those that are next."""
        while self._large_running < self._large_places and self._promote():
            continue
        while self._idle and self._small_running < self.workers and len(self._small):
            self._begin(self._small, large=False)
        while self._idle and self._large_running < self._large_places and len(self._large):
            self._begin(self._large, large=True)
        if len(self._small) and self._small_running >= self.workers:
            self._end_an_overdue()
        self._fill()

    @property
    def _large_running(self) -> int:
        return sum(run.large for run in self._busy.values())

    @property
    def _small_running(self) -> int:
        return len(self._busy) - self._large_running

    def _begin(self, queue: FairQueue, *, large: bool) -> None:
        ticket = queue.pop()
        if ticket is None:
            return
        run, worker = self._runs[ticket], self._idle.pop()
        run.stop_timers()
        run.worker, run.begun, run.large, run.overdue = worker, time.perf_counter(), large, False
        self._busy[worker] = run
        if large:
            worker.make_way()
        worker.send(run.task, run.arguments)
        run.timers = [
            self._loop.call_later(SLICE_S, self._look_again, run, SLICE_S),
            self._loop.call_later(run.limit_s, self._end_late, run),
        ]

    def _told(self, worker: Worker, outcome: Outcome, result: Any) -> None:  # noqa: ANN401
        """Take what a worker tells."""
        starting = self._starting.pop(worker, None)
        if starting is not None:
            starting.cancel()
            self._failed_starts = 0
            self._idle.append(worker)
            self._dispatch()
            return
        run = self._busy.pop(worker)
        if outcome == "memory" or run.large:
            worker.kill()  # it has made way, which it cannot take back, or is near its limit
        else:
            self._idle.append(worker)
        self._account(run)
        if outcome == "done":
            self._leave(run)
            if not run.done.done():
                run.done.set_result(result)
        elif outcome == "memory":
            megabytes = self._memory_bytes / 1e6
            told = f"the work asks for more than the {megabytes:.0f} MB that a worker may use"
            self._fail(run, TaskError(Problem(TOO_LARGE, told)))
        else:
            LOG.error("a task failed: %s", result)
            told = "the service failed; its log has the reason"
            self._fail(run, TaskError(Problem(INTERNAL, told)))
        self._dispatch()

    def _account(self, run: _Run) -> None:
        """Learn what a task has cost."""
        spent_s = self._charge(run)
        if not run.splits:
            self.costs.record(run.shape, spent_s)
        if not run.large and run.kind != "batch":
            self._patience.answered(self._loop.time())

    def _charge(self, run: _Run) -> float:
        """Charge what a task has cost to its flow, and return it [s]."""
        spent_s = time.perf_counter() - run.begun
        if run.ticket.flow.large:
            self._large.charge(run.ticket, spent_s)
        else:
            self._small.charge(run.ticket, min(spent_s, SLICE_S))
        return spent_s

    def _fail(self, run: _Run, error: Exception) -> None:
        self._leave(run)
        if not run.done.done():
            run.done.set_exception(error)
            if run.callers == 0:
                run.done.exception()  # nobody is there to retrieve it

    def _give_up(self, run: _Run) -> None:
        """End a task for which nobody waits any more."""
        self._leave(run)
        run.done.cancel()
        self._end_worker(run, "its client has left")
        self._dispatch()

    def _end_worker(self, run: _Run, reason: str) -> None:
        worker, run.worker = run.worker, None
        if worker is not None and self._busy.pop(worker, None) is not None:
            self._charge(run)
            LOG.info("worker %s ended: %s", worker.pid, reason)
            worker.kill()

    def _end_late(self, run: _Run) -> None:
        self.costs.at_least(run.shape, run.limit_s)
        self._end_worker(run, f"its task ran for {run.limit_s:g} s")
        told = f"the work was ended after {run.limit_s:g} s"
        self._fail(run, TaskError(Problem(TIME_LIMIT, told)))
        self._dispatch()

    # What is large.

    def _look_again(self, run: _Run, after_s: float) -> None:
        """Move a task out of the way that has taken longer than a slice; once more at twice that.

        Until it ends nobody knows what it costs: as much again is the best guess.
        """
        run.timers.append(self._loop.call_later(after_s, self._look_again, run, 2 * after_s))
        if run.splits:
            self._end_worker(run, "some of its parts are large: they are run apart")
            self._fail(run, SplitError())
        else:
            self.costs.at_least(run.shape, 2 * after_s)
            if not run.large:
                run.overdue = True
            self._sort_out()
        self._dispatch()

    def _sort_out(self) -> None:
        """Move what waits among the small and is known as large; refuse what waits in vain."""
        for ticket in list(self._small):
            run = self._runs[ticket]
            cost_s = self.costs.of(run.shape)
            if cost_s > SLICE_S and not run.splits:
                self._to_large(run, cost_s)
        ahead_s = 0.0
        for ticket in list(self._large):
            run = self._runs[ticket]
            wait_s = ahead_s / self._large_places
            if wait_s > LONGEST_WAIT_S and run.kind != "batch":
                late = f"a worker is expected to be free in {wait_s:.2g} s only"
                self._fail(run, _refused(late, wait_s))
            else:
                ahead_s += self.costs.of(run.shape)

    def _to_large(self, run: _Run, cost_s: float) -> None:
        """Let a task wait for a place for large work."""
        self._small.remove(run.ticket)
        del self._runs[run.ticket]
        run.stop_timers()
        self._wait(run, Flow(run.client, run.kind, large=True), cost_s)

    def _promote(self) -> bool:
        """Give the oldest task that is overdue a place for large work, if there is one."""
        run = self._oldest_overdue()
        if run is None or run.worker is None:
            return False
        run.large, run.overdue = True, False
        run.worker.make_way()
        return True

    def _end_an_overdue(self) -> None:
        """End the youngest task that is overdue, as others wait; it waits for its place."""
        overdue = [run for run in self._busy.values() if run.overdue]
        if overdue:
            run = max(overdue, key=lambda one: one.begun)
            self._end_worker(run, "its task is large and all places for such are taken")
            self._to_large(run, self.costs.of(run.shape))

    def _oldest_overdue(self) -> _Run | None:
        overdue = [run for run in self._busy.values() if run.overdue]
        return min(overdue, key=lambda one: one.begun, default=None)

    # Workers.

    def _fill(self) -> None:
        """Start the workers that are missing, and end those that are too many."""
        if self._closed:
            return
        wanted = self.workers + min(self._large_places, self._large_running + len(self._large))
        there = len(self._idle) + len(self._busy) + len(self._starting) + self._to_start
        for _ in range(wanted - there):
            self._to_start += 1
            self._soon(self._start())
        for _ in range(min(there - wanted, len(self._idle))):
            self._idle.pop().close()

    async def _start(self) -> None:
        pause_s = START_PAUSES_S[min(self._failed_starts, len(START_PAUSES_S) - 1)]
        try:
            if pause_s:
                await asyncio.sleep(pause_s)
            prepare()
            worker = await self._loop.run_in_executor(
                self._starter, Worker, self._memory_bytes, self._told, self._lost
            )
            self._starting[worker] = self._loop.call_later(START_LIMIT_S, self._end_stuck, worker)
            await worker.connect()
        except (OSError, EOFError) as error:
            # EOFError: the fork server died while it forked; the next start begins another.
            self._failed_starts += 1
            LOG.error("no worker could be started: %r", error)
        finally:
            self._to_start -= 1
        self._fill()

    def _lost(self, worker: Worker) -> None:
        """Replace a worker that has died."""
        if self._closed:
            return
        where, run = "idle", self._busy.pop(worker, None)
        if run is not None:
            where, run.worker = "at a task", None
            run.stop_timers()
        elif worker in self._starting:
            self._starting.pop(worker).cancel()
            self._failed_starts += 1
            where = "at its start"
        elif worker in self._idle:
            self._idle.remove(worker)
        else:
            return  # it was one too many
        self._fill()
        self._soon(self._buried(worker, where, run))

    async def _buried(self, worker: Worker, where: str, run: _Run | None) -> None:
        """Tell how a worker has died, and have its task run by another."""
        how = await worker.ending()
        LOG.error("worker %s died %s: %s; another takes its place", worker.pid, where, how)
        worker.close()
        if run is None or run.done.done():
            return
        crashed = worker.by_its_own_fault
        run.crashes, run.deaths = run.crashes + crashed, run.deaths + (not crashed)
        if run.crashes >= MOST_CRASHES or run.deaths >= MOST_DEATHS:
            self._fail(run, TaskError(Problem(INTERNAL, "every worker died at this request")))
        else:
            ticket = run.ticket
            del self._runs[ticket]
            self._wait(run, ticket.flow, ticket.cost_s, ticket.start)
        self._dispatch()

    def _soon(self, work: Coroutine[Any, Any, None]) -> None:
        task = self._loop.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    def _end_stuck(self, worker: Worker) -> None:
        """Replace a worker that is not ready in time."""
        del self._starting[worker]
        self._failed_starts += 1
        LOG.error("worker %s is not ready after %g s; another starts", worker.pid, START_LIMIT_S)
        worker.kill()
        self._fill()

    async def close(self) -> None:
        """End the workers; all tasks have ended."""
        self._closed = True
        for task in list(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        workers = [*self._idle, *self._busy, *self._starting]
        for timer in self._starting.values():
            timer.cancel()
        for worker in workers:
            worker.close()
        joined = (asyncio.to_thread(worker.join, STOP_WAIT_S) for worker in workers)
        await asyncio.gather(*joined)
        self._starter.shutdown()


def _refused(detail: str, wait_s: float) -> TaskError:
    problem = Problem(
        OVERLOADED, f"{detail}; try again later", retry_after_s=max(1, math.ceil(wait_s))
    )
    return TaskError(problem)
