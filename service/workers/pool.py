"""A pool of worker processes: who waits is served in turn, what is slow makes way, what dies heals.

Small work has as many workers as the pool is given. Work that takes longer than a slice is large:
it goes on in its worker, which then counts as one of the few for large work, while a fresh worker
takes its place. Where all places for large work are taken it is ended and waits for one. To end a
worker costs little: the fork server has the solvers built, so that another is born within
milliseconds.

Longer than other modules: what decides over the one queue and its workers stands together.
"""

import asyncio
import logging
import time
from asyncio import get_running_loop
from collections.abc import Callable, Hashable
from dataclasses import replace
from functools import partial
from typing import cast

from service.problems import INTERNAL, TIME_LIMIT, TOO_LARGE, Problem
from service.workers.costs import SLICE_S, Costs
from service.workers.crew import Crew
from service.workers.large import oldest_overdue, youngest_overdue, youngest_second
from service.workers.patience import Patience
from service.workers.process import Outcome, Worker
from service.workers.protocol import Arguments, Result
from service.workers.queue import FairQueue, Flow, Kind, Ticket
from service.workers.runs import (
    STOPPING,
    Run,
    SplitError,
    TaskError,
    failure,
    long_wait_error,
    no_room_error,
)

MAX_CRASHES = 2
"""Workers that a task may crash: it is the task's fault then."""

MAX_DEATHS = 10
"""Workers of a task that may be killed from outside: then it may be the system, short of memory."""

MAX_WAIT_S = 30.0
"""How long a task may wait for a worker, or be expected to [s]."""

IDLING_S = 4 * SLICE_S
"""A task that takes so long is large whatever it costs: it waits for something [s]."""

LOG = logging.getLogger("shapersmith.pool")


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
        Memory that a worker may have for itself [bytes].
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
        self._runs: dict[Ticket, Run] = {}
        self._shared: dict[Hashable, Run] = {}
        self._busy: dict[Worker, Run] = {}
        self._closed = False
        self._crew = Crew(self, memory_bytes)

    def start(self) -> None:
        """Start the workers; the pool is of the running loop from then on."""
        self._crew.keep(self.workers)

    async def run(
        self,
        task: Callable[[*Arguments], Result],
        *arguments: *Arguments,
        client: str = "",
        kind: Kind = "single",
        shape: Hashable = None,
        key: Hashable = None,
        limit_s: float | None = None,
        splits: bool = False,
    ) -> Result:
        """Run a task in a worker, as `Pool.run` says.

        Parameters
        ----------
        task, arguments, client, kind, shape, key, limit_s, splits
            As of `Pool.run`.

        Returns
        -------
        Result
            What the task returned.

        Raises
        ------
        TaskError
            As of `Pool.run`, and if the pool is closed.
        SplitError
            If it ``splits`` and takes longer than a slice.
        """
        if self._closed:
            raise TaskError(STOPPING)
        run = self._shared.get(key) if key is not None else None
        if run is None:
            limit_s = self._time_limit_s if limit_s is None else limit_s
            run = Run(
                task=task, arguments=arguments, client=client, kind=kind,
                shape=shape if shape is not None else task.__qualname__, key=key,
                limit_s=limit_s, splits=splits,
                done=get_running_loop().create_future(), ticket=Ticket(Flow(), 0.0),
            )  # fmt: skip
            self._admit(run)
        run.callers += 1
        try:
            return cast("Result", await asyncio.shield(run.done))  # what the task has returned
        finally:
            run.callers -= 1
            if run.callers == 0 and not run.done.done():
                self._give_up(run)

    def refusal(self, client: str) -> Problem | None:
        """Return why a small single request would be refused at once, or None."""
        cost_s = self.costs.small_s
        wait_s = self._wait_s(Flow(client), cost_s)
        if self._patience.refuses(get_running_loop().time(), wait_s, cost_s):
            return long_wait_error(wait_s).problem
        return None

    @property
    def pending(self) -> int:
        """Tasks running and waiting."""
        return len(self._runs)

    @property
    def ready(self) -> bool:
        """Whether a worker has its solvers built and a task has room."""
        return self._crew.has_built_worker and self.pending < self._max_pending

    # Waiting.

    def _admit(self, run: Run) -> None:
        """Let a task wait, or refuse it at once where it would wait too long."""
        cost_s = self.costs.of(run.client, run.shape)
        large = cost_s > SLICE_S and not run.splits
        flow = Flow(run.client, run.kind, large)
        wait_s = self._wait_s(flow, cost_s)
        if run.kind != "batch":  # which has few under way, and waits until it ends
            if self.pending >= self._max_pending:
                raise no_room_error(f"{self.pending} tasks are running or waiting", wait_s)
            admitted = (
                wait_s <= MAX_WAIT_S
                if large
                else self._patience.admits(
                    get_running_loop().time(), wait_s, cost_s * self.costs.slowness
                )
            )
            if not admitted:
                raise long_wait_error(wait_s)
        self._wait(run, flow, cost_s)
        if run.key is not None:
            self._shared[run.key] = run
        self.may_begin()

    def _wait_s(self, flow: Flow, cost_s: float) -> float:
        if flow.large:
            return self._large.wait_s(flow, cost_s, self._large_places)
        if self._crew.idle:
            return 0.0
        return self._small.wait_s(flow, cost_s, self.workers) * self.costs.slowness

    def _wait(self, run: Run, flow: Flow, cost_s: float, start: float | None = None) -> None:
        run.ticket = Ticket(flow, cost_s)
        self._runs[run.ticket] = run
        (self._large if flow.large else self._small).add(run.ticket, start)
        if run.kind != "batch":
            run.timers.append(get_running_loop().call_later(MAX_WAIT_S, self._refuse_late, run))

    def _refuse_late(self, run: Run) -> None:
        late = f"no worker was free within {MAX_WAIT_S:g} s"
        self._fail(run, no_room_error(late, MAX_WAIT_S))

    def _leave(self, run: Run) -> None:
        """Take a task out of the queue and the books."""
        run.stop_timers()
        (self._large if run.ticket.flow.large else self._small).remove(run.ticket)
        self._runs.pop(run.ticket, None)
        if run.key is not None and self._shared.get(run.key) is run:
            del self._shared[run.key]

    # Running.

    def may_begin(self) -> None:
        """Give the workers that are idle to those that are next."""
        while self._large_running < self._large_places and self._promote():
            continue
        while self._crew.idle and self._small_running < self.workers and len(self._small):
            self._begin(self._small, large=False)
        while self._crew.idle and self._large_running < self._large_places and len(self._large):
            self._begin(self._large, large=True)
        if len(self._small) and self._small_running >= self.workers:
            self._end_an_overdue()
        if len(self._large) and self._large_running >= self._large_places:
            self._end_a_second()
        waiting = min(self._large_places, self._large_running + len(self._large))
        self._crew.keep(self.workers + waiting)

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
        run, worker = self._runs[ticket], self._crew.take()
        run.stop_timers()
        run.worker, run.begun, run.large, run.overdue = worker, time.perf_counter(), large, False
        self._busy[worker] = run
        if large:
            worker.make_way()
        worker.send(run.task, run.arguments)
        run.timers = [
            get_running_loop().call_later(SLICE_S, self._look_again, run, SLICE_S),
            get_running_loop().call_later(run.limit_s, self._end_late, run),
        ]

    def take_outcome(self, worker: Worker, outcome: Outcome, result: object) -> None:
        """Take the outcome of a worker's task.

        Parameters
        ----------
        worker, outcome, result
            As of `Foreman.take_outcome`.
        """
        run = self._busy.pop(worker)
        if outcome == "memory" or run.large:
            self._crew.end(worker)  # it is near its limit, or has made way for good
        else:
            self._crew.give_back(worker)
        self._account(run, worker.cost_s)
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
            self._fail(run, failure())
        self.may_begin()

    def _account(self, run: Run, spent_s: float) -> None:
        """Learn what a task has cost."""
        self._charge(run, spent_s)
        if run.kind == "single" and not run.large:
            self.costs.took(time.perf_counter() - run.begun, spent_s)
        if not run.splits:
            self.costs.record(run.client, run.shape, spent_s)
        if not run.large and run.kind != "batch":
            self._patience.count_answer(get_running_loop().time())

    def _charge(self, run: Run, spent_s: float) -> None:
        """Charge what a task has cost to its flow."""
        if run.ticket.flow.large:
            self._large.charge(run.ticket, spent_s)
        else:
            self._small.charge(run.ticket, min(spent_s, SLICE_S))

    def _fail(self, run: Run, error: Exception) -> None:
        self._leave(run)
        if not run.done.done():
            run.done.set_exception(error)
            if run.callers == 0:
                run.done.exception()  # nobody is there to retrieve it

    def _give_up(self, run: Run) -> None:
        """End a task for which nobody waits any more."""
        self._leave(run)
        run.done.cancel()
        self._end_worker(run, "its client has left")
        self.may_begin()

    def _end_worker(self, run: Run, reason: str) -> None:
        worker, run.worker = run.worker, None
        if worker is not None and self._busy.pop(worker, None) is not None:
            self._charge(run, worker.spent_s())
            LOG.info("worker %s ended: %s", worker.pid, reason)
            self._crew.end(worker)

    def _end_late(self, run: Run) -> None:
        self.costs.at_least(run.client, run.shape, run.limit_s)
        self._end_worker(run, f"its task ran for {run.limit_s:g} s")
        told = f"the work was ended after {run.limit_s:g} s"
        self._fail(run, TaskError(Problem(TIME_LIMIT, told)))
        self.may_begin()

    # What is large.

    def _look_again(self, run: Run, after_s: float) -> None:
        """Move a task out of the way that has taken longer than a slice; once more at twice that.

        Until it ends nobody knows what it costs: as much again is the best guess. Small work on a
        machine that is busy with other things takes long too, and costs no more for it.
        """
        run.timers.append(
            get_running_loop().call_later(after_s, self._look_again, run, 2 * after_s)
        )
        starved = run.worker is not None and run.worker.spent_s() < SLICE_S / 2
        if starved and after_s < IDLING_S:
            return
        if run.splits:
            self._end_worker(run, "some of its parts are large: they are run apart")
            self._fail(run, SplitError())
        else:
            self.costs.at_least(run.client, run.shape, 2 * after_s)
            if not run.large:
                run.overdue = True
            self._sort_out()
        self.may_begin()

    def _sort_out(self) -> None:
        """Move what waits among the small and is known as large; refuse what waits in vain."""
        for ticket in list(self._small):
            run = self._runs[ticket]
            cost_s = self.costs.of(run.client, run.shape)
            if cost_s > SLICE_S and not run.splits:
                self._to_large(run, cost_s)
        ahead_s = 0.0
        for ticket in list(self._large):
            run = self._runs[ticket]
            wait_s = ahead_s / self._large_places
            if wait_s > MAX_WAIT_S and run.kind != "batch":
                self._fail(run, long_wait_error(wait_s))
            else:
                ahead_s += self.costs.of(run.client, run.shape)

    def _to_large(self, run: Run, cost_s: float) -> None:
        """Let a task wait for a place for large work."""
        self._small.remove(run.ticket)
        del self._runs[run.ticket]
        run.stop_timers()
        self._wait(run, Flow(run.client, run.kind, large=True), cost_s)

    def _promote(self) -> bool:
        """Give the oldest task that is overdue a place for large work, if there is one."""
        run = oldest_overdue(self._busy.values())
        if run is None or run.worker is None:
            return False
        run.large, run.overdue = True, False
        run.worker.make_way()
        return True

    def _end_an_overdue(self) -> None:
        """End the youngest task that is overdue, as others wait; it waits for its place."""
        run = youngest_overdue(self._busy.values())
        if run is not None:
            self._end_worker(run, "its task is large and all places for such are taken")
            self._to_large(run, self.costs.of(run.client, run.shape))

    def _end_a_second(self) -> None:
        """End the youngest large task of a client that has several, as one waits who has none."""
        run = youngest_second(self._busy.values(), self._large)
        if run is not None:
            self._end_worker(run, "its client has another large task, and one waits who has none")
            ticket = run.ticket
            del self._runs[ticket]
            run.stop_timers()
            self._wait(run, replace(ticket.flow, large=True), self.costs.of(run.client, run.shape))

    # What dies.

    def forget(self, worker: Worker) -> Callable[[bool], None]:
        """Forget a worker that has died at a task, which others do."""
        run = self._busy.pop(worker)
        run.worker = None
        run.stop_timers()
        return partial(self._try_again, run)

    def _try_again(self, run: Run, crashed: bool) -> None:
        """Have a task run by another worker, unless it is the task that ends them."""
        if run.done.done():
            return
        run.crashes, run.deaths = run.crashes + crashed, run.deaths + (not crashed)
        if run.crashes >= MAX_CRASHES or run.deaths >= MAX_DEATHS:
            self._fail(run, TaskError(Problem(INTERNAL, "every worker died at this request")))
        else:
            ticket = run.ticket
            del self._runs[ticket]
            self._wait(run, ticket.flow, ticket.cost_s, ticket.start)
        self.may_begin()

    async def close(self) -> None:
        """End the workers; who still waits gets an error."""
        self._closed = True
        for run in list(self._runs.values()):
            self._fail(run, TaskError(STOPPING))
        await self._crew.close()
