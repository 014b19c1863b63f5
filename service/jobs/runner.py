"""The loop that claims chunks, has them computed, and records them."""

import logging
import os
import socket
import threading
import time
import uuid
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from typing import TypeVar

from sqlalchemy.exc import DBAPIError, OperationalError

from design.tables.specification import TableSpecification
from service.jobs.database import StoreError, disk_full
from service.jobs.executors import Start, Started
from service.jobs.plan import specification_of
from service.jobs.records import Claim, Done
from service.jobs.store import Store
from service.jobs.work import compute_chunk, part_of

Answer = TypeVar("Answer")

LOG = logging.getLogger("shapersmith.jobs")

BEATS_A_STALL = 4
"""Heartbeats in the time after which a silent worker counts as stalled."""

LONGEST_PAUSE_S = 2.0
"""Between two attempts to reach a database that is gone [s]."""

IDLE_PAUSE_S = 0.5
"""Between two looks for new jobs [s]."""


class Runner:
    """Runs the jobs of a store until told to stop.

    Parameters
    ----------
    store
        The store.
    start
        Starts the executor; once more after it has broken.
    database_wait_s
        How long to wait for a database that is gone [s].
    tell
        Is told what a person should know.
    """

    def __init__(
        self,
        store: Store,
        start: Start,
        *,
        database_wait_s: float,
        tell: Callable[[str], None] = LOG.warning,
    ) -> None:
        self.name = f"{socket.gethostname()[:50]}:{os.getpid()}:{uuid.uuid4().hex[:8]}"
        self.stopping = threading.Event()
        self._store = store
        self._start = start
        self._database_wait_s = database_wait_s
        self._tell = tell
        self._started: Started | None = None
        self._specification: tuple[str, TableSpecification] | None = None
        self._running: dict[Future[Done], Claim] = {}
        self._suspects = 0
        self._beaten = time.monotonic()

    def run(self, *, until: Callable[[], bool], pause_s: float = IDLE_PAUSE_S) -> None:
        """Work until ``until`` says so or `stopping` is set; then leave the rest to others.

        Parameters
        ----------
        until
            Asked after each round.
        pause_s
            Between two looks for chunks when none is left: others may add some, or fail [s].

        Raises
        ------
        StoreError
            If the database was gone for too long, or has no space left.
        """
        try:
            while not self.stopping.is_set():
                self._round(pause_s)
                if until():
                    return
        finally:
            self._end()

    def _round(self, pause_s: float) -> None:
        slots = 1 if self._started is None else self._started.slots
        free = (1 if self._suspects else slots) - len(self._running)
        claims: list[Claim] = []
        if free > 0:
            claims = self.patiently(lambda: self._store.claim(self.name, free))
        for claim in claims:
            self._submit(claim)
        if not self._running:
            self.patiently(self._store.settle)
            self.stopping.wait(pause_s)
            return
        beat_s = self._store.stalled_s / BEATS_A_STALL
        ended, _ = wait(
            self._running, timeout=min(beat_s, IDLE_PAUSE_S), return_when=FIRST_COMPLETED
        )
        if time.monotonic() - self._beaten > beat_s:
            held = list(self._running.values())
            self.patiently(lambda: self._store.beat(self.name, held))
            self._beaten = time.monotonic()
        for future in ended:
            self._record(self._running.pop(future), future)

    def _submit(self, claim: Claim) -> None:
        if self._started is None:
            self._started = self._start()
        if self._specification is None or self._specification[0] != claim.job:
            made_of = self.patiently(lambda: self._store.made_of(claim.job))
            specification = specification_of(made_of.specification, made_of.impulses)
            self._specification = claim.job, specification
        part = part_of(self._specification[1], claim.number)
        try:
            future = self._started.executor.submit(compute_chunk, *part)
        except (BrokenExecutor, RuntimeError) as error:
            future = Future()
            future.set_exception(error)
        self._running[future] = claim

    def _record(self, claim: Claim, future: "Future[Done]") -> None:
        error = future.exception()
        if error is None:
            done = future.result()
            self.patiently(lambda: self._store.finish(self.name, claim, done))
            self._suspects = max(self._suspects - 1, 0)
        else:
            reason = f"{type(error).__name__}: {error}"
            self._tell(f"chunk {claim.number} of job {claim.job} failed: {reason}")
            self.patiently(lambda: self._store.fail(self.name, claim, reason))
            if isinstance(error, BrokenExecutor):
                # One of the chunks in flight killed its worker. Try them one by one, so that it
                # spoils no other.
                self._suspects = max(self._suspects, len(self._running) + 1)
                self._drop_executor()
        self.patiently(self._store.settle)

    def patiently(self, ask: Callable[[], Answer]) -> Answer:
        """Ask the store; wait, for a bounded time, while the database is gone."""
        since: float | None = None
        pause = 0.05
        while True:
            try:
                answer = ask()
            except DBAPIError as error:
                if disk_full(error):
                    raise StoreError(
                        "no space left for the job store; free some and run again"
                    ) from None
                if not isinstance(error, OperationalError) and not error.connection_invalidated:
                    raise
                now = time.monotonic()
                if since is None:
                    since = now
                    self._tell(f"the database does not answer, waiting: {_first_line(error)}")
                if now - since > self._database_wait_s or self.stopping.is_set():
                    raise StoreError(
                        f"the database did not answer for {now - since:.0f} s; run again when it "
                        f"does: {_first_line(error)}"
                    ) from None
                time.sleep(pause)
                pause = min(2 * pause, LONGEST_PAUSE_S)
            else:
                if since is not None:
                    self._tell("the database answers again")
                return answer

    def _drop_executor(self) -> None:
        started, self._started = self._started, None
        if started is not None:
            started.end()

    def _end(self) -> None:
        held = list(self._running.values())
        self._running.clear()
        self._drop_executor()
        if held:
            try:
                self._store.give_back(self.name, held)
            except DBAPIError as error:
                # They count as stalled soon, and are claimed by others.
                self._tell(f"chunks could not be given back: {_first_line(error)}")


def _first_line(error: DBAPIError) -> str:
    return str(error.orig).strip().partition("\n")[0]
