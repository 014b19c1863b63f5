"""What a worker process does: one chunk from the specification to its blob."""

import functools
import signal
import threading
import warnings
import zlib
from multiprocessing.connection import Connection

from design.errors import DesignError
from design.tables.compute import compute_rows
from design.tables.rows import INFEASIBLE, VERIFIED, VERIFIED_IDEAL
from design.tables.specification import TableSpecification
from service.jobs.blobs import to_blob
from service.jobs.plan import specification_of
from service.jobs.records import Done
from service.workers.watchdog import end_with_parent

ALONE = threading.Lock()
"""One solver at a time in a process, however many threads a Dask worker has: CasADi crashes when
threads share it."""

MAX_SPECIFICATIONS = 2
"""Specifications that a worker keeps expanded: two jobs in turn are not read again and again."""


class UnreadableError(Exception):
    """The specification of a job is none, or none that this version knows."""


def pack(specification: str) -> bytes:
    """Return a specification as it travels to workers.

    Workers alone read and expand it.
    """
    return zlib.compress(specification.encode())


@functools.lru_cache(maxsize=MAX_SPECIFICATIONS)
def _expand(content: bytes, impulses: int | None) -> TableSpecification:
    try:
        return specification_of(zlib.decompress(content).decode(), impulses)
    except (DesignError, ValueError) as error:  # pydantic's are ValueErrors
        raise UnreadableError(f"its specification cannot be read: {error}") from error


def compute_chunk(content: bytes, impulses: int | None, number: int) -> Done:
    """Compute the rows of one chunk.

    Parameters
    ----------
    content
        The specification of the job, `pack`.
    impulses
        Of each row; None where the kind of shaper says.
    number
        Of the chunk.

    Returns
    -------
    Done
        The rows as one blob, and how many of them are verified or infeasible.

    Raises
    ------
    UnreadableError
        If the specification is none that this version knows.
    """
    with ALONE, warnings.catch_warnings():
        # Results are checked to be finite.
        warnings.simplefilter("ignore", RuntimeWarning)
        specification = _expand(content, impulses)
        rows = compute_rows(specification, *specification.chunk(number))
    return Done(
        blob=to_blob(rows),
        verified=int((rows.status == VERIFIED).sum()),
        verified_ideal=int((rows.status == VERIFIED_IDEAL).sum()),
        infeasible=int((rows.status == INFEASIBLE).sum()),
    )


def begin(lifeline: Connection) -> None:
    """Prepare a worker process, which ends with its parent.

    Its parent alone hears signals. It ends with its executor too, which holds the other end of the
    lifeline: nobody else can end a worker whose fork server has died.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    end_with_parent(lifeline)
