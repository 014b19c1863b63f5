"""JSON: one object, its rows as arrays in the order of its columns, a line each."""

import json
from collections.abc import Iterable, Iterator
from typing import BinaryIO

from design.errors import InvalidInputError
from design.export.csv_file import number_texts, runs_of_cells
from design.export.header import END, facts, head_of
from design.export.kind import Export, takes_all
from design.tables.rows import STATUSES, Rows, TableHead

ROWS_LINE = '"rows": ['


def write_json(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as JSON, a piece for each run.

    What is not known is ``null``.

    Parameters
    ----------
    head, runs
        The table, its runs in order.

    Yields
    ------
    bytes
        The facts, a piece for each run, the end.
    """
    lines = [f'"{name}": {text},\n' for name, text in facts(head).items()]
    yield ("{\n" + "".join(lines) + ROWS_LINE).encode()
    between = "\n"
    for rows in runs:
        reasons = {index: json.dumps(text) for index, text in rows.reasons.items()}
        texts = [
            f'[{", ".join(cells)}, "{STATUSES[status]}", {reasons.get(index, "null")}]'
            for index, (cells, status) in enumerate(
                zip(number_texts(rows, "null"), rows.status.tolist(), strict=True)
            )
        ]
        if texts:
            yield (between + ",\n".join(texts)).encode()
            between = ",\n"
    yield b"\n]}\n"


def read_json(file: BinaryIO) -> tuple[TableHead, Iterator[Rows]]:
    """Read back what `write_json` wrote, a few lines at a time.

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
    lines = (line.decode("utf-8", errors="replace").rstrip("\n") for line in file)
    texts = {}
    next(lines, "")
    for line in lines:
        if line == ROWS_LINE:
            break
        name, _, text = line.removesuffix(",").partition(": ")
        texts[name.strip('"')] = text
    head = head_of(texts, {name: number for number, name in enumerate([*texts, END], start=2)})
    rows = ((number, line) for number, line in enumerate(lines, len(texts) + 3) if line != "]}")
    return head, runs_of_cells(head, ((number, _cells(line, number)) for number, line in rows))


def _cells(line: str, number: int) -> list[str]:
    """Return the cells of a row as texts, empty where it says null."""
    try:
        values = json.loads(line.removesuffix(","), parse_float=str, parse_int=str)
        return ["" if value is None else str(value) for value in values]
    except (ValueError, TypeError):
        raise InvalidInputError(
            f"line {number}", line, "a row as a JSON array", code="unreadable_json_row"
        ) from None


EXPORT = Export(
    name="json",
    media_type="application/json",
    suffix=".json",
    checks=takes_all,
    write=write_json,
    read=read_json,
)
