"""A table in pieces: its head, and runs of its rows by column."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from design.fits import Fit
from design.types import FloatArray

STATUSES = ("verified", "infeasible", "failed")
"""What may become of a row: a design and its proof; none exists; the solver or the proof failed."""

VERIFIED, INFEASIBLE, FAILED = range(len(STATUSES))


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """One column of a table.

    Attributes
    ----------
    name
        As ``plant.cable_length_m`` or ``t2_s``.
    unit
        In words of SI, ``1`` for a ratio; empty where it has none.
    kind
        A varied field, a result, the row's status, or why it is not verified.
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
        Number of its first row in the table, from 0.
    fields
        Value of each varied field, shape (m, f), in the order of the specification.
    results
        Shape (m, r); not a number where a row has no design.
    status
        Index in `STATUSES`, shape (m,).
    reasons
        Why a row is not verified, by its number within this run; all rows that are not.
    """

    first: int
    fields: FloatArray
    results: FloatArray
    status: NDArray[np.int8]
    reasons: dict[int, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class TableHead:
    """What a file of a table says of it besides its rows.

    Attributes
    ----------
    version
        Of the tool.
    specification_json
        The specification as canonical JSON.
    specification_sha256
        Its hash, in hexadecimal.
    title
        One line for people.
    columns
        Fields, results, status, reason.
    rows
        Number of rows.
    impulses
        Impulses of the shaper, all rows alike.
    amplitudes
        Their amplitudes, all rows alike [-].
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
