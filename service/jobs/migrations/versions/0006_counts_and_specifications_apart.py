"""Jobs count what their chunks come to; specifications lie apart; chunks have a hash.

The chunks of the jobs before are counted here; they have no hash.
"""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"

COUNTS = ("rows_done", "verified", "verified_ideal", "infeasible")
ROWS = (*COUNTS, "earlier_rows", "lately_rows")
TIMES = ("last_finished", "earlier_from", "lately_from")

INDEX = "chunks_by_state"
BEFORE = ["job", "state", "number", "heartbeat", "finished", "rows", "verified", "infeasible"]


def upgrade() -> None:
    """Count, and take the specifications out of the jobs."""
    for name in ROWS:
        op.add_column("jobs", sa.Column(name, sa.BigInteger, nullable=False, server_default="0"))
    for name in TIMES:
        op.add_column("jobs", sa.Column(name, sa.Double))
    sums = ", ".join(
        f"{name} = (SELECT coalesce(sum({name.removesuffix('_done')}), 0) FROM chunks "
        "WHERE chunks.job = jobs.id AND chunks.state = 'done')"
        for name in COUNTS
    )
    op.execute(
        f"UPDATE jobs SET {sums}, last_finished = (SELECT max(finished) FROM chunks "
        "WHERE chunks.job = jobs.id AND chunks.state = 'done') "
        "WHERE state NOT IN ('cancelled', 'deleted')"
    )
    # Of those that were cancelled no chunk told how many rows it had: any number that gives as many
    # chunks will do.
    op.execute(
        "UPDATE jobs SET chunk_rows = (rows + chunks - 1) / chunks "
        "WHERE chunks > 1 AND chunk_rows >= rows"
    )
    op.create_table(
        "specifications",
        sa.Column("job", sa.String(32), sa.ForeignKey("jobs.id"), primary_key=True),
        sa.Column("specification", sa.Text, nullable=False),
    )
    op.execute("INSERT INTO specifications SELECT id, specification FROM jobs")
    op.drop_column("jobs", "specification")
    op.add_column("chunks", sa.Column("sha256", sa.String(64)))
    op.drop_index(INDEX, "chunks")
    op.create_index(INDEX, "chunks", ["job", "state", "number", "heartbeat"])


def downgrade() -> None:
    """Put the specifications back, and drop what was counted."""
    op.drop_index(INDEX, "chunks")
    op.create_index(INDEX, "chunks", [*BEFORE, "verified_ideal"])
    op.drop_column("chunks", "sha256")
    op.add_column("jobs", sa.Column("specification", sa.Text, nullable=False, server_default=""))
    op.execute(
        "UPDATE jobs SET specification = coalesce((SELECT specification FROM specifications "
        "WHERE specifications.job = jobs.id), '')"
    )
    op.drop_table("specifications")
    for name in (*ROWS, *TIMES):
        op.drop_column("jobs", name)
