"""The store of table jobs, which is the truth about them.

A chunk is ``waiting``, ``running`` (claimed by a worker that beats its heart) or ``done`` (its
rows are in the same record). Whoever records a chunk must still hold it: what was reclaimed or
cancelled meanwhile is dropped, so that nothing is lost or doubled.
"""

from collections.abc import Iterable, Iterator
from dataclasses import fields
from typing import Any

import sqlalchemy as sa
from sqlalchemy.exc import IntegrityError

from service.jobs.claims import Claimer, has_rows
from service.jobs.database import StoreError, opened
from service.jobs.erasing import erase_chunks
from service.jobs.records import DELETED, ENDED, UNFINISHED, Claim, Done, Job, NewJob
from service.jobs.schema import CHUNKS, JOBS
from service.jobs.views import seen_jobs
from service.operations import version as version_of_product

MOST_FAILURES = 3
"""A chunk that fails so often fails its job."""

BLOBS_AT_ONCE = 8
"""Chunks read at a time: at 10,000 rows, a few megabytes."""


class GoneError(StoreError):
    """The job that is asked for is not there any more."""


class KeyReusedError(Exception):
    """A key that began a job came with another specification."""


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
        self._database = opened(url)
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
        """Add a job, unless its key has begun one already; return the id of the one that is there.

        Raises
        ------
        KeyReusedError
            If the key began a job of another specification.
        """
        new = {
            "id": job.id,
            "state": "waiting",
            "created": self._now,
            "specification": job.specification,
            "sha256": job.sha256,
            "version": job.version,
            "rows": job.rows,
            "chunks": job.chunks,
            "impulses": job.impulses,
            "chunk_rows": job.chunk_rows,
            "estimated_bytes": job.estimated_bytes,
            "key": key,
        }
        try:
            with self._engine.begin() as connection:
                connection.execute(JOBS.insert().values(new))
        except IntegrityError:
            begun = self._begun_by(key)
            if begun is None:
                raise
            known, sha256 = begun
            if sha256 != job.sha256:
                raise KeyReusedError("this key began a table of another specification") from None
            return known
        return job.id

    def _begun_by(self, key: str | None) -> tuple[str, str] | None:
        """Return id and hash of the job that a key began."""
        with self._reading.connect() as connection:
            wanted = sa.select(JOBS.c.id, JOBS.c.sha256).where(JOBS.c.key == key)
            found = connection.execute(wanted).one_or_none()
        return None if found is None else (found.id, found.sha256)

    def claim(self, worker: str, most: int) -> list[Claim]:
        """Claim chunks for a worker, of the jobs in turn; see `service.jobs.claims`."""
        unfinished = sa.select(sa.exists().where(JOBS.c.state.in_(UNFINISHED)))
        with self._reading.connect() as connection:
            if not connection.scalar(unfinished):
                return []
        claimer = Claimer(
            worker=worker, now=self._now, stalled_s=self.stalled_s, version=self.version
        )
        with self._engine.begin() as connection:
            return claimer.claim(connection, most)

    def beat(self, worker: str, claims: Iterable[Claim]) -> None:
        """Say that a worker still computes its chunks."""
        for claim in claims:
            self._change(worker, claim, heartbeat=self._now)

    def give_back(self, worker: str, claims: Iterable[Claim]) -> None:
        """Leave chunks to others, as a worker does when it stops."""
        for claim in claims:
            self._change(worker, claim, state="waiting", worker=None)

    def finish(self, worker: str, claim: Claim, done: Done) -> bool:
        """Record a chunk, and return whether the worker still held it."""
        return self._change(
            worker,
            claim,
            state="done",
            finished=self._now,
            blob=done.blob,
            verified=done.verified,
            verified_ideal=done.verified_ideal,
            infeasible=done.infeasible,
        )

    def _change(self, _holder: str, _claim: Claim, **values: Any) -> bool:  # noqa: ANN401
        """Change a chunk if a worker holds it; one a transaction, so that none waits for two."""
        with self._engine.begin() as connection:
            held = connection.execute(CHUNKS.update().where(*_held(_holder, _claim)).values(values))
        return held.rowcount == 1

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

    def fail(self, worker: str, claim: Claim, reason: str) -> None:
        """Record that a chunk failed: it is tried again, or its job fails with the reason."""
        with self._engine.begin() as connection:
            self._lock(connection, claim.job)
            held = connection.execute(
                CHUNKS
                .update()
                .where(*_held(worker, claim))
                .values(state="waiting", worker=None, attempt=CHUNKS.c.attempt + 1)
            )
            attempts = connection.scalar(
                sa.select(CHUNKS.c.attempt).where(
                    CHUNKS.c.job == claim.job, CHUNKS.c.number == claim.number
                )
            )
            if held.rowcount == 1 and attempts is not None and attempts >= MOST_FAILURES:
                told = f"chunk {claim.number} failed {attempts} times, last: {reason}"
                connection.execute(_failed(claim.job, told))

    def fail_job(self, job: str, reason: str) -> None:
        """Record that a job cannot go on, whatever its chunks do."""
        with self._engine.begin() as connection:
            connection.execute(_failed(job, reason))

    def release(self, job: str) -> None:
        """Take back all chunks of a job: for one who knows that nobody else computes them."""
        with self._engine.begin() as connection:
            connection.execute(
                CHUNKS
                .update()
                .where(CHUNKS.c.job == job, CHUNKS.c.state == "running")
                .values(state="waiting", worker=None)
            )

    def resume(self, job: str) -> bool:
        """Let a failed job be tried again, and return whether it is unfinished now.

        One that has rows of another version is not: its rows would be of both.
        """
        with self._engine.begin() as connection:
            self._lock(connection, job)
            same = sa.or_(JOBS.c.version == self.version, ~has_rows(job))
            held = connection.execute(
                JOBS
                .update()
                .where(JOBS.c.id == job, JOBS.c.state == "failed", same)
                .values(state="running", reason="")
            )
            if held.rowcount:
                tried = CHUNKS.c.job == job, CHUNKS.c.state.in_(UNFINISHED)
                connection.execute(CHUNKS.update().where(*tried).values(attempt=0))
            return _state_of(connection, job) in UNFINISHED

    def cancel(self, job: str) -> bool:
        """Cancel a job, drop its rows, and return whether it is cancelled now."""
        with self._engine.begin() as connection:
            connection.execute(
                JOBS
                .update()
                .where(JOBS.c.id == job, JOBS.c.state.in_(UNFINISHED))
                .values(state="cancelled")
            )
            cancelled = _state_of(connection, job) == "cancelled"
        if cancelled:
            erase_chunks(self._engine, job)
        return cancelled

    def delete(self, job: str) -> bool:
        """Erase a job that has ended, with its rows, and return whether it had.

        Nobody sees it from the first moment on; what a killed process leaves, `erase_deleted` ends.
        """
        with self._engine.begin() as connection:
            held = connection.execute(
                JOBS
                .update()
                .where(JOBS.c.id == job, JOBS.c.state.not_in((*UNFINISHED, DELETED)))
                .values(state=DELETED, key=None)
            )
        if held.rowcount:
            self._erase(job)
        return held.rowcount == 1

    def erase_deleted(self) -> None:
        """Erase what was deleted by processes that were killed meanwhile."""
        with self._reading.connect() as connection:
            wanted = sa.select(JOBS.c.id).where(JOBS.c.state == DELETED)
            left = connection.scalars(wanted).all()
        for job in left:
            self._erase(job)

    def drop_ended(self, older_than_s: float) -> int:
        """Delete jobs that ended so long ago; return how many.

        A job has ended with the last chunk that was recorded; one without any when it was begun.
        """
        last = sa.select(sa.func.max(CHUNKS.c.finished)).where(CHUNKS.c.job == JOBS.c.id)
        ended = sa.func.coalesce(last.scalar_subquery(), JOBS.c.created)
        old = JOBS.c.state.in_(ENDED), ended < self._now - older_than_s
        with self._reading.connect() as connection:
            found = connection.scalars(sa.select(JOBS.c.id).where(*old)).all()
        dropped = sum(self.delete(job) for job in found)
        self.erase_deleted()
        return dropped

    def _erase(self, job: str) -> None:
        erase_chunks(self._engine, job)
        with self._engine.begin() as connection:
            connection.execute(JOBS.delete().where(JOBS.c.id == job))

    def job(self, job: str) -> Job | None:
        """Return a job, or None."""
        with self._reading.connect() as connection:
            found = seen_jobs(connection, self._now, lambda seen: seen.where(JOBS.c.id == job))
        return found[0] if found else None

    def jobs(self, most: int) -> list[Job]:
        """Return the newest jobs, newest first."""
        newest = JOBS.c.created.desc(), JOBS.c.id
        with self._reading.connect() as connection:
            return seen_jobs(connection, self._now, lambda seen: seen.order_by(*newest).limit(most))

    def made_of(self, job: str) -> NewJob:
        """Return what a job is made of.

        Raises
        ------
        GoneError
            If it has gone.
        """
        wanted = [JOBS.c[one.name] for one in fields(NewJob)]
        with self._reading.connect() as connection:
            seen = sa.select(*wanted).where(JOBS.c.id == job, JOBS.c.state != DELETED)
            found = connection.execute(seen).mappings().one_or_none()
        if found is None:
            raise GoneError(f"the job {job} has gone")
        return NewJob(**found)

    def blobs(self, job: str) -> Iterator[bytes]:
        """Yield the rows of a job's chunks in order.

        Raises
        ------
        GoneError
            If the job is deleted before all are read.
        """
        with self._reading.connect() as connection:
            chunks = connection.scalar(sa.select(JOBS.c.chunks).where(JOBS.c.id == job))
        if chunks is None:
            raise GoneError(f"the job {job} has gone")
        for first in range(0, chunks, BLOBS_AT_ONCE):
            after = min(first + BLOBS_AT_ONCE, chunks)
            with self._reading.connect() as connection:
                held = connection.scalars(
                    sa
                    .select(CHUNKS.c.blob)
                    .where(CHUNKS.c.job == job, CHUNKS.c.number >= first, CHUNKS.c.number < after)
                    .order_by(CHUNKS.c.number)
                ).all()
            if len(held) < after - first:
                raise GoneError(f"the rows of job {job} have gone")
            yield from held

    def _lock(self, connection: sa.Connection, job: str) -> None:
        """Lock a job before its chunks, as all do who need both."""
        connection.execute(sa.select(JOBS.c.id).where(JOBS.c.id == job).with_for_update())


def _failed(job: str, reason: str) -> sa.Update:
    unfinished = JOBS.c.id == job, JOBS.c.state.in_(UNFINISHED)
    return JOBS.update().where(*unfinished).values(state="failed", reason=reason)


def _state_of(connection: sa.Connection, job: str) -> str | None:
    found: str | None = connection.scalar(sa.select(JOBS.c.state).where(JOBS.c.id == job))
    return found


def _held(worker: str, claim: Claim) -> tuple[sa.ColumnElement[bool], ...]:
    return (
        CHUNKS.c.job == claim.job,
        CHUNKS.c.number == claim.number,
        CHUNKS.c.state == "running",
        CHUNKS.c.worker == worker,
    )
