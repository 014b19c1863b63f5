"""Columns of a table by their meaning."""

import numpy as np

from design.errors import InvalidInputError
from design.fields import Path, unit_of
from design.tables.rows import Column, Rows, Subject, TableHead
from design.tables.specification import TableSpecification
from design.types import FloatArray


def names_of(head: TableHead, kind: str) -> list[str]:
    """Return the names of the columns of one kind, in order.

    Parameters
    ----------
    head
        The table's head.
    kind
        ``field``, ``result``, ``status`` or ``reason``.

    Returns
    -------
    list of str
        In the order of the table.
    """
    return [column.name for column in head.columns if column.kind == kind]


def varied_paths(head: TableHead) -> list[Path]:
    """Return the paths of the varied fields, in the columns' order."""
    return [tuple(name.split(".")) for name in names_of(head, "field")]


def times_of(head: TableHead, rows: Rows) -> FloatArray:
    """Return the times of the impulses in every row.

    Parameters
    ----------
    head, rows
        The table's head and one of its runs, of m rows.

    Returns
    -------
    FloatArray
        Shape (m, impulses) [s]; not a number in a row without a design.

    Raises
    ------
    InvalidInputError
        If the table has no columns of times.
    """
    wanted = [f"t{number}_s" for number in range(1, head.impulses + 1)]
    return rows.results[:, _positions(head, wanted, "times_s")]


def amplitudes_of(head: TableHead, rows: Rows) -> FloatArray:
    """Return the heights of the impulses in every row.

    Those of the head where all rows share them.

    Parameters
    ----------
    head, rows
        The table's head and one of its runs, of m rows.

    Returns
    -------
    FloatArray
        Shape (m, impulses) [-].

    Raises
    ------
    InvalidInputError
        If they neither are shared nor have columns.
    """
    if head.amplitudes and "a1" not in names_of(head, "result"):
        return np.broadcast_to(np.array(head.amplitudes), (rows.status.size, head.impulses))
    wanted = [f"a{number}" for number in range(1, head.impulses + 1)]
    return rows.results[:, _positions(head, wanted, "amplitudes")]


def _positions(head: TableHead, wanted: list[str], column: str) -> list[int]:
    names = names_of(head, "result")
    if not set(wanted) <= set(names):
        raise InvalidInputError(
            "columns", names, f"with {column!r} among them", code="column_missing"
        )
    return [names.index(name) for name in wanted]


def require_times(head: TableHead) -> None:
    """Raise InvalidInputError unless the table has columns of times."""
    _positions(head, [f"t{number}_s" for number in range(1, head.impulses + 1)], "times_s")


def require_no_samples(subject: Subject) -> None:
    """Raise InvalidInputError if rows are on samples: nothing is between two."""
    if subject.grid is not None:
        raise InvalidInputError(
            "subject",
            subject.grid,
            "without sample_time_s, to interpolate: on samples rows have other numbers of impulses "
            "and whole numbers of samples; take the nearest row",
            code="samples_not_interpolated",
        )


def columns_of(specification: TableSpecification) -> tuple[Column, ...]:
    """Return the columns of a table: fields, results, status, reason.

    Returns
    -------
    tuple of Column
        Those of results in the order that is asked for.

    Raises
    ------
    InvalidInputError
        If it is not known how many impulses there are.
    """
    impulses = specification.impulses
    if impulses is None:
        raise InvalidInputError(
            "impulses",
            None,
            "counted first, by design.tables.compute.with_impulse_count",
            code="impulses_not_counted",
        )
    series = {
        "times_s": [(f"t{number}_s", "s") for number in range(1, impulses + 1)],
        "amplitudes": [(f"a{number}", "1") for number in range(1, impulses + 1)],
        "phases_rad": [(f"phase{number}_rad", "rad") for number in range(1, impulses + 1)],
        "duration_s": [("duration_s", "s")],
        "residual": [("residual", "1")],
        "slope": [("slope", "1")],
        "samples": [(f"n{number}", "1") for number in range(1, impulses + 1)],
        "duration_samples": [("duration_samples", "1")],
    }
    return (
        *(
            Column(name=".".join(path), unit=unit_of(path[-1]), kind="field")
            for path in specification.fields
        ),
        *(
            Column(name=name, unit=unit, kind="result")
            for wanted in specification.columns
            for name, unit in series[wanted]
        ),
        Column(name="status", unit="", kind="status"),
        Column(name="reason", unit="", kind="reason"),
    )
