"""How many rows of a chunk are verified for an ideal actuator only; the index counts them too."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"

NAME = "chunks_by_state"
BEFORE = ["job", "state", "number", "heartbeat", "finished", "rows", "verified", "infeasible"]


def upgrade() -> None:
    """Add the column: no row was counted so before."""
    op.add_column(
        "chunks", sa.Column("verified_ideal", sa.Integer, nullable=False, server_default="0")
    )
    op.drop_index(NAME, "chunks")
    op.create_index(NAME, "chunks", [*BEFORE, "verified_ideal"])


def downgrade() -> None:
    """Drop it."""
    op.drop_index(NAME, "chunks")
    op.create_index(NAME, "chunks", BEFORE)
    op.drop_column("chunks", "verified_ideal")
