"""What a job holds: its specification, and its rows; both are checked against their hashes."""

import hashlib
from collections.abc import Iterator
from dataclasses import fields

import sqlalchemy as sa

from schemas.tables import sha256_of
from service.jobs.database import StoreError
from service.jobs.records import DELETED, NewJob
from service.jobs.schema import CHUNKS, JOBS, SPECIFICATIONS
from service.jobs.soundness import damage_of

BLOBS_AT_ONCE = 8
"""Chunks read at a time: at 10,000 rows, a few megabytes."""


class GoneError(StoreError):
    """The job that is asked for is not there any more."""


class DamagedError(StoreError):
    """What is asked for is not what was stored."""


def hash_of(job: str, number: int, blob: bytes) -> str:
    """Return the hash of a chunk's rows and of the place that they have.

    Rows that stand in another chunk's place thereby count as damaged.

    Parameters
    ----------
    job
        Id of the job.
    number
        Number of the chunk.
    blob
        The rows.

    Returns
    -------
    str
        SHA-256, in hexadecimal digits.
    """
    found = hashlib.sha256(f"{job} {number} ".encode())
    found.update(blob)
    return found.hexdigest()


def read_contents(engine: sa.Engine, job: str) -> NewJob:
    """Return what a job is made of.

    Parameters
    ----------
    engine
        Reads the store.
    job
        Id of the job.

    Returns
    -------
    NewJob
        The specification and size of the job.

    Raises
    ------
    GoneError
        If it has gone.
    DamagedError
        If its record or its specification is not what was stored.
    """
    wanted = (
        sa
        .select(JOBS, SPECIFICATIONS.c.specification)
        .select_from(JOBS.outerjoin(SPECIFICATIONS))
        .where(JOBS.c.id == job, JOBS.c.state != DELETED)
    )
    with engine.connect() as connection:
        found = connection.execute(wanted).mappings().one_or_none()
    if found is None:
        raise GoneError(f"the job {job} has gone")
    damage = damage_of(dict(found))
    if damage:
        raise DamagedError(damage)
    specification = found["specification"]
    if not isinstance(specification, str) or sha256_of(specification) != found["sha256"]:
        raise DamagedError("its specification in the job store is damaged")
    return NewJob(**{one.name: found[one.name] for one in fields(NewJob)})


def blobs(engine: sa.Engine, job: str) -> Iterator[bytes]:
    """Yield the rows of a job's chunks in order.

    Parameters
    ----------
    engine
        Reads the store.
    job
        Id of the job, which is done.

    Yields
    ------
    bytes
        The rows of one chunk.

    Raises
    ------
    GoneError
        If the job is deleted before all are read.
    DamagedError
        If some are not what was stored; chunks of older versions have no hash to tell by.
    """
    there = JOBS.c.id == job, JOBS.c.state != DELETED
    with engine.connect() as connection:
        chunks = connection.scalar(sa.select(JOBS.c.chunks).where(*there))
    if chunks is None:
        raise GoneError(f"the job {job} has gone")
    for first in range(0, chunks, BLOBS_AT_ONCE):
        after = min(first + BLOBS_AT_ONCE, chunks)
        wanted = (
            sa
            .select(CHUNKS.c.number, CHUNKS.c.blob, CHUNKS.c.sha256)
            .join(JOBS)
            .where(*there, CHUNKS.c.number >= first, CHUNKS.c.number < after)
            .order_by(CHUNKS.c.number)
        )
        with engine.connect() as connection:
            held = connection.execute(wanted).all()
        if len(held) < after - first:
            raise GoneError(f"the rows of job {job} have gone")
        for number, blob, told in held:
            whole = isinstance(blob, bytes)
            if not whole or told not in {None, hash_of(job, number, blob)}:
                raise DamagedError(f"the rows of chunk {number} of job {job} are damaged")
            yield blob
