"""Settings of the service, from the environment."""

import os
from collections.abc import Mapping
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field

PREFIX = "SHAPERSMITH_"

IN_WORDS = "default_in_words"
"""Key of a default that depends on the machine, as the documentation has it."""


class Settings(BaseModel):
    """Settings; each is read from `SHAPERSMITH_` and its name in capitals."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    # One more than processors: while an answer is on its way, another design is computed.
    workers: Annotated[
        int,
        Field(
            ge=1,
            le=1024,
            description="Worker processes for small work; large work has up to one fewer beside "
            "them.",
            json_schema_extra={IN_WORDS: "processors + 1"},
        ),
    ] = (os.cpu_count() or 1) + 1
    time_limit_s: Annotated[
        float, Field(gt=0, description="Longest run of one request, or of one line of a batch [s].")
    ] = 30.0
    batch_limit_s: Annotated[float, Field(gt=0, description="Longest run of one batch [s].")] = (
        300.0
    )
    export_limit_s: Annotated[
        float, Field(gt=0, description="Longest that the file of a table is made [s].")
    ] = 600.0
    worker_memory_bytes: Annotated[
        int,
        Field(ge=256 * 1024**2, description="Private memory that a worker may have [bytes]."),
    ] = 2 * 1024**3
    max_body_bytes: Annotated[int, Field(ge=1, description="Largest body [bytes].")] = 1024 * 1024
    max_batch_bytes: Annotated[int, Field(ge=1, description="Largest batch [bytes].")] = (
        8 * 1024 * 1024
    )
    max_batch_lines: Annotated[int, Field(ge=1, description="Most lines of a batch.")] = 1000
    # Planned in 8 s by 1.4 GB: 64 MB pass the limits of time and memory.
    max_table_bytes: Annotated[
        int,
        Field(
            ge=1,
            description="Largest specification of a table [bytes]: 700,000 listed designs of one "
            "field.",
        ),
    ] = 24 * 1024 * 1024
    data_dir: Annotated[
        str,
        Field(
            min_length=1,
            description="Folder of the job store and of tables' files; of compiled code too, where "
            "the program's own folder is read-only.",
        ),
    ] = "shapersmith-data"
    database_url: Annotated[
        str,
        Field(
            description="Job store in PostgreSQL (`postgresql://...`, extra `postgres`); if empty, "
            "an SQLite file in that folder."
        ),
    ] = ""
    job_workers: Annotated[
        int,
        Field(
            ge=0,
            le=1024,
            description="Processes for table jobs; 0: none are computed here.",
            json_schema_extra={IN_WORDS: "processors"},
        ),
    ] = os.cpu_count() or 1
    scheduler: Annotated[
        str,
        Field(
            description="Address of a Dask scheduler (extra `dask`) that computes table jobs "
            "instead."
        ),
    ] = ""
    stalled_s: Annotated[
        float,
        Field(
            ge=0.5,
            description="Silence after which a job's chunk is given to another process [s].",
        ),
    ] = 30.0
    database_wait_s: Annotated[
        float, Field(ge=0, description="How long a job waits for a database that is gone [s].")
    ] = 600.0
    keep_tables_days: Annotated[
        float,
        Field(
            ge=0,
            description="How long after its end a table is dropped with its files [d]; 0: kept.",
        ),
    ] = 0.0
    max_pending: Annotated[
        int, Field(ge=1, description="Tasks running and waiting beyond which requests get 503.")
    ] = 256

    max_live: Annotated[
        int, Field(ge=0, description="Most live sessions (`WS /v1/live`) at a time.")
    ] = 16
    live_idle_s: Annotated[
        float,
        Field(gt=0, description="A live session without an event for so long is stopped [s]."),
    ] = 600.0

    @classmethod
    def from_environment(cls, environment: Mapping[str, str]) -> Self:
        """Read the settings.

        Parameters
        ----------
        environment
            Variables by name; those without the prefix are passed over.

        Returns
        -------
        Self
            With defaults for what is not given.

        Raises
        ------
        pydantic.ValidationError
            If a value breaks its rule, or a variable with the prefix names no setting.
        """
        given = {
            name.removeprefix(PREFIX).lower(): value
            for name, value in environment.items()
            if name.startswith(PREFIX)
        }
        return cls.model_validate(given)
