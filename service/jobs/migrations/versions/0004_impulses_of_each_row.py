"""How many impulses the rows of a job have; no earlier job needs it."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"


def upgrade() -> None:
    """Add the column."""
    op.add_column("jobs", sa.Column("impulses", sa.Integer))


def downgrade() -> None:
    """Drop it."""
    op.drop_column("jobs", "impulses")
