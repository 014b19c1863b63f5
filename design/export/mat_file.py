"""MATLAB's .mat, version 5: ``load`` gives one struct, ``table``.

Its matrices lie in the file by column, so all rows must be held until the last has come: memory is
not flat here, and the struct has less than 2^31 bytes.
"""

import io
import json
import re
from collections.abc import Iterable, Iterator
from typing import Any, BinaryIO

import numpy as np

from design.errors import InvalidInputError
from design.export.header import FACTS, facts, head_of, short_names
from design.export.kind import Export
from design.export.mat_header import HEADER_START, HEADER_TEXT_BYTES, header_text
from design.tables.columns import names_of
from design.tables.rows import STATUSES, Rows, TableHead
from design.types import FloatArray

MAX_MATRIX_BYTES = 2**31 - 1
"""Of one variable (MAT-File Format, Mathworks, "Level 5 MAT-File": sizes are 32 bit)."""

NAME = "table"

OF_IMPULSES = re.compile(r"(t|a|phase|n)(\d+)(?:_s|_rad)?")
MATRICES = {"t": "times_s", "a": "amplitudes", "phase": "phases_rad", "n": "samples"}
"""Columns of an impulse, by the letters ahead of its number, and the matrix that they are in."""

BESIDES = 2
"""Columns besides those of numbers: the status, and room for names and reasons."""


def check_mat(head: TableHead) -> None:
    """Raise InvalidInputError where the struct would have 2^31 bytes."""
    # Values of a field stand twice, as an axis too.
    numbers = 2 * len(names_of(head, "field")) + len(names_of(head, "result"))
    most = MAX_MATRIX_BYTES // (8 * (numbers + BESIDES))
    if head.rows > most:
        raise InvalidInputError(
            "rows",
            head.rows,
            f"at most {most} for a .mat file; take parquet",
            code="too_many_rows_for_mat",
        )


def write_mat(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as .mat, all at once, with no date in it.

    The struct ``table`` has: ``axes``, the different values of each field by its name; ``fields``,
    its value in each row; ``times_s``, ``amplitudes`` and other matrices, a row for each row of the
    table and a column for each impulse; ``residual`` and others, a column each; ``units`` by these
    names; ``status``, from 0, by ``status_names``; ``reason_rows`` (from 1) and ``reasons``;
    ``row_count``, ``impulses``, ``title``; and ``head``, the facts of a file as texts of JSON.

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
    reasons = {
        rows.first + index + 1: text
        for rows in held
        for index, text in sorted(rows.reasons.items())
    }
    numbers, units = _numbers(head, held)
    table = {
        "title": head.title,
        "row_count": float(head.rows),
        "impulses": float(head.impulses),
        **numbers,
        "units": units,
        "status": np.concatenate([np.empty(0, np.int8), *(rows.status for rows in held)])[:, None],
        "status_names": _cells(STATUSES),
        "reason_rows": np.array(list(reasons), dtype=np.float64)[:, None],
        "reasons": _cells(reasons.values()),
        "head": facts(head),
    }
    file = io.BytesIO()
    savemat(file, {NAME: table}, format="5", do_compression=False, long_field_names=True)
    yield header_text(json.loads(facts(head)["tool"]))
    yield file.getbuffer()[HEADER_TEXT_BYTES:].tobytes()


def _numbers(head: TableHead, held: list[Rows]) -> tuple[dict[str, Any], dict[str, str]]:
    """Return what the struct has of numbers, and units by the same names."""
    paths, results = names_of(head, "field"), names_of(head, "result")
    values = np.vstack([np.empty((0, len(paths))), *(rows.fields for rows in held)])
    found = np.vstack([np.empty((0, len(results))), *(rows.results for rows in held)])
    unit = {column.name: column.unit for column in head.columns}
    names = short_names(paths)
    numbers: dict[str, Any] = {}
    if names:
        columns = dict(zip(names, values.T, strict=True))
        numbers["axes"] = {name: _different(column) for name, column in columns.items()}
        numbers["fields"] = {name: column[:, None] for name, column in columns.items()}
    for name, places in _places(results).items():
        numbers[name] = found[:, places]
    if head.amplitudes and "amplitudes" not in numbers:
        numbers["amplitudes"] = np.array([head.amplitudes])
    units = {name: unit[path] for name, path in zip(names, paths, strict=True)}
    units |= {name: unit[results[places[0]]] for name, places in _places(results).items()}
    return numbers, units


def _places(results: list[str]) -> dict[str, list[int]]:
    """Return the columns of results that stand in each matrix, by its name."""
    places: dict[str, list[int]] = {}
    for place, name in enumerate(results):
        match = OF_IMPULSES.fullmatch(name)
        places.setdefault(name if match is None else MATRICES[match[1]], []).append(place)
    return places


def _different(values: FloatArray) -> FloatArray:
    """Return the different values of a field in the order in which they come, a column."""
    _, first = np.unique(values, return_index=True)
    return values[np.sort(first)][:, None]


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
    table = held[NAME][0, 0] if NAME in held and held[NAME].dtype.names else None
    if table is None:
        raise InvalidInputError("file", f"without {NAME}", "a whole table", code="table_incomplete")
    texts: Any = table["head"][0, 0] if "head" in table.dtype.names else np.empty(0)
    known = texts.dtype.names or ()
    head = head_of({
        name: str(texts[name][0]) for name in FACTS if name in known and texts[name].size
    })
    places = _places(names_of(head, "result"))
    paths = names_of(head, "field")
    wanted = {*places, *(("fields",) if paths else ()), "status", "reason_rows", "reasons"}
    missing = wanted - set(table.dtype.names)
    if missing:
        raise InvalidInputError(
            "file",
            f"without {', '.join(sorted(missing))}",
            "a whole table",
            code="table_incomplete",
        )
    counted = [float(table[name][0, 0]) for name in ("row_count", "impulses")]
    if counted != [head.rows, head.impulses]:
        raise InvalidInputError(
            "file", f"counts {counted}", "those of its head", code="counts_unlike_head"
        )
    count = table["status"].shape[0]
    fields = np.empty((count, len(paths)))
    results = np.empty((count, len(names_of(head, "result"))))
    for place, name in enumerate(short_names(paths)):
        fields[:, place] = table["fields"][0, 0][name].ravel()
    for name, columns in places.items():
        results[:, columns] = table[name]
    reasons = [str(cell[0]) for cell in table["reasons"][:, 0]] if table["reasons"].size else []
    rows = [int(number) - 1 for number in table["reason_rows"].ravel()]
    run = Rows(
        first=0,
        fields=fields,
        results=results,
        status=table["status"].astype(np.int8).ravel(),
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
