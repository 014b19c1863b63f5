"""What a job's record counts of its chunks, so that a look at it need not read them.

The rate is that of two spans of time: one that lasts, and the one before. The chunk that ends a
span is the last of it, as its rows took the time before.
"""

from collections.abc import Mapping
from typing import Any

import sqlalchemy as sa

from service.jobs.records import Done
from service.jobs.schema import JOBS

SPAN_S = 15.0
"""A span ends with the first chunk after so long [s]."""

NO_RATE: dict[str, Any] = {
    "earlier_from": None,
    "earlier_rows": 0,
    "lately_from": None,
    "lately_rows": 0,
}
"""Of a job without a chunk that was done lately."""

NOTHING: dict[str, Any] = {
    **NO_RATE,
    "rows_done": 0,
    "verified": 0,
    "verified_ideal": 0,
    "infeasible": 0,
}
"""Of a job without rows."""


def with_chunk(rows: int, done: Done, now: sa.ColumnElement[float]) -> dict[str, Any]:
    """Return what a job's record becomes by a chunk of some rows.

    Parameters
    ----------
    rows
        Rows of the chunk.
    done
        What became of the rows.
    now
        The database's clock [s].

    Returns
    -------
    dict of str to Any
        Values of columns, as expressions of the record's own.
    """
    lately = JOBS.c.lately_rows + rows
    first = JOBS.c.lately_from.is_(None)
    over = sa.or_(first, JOBS.c.lately_from < now - SPAN_S)
    return {
        "rows_done": JOBS.c.rows_done + rows,
        "verified": JOBS.c.verified + done.verified,
        "verified_ideal": JOBS.c.verified_ideal + done.verified_ideal,
        "infeasible": JOBS.c.infeasible + done.infeasible,
        "last_finished": now,
        "earlier_from": sa.case(
            (first, now), (over, JOBS.c.lately_from), else_=JOBS.c.earlier_from
        ),
        "earlier_rows": sa.case((first, 0), (over, lately), else_=JOBS.c.earlier_rows),
        "lately_from": sa.case((over, now), else_=JOBS.c.lately_from),
        "lately_rows": sa.case((over, 0), else_=lately),
    }


def rate_rows_s(record: Mapping[str, Any], now: float) -> float:
    """Return how many rows a job has done lately [1/s].

    Parameters
    ----------
    record
        The record of the job, by the names of its columns.
    now
        Time by the database's clock [s].

    Returns
    -------
    float
        Rows over the time of the last two spans [1/s]; 0 where that is not known.
    """
    since = record["earlier_from"]
    if since is None or now <= since:
        return 0.0
    return float((record["earlier_rows"] + record["lately_rows"]) / (now - since))
