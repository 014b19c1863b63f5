"""Wire form of the state of a table job."""

from typing import Annotated, Literal

from pydantic import Field

from schemas.base import Wire
from schemas.warnings import WarningOut


class TableSize(Wire):
    """How large a table is, before it is computed."""

    rows: Annotated[int, Field(description="Number of designs.")]
    chunks: Annotated[int, Field(description="Number of parts in which they are computed.")]
    estimated_bytes: Annotated[int, Field(description="Size of its numbers, uncompressed [bytes].")]


class TableJob(Wire):
    """State of a table job."""

    id: Annotated[str, Field(description="Id of the job, for its routes.")]
    state: Annotated[
        Literal["waiting", "running", "done", "failed", "cancelled"],
        Field(description="State of the job."),
    ]
    reason: Annotated[str | None, Field(description="Reason of a failure.")]
    created: Annotated[float, Field(description="Seconds since 1970.")]
    size: Annotated[TableSize, Field(description="Size of the table.")]
    rows_done: Annotated[int, Field(description="Rows that are computed.")]
    verified: Annotated[int, Field(description="Rows proven for the actuator given.")]
    verified_ideal: Annotated[int, Field(description="Rows proven for an ideal actuator only.")]
    infeasible: Annotated[int, Field(description="Rows of which there is no such shaper.")]
    failed: Annotated[int, Field(description="Rows that could not be computed.")]
    rows_per_s: Annotated[float, Field(description="Rows computed a second [1/s].")]
    seconds_left: Annotated[
        float | None,
        Field(description="Time until the end at that rate; null where it is not known [s]."),
    ]
    specification_sha256: Annotated[str, Field(description="Hash of the specification.")]
    version: Annotated[str, Field(description="Version of shapersmith that began the job.")]
    warnings: Annotated[
        list[WarningOut],
        Field(description="What is hardly meant in the specification, in the answer to it."),
    ]


class TableJobs(Wire):
    """The newest table jobs."""

    tables: Annotated[list[TableJob], Field(description="Jobs, the newest first.")]
