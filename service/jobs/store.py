"""The store of table jobs, which is the truth about them.

A chunk is ``waiting``, ``running`` (claimed by a worker that beats its heart) or ``done`` (its
rows are in the same record). Whoever records a chunk must still hold it: what was reclaimed or
cancelled meanwhile is dropped, so that nothing is lost or doubled.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import sqlalchemy as sa

from service.jobs import adding, contents, erasing
from service.jobs.claims import Claimer, has_rows
from service.jobs.counting import NO_RATE, NOTHING, with_chunk
from service.jobs.database import open_database
from service.jobs.records import DELETED, ENDED, UNFINISHED, ChunkClaim, Done, Job, NewJob
from service.jobs.schema import CHUNKS, JOBS
from service.jobs.views import see_jobs
from service.version import version as version_of_product

MAX_FAILURES = 3
"""A chunk that fails so often fails its job."""


class Store:
    """Jobs in a database, shared by any number of processes.

    Parameters
    ----------
    url
        Of an SQLite file or a PostgreSQL database; made or migrated if need be.
    stalled_s
        A chunk whose worker has been silent for so long may be claimed by another [s].
    version
        Of what computes the rows; that of this product if not given.
    """

    def __init__(self, url: str, *, stalled_s: float, version: str | None = None) -> None:
        self.url = url
        self.stalled_s = stalled_s
        self.version = version_of_product() if version is None else version
        self._database = open_database(url)
        self._engine, self._reading = self._database.writing, self._database.reading
        postgres = self._engine.dialect.name == "postgresql"
        # One clock for all: that of the database.
        self._now: sa.ColumnElement[float] = sa.literal_column(
            "extract(epoch from clock_timestamp())"
            if postgres
            else "((julianday('now') - 2440587.5) * 86400.0)",
            sa.Double,
        )

    def close(self) -> None:
        """Let go of the database."""
        self._database.close()

    def add(self, job: NewJob, key: str | None = None) -> str:
        """Add a job, unless its key has begun one already.

        Parameters
        ----------
        job, key
            As of `adding.add`.

        Returns
        -------
        str
            Id of the new job, or of the one that the key has begun.

        Raises
        ------
        KeyReusedError
            If the key began a job of another specification.
        """
        return adding.add(self._database, job, key, self._now)

    def claim(self, worker: str, most: int) -> list[ChunkClaim]:
        """Claim chunks for a worker, of the jobs in turn.

        Parameters
        ----------
        worker
            Name of the worker.
        most
            Most chunks.

        Returns
        -------
        list of Claim
            The chunks that the worker holds now; `service.jobs.claims` says which.
        """
        unfinished = sa.select(sa.exists().where(JOBS.c.state.in_(UNFINISHED)))
        with self._reading.connect() as connection:
            if not connection.scalar(unfinished):
                return []
        claimer = Claimer(
            worker=worker, now=self._now, stalled_s=self.stalled_s, version=self.version
        )
        with self._engine.begin() as connection:
            return claimer.claim(connection, most)

    def beat(self, worker: str, claims: Iterable[ChunkClaim]) -> None:
        """Record that a worker still computes its chunks.

        Parameters
        ----------
        worker
            Name of the worker.
        claims
            Its chunks; one that it holds no more stays as it is.
        """
        for claim in claims:
            self._change(worker, claim, heartbeat=self._now)

    def give_back(self, worker: str, claims: Iterable[ChunkClaim]) -> None:
        """Free chunks for others, as a worker does when it stops.

        Parameters
        ----------
        worker
            Name of the worker.
        claims
            Its chunks; one that it holds no more stays as it is.
        """
        for claim in claims:
            self._change(worker, claim, state="waiting", worker=None)

    def finish(self, worker: str, claim: ChunkClaim, done: Done) -> bool:
        """Record a chunk and count it, if its worker still holds it.

        Parameters
        ----------
        worker
            Name of the worker.
        claim
            The chunk.
        done
            Its rows, and what became of them.

        Returns
        -------
        bool
            Whether the worker still held it; False too where its job is cancelled or gone.
        """
        told = contents.hash_of(claim.job, claim.number, done.blob)
        with self._engine.begin() as connection:
            if _lock_job(connection, claim.job) in {None, "cancelled", DELETED}:
                return False
            rows = connection.execute(
                CHUNKS
                .update()
                .where(*_is_held(worker, claim))
                .values(
                    state="done",
                    finished=self._now,
                    blob=done.blob,
                    sha256=told,
                    verified=done.verified,
                    verified_ideal=done.verified_ideal,
                    infeasible=done.infeasible,
                )
                .returning(CHUNKS.c.rows)
            ).scalar_one_or_none()
            if rows is None:
                return False
            counted = with_chunk(rows, done, self._now)
            connection.execute(JOBS.update().where(JOBS.c.id == claim.job).values(counted))
        return True

    def _change(self, _holder: str, _claim: ChunkClaim, **values: Any) -> None:  # noqa: ANN401
        """Change a chunk if a worker holds it; one a transaction, so that none waits for two."""
        with self._engine.begin() as connection:
            connection.execute(CHUNKS.update().where(*_is_held(_holder, _claim)).values(values))

    def settle(self) -> None:
        """Mark jobs as done whose chunks all are.

        After the transaction of the last chunk: of two that end at once, neither sees the other's
        before.
        """
        open_chunk = sa.exists().where(CHUNKS.c.job == JOBS.c.id, CHUNKS.c.state.in_(UNFINISHED))
        complete = sa.and_(JOBS.c.state == "running", JOBS.c.begun == JOBS.c.chunks, ~open_chunk)
        with self._reading.connect() as connection:
            found = connection.scalars(sa.select(JOBS.c.id).where(complete)).all()
        for job in found:
            with self._engine.begin() as connection:
                done = JOBS.update().where(JOBS.c.id == job, complete).values(state="done")
                connection.execute(done)

    def fail(self, worker: str, claim: ChunkClaim, reason: str) -> None:
        """Record that a chunk failed.

        The chunk is tried again. One that fails `MAX_FAILURES` times fails its job.

        Parameters
        ----------
        worker
            Name of the worker; nothing is recorded unless it holds the chunk.
        claim
            The chunk.
        reason
            Why it failed; the last reason becomes that of the job.
        """
        with self._engine.begin() as connection:
            _lock_job(connection, claim.job)
            held = connection.execute(
                CHUNKS
                .update()
                .where(*_is_held(worker, claim))
                .values(state="waiting", worker=None, attempt=CHUNKS.c.attempt + 1)
            )
            attempts = connection.scalar(
                sa.select(CHUNKS.c.attempt).where(
                    CHUNKS.c.job == claim.job, CHUNKS.c.number == claim.number
                )
            )
            if held.rowcount == 1 and attempts is not None and attempts >= MAX_FAILURES:
                told = f"chunk {claim.number} failed {attempts} times, last: {reason}"
                connection.execute(_set_failed(claim.job, told))

    def fail_job(self, job: str, reason: str) -> None:
        """Record that a job cannot go on, whatever its chunks do.

        Parameters
        ----------
        job
            Id of the job; one that has ended stays as it is.
        reason
            Why it failed.
        """
        with self._engine.begin() as connection:
            connection.execute(_set_failed(job, reason))

    def release(self, job: str) -> None:
        """Take back all chunks of a job.

        It is for one who knows that nobody else computes them.
        """
        with self._engine.begin() as connection:
            connection.execute(
                CHUNKS
                .update()
                .where(CHUNKS.c.job == job, CHUNKS.c.state == "running")
                .values(state="waiting", worker=None)
            )

    def resume(self, job: str) -> bool:
        """Let a failed job be tried again; return whether it is unfinished now.

        One that has rows of another version is not, as its rows would be of both; nor is one whose
        record is damaged.
        """
        with self._engine.begin() as connection:
            state = _lock_job(connection, job)
            seen = self._see(connection, job)
            if seen is None or not seen.sound:
                return False
            if state == "failed":
                if seen.version != self.version and connection.scalar(sa.select(has_rows(job))):
                    return False
                again = {"state": "running", "reason": "", **NO_RATE}
                connection.execute(JOBS.update().where(JOBS.c.id == job).values(again))
                tried = CHUNKS.c.job == job, CHUNKS.c.state.in_(UNFINISHED)
                connection.execute(CHUNKS.update().where(*tried).values(attempt=0))
        return state in {*UNFINISHED, "failed"}

    def cancel(self, job: str) -> bool:
        """Cancel a job, and return whether it is cancelled now.

        Its rows count no more from the first moment on; `erase` drops them.
        """
        with self._engine.begin() as connection:
            state = _lock_job(connection, job)
            if state in UNFINISHED:
                cancelled = {"state": "cancelled", **NOTHING}
                connection.execute(JOBS.update().where(JOBS.c.id == job).values(cancelled))
        return state in {*UNFINISHED, "cancelled"}

    def delete(self, job: str) -> bool:
        """Delete a job that has ended, or cannot go on, and return whether it had.

        Nobody sees it from the first moment on; `erase` drops it and its rows.
        """
        with self._engine.begin() as connection:
            _lock_job(connection, job)
            seen = self._see(connection, job)
            if seen is None or not seen.ended:
                return False
            deleted = {"state": DELETED, "key": None}
            connection.execute(JOBS.update().where(JOBS.c.id == job).values(deleted))
        return True

    def jobs_to_erase(self) -> list[str]:
        """Return the cancelled and deleted jobs that are still to be erased."""
        with self._reading.connect() as connection:
            return list(connection.scalars(sa.select(JOBS.c.id).where(erasing.LEFT)).all())

    def erase(self, job: str, stopping: Callable[[], bool] = lambda: False) -> None:
        """Erase the rest of a job that is cancelled or deleted.

        Parameters
        ----------
        job
            Id of the job.
        stopping
            Asked again and again whether to stop before all is erased.
        """
        erasing.erase_job(self._engine, job, stopping)

    def drop_ended(self, older_than_s: float) -> int:
        """Delete jobs that ended so long ago; return how many.

        A job has ended with the last chunk that was recorded; one without any when it was begun.
        """
        ended = sa.func.coalesce(JOBS.c.last_finished, JOBS.c.created)
        old = JOBS.c.state.in_(ENDED), ended < self._now - older_than_s
        with self._reading.connect() as connection:
            found = connection.scalars(sa.select(JOBS.c.id).where(*old)).all()
        return sum(self.delete(job) for job in found)

    def job(self, job: str) -> Job | None:
        """Return a job, or None."""
        with self._reading.connect() as connection:
            return self._see(connection, job)

    def _see(self, connection: sa.Connection, job: str) -> Job | None:
        found = see_jobs(connection, self._now, lambda seen: seen.where(JOBS.c.id == job))
        return found[0] if found else None

    def jobs(self, most: int) -> list[Job]:
        """Return the newest jobs, newest first."""
        newest = JOBS.c.created.desc(), JOBS.c.id
        with self._reading.connect() as connection:
            return see_jobs(connection, self._now, lambda seen: seen.order_by(*newest).limit(most))

    def contents_of(self, job: str) -> NewJob:
        """Return what a job is made of; see `contents.read_contents`."""
        return contents.read_contents(self._reading, job)

    def blobs(self, job: str) -> Iterator[bytes]:
        """Return the rows of a job's chunks in order; see `contents.blobs`."""
        return contents.blobs(self._reading, job)


def _set_failed(job: str, reason: str) -> sa.Update:
    unfinished = JOBS.c.id == job, JOBS.c.state.in_(UNFINISHED)
    return JOBS.update().where(*unfinished).values(state="failed", reason=reason)


def _lock_job(connection: sa.Connection, job: str) -> str | None:
    """Lock a job, before its chunks as all do who need both, and return its state."""
    wanted = sa.select(JOBS.c.state).where(JOBS.c.id == job).with_for_update()
    state: str | None = connection.scalar(wanted)
    return state


def _is_held(worker: str, claim: ChunkClaim) -> tuple[sa.ColumnElement[bool], ...]:
    return (
        CHUNKS.c.job == claim.job,
        CHUNKS.c.number == claim.number,
        CHUNKS.c.state == "running",
        CHUNKS.c.worker == worker,
    )
