"""Rows erased a few chunks at a time, so that whoever else writes to the store need not wait."""

import time
from collections.abc import Callable

import sqlalchemy as sa

from service.jobs.records import DELETED
from service.jobs.schema import CHUNKS, JOBS, SPECIFICATIONS

ERASED_AT_ONCE = 100
"""Chunks erased in one transaction: at 10,000 rows, tens of megabytes."""

LEFT = sa.or_(
    JOBS.c.state == DELETED,
    sa.and_(JOBS.c.state == "cancelled", sa.exists().where(CHUNKS.c.job == JOBS.c.id)),
)
"""Whether there is something to erase of a job, of which no chunk will be claimed any more."""


def erase_job(engine: sa.Engine, job: str, stopping: Callable[[], bool]) -> None:
    """Erase the chunks of a job, then the rest of one that is deleted.

    Parameters
    ----------
    engine
        Writes to the store.
    job
        Id of the job, which is cancelled or deleted.
    stopping
        Asked again and again whether to stop before all is erased.
    """
    some = sa.select(CHUNKS.c.number).where(CHUNKS.c.job == job).limit(ERASED_AT_ONCE)
    numbers: list[int] = [0]
    while numbers:
        if stopping():
            return
        began = time.monotonic()
        with engine.begin() as connection:
            numbers = list(connection.scalars(some).all())
            erased = CHUNKS.c.job == job, CHUNKS.c.number.in_(numbers)
            connection.execute(CHUNKS.delete().where(*erased))
        # SQLite has no queue of writers: they get in between if they are left as long as this held
        # the lock.
        time.sleep(time.monotonic() - began)
    deleted = sa.exists().where(JOBS.c.id == job, JOBS.c.state == DELETED)
    with engine.begin() as connection:
        connection.execute(SPECIFICATIONS.delete().where(SPECIFICATIONS.c.job == job, deleted))
        connection.execute(JOBS.delete().where(JOBS.c.id == job, JOBS.c.state == DELETED))
