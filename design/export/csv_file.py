"""Comma-separated values, exact: each number is the shortest text that reads back as itself.

The head stands in lines that start with ``#``, as ``pandas.read_csv(path, comment="#")`` and
``numpy.genfromtxt`` skip them. The results of a row without a design are empty.
"""

import csv
import math
from collections.abc import Iterable, Iterator
from itertools import islice
from typing import BinaryIO

import numpy as np

from design.errors import InvalidInputError
from design.export.header import END, facts, head_of
from design.export.kind import Export, takes_all
from design.tables.rows import STATUSES, Rows, TableHead

ROWS_AT_ONCE = 10_000
"""Rows of a run when a text is read back."""


def write_csv(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as CSV, a piece for each run.

    Parameters
    ----------
    head, runs
        The table, its runs in order.

    Yields
    ------
    bytes
        Facts and heading, then a piece for each run.
    """
    lines = [f"# {name}: {text}\n" for name, text in facts(head).items()]
    lines.append(",".join(column.name for column in head.columns) + "\n")
    yield "".join(lines).encode()
    for rows in runs:
        reasons = {index: _quote(text) for index, text in rows.reasons.items()}
        texts = [
            f"{','.join(cells)},{STATUSES[status]},{reasons.get(index, '')}"
            for index, (cells, status) in enumerate(
                zip(number_texts(rows, ""), rows.status.tolist(), strict=True)
            )
        ]
        yield ("\n".join(texts) + "\n").encode() if texts else b""


def number_texts(rows: Rows, unknown: str) -> Iterator[Iterable[str]]:
    """Yield the numbers of each row as shortest exact texts.

    Parameters
    ----------
    rows
        A run of a table.
    unknown
        What is written for a number that is not known (nan).

    Yields
    ------
    iterable of str
        Fields, then results of a row.
    """
    numbers = np.hstack((rows.fields, rows.results))
    gaps = np.isnan(numbers).any(axis=1).tolist()
    for row, gap in zip(numbers.tolist(), gaps, strict=True):
        if gap:
            yield [unknown if math.isnan(value) else repr(value) for value in row]
        else:
            yield map(repr, row)


def _quote(text: str) -> str:
    """Quote what would read as more than one cell, or as a comment."""
    if any(mark in text for mark in '",\n\r#'):
        return '"' + text.replace('"', '""') + '"'
    return text


def read_csv(file: BinaryIO) -> tuple[TableHead, Iterator[Rows]]:
    """Read back what `write_csv` wrote.

    Returns
    -------
    TableHead
        Without a subject.
    iterator of Rows
        Read as they are asked for; errors in lines are raised then.

    Raises
    ------
    InvalidInputError
        If it is no such file; a bad line is named by its number.
    """
    text = (line.decode("utf-8", errors="replace") for line in file)
    texts = {}
    heading = ""
    for line in text:
        if not line.startswith("# "):
            heading = line.rstrip("\r\n")
            break
        name, _, value = line[2:].partition(": ")
        texts[name] = value.rstrip("\r\n")
    # Names stand in the order of their lines.
    lines = {name: number for number, name in enumerate([*texts, END], start=1)}
    head = head_of(texts, lines)
    if heading != ",".join(column.name for column in head.columns):
        raise InvalidInputError(
            "file",
            f"line {lines[END]}: {heading}",
            "a heading that names the columns of its head",
            code="wrong_heading",
        )
    return head, runs_of_cells(head, _cells(text, len(texts) + 1))


def _cells(text: Iterator[str], before: int) -> Iterator[tuple[int, list[str]]]:
    """Yield the cells of each row, and the line on which it ends."""
    lines = csv.reader(text, strict=True)
    try:
        for cells in lines:
            yield before + lines.line_num, cells
    except csv.Error as error:
        number = before + lines.line_num
        raise InvalidInputError(
            f"line {number}", str(error), "a row of cells", code="unreadable_cells"
        ) from None


def runs_of_cells(head: TableHead, rows: Iterator[tuple[int, list[str]]]) -> Iterator[Rows]:
    """Yield runs of rows from the cells of each row.

    Parameters
    ----------
    head
        The table's head.
    rows
        Number of a line and its cells, for each row.

    Yields
    ------
    Rows
        At most ``ROWS_AT_ONCE`` rows each.

    Raises
    ------
    InvalidInputError
        If the cells of a line are no row of the table.
    """
    first = 0
    while batch := list(islice(rows, ROWS_AT_ONCE)):
        yield _rows_of_cells(head, first, batch)
        first += len(batch)


def _rows_of_cells(head: TableHead, first: int, cells: list[tuple[int, list[str]]]) -> Rows:
    fields = sum(column.kind == "field" for column in head.columns)
    numbers = len(head.columns) - 2
    values = np.empty((len(cells), numbers))
    status = np.empty(len(cells), dtype=np.int8)
    reasons = {}
    for index, (line, row) in enumerate(cells):
        try:
            *texts, outcome, reason = row
            values[index] = [float(text) if text else math.nan for text in texts]
            status[index] = STATUSES.index(outcome)
        except ValueError:
            raise InvalidInputError(
                f"line {line}",
                ",".join(row),
                f"{numbers} numbers, a status and a reason",
                code="unreadable_csv_row",
            ) from None
        if reason:
            reasons[index] = reason
    return Rows(
        first=first,
        fields=values[:, :fields],
        results=values[:, fields:],
        status=status,
        reasons=reasons,
    )


EXPORT = Export(
    name="csv",
    media_type="text/csv; charset=utf-8",
    suffix=".csv",
    checks=takes_all,
    write=write_csv,
    read=read_csv,
)
