"""Tables read back from the formats that hold them whole."""

from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from design.errors import InvalidInputError
from design.export.registry import EXPORTS
from design.tables.rows import Rows, TableHead

READERS = {name: one.read for name, one in sorted(EXPORTS.items()) if one.read is not None}
"""Formats that hold a table whole."""

NOT_AS_WRITTEN = frozenset({
    "unsound_head",
    "wrong_hash",
    "wrong_heading",
    "columns_unlike_head",
    "not_parquet_file",
    "not_mat_file",
    "mat_file_damaged",
    "table_incomplete",
})
"""Codes of files that something else than `design.export` wrote, or wrote last."""

SAVED_BY = {"csv": "a spreadsheet"}
"""What most often saves the files of a format anew, where it is known."""


def why_not_read(format_name: str, path: Path, error: InvalidInputError) -> str:
    """Return why a file could not be read back.

    Parameters
    ----------
    format_name, path
        The format, and the file.
    error
        What `rows_of` raised.

    Returns
    -------
    str
        The file, what is wrong with it, and what may have been done to it.
    """
    if path.stat().st_size == 0:
        return f"{path} is empty: shapersmith wrote no such file"
    if error.code not in NOT_AS_WRITTEN:
        return f"{path} cannot be checked: {error}"
    other = SAVED_BY.get(format_name, "another program")
    return f"{path} is not as shapersmith wrote it; was it saved by {other}? {error.value}"


def rows_of(format_name: str, file: BinaryIO) -> tuple[TableHead, Iterator[Rows]]:
    """Read a table that `design.export` wrote.

    Parameters
    ----------
    format_name
        One of `READERS`.
    file
        Its bytes, opened; it must stay open while the rows are read.

    Returns
    -------
    head, runs
        The head, and the rows in runs of the file's own choice, in order.

    Raises
    ------
    InvalidInputError
        If the format cannot be read back, or the file is no such table.
    """
    if format_name not in READERS:
        raise InvalidInputError(
            "format",
            format_name,
            f"one of {', '.join(READERS)} to be read",
            code="format_not_readable",
        )
    head, runs = READERS[format_name](file)
    return head, _check_count(head, runs)


def _check_count(head: TableHead, runs: Iterator[Rows]) -> Iterator[Rows]:
    """Hand the runs on, and see that none are missing at the end."""
    rows = 0
    for run in runs:
        yield run
        rows += run.status.size
    if rows != head.rows:
        raise InvalidInputError(
            "file",
            f"{rows} rows",
            f"of {head.rows} rows, as its head says",
            code="rows_unlike_head",
        )
