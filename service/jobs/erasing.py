"""Chunks erased a few at a time, so that whoever else writes to the store need not wait for all."""

import time

import sqlalchemy as sa

from service.jobs.schema import CHUNKS

ERASED_AT_ONCE = 100
"""Chunks erased in one transaction: at 10,000 rows, tens of megabytes."""


def erase_chunks(engine: sa.Engine, job: str) -> None:
    """Erase the chunks of a job of which none will be claimed any more."""
    some = sa.select(CHUNKS.c.number).where(CHUNKS.c.job == job).limit(ERASED_AT_ONCE)
    while True:
        began = time.monotonic()
        with engine.begin() as connection:
            numbers = connection.scalars(some).all()
            erased = CHUNKS.c.job == job, CHUNKS.c.number.in_(numbers)
            connection.execute(CHUNKS.delete().where(*erased))
        if len(numbers) < ERASED_AT_ONCE:
            return
        # SQLite has no queue of writers: they get in between if they are left as long as this held
        # the lock.
        time.sleep(time.monotonic() - began)
