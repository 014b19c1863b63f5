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
from design.tables.sampled_rows import widened, widest_of
from service.files import LockedError, hold_lock, remove_parts, write_pieces
from service.jobs.blobs import from_blob
from service.jobs.contents import DamagedError, GoneError
from service.jobs.database import StoreError, reason_of
from service.jobs.plan import FEWEST_IMPULSES_ON_SAMPLES, head_of, specification_of
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

    Parameters
    ----------
    name
        Name of the format.

    Returns
    -------
    Export
        Its check of a head, and its writer.

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


def table_of(
    store: Store, job: NewJob, name: str, path: Path | None = None
) -> tuple[TableHead, Iterator[Rows]]:
    """Return head and rows of a job that is done, for a format.

    On samples both are as wide as the widest row, for which all rows are read once before.

    Parameters
    ----------
    store
        The store.
    job
        The job.
    name
        Name of the format.
    path
        Of the file, where a person has named it.

    Returns
    -------
    TableHead
        The head.
    Iterator of Rows
        Reads as it goes on, and raises the errors of `rows_of_job`.

    Raises
    ------
    InvalidInputError
        If the format refuses the head.
    DesignError
        If the polynomials cannot be fitted.
    GoneError
        If the job is deleted before all is read.
    DamagedError
        If some rows are damaged.
    """
    specification = specification_of(job.specification, job.impulses)
    rows = rows_of_job(store, job.id)
    if specification.grid is None:
        head = head_for(job, name, path)
    else:
        columns = specification.columns
        impulses = widest_of(columns, rows)
        head = head_for(job, name, path, impulses=impulses)
        rows = (widened(columns, run, impulses) for run in rows_of_job(store, job.id))
    export_of(name).checks(head)
    return head, rows


def head_for(
    job: NewJob,
    name: str,
    path: Path | None = None,
    *,
    impulses: int = FEWEST_IMPULSES_ON_SAMPLES,
) -> TableHead:
    """Return the head of a job's file in a format.

    The format may still refuse the head. Polynomials are only for the formats that are programs,
    which cannot be read back.

    Parameters
    ----------
    job
        The job.
    name
        Name of the format.
    path
        Of the file, where a person has named it.
    impulses
        On samples those of the widest row, where it is known.

    Returns
    -------
    TableHead
        The head.

    Raises
    ------
    DesignError
        If the polynomials cannot be fitted.
    """
    stem = "" if path is None else path.stem
    return head_of(job, fitted=name not in READERS, name=stem, impulses=impulses)


def require_taken(job: NewJob, name: str) -> None:
    """Raise InvalidInputError if a format cannot take the table.

    Parameters
    ----------
    job
        The job.
    name
        Name of the format.

    Raises
    ------
    InvalidInputError
        If there is no such format, or it refuses the head of the table.
    DesignError
        If the polynomials of a program cannot be fitted.
    """
    export = export_of(name)
    export.checks(head_for(job, name))


def rows_of_job(store: Store, job: str) -> Iterator[Rows]:
    """Yield the rows of a job that is done, a chunk at a time.

    Parameters
    ----------
    store
        The store.
    job
        Id of the job.

    Yields
    ------
    Rows
        The rows of one chunk.

    Raises
    ------
    GoneError
        If the job is deleted before all are read.
    DamagedError
        If some are damaged.
    """
    for number, blob in enumerate(store.blobs(job)):
        try:
            rows = from_blob(blob)
        except UNREADABLE as error:
            raise DamagedError(f"the rows of chunk {number} of job {job} are damaged") from error
        yield rows


def pieces(store: Store, job: str, name: str, path: Path | None = None) -> Iterator[bytes]:
    """Return the bytes of a job's file, piece by piece.

    Parameters
    ----------
    store
        The store.
    job
        Id of the job, which is done.
    name
        Name of the format.
    path
        Of the file, where a person has named it.

    Returns
    -------
    Iterator of bytes
        Reads the rows as it goes on: it raises the errors of `rows_of_job`, and InvalidInputError
        where a row breaks a rule of the format.

    Raises
    ------
    InvalidInputError
        If there is no such format, or it refuses the head.
    DesignError
        If the polynomials of a program cannot be fitted.
    GoneError
        If the job has gone.
    DamagedError
        If the job's record or specification is damaged.
    """
    export = export_of(name)
    return export.write(*table_of(store, store.contents_of(job), name, path))


def write_result(store: Store, job: Job, name: str, path: Path) -> None:
    """Write the file of a job that a person has named: whole, or not at all.

    Parameters
    ----------
    store
        The store.
    job
        The job, which is done.
    name
        Name of the format.
    path
        The file.

    Raises
    ------
    DesignError
        If the format refuses a row, or the polynomials of a program cannot be fitted.
    StoreError
        If the job has gone, or is damaged.
    NotReplaceableError
        If something else than a file that may be written stands there.
    OSError
        If the file cannot be written.
    """
    write_pieces(path, pieces(store, job.id, name, path))


def lock_of(path: Path) -> Path:
    """Return the lock file of a file.

    The writer of the file holds the lock, which dies with the writer.
    """
    return path.with_name(f".{path.name}.lock")


def write_result_of(url: str, job: str, name: str, path: str) -> Problem | None:
    """Write the file of a job in a process that may be killed.

    What another process writes is waited for; what a killed one left behind is removed.

    Parameters
    ----------
    url
        URL of the store.
    job
        Id of the job, which is done.
    name
        Name of the format.
    path
        The file.

    Returns
    -------
    Problem or None
        Why the file is not there; None where it is.
    """
    target = Path(path)
    try:
        while not target.is_file():
            try:
                with hold_lock(lock_of(target)):
                    remove_parts(target)
                    return _write(url, job, name, target)
            except LockedError:
                time.sleep(LOCK_PAUSE_S)
    except OSError as error:
        return Problem(OVERLOADED, f"the file could not be made: {error.strerror}")
    return None


def _write(url: str, job: str, name: str, path: Path) -> Problem | None:
    try:
        store = Store(url, stalled_s=0.0)
        try:
            write_pieces(path, pieces(store, job, name))
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
