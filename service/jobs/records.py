"""What the job store holds, as records."""

from dataclasses import dataclass
from typing import Literal, NamedTuple

State = Literal["waiting", "running", "done", "failed", "cancelled"]

UNFINISHED = ("waiting", "running")

ENDED = ("done", "failed", "cancelled")

DELETED = "deleted"
"""State of a job that is being erased, which nobody sees any more."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NewJob:
    """What a job is made of: its specification as canonical JSON, and its size.

    ``impulses``: of each row; None where the kind of shaper says.
    """

    id: str
    specification: str
    sha256: str
    version: str
    rows: int
    chunk_rows: int
    estimated_bytes: int
    impulses: int | None = None

    @property
    def chunks(self) -> int:
        """Number of chunks."""
        return -(-self.rows // self.chunk_rows)


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """A job and how far it is.

    Attributes
    ----------
    reason
        Why it failed; empty where it did not.
    version
        Of shapersmith, that computes its rows.
    estimated_bytes
        Of its numbers, uncompressed; 0 for jobs begun before that was kept.
    done, verified, verified_ideal, infeasible
        Rows that are computed, and what became of them.
    rate_rows_s
        Rows done lately [1/s].
    created
        Seconds since 1970, by the database's clock [s].
    sound
        Whether this version can go on with its record; otherwise it is shown as failed.
    """

    id: str
    state: State
    reason: str
    created: float
    sha256: str
    version: str
    rows: int
    chunks: int
    estimated_bytes: int
    done: int
    verified: int
    verified_ideal: int
    infeasible: int
    rate_rows_s: float
    sound: bool = True

    @property
    def failed(self) -> int:
        """Rows whose solver or proof failed."""
        return self.done - self.verified - self.verified_ideal - self.infeasible

    @property
    def ended(self) -> bool:
        """Whether nothing more will happen to it."""
        return self.state not in UNFINISHED

    @property
    def left_s(self) -> float | None:
        """Time left at the present rate; None where that is not known [s]."""
        if self.state != "running" or self.rate_rows_s == 0:
            return None
        return (self.rows - self.done) / self.rate_rows_s


@dataclass(frozen=True, slots=True)
class ChunkClaim:
    """A chunk that a worker holds."""

    job: str
    number: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Done:
    """A computed chunk: its rows as one blob, and what became of them."""

    blob: bytes
    verified: int
    infeasible: int
    verified_ideal: int = 0


class Event(NamedTuple):
    """What is sent of a job that is watched: a name, and the job as JSON."""

    name: str
    data: str
