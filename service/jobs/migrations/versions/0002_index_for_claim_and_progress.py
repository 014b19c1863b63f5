"""An index, so that claims and progress need not read past the blobs."""

from alembic import op

revision = "0002"
down_revision = "0001"

COLUMNS = ["job", "state", "number", "heartbeat", "finished", "rows", "verified", "infeasible"]


def upgrade() -> None:
    """Add the index."""
    op.create_index("chunks_by_state", "chunks", COLUMNS)


def downgrade() -> None:
    """Drop it."""
    op.drop_index("chunks_by_state", "chunks")
