"""What is seen of jobs from outside: how far they are, without their specifications."""

from collections.abc import Callable
from typing import Any

import sqlalchemy as sa

from service.jobs.records import DELETED, ENDED, UNFINISHED, Job
from service.jobs.schema import CHUNKS, JOBS

RATE_WINDOW_S = 30.0
"""The rate is that of the chunks done so recently [s]."""

SEEN = (
    JOBS.c.id,
    JOBS.c.state,
    JOBS.c.reason,
    JOBS.c.created,
    JOBS.c.sha256,
    JOBS.c.version,
    JOBS.c.rows,
    JOBS.c.chunks,
    JOBS.c.estimated_bytes,
)
"""Columns: not the specification, which may be megabytes, and which others may have written."""


def seen_jobs(
    connection: sa.Connection,
    now: sa.ColumnElement[float],
    which: Callable[[sa.Select[Any]], sa.Select[Any]],
) -> list[Job]:
    """Return jobs that are not deleted; ``which`` narrows the selection of all of them."""
    wanted = which(sa.select(*SEEN).where(JOBS.c.state != DELETED))
    return [
        Job(**{**row, **_known(row["state"])}, **_progress(connection, now, row["id"]))
        for row in connection.execute(wanted).mappings().all()
    ]


def _known(state: str) -> dict[str, str]:
    """Return what replaces a state that this version does not know."""
    if state in UNFINISHED or state in ENDED:
        return {}
    told = f"its state {state!r} is none that this version of shapersmith knows"
    return {"state": "failed", "reason": told}


def _progress(connection: sa.Connection, now: sa.ColumnElement[float], job: str) -> dict[str, Any]:
    recent = CHUNKS.c.finished > now - RATE_WINDOW_S
    sums = [
        sa.func.sum(CHUNKS.c.rows),
        sa.func.sum(CHUNKS.c.verified),
        sa.func.sum(CHUNKS.c.verified_ideal),
        sa.func.sum(CHUNKS.c.infeasible),
        sa.func.sum(sa.case((recent, CHUNKS.c.rows), else_=0)),
        sa.func.min(CHUNKS.c.finished),
        now,
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
