"""What is seen of jobs from outside: how far they are, without their specifications."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import sqlalchemy as sa

from service.jobs.counting import NOTHING, rate_rows_s
from service.jobs.records import DELETED, ENDED, UNFINISHED, Job
from service.jobs.schema import JOBS
from service.jobs.soundness import RULES, damage_of

UNKNOWN: dict[str, Any] = {
    "created": 0.0,
    "rows": 0,
    "chunks": 0,
    "estimated_bytes": 0,
    "sha256": "",
    "version": "",
}
"""What is shown in place of a value that cannot be."""


def see_jobs(
    connection: sa.Connection,
    now: sa.ColumnElement[float],
    which: Callable[[sa.Select[Any]], sa.Select[Any]],
) -> list[Job]:
    """Return jobs that are not deleted, as they are seen from outside.

    Parameters
    ----------
    connection
        Reads the store.
    now
        The database's clock [s].
    which
        Narrows or orders the selection of all of them.

    Returns
    -------
    list of Job
        One whose record is damaged, or of no state known here, is there as failed.
    """
    wanted = which(sa.select(JOBS, now.label("now")).where(JOBS.c.state != DELETED))
    return [_see_job(dict(record)) for record in connection.execute(wanted).mappings()]


def _see_job(record: Mapping[str, Any]) -> Job:
    """Return a job; one whose record cannot be, or is of no state known here, as failed."""
    damage = damage_of(record)
    if damage:
        whole = {name: value for name, value in record.items() if name not in UNKNOWN}
        for name, instead in UNKNOWN.items():
            whole[name] = record[name] if RULES[name](record[name]) else instead
        return _unsound(_job({**whole, **NOTHING, "id": str(record["id"])}), damage)
    job = _job(record)
    if job.state in UNFINISHED or job.state in ENDED:
        return job
    told = f"its state {job.state!r} is none that this version of shapersmith knows"
    return _unsound(job, told)


def _unsound(job: Job, reason: str) -> Job:
    return replace(job, state="failed", reason=reason, rate_rows_s=0.0, sound=False)


def _job(record: Mapping[str, Any]) -> Job:
    unfinished = record["state"] in UNFINISHED
    return Job(
        id=record["id"],
        state=record["state"],
        reason=record["reason"],
        created=record["created"],
        sha256=record["sha256"],
        version=record["version"],
        rows=record["rows"],
        chunks=record["chunks"],
        estimated_bytes=record["estimated_bytes"],
        done=record["rows_done"],
        verified=record["verified"],
        verified_ideal=record["verified_ideal"],
        infeasible=record["infeasible"],
        rate_rows_s=rate_rows_s(record, record["now"]) if unfinished else 0.0,
    )
