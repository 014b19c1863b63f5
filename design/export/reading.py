"""Tables read back from the formats that hold them whole."""

from collections.abc import Iterator
from typing import BinaryIO

from design.errors import InvalidInputError
from design.export.registry import EXPORTS
from design.tables.rows import Rows, TableHead

READERS = {name: one.read for name, one in sorted(EXPORTS.items()) if one.read is not None}
"""Formats that hold a table whole."""


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
