"""The store of table jobs, which is the truth about them.

A chunk is ``waiting``, ``running`` (claimed by a worker that beats its heart) or ``done`` (its
rows are in the same record). Whoever records a chunk must still hold it: what was reclaimed or
cancelled meanwhile is dropped, so that nothing is lost or doubled.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

import sqlalchemy as sa

from service.jobs.database import opened
from service.jobs.schema import CHUNKS, JOBS

State = Literal["waiting", "running", "done", "failed", "cancelled"]

UNFINISHED = ("waiting", "running")

MOST_FAILURES = 3
"""A chunk that fails so often fails its job."""

RATE_WINDOW_S = 30.0
"""The rate is that of the chunks done so recently [s]."""

INSERTED_AT_ONCE = 10_000
BLOBS_AT_ONCE = 8
"""Chunks read at a time: at 10,000 rows, a few megabytes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NewJob:
    """What a job is made of: its specification as canonical JSON, and its size.

    ``impulses``: of each row; None where the kind of shaper says.
    """

    id: str
    specification: str
    sha256: str
    version: str
    rows: int
    chunk_rows: int
    impulses: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """A job and how far it is.

    Attributes
    ----------
    done, verified, verified_ideal, infeasible
        Rows that are computed, and what became of them.
    rate_rows_s
        Rows done lately [1/s].
    created
        Seconds since 1970, by the database's clock [s].
    """

    id: str
    state: State
    reason: str
    created: float
    specification: str
    sha256: str
    version: str
    rows: int
    chunks: int
    done: int
    verified: int
    verified_ideal: int
    infeasible: int
    rate_rows_s: float
    impulses: int | None = None

    @property
    def failed(self) -> int:
        """Rows whose solver or proof failed."""
        return self.done - self.verified - self.verified_ideal - self.infeasible

    @property
    def ended(self) -> bool:
        """Whether nothing more will happen to it."""
        return self.state not in UNFINISHED

    @property
    def left_s(self) -> float | None:
        """Time left at the present rate; None where that is not known [s]."""
        if self.state != "running" or self.rate_rows_s == 0:
            return None
        return (self.rows - self.done) / self.rate_rows_s


@dataclass(frozen=True, slots=True)
class Claim:
    """A chunk that a worker holds."""

    job: str
    number: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Done:
    """A computed chunk: its rows as one blob, and what became of them."""

    blob: bytes
    verified: int
    infeasible: int
    verified_ideal: int = 0


class Store:
    """Jobs in a database, shared by any number of processes.

    Parameters
    ----------
    url
        Of an SQLite file or a PostgreSQL database; made or migrated if need be.
    stalled_s
        A chunk whose worker has been silent for so long may be claimed by another [s].
    """

    def __init__(self, url: str, *, stalled_s: float) -> None:
        self.url = url
        self.stalled_s = stalled_s
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

    def add(self, job: NewJob) -> None:
        """Add a job; all of it, or nothing."""
        chunks = -(-job.rows // job.chunk_rows)
        new = {
            "id": job.id,
            "state": "waiting",
            "created": self._now,
            "specification": job.specification,
            "sha256": job.sha256,
            "version": job.version,
            "rows": job.rows,
            "chunks": chunks,
            "impulses": job.impulses,
        }
        with self._engine.begin() as connection:
            connection.execute(JOBS.insert().values(new))
            for first in range(0, chunks, INSERTED_AT_ONCE):
                connection.execute(
                    CHUNKS.insert(),
                    [
                        {
                            "job": job.id,
                            "number": number,
                            "state": "waiting",
                            "rows": min(job.chunk_rows, job.rows - number * job.chunk_rows),
                        }
                        for number in range(first, min(first + INSERTED_AT_ONCE, chunks))
                    ],
                )

    def claim(self, worker: str, most: int) -> list[Claim]:
        """Claim chunks for a worker: of the oldest job first, in order."""
        claimed: list[Claim] = []
        with self._engine.begin() as connection:
            active = sa.select(JOBS.c.id).where(JOBS.c.state.in_(UNFINISHED))
            for job in connection.scalars(active.order_by(JOBS.c.created, JOBS.c.id)).all():
                if len(claimed) == most:
                    break
                claimed += self._claim_of(connection, job, worker, most - len(claimed))
        return claimed

    def _claim_of(self, connection: sa.Connection, job: str, worker: str, most: int) -> list[Claim]:
        numbers: list[int] = []
        silent = sa.and_(
            CHUNKS.c.state == "running", CHUNKS.c.heartbeat < self._now - self.stalled_s
        )
        for free in (CHUNKS.c.state == "waiting", silent):
            numbers += connection.scalars(
                sa
                .select(CHUNKS.c.number)
                .where(CHUNKS.c.job == job, free)
                .order_by(CHUNKS.c.number)
                .limit(most - len(numbers))
                .with_for_update(skip_locked=True)
            ).all()
        if numbers:
            connection.execute(
                CHUNKS
                .update()
                .where(CHUNKS.c.job == job, CHUNKS.c.number.in_(numbers))
                .values(state="running", worker=worker, heartbeat=self._now)
            )
            connection.execute(
                JOBS
                .update()
                .where(JOBS.c.id == job, JOBS.c.state == "waiting")
                .values(state="running")
            )
        return [Claim(job, number) for number in numbers]

    def beat(self, worker: str, claims: Iterable[Claim]) -> None:
        """Say that a worker still computes its chunks."""
        with self._engine.begin() as connection:
            for claim in claims:
                connection.execute(
                    CHUNKS.update().where(*_held(worker, claim)).values(heartbeat=self._now)
                )

    def release(self, job: str) -> None:
        """Take back all chunks of a job: for one who knows that nobody else computes them."""
        with self._engine.begin() as connection:
            connection.execute(
                CHUNKS
                .update()
                .where(CHUNKS.c.job == job, CHUNKS.c.state == "running")
                .values(state="waiting", worker=None)
            )

    def reopen(self, job: str) -> None:
        """Let a failed job be tried again."""
        with self._engine.begin() as connection:
            failed = JOBS.c.id == job, JOBS.c.state == "failed"
            held = connection.execute(
                JOBS.update().where(*failed).values(state="running", reason="")
            )
            if held.rowcount:
                connection.execute(CHUNKS.update().where(CHUNKS.c.job == job).values(attempt=0))

    def give_back(self, worker: str, claims: Iterable[Claim]) -> None:
        """Leave chunks to others, as a worker does when it stops."""
        with self._engine.begin() as connection:
            for claim in claims:
                connection.execute(
                    CHUNKS
                    .update()
                    .where(*_held(worker, claim))
                    .values(state="waiting", worker=None)
                )

    def finish(self, worker: str, claim: Claim, done: Done) -> bool:
        """Record a chunk, and return whether the worker still held it."""
        with self._engine.begin() as connection:
            held = connection.execute(
                CHUNKS
                .update()
                .where(*_held(worker, claim))
                .values(
                    state="done",
                    finished=self._now,
                    blob=done.blob,
                    verified=done.verified,
                    verified_ideal=done.verified_ideal,
                    infeasible=done.infeasible,
                )
            )
        return held.rowcount == 1

    def settle(self) -> None:
        """Mark jobs as done whose chunks all are.

        In a transaction after that of the last chunk: of two that end at once, neither sees the
        other's before.
        """
        with self._engine.begin() as connection:
            open_chunk = sa.exists().where(
                CHUNKS.c.job == JOBS.c.id, CHUNKS.c.state.in_(UNFINISHED)
            )
            connection.execute(
                JOBS.update().where(JOBS.c.state == "running", ~open_chunk).values(state="done")
            )

    def fail(self, worker: str, claim: Claim, reason: str) -> None:
        """Record that a chunk failed: it is tried again, or its job fails with the reason."""
        with self._engine.begin() as connection:
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
                connection.execute(
                    JOBS
                    .update()
                    .where(JOBS.c.id == claim.job, JOBS.c.state == "running")
                    .values(state="failed", reason=told)
                )

    def cancel(self, job: str) -> bool:
        """Cancel a job, drop its rows, and return whether it is cancelled now."""
        with self._engine.begin() as connection:
            connection.execute(
                JOBS
                .update()
                .where(JOBS.c.id == job, JOBS.c.state.in_(UNFINISHED))
                .values(state="cancelled")
            )
            state = connection.scalar(sa.select(JOBS.c.state).where(JOBS.c.id == job))
            if state == "cancelled":
                connection.execute(CHUNKS.delete().where(CHUNKS.c.job == job))
        return state == "cancelled"

    def drop_ended(self, older_than_s: float) -> int:
        """Drop jobs that ended so long ago, with their rows; return how many.

        A job has ended with the last chunk that was recorded; one without any when it was begun.
        """
        with self._engine.begin() as connection:
            last = sa.select(sa.func.max(CHUNKS.c.finished)).where(CHUNKS.c.job == JOBS.c.id)
            ended = sa.func.coalesce(last.scalar_subquery(), JOBS.c.created)
            old = connection.scalars(
                sa
                .select(JOBS.c.id)
                .where(JOBS.c.state.not_in(UNFINISHED), ended < self._now - older_than_s)
                .with_for_update(skip_locked=True)
            ).all()
            for table, column in ((CHUNKS, CHUNKS.c.job), (JOBS, JOBS.c.id)):
                connection.execute(table.delete().where(column.in_(old)))
        return len(old)

    def job(self, job: str) -> Job | None:
        """Return a job, or None."""
        found = self._jobs(sa.select(JOBS).where(JOBS.c.id == job))
        return found[0] if found else None

    def jobs(self, most: int) -> list[Job]:
        """Return the newest jobs, newest first."""
        newest = sa.select(JOBS).order_by(JOBS.c.created.desc(), JOBS.c.id).limit(most)
        return self._jobs(newest)

    def specification(self, job: str) -> tuple[str, int | None]:
        """Return the specification of a job as canonical JSON, and the impulses of each row."""
        with self._reading.connect() as connection:
            wanted = sa.select(JOBS.c.specification, JOBS.c.impulses).where(JOBS.c.id == job)
            canonical, impulses = connection.execute(wanted).one()
            return canonical, impulses

    def _jobs(self, wanted: sa.Select[Any]) -> list[Job]:
        with self._reading.connect() as connection:
            return [
                Job(**row, **self._progress(connection, row["id"]))
                for row in connection.execute(wanted).mappings().all()
            ]

    def _progress(self, connection: sa.Connection, job: str) -> dict[str, Any]:
        recent = CHUNKS.c.finished > self._now - RATE_WINDOW_S
        sums = [
            sa.func.sum(CHUNKS.c.rows),
            sa.func.sum(CHUNKS.c.verified),
            sa.func.sum(CHUNKS.c.verified_ideal),
            sa.func.sum(CHUNKS.c.infeasible),
            sa.func.sum(sa.case((recent, CHUNKS.c.rows), else_=0)),
            sa.func.min(CHUNKS.c.finished),
            self._now,
        ]
        row = connection.execute(
            sa.select(*sums).where(CHUNKS.c.job == job, CHUNKS.c.state == "done")
        ).one()
        done, verified, ideal, infeasible, lately = (int(value or 0) for value in row[:5])
        # The first chunk marks the start: its own rows took the time before it.
        seconds = min(RATE_WINDOW_S, row[6] - row[5]) if done else 0.0
        return {
            "done": done,
            "verified": verified,
            "verified_ideal": ideal,
            "infeasible": infeasible,
            "rate_rows_s": lately / seconds if seconds > 0 else 0.0,
        }

    def blobs(self, job: str) -> Iterator[bytes]:
        """Yield the rows of a job's chunks in order."""
        first = 0
        while True:
            with self._reading.connect() as connection:
                held = connection.scalars(
                    sa
                    .select(CHUNKS.c.blob)
                    .where(CHUNKS.c.job == job, CHUNKS.c.number >= first)
                    .order_by(CHUNKS.c.number)
                    .limit(BLOBS_AT_ONCE)
                ).all()
            yield from held
            if len(held) < BLOBS_AT_ONCE:
                return
            first += BLOBS_AT_ONCE


def _held(worker: str, claim: Claim) -> tuple[sa.ColumnElement[bool], ...]:
    return (
        CHUNKS.c.job == claim.job,
        CHUNKS.c.number == claim.number,
        CHUNKS.c.state == "running",
        CHUNKS.c.worker == worker,
    )
