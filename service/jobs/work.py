"""What a worker process does: one chunk from its part of the specification to its blob."""

import multiprocessing
import multiprocessing.connection
import os
import signal
import threading
import warnings
from dataclasses import replace

from design.tables.compute import compute_rows
from design.tables.rows import INFEASIBLE, VERIFIED, VERIFIED_IDEAL
from design.tables.specification import TableSpecification
from service.jobs.blobs import to_blob
from service.jobs.records import Done

ALONE = threading.Lock()
"""One solver at a time in a process, however many threads a Dask worker has: CasADi crashes when
threads share it."""


def part_of(specification: TableSpecification, number: int) -> tuple[TableSpecification, int, int]:
    """Return what a worker needs to know of one chunk: of listed designs, its own only."""
    start, stop = specification.chunk(number)
    if specification.listed is not None:
        return replace(specification, listed=specification.listed[start:stop]), start, stop
    return specification, start, stop


def compute_chunk(part: TableSpecification, start: int, stop: int) -> Done:
    """Compute the rows of one chunk."""
    with ALONE, warnings.catch_warnings():
        # Results are checked to be finite.
        warnings.simplefilter("ignore", RuntimeWarning)
        if part.listed is not None:
            rows = replace(compute_rows(part, 0, stop - start), first=start)
        else:
            rows = compute_rows(part, start, stop)
    return Done(
        blob=to_blob(rows),
        verified=int((rows.status == VERIFIED).sum()),
        verified_ideal=int((rows.status == VERIFIED_IDEAL).sum()),
        infeasible=int((rows.status == INFEASIBLE).sum()),
    )


def begin() -> None:
    """Prepare a worker process: it ends with its parent, which alone hears signals."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    multiprocessing.connection.wait([sentinel])
    os._exit(0)
