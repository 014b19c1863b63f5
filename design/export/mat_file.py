"""MATLAB's .mat, version 5: ``load`` gives a matrix of fields, one of results, and the head.

Its matrices lie in the file by column, so all rows must be held until the last has come: memory is
not flat here, and a matrix has less than 2^31 bytes.
"""

import io
import json
from collections.abc import Iterable, Iterator
from typing import BinaryIO

import numpy as np

from design.errors import InvalidInputError
from design.export.header import FACTS, facts, head_of
from design.export.kind import Export
from design.tables.columns import names_of
from design.tables.rows import STATUSES, Rows, TableHead

MAX_MATRIX_BYTES = 2**31 - 1
"""Of one variable (MAT-File Format, Mathworks, "Level 5 MAT-File": sizes are 32 bit)."""

HEADER_START = b"MATLAB 5.0 MAT-file"
HEADER_TEXT_BYTES = 116
"""Of the text that starts a file; SciPy writes the date into it."""


def check_mat(head: TableHead) -> None:
    """Raise InvalidInputError where a matrix would have 2^31 bytes."""
    widest = max(len(names_of(head, "field")), len(names_of(head, "result")))
    most = MAX_MATRIX_BYTES // (8 * max(widest, 1))
    if head.rows > most:
        raise InvalidInputError(
            "rows",
            head.rows,
            f"at most {most} for a .mat file; take parquet",
            code="too_many_rows_for_mat",
        )


def write_mat(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as .mat, all at once, with no date in it.

    Variables: ``fields`` and ``results``, matrices with a row for each row of the table and names
    and units in ``field_names``, ``field_units``, ``result_names``, ``result_units``; ``status``,
    from 0, by ``status_names``; ``reason_rows`` (from 1) and ``reasons``; the facts of the head as
    texts of JSON.

    Parameters
    ----------
    head, runs
        The table, its runs in order.

    Yields
    ------
    bytes
        The file's first bytes, then all others.
    """
    from scipy.io import savemat  # noqa: PLC0415

    held = list(runs)
    fields, results = names_of(head, "field"), names_of(head, "result")
    reasons = {
        rows.first + index + 1: text
        for rows in held
        for index, text in sorted(rows.reasons.items())
    }
    units = {column.name: column.unit for column in head.columns}
    variables = {
        "fields": np.vstack([np.empty((0, len(fields))), *(rows.fields for rows in held)]),
        "results": np.vstack([np.empty((0, len(results))), *(rows.results for rows in held)]),
        "status": np.concatenate([np.empty(0, np.int8), *(rows.status for rows in held)])[:, None],
        "field_names": _cells(fields),
        "field_units": _cells([units[name] for name in fields]),
        "result_names": _cells(results),
        "result_units": _cells([units[name] for name in results]),
        "status_names": _cells(STATUSES),
        "reason_rows": np.array(list(reasons), dtype=np.float64)[:, None],
        "reasons": _cells(reasons.values()),
        **facts(head),
    }
    file = io.BytesIO()
    savemat(file, variables, format="5", do_compression=False)
    text = f"{HEADER_START.decode()}, {json.loads(facts(head)['tool'])}".ljust(HEADER_TEXT_BYTES)
    yield text[:HEADER_TEXT_BYTES].encode("ascii", errors="replace")
    yield file.getbuffer()[HEADER_TEXT_BYTES:].tobytes()


def _cells(texts: Iterable[str]) -> np.ndarray[tuple[int, int], np.dtype[np.object_]]:
    """Return texts as a column of cells."""
    listed = list(texts)
    cells = np.empty((len(listed), 1), dtype=object)
    cells[:, 0] = listed
    return cells


def read_mat(file: BinaryIO) -> tuple[TableHead, Iterator[Rows]]:
    """Read back what `write_mat` wrote, as one run.

    Returns
    -------
    TableHead
        Without a subject.
    iterator of Rows
        One run.

    Raises
    ------
    InvalidInputError
        If it is no such file.
    """
    from scipy.io import loadmat  # noqa: PLC0415
    from scipy.io.matlab import MatReadError  # noqa: PLC0415

    start = file.read(HEADER_TEXT_BYTES)
    if not (start.startswith(HEADER_START) and len(start) == HEADER_TEXT_BYTES):
        raise InvalidInputError("file", start[:20], "a .mat file of version 5", code="not_mat_file")
    file.seek(0)
    try:
        held = loadmat(file, chars_as_strings=True)
    except (MatReadError, ValueError, TypeError, IndexError, OSError) as error:
        # What SciPy raises where a file of the right kind is cut or damaged.
        raise InvalidInputError(
            "file", str(error), "a whole .mat file", code="mat_file_damaged"
        ) from None
    texts = {name: str(held[name][0]) for name in FACTS if name in held and held[name].size}
    head = head_of(texts)
    missing = {"fields", "results", "status", "reason_rows", "reasons"} - set(held)
    if missing:
        raise InvalidInputError(
            "file",
            f"without {', '.join(sorted(missing))}",
            "a whole table",
            code="table_incomplete",
        )
    reasons = [str(cell[0]) for cell in held["reasons"][:, 0]] if held["reasons"].size else []
    rows = [int(number) - 1 for number in held["reason_rows"].ravel()]
    run = Rows(
        first=0,
        fields=held["fields"],
        results=held["results"],
        status=held["status"].astype(np.int8).ravel(),
        reasons=dict(zip(rows, reasons, strict=True)),
    )
    return head, iter((run,))


EXPORT = Export(
    name="mat",
    media_type="application/x-matlab-data",
    suffix=".mat",
    checks=check_mat,
    write=write_mat,
    read=read_mat,
)
