"""Jobs for tests of the store, and what others may do to it."""

import uuid

import sqlalchemy as sa

from schemas.tables import sha256_of
from service.jobs.records import Done, NewJob
from service.jobs.schema import CHUNKS, JOBS
from service.jobs.store import Store

HOUR_S = 3600.0
"""A silence that no test comes to by itself, however slow the machine is [s]."""


def engine_of(url: str) -> sa.Engine:
    """Return a way to a store's database beside the store."""
    return sa.create_engine(url.replace("postgresql://", "postgresql+psycopg://"))


def silent_for(url: str, seconds: float) -> None:
    """Make all heartbeats older, as if time had passed."""
    engine = engine_of(url)
    with engine.begin() as connection:
        connection.execute(sa.update(CHUNKS).values(heartbeat=CHUNKS.c.heartbeat - seconds))
    engine.dispose()


def job(rows: int = 10, chunk_rows: int = 4) -> NewJob:
    return NewJob(
        id=uuid.uuid4().hex,
        specification="{}",
        sha256=sha256_of("{}"),
        version="1",
        rows=rows,
        chunk_rows=chunk_rows,
        estimated_bytes=0,
    )


def done(blob: bytes = b"rows", *, infeasible: int = 0, verified_ideal: int = 0) -> Done:
    """Return a chunk of a row or more, the first of them verified."""
    return Done(blob=blob, verified=1, infeasible=infeasible, verified_ideal=verified_ideal)


def count_chunks(url: str, job: str) -> int:
    """Return how many chunks of a job have a record."""
    engine = engine_of(url)
    with engine.connect() as connection:
        wanted = sa.select(sa.func.count()).select_from(CHUNKS).where(CHUNKS.c.job == job)
        found = int(connection.scalar(wanted) or 0)
    engine.dispose()
    return found


def state_of(store: Store, one: str) -> str:
    found = store.job(one)
    return "gone" if found is None else found.state


def erase(store: Store) -> None:
    """Erase what there is to erase, as the service's cleaner does."""
    for one in store.jobs_to_erase():
        store.erase(one)


def change_jobs(url: str, **values: object) -> None:
    """Change all jobs as another version, or a person, would."""
    engine = engine_of(url)
    with engine.begin() as connection:
        connection.execute(sa.update(JOBS).values(**values))
    engine.dispose()
