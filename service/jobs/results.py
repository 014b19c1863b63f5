"""From the blobs of a job to the bytes of a file."""

from collections.abc import Iterator
from pathlib import Path

from design.errors import InvalidInputError
from design.export.kind import Export
from design.export.reading import READERS
from design.export.registry import EXPORTS
from design.tables.rows import Rows, TableHead
from service.files import write_pieces
from service.jobs.blobs import from_blob
from service.jobs.plan import head_of
from service.jobs.records import Job, NewJob
from service.jobs.store import Store


def export_of(name: str) -> Export:
    """Return the entry of a format.

    Raises
    ------
    InvalidInputError
        If there is none.
    """
    if name not in EXPORTS:
        raise InvalidInputError("format", name, f"one of {', '.join(EXPORTS)}")
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


def rows_of_job(store: Store, job: Job) -> Iterator[Rows]:
    """Yield the rows of a job that is done, a chunk at a time."""
    return map(from_blob, store.blobs(job.id))


def pieces(store: Store, job: Job, name: str, path: Path | None = None) -> Iterator[bytes]:
    """Yield the bytes of a job's file; ``path`` as for `head_for`."""
    head = head_for(store.made_of(job.id), name, path)
    return export_of(name).write(head, rows_of_job(store, job))


def write_result(store: Store, job: Job, name: str, path: Path, *, named: bool) -> None:
    """Write the file of a job: whole, or not at all; ``named``: whether by a person."""
    write_pieces(path, pieces(store, job, name, path if named else None))


def write_result_of(url: str, job: str, name: str, path: str) -> None:
    """Write the file of a job in a process of its own."""
    store = Store(url, stalled_s=0.0)
    try:
        found = store.job(job)
        if found is not None:
            write_result(store, found, name, Path(path), named=False)
    finally:
        store.close()
