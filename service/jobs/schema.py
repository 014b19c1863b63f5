"""The tables of the job store, as the newest migration makes them.

The first ``begun`` chunks of a job have a record each: it is made when the chunk is first claimed,
so that a job costs the same to add whatever its size. What its chunks come to is counted in its own
record, and its specification lies apart, so that a look at it costs the same too.
"""

import sqlalchemy as sa

METADATA = sa.MetaData()

JOBS = sa.Table(
    "jobs",
    METADATA,
    sa.Column("id", sa.String(32), primary_key=True),
    sa.Column("state", sa.String(10), nullable=False),
    sa.Column("reason", sa.Text, nullable=False, default=""),
    sa.Column("created", sa.Double, nullable=False),
    sa.Column("sha256", sa.String(64), nullable=False),
    sa.Column("version", sa.String(64), nullable=False),
    sa.Column("rows", sa.BigInteger, nullable=False),
    sa.Column("chunks", sa.Integer, nullable=False),
    sa.Column("impulses", sa.Integer),
    sa.Column("chunk_rows", sa.Integer, nullable=False),
    sa.Column("estimated_bytes", sa.BigInteger, nullable=False),
    sa.Column("begun", sa.Integer, nullable=False, default=0),
    sa.Column("served", sa.Double, nullable=False, default=0.0),
    sa.Column("key", sa.String(255)),
    sa.Column("rows_done", sa.BigInteger, nullable=False, default=0),
    sa.Column("verified", sa.BigInteger, nullable=False, default=0),
    sa.Column("verified_ideal", sa.BigInteger, nullable=False, default=0),
    sa.Column("infeasible", sa.BigInteger, nullable=False, default=0),
    sa.Column("last_finished", sa.Double),
    sa.Column("earlier_from", sa.Double),
    sa.Column("earlier_rows", sa.BigInteger, nullable=False, default=0),
    sa.Column("lately_from", sa.Double),
    sa.Column("lately_rows", sa.BigInteger, nullable=False, default=0),
    sa.Index("jobs_by_key", "key", unique=True),
)

SPECIFICATIONS = sa.Table(
    "specifications",
    METADATA,
    sa.Column("job", sa.String(32), sa.ForeignKey("jobs.id"), primary_key=True),
    sa.Column("specification", sa.Text, nullable=False),
)

CHUNKS = sa.Table(
    "chunks",
    METADATA,
    sa.Column("job", sa.String(32), sa.ForeignKey("jobs.id"), primary_key=True),
    sa.Column("number", sa.Integer, primary_key=True),
    sa.Column("state", sa.String(10), nullable=False),
    sa.Column("attempt", sa.Integer, nullable=False, default=0),
    sa.Column("worker", sa.String(100)),
    sa.Column("heartbeat", sa.Double),
    sa.Column("finished", sa.Double),
    sa.Column("rows", sa.Integer, nullable=False),
    sa.Column("verified", sa.Integer, nullable=False, default=0),
    sa.Column("infeasible", sa.Integer, nullable=False, default=0),
    sa.Column("verified_ideal", sa.Integer, nullable=False, default=0),
    sa.Column("blob", sa.LargeBinary),
    sa.Column("sha256", sa.String(64)),
)
