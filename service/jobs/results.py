"""From the blobs of a job to the bytes of a file."""

import time
from collections.abc import Iterator
from pathlib import Path

from sqlalchemy.exc import DBAPIError

from design.errors import DesignError, InvalidInputError
from design.export.kind import Export
from design.export.reading import READERS
from design.export.registry import EXPORTS
from design.tables.rows import Rows, TableHead
from service.files import LockedError, locked, remove_parts, write_pieces
from service.jobs.blobs import from_blob
from service.jobs.contents import DamagedError, GoneError
from service.jobs.database import StoreError, reason_of
from service.jobs.plan import head_of
from service.jobs.records import Job, NewJob
from service.jobs.store import Store
from service.problems import NOT_FOUND, OVERLOADED, Problem, problem_of_design

UNREADABLE = (
    OSError,
    ValueError,
    TypeError,
    LookupError,
    AttributeError,
    NotImplementedError,
)
"""What bytes raise that are no rows: Arrow's errors are of these."""

LOCK_PAUSE_S = 0.1
"""Between two looks at a file that another process writes [s]."""


def export_of(name: str) -> Export:
    """Return the entry of a format.

    Raises
    ------
    InvalidInputError
        If there is none.
    """
    if name not in EXPORTS:
        raise InvalidInputError(
            "format", name, f"one of {', '.join(EXPORTS)}", code="format_not_served"
        )
    return EXPORTS[name]


def head_for(job: NewJob, name: str, path: Path | None = None) -> TableHead:
    """Return the head of a job's file in a format, whether the format takes it or not.

    Polynomials are only for the formats that are programs, which cannot be read back. ``path``: of
    the file, where a person has named it.
    """
    return head_of(job, fitted=name not in READERS, name="" if path is None else path.stem)


def require_taken(job: NewJob, name: str) -> None:
    """Raise InvalidInputError if a format cannot take the table."""
    export = export_of(name)
    export.checks(head_for(job, name))


def rows_of_job(store: Store, job: str) -> Iterator[Rows]:
    """Yield the rows of a job that is done, a chunk at a time.

    Raises
    ------
    StoreError
        If the job is deleted before all are read, or some are damaged.
    """
    for number, blob in enumerate(store.blobs(job)):
        try:
            rows = from_blob(blob)
        except UNREADABLE as error:
            raise DamagedError(f"the rows of chunk {number} of job {job} are damaged") from error
        yield rows


def pieces(store: Store, job: Job, name: str, path: Path | None = None) -> Iterator[bytes]:
    """Yield the bytes of a job's file; ``path`` as for `head_for`."""
    head = head_for(store.made_of(job.id), name, path)
    return export_of(name).write(head, rows_of_job(store, job.id))


def write_result(store: Store, job: Job, name: str, path: Path) -> None:
    """Write the file of a job that a person has named: whole, or not at all."""
    write_pieces(path, pieces(store, job, name, path))


def lock_of(path: Path) -> Path:
    """Return the lock file that the writer of a file holds, and that dies with it."""
    return path.with_name(f".{path.name}.lock")


def write_result_of(url: str, job: str, name: str, path: str) -> Problem | None:
    """Write the file of a job in a process that may be killed, and return why it is not there.

    What another process writes is waited for; what a killed one left behind is removed.
    """
    target = Path(path)
    try:
        while not target.is_file():
            try:
                with locked(lock_of(target)):
                    remove_parts(target)
                    return _written(url, job, name, target)
            except LockedError:
                time.sleep(LOCK_PAUSE_S)
    except OSError as error:
        return Problem(OVERLOADED, f"the file could not be made: {error.strerror}")
    return None


def _written(url: str, job: str, name: str, path: Path) -> Problem | None:
    try:
        store = Store(url, stalled_s=0.0)
        try:
            head, export = head_for(store.made_of(job), name), export_of(name)
            export.checks(head)
            write_pieces(path, export.write(head, rows_of_job(store, job)))
        finally:
            store.close()
    except DesignError as error:
        # What a format finds in the rows, as a damping ratio that a firmware does not take.
        return problem_of_design(error)
    except GoneError as error:
        return Problem(NOT_FOUND, str(error))
    except StoreError as error:
        return Problem(OVERLOADED, f"the file could not be made: {error}")
    except DBAPIError as error:
        return Problem(OVERLOADED, f"the job store does not answer: {reason_of(error)}")
    return None
