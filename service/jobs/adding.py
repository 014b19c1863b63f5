"""How a job comes into the store, once for each key."""

import sqlalchemy as sa
from sqlalchemy.exc import IntegrityError

from service.jobs.database import Database
from service.jobs.records import NewJob
from service.jobs.schema import JOBS, SPECIFICATIONS


class KeyReusedError(Exception):
    """A key that began a job came with another specification."""


def add(database: Database, job: NewJob, key: str | None, now: sa.ColumnElement[float]) -> str:
    """Add a job, unless its key has begun one already.

    Parameters
    ----------
    database
        The database of the store.
    job
        The new job.
    key
        Names the request that asks for the job; None of one that may not be repeated.
    now
        The database's clock [s].

    Returns
    -------
    str
        Id of the new job, or of the one that the key has begun.

    Raises
    ------
    KeyReusedError
        If the key began a job of another specification.
    sqlalchemy.exc.IntegrityError
        If the database refuses the record, and no job of that key is the reason.
    """
    new = {
        "id": job.id,
        "state": "waiting",
        "created": now,
        "sha256": job.sha256,
        "version": job.version,
        "rows": job.rows,
        "chunks": job.chunks,
        "impulses": job.impulses,
        "chunk_rows": job.chunk_rows,
        "estimated_bytes": job.estimated_bytes,
        "key": key,
    }
    apart = {"job": job.id, "specification": job.specification}
    try:
        with database.writing.begin() as connection:
            connection.execute(JOBS.insert().values(new))
            connection.execute(SPECIFICATIONS.insert().values(apart))
    except IntegrityError:
        begun = _job_of_key(database, key)
        if begun is None:
            raise
        known, sha256 = begun
        if sha256 != job.sha256:
            raise KeyReusedError("this key began a table of another specification") from None
        return known
    return job.id


def _job_of_key(database: Database, key: str | None) -> tuple[str, str] | None:
    """Return id and hash of the job that a key began."""
    with database.reading.connect() as connection:
        wanted = sa.select(JOBS.c.id, JOBS.c.sha256).where(JOBS.c.key == key)
        found = connection.execute(wanted).one_or_none()
    return None if found is None else (found.id, found.sha256)
