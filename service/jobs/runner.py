"""The loop that claims chunks, has them computed, and records them."""

import logging
import os
import socket
import threading
import time
import uuid
from collections import deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from typing import TypeVar

from sqlalchemy.exc import DBAPIError, OperationalError

from service.jobs.contents import DamagedError, GoneError
from service.jobs.database import StoreError, disk_full
from service.jobs.executors import Start, Started
from service.jobs.records import ChunkClaim, Done
from service.jobs.store import Store
from service.jobs.work import UnreadableError, compute_chunk, pack

Answer = TypeVar("Answer")

LOG = logging.getLogger("shapersmith.jobs")

BEATS_PER_STALL = 4
"""Heartbeats in the time after which a silent worker counts as stalled."""

MAX_PAUSE_S = 2.0
"""Between two attempts to reach a database that is gone [s]."""

IDLE_PAUSE_S = 0.5
"""Between two looks for new jobs [s]."""

START_PAUSE_S = 0.5
"""Before workers are started anew that could not be started [s]."""

MAX_KILLS = 20
"""A chunk whose worker is killed so often in a row, while it is computed alone, fails its job."""


class Runner:
    """Runs the jobs of a store until it is stopped.

    Parameters
    ----------
    store
        The store.
    start
        Starts the executor; once more after it has broken.
    database_wait_s
        How long to wait for a database that is gone [s].
    tell
        Takes what a person should know.
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
        self._specifications: dict[str, tuple[bytes, int | None]] = {}
        self._running: dict[Future[Done], ChunkClaim] = {}
        self._suspects: deque[ChunkClaim] = deque()
        self._kills = 0
        self._beaten = time.monotonic()

    def run(self, *, until: Callable[[], bool], pause_s: float = IDLE_PAUSE_S) -> None:
        """Work until ``until`` says so or `stopping` is set.

        The rest is then left to others.

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
        for claim in self._next():
            self._submit(claim)
        if not self._running:
            self.patiently(self._store.settle)
            if not self._suspects:
                self.stopping.wait(pause_s)
            return
        beat_s = self._store.stalled_s / BEATS_PER_STALL
        ended, _ = wait(
            self._running, timeout=min(beat_s, IDLE_PAUSE_S), return_when=FIRST_COMPLETED
        )
        if time.monotonic() - self._beaten > beat_s:
            self.patiently(lambda: self._store.beat(self.name, self._held))
            self._beaten = time.monotonic()
        sound = {future for future in ended if not _broken(future)}
        for future in sound:
            self._record(self._running.pop(future), future)
        if sound:
            self.patiently(self._store.settle)
        if sound != ended:
            self._start_over()

    @property
    def _held(self) -> list[ChunkClaim]:
        return [*self._running.values(), *self._suspects]

    def _next(self) -> list[ChunkClaim]:
        """Return the chunks to be computed next: of suspects one at a time, with none beside it."""
        if self._suspects:
            return [] if self._running else [self._suspects.popleft()]
        slots = 1 if self._started is None else self._started.slots
        free = slots - len(self._running)
        return self.patiently(lambda: self._store.claim(self.name, free)) if free > 0 else []

    def _submit(self, claim: ChunkClaim) -> None:
        try:
            content, impulses = self._specification(claim.job)
        except GoneError:
            return  # and its chunks with it
        except DamagedError as error:
            self._fail_job(claim, str(error))
            return
        try:
            if self._started is None:
                self._started = self._start()
            future = self._started.executor.submit(compute_chunk, content, impulses, claim.number)
        except (BrokenExecutor, RuntimeError, OSError, EOFError) as error:
            self._tell(f"workers are restarted: {type(error).__name__}: {error}")
            self._suspects.appendleft(claim)
            self._suspects.extend(self._running.values())
            self._running.clear()
            self._drop_executor()
            self.stopping.wait(START_PAUSE_S)
        else:
            self._running[future] = claim

    def _specification(self, job: str) -> tuple[bytes, int | None]:
        """Return the specification of a job for workers, kept while a chunk of it is in flight."""
        if job not in self._specifications:
            contents = self.patiently(lambda: self._store.contents_of(job))
            in_flight = {claim.job for claim in self._held}
            kept = {
                one: self._specifications[one] for one in self._specifications if one in in_flight
            }
            self._specifications = {**kept, job: (pack(contents.specification), contents.impulses)}
        return self._specifications[job]

    def _record(self, claim: ChunkClaim, future: "Future[Done]") -> None:
        error = future.exception()
        if error is None:
            done = future.result()
            self.patiently(lambda: self._store.finish(self.name, claim, done))
            self._kills = 0
            return
        reason = f"{type(error).__name__}: {error}"
        self._tell(f"chunk {claim.number} of job {claim.job} failed: {reason}")
        if isinstance(error, UnreadableError):
            self._fail_job(claim, str(error))
        else:
            self.patiently(lambda: self._store.fail(self.name, claim, reason))

    def _start_over(self) -> None:
        """Find out whom the death of a worker is to be blamed on.

        With several chunks in flight, on none: they are computed once more, each alone. One that
        was alone has failed if its worker died by its own fault; if it was killed, by whom is not
        known: a person, or the system for want of memory. That is borne for long, not for ever.
        """
        lost = list(self._running.values())
        self._running.clear()
        fault = "" if self._started is None else self._started.fault()
        self._drop_executor()
        if len(lost) > 1:
            self._tell(f"a worker died; the {len(lost)} chunks in flight are computed one by one")
            self._suspects.extend(lost)
            return
        (claim,) = lost
        of_job = f"chunk {claim.number} of job {claim.job}"
        if fault:
            self._tell(f"{of_job} failed: its worker died by {fault}")
            reason = f"its worker died by {fault}"
            self.patiently(lambda: self._store.fail(self.name, claim, reason))
            return
        self._kills += 1
        self._tell(f"the worker of {of_job} was killed, {self._kills} times in a row")
        if self._kills < MAX_KILLS:
            self._suspects.appendleft(claim)
            return
        self._kills = 0
        self._fail_job(
            claim,
            f"the worker of chunk {claim.number} was killed {MAX_KILLS} times in a row, as the "
            "system does for want of memory: take fewer chunk_rows, or fewer workers",
        )

    def _fail_job(self, claim: ChunkClaim, reason: str) -> None:
        self.patiently(lambda: self._store.fail_job(claim.job, reason))
        self.patiently(lambda: self._store.give_back(self.name, [claim]))

    def patiently(self, ask: Callable[[], Answer]) -> Answer:
        """Ask the store; wait, for a bounded time, while the database is gone.

        Parameters
        ----------
        ask
            Asks the store.

        Returns
        -------
        Answer
            What it returned.

        Raises
        ------
        StoreError
            If the database was gone for too long or until `stopping` was set, or has no space left.
        sqlalchemy.exc.DBAPIError
            If the database refuses for another reason.
        """
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
                pause = min(2 * pause, MAX_PAUSE_S)
            else:
                if since is not None:
                    self._tell("the database answers again")
                return answer

    def _drop_executor(self) -> None:
        started, self._started = self._started, None
        if started is not None:
            started.end()

    def _end(self) -> None:
        held = self._held
        self._running.clear()
        self._suspects.clear()
        self._drop_executor()
        if held:
            try:
                self._store.give_back(self.name, held)
            except DBAPIError as error:
                # They count as stalled soon, and are claimed by others.
                self._tell(f"chunks could not be given back: {_first_line(error)}")


def _broken(future: "Future[Done]") -> bool:
    """Whether the executor of a task that has ended broke, or dropped it."""
    return future.cancelled() or isinstance(future.exception(), BrokenExecutor)


def _first_line(error: DBAPIError) -> str:
    return str(error.orig).strip().partition("\n")[0]
