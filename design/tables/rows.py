"""What a table holds: its head, its columns, runs of its rows."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from design.fits import Fit
from design.types import FloatArray

STATUSES = ("verified", "infeasible", "failed")
"""What may become of a row; `Rows.status` holds indices into it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """One column of a table.

    Attributes
    ----------
    name
        ``plant.cable_length_m`` for a varied field, ``t1_s``, ``residual`` ... for a result.
    unit
        ``s``, ``rad/s``, ``1``; empty for status and reason.
    kind
        A varied field, a result, the status or the reason why there is no design.
    """

    name: str
    unit: str
    kind: Literal["field", "result", "status", "reason"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rows:
    """A run of rows of a table, by column.

    Attributes
    ----------
    first
        Number of its first row in the table.
    fields
        Values of the varied fields, shape (m, f), each in its own unit.
    results
        Values of the result columns, shape (m, r); nan where a row has no design.
    status
        Index in `STATUSES`, shape (m,), int8.
    reasons
        From the index of a row within this run to why it is not verified; all that are not.
    """

    first: int
    fields: FloatArray
    results: FloatArray
    status: NDArray[np.signedinteger[Any]]
    reasons: dict[int, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class TableHead:
    """What is true of a whole table.

    Attributes
    ----------
    version
        Of the tool that computed it.
    specification_json, specification_sha256
        The specification as canonical JSON, on one line, and the hash of that text.
    title
        A name for people; names in generated programs are made from it.
    columns
        Fields, results, then status and reason.
    rows
        Number of rows.
    impulses
        Number of impulses of the shaper, the same in all rows.
    amplitudes
        Their heights, shape (impulses,), where no column tells them [-].
    fit
        Polynomials for the times, where the specification asks for them.
    """

    version: str
    specification_json: str
    specification_sha256: str
    title: str
    columns: tuple[Column, ...]
    rows: int
    impulses: int
    amplitudes: tuple[float, ...]
    fit: Fit | None = None
