"""Chunks are made when they are claimed; jobs tell their size, and by which key they were begun.

All chunks of the jobs before are made already; how large their tables are was not kept.
"""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"

ADDED = {
    "chunk_rows": sa.Integer,
    "estimated_bytes": sa.BigInteger,
    "begun": sa.Integer,
    "served": sa.Double,
}

MAX_INSERTED = 10_000


def upgrade() -> None:
    """Add the columns."""
    for name, kind in ADDED.items():
        op.add_column("jobs", sa.Column(name, kind, nullable=False, server_default="0"))
    op.add_column("jobs", sa.Column("key", sa.String(255)))
    op.create_index("jobs_by_key", "jobs", ["key"], unique=True)
    # Of those that were cancelled no chunk has its rows: any number with as many chunks will do.
    op.execute(
        "UPDATE jobs SET begun = chunks, chunk_rows = coalesce("
        "(SELECT rows FROM chunks WHERE chunks.job = jobs.id AND number = 0), "
        "(rows + chunks - 1) / chunks)"
    )


def downgrade() -> None:
    """Make the chunks that nobody has claimed, and drop the columns."""
    connection = op.get_bind()
    jobs = connection.execute(
        sa.text(
            "SELECT id, rows, chunks, chunk_rows, begun FROM jobs "
            "WHERE state IN ('waiting', 'running', 'failed') AND begun < chunks"
        )
    ).all()
    insert = sa.text(
        "INSERT INTO chunks (job, number, state, attempt, rows, verified, infeasible, "
        "verified_ideal) VALUES (:job, :number, 'waiting', 0, :rows, 0, 0, 0)"
    )
    for job, rows, chunks, chunk_rows, begun in jobs:
        for first in range(begun, chunks, MAX_INSERTED):
            numbers = range(first, min(first + MAX_INSERTED, chunks))
            of_each = [
                {"job": job, "number": one, "rows": min(chunk_rows, rows - one * chunk_rows)}
                for one in numbers
            ]
            connection.execute(insert, of_each)
    op.drop_index("jobs_by_key", "jobs")
    for name in ("key", *ADDED):
        op.drop_column("jobs", name)
