"""A table in pieces: its head, and runs of its rows by column."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from design.curve_fit.polynomials import Fit
from design.errors import InvalidInputError
from design.fields import vary
from design.model.actuators.registry import Actuator
from design.model.plants.registry import Plant
from design.sampling.on_grid import SampleGrid
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.types import BoolArray, FloatArray

STATUSES = ("verified", "infeasible", "failed", "verified_ideal")
"""What may become of a row: a design whose claims are proven for the actuator given; none exists;
the solver or the proof failed; a design whose claims are proven for an ideal actuator alone. In the
order in which they came: a code means the same in files of any age."""

VERIFIED, INFEASIBLE, FAILED, VERIFIED_IDEAL = range(len(STATUSES))

WITH_DESIGN = (VERIFIED, VERIFIED_IDEAL)
"""Codes of the rows that hold impulses."""


GRID_FIELDS = ("sample_time_s", "sample_tolerance")
"""Fields of a request's shaper that are not of its kind but of the samples."""


Real = Literal["LREAL", "REAL"]
"""Types of numbers in Structured Text: double and single precision."""


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
        A varied field, a result, the row's status, or why it has no design.
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
        Shape (m, r); not a number where a row has no design, or on samples fewer impulses than
        others. The residual is with the actuator given, whatever the claims are proven for.
    status
        Index in `STATUSES`, shape (m,).
    reasons
        Why a row has no design, by its number within this run; all rows that have none. On samples
        also what a row does not keep of the claims of its shaper.
    """

    first: int
    fields: FloatArray
    results: FloatArray
    status: NDArray[np.int8]
    reasons: dict[int, str]

    @property
    def designed(self) -> BoolArray:
        """Which rows hold impulses, shape (m,)."""
        held: BoolArray = np.isin(self.status, WITH_DESIGN)
        return held


def join_rows(runs: Sequence[Rows]) -> Rows:
    """Return runs of one table as one.

    Parameters
    ----------
    runs
        Each begins where the last ends; all as wide. At least one.

    Returns
    -------
    Rows
        All their rows.
    """
    first = runs[0].first
    return Rows(
        first=first,
        fields=np.concatenate([run.fields for run in runs]),
        results=np.concatenate([run.results for run in runs]),
        status=np.concatenate([run.status for run in runs]),
        reasons={
            run.first - first + row: reason for run in runs for row, reason in run.reasons.items()
        },
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Subject:
    """What the rows of a table are designs of, before a field is varied.

    Attributes
    ----------
    plant, actuator, kind, options
        As for `design.pipeline.design`.
    grid
        The samples of a controller on which impulses lie; None between samples.
    """

    plant: Plant
    actuator: Actuator
    kind: ShaperKind
    options: ShaperOptions | None
    grid: SampleGrid | None = None

    def at(
        self, paths: Iterable[Sequence[str]], values: Iterable[float]
    ) -> tuple[Plant, Actuator, ShaperOptions | None]:
        """Return plant, actuator and options with some numbers replaced.

        Parameters
        ----------
        paths
            A path for each number, from ``plant``, ``actuator`` or ``shaper`` down.
        values
            The numbers, as many, each in its field's unit.

        Returns
        -------
        Plant
            What moves.
        Actuator
            What drives it.
        Any
            The options of the kind of shaper.

        Raises
        ------
        InvalidInputError
            If there is no such number, or it breaks its rule.
        """
        parts = self._parts_at(paths, values)
        return parts["plant"], parts["actuator"], parts["shaper"]

    def grid_at(self, paths: Iterable[Sequence[str]], values: Iterable[float]) -> SampleGrid | None:
        """Return the samples with some numbers replaced.

        Parameters
        ----------
        paths, values
            As of `at`.

        Returns
        -------
        SampleGrid or None
            None between samples.

        Raises
        ------
        InvalidInputError
            If there is no such number, or it breaks its rule.
        """
        grid: SampleGrid | None = self._parts_at(paths, values)["grid"]
        return grid

    def part_of(self, path: Sequence[str]) -> str:
        """Return the part of the subject that a path of a request leads to."""
        on_grid = path[0] == "shaper" and path[-1] in GRID_FIELDS
        return "grid" if on_grid and self.grid is not None else path[0]

    @property
    def parts(self) -> dict[str, Any]:
        """What may be varied: plant, actuator, shaper and, on samples, grid."""
        parts = {"plant": self.plant, "actuator": self.actuator, "shaper": self.options}
        return parts if self.grid is None else {**parts, "grid": self.grid}

    def _parts_at(self, paths: Iterable[Sequence[str]], values: Iterable[float]) -> dict[str, Any]:
        parts = {"grid": None, **self.parts}
        for path, value in zip(paths, values, strict=True):
            part = self.part_of(path)
            parts[part] = vary(parts[part], path[1:], value)
        return parts


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
        Impulses of the shaper, all rows alike; on samples most of any row.
    amplitudes
        Their amplitudes, all rows alike [-]; none where each row has its own, in columns.
    name
        What names in programs begin with; made from the title where empty.
    fit
        Polynomials for the times, where the specification asks for them.
    real
        Type of numbers in Structured Text.
    subject
        What the rows are designs of; None in a head that was read back from a file, of which
        `schemas.tables.with_subject` makes it anew.
    """

    version: str
    specification_json: str
    specification_sha256: str
    title: str
    columns: tuple[Column, ...]
    rows: int
    impulses: int
    amplitudes: tuple[float, ...]
    name: str = ""
    fit: Fit | None = None
    real: Real = "LREAL"
    subject: Subject | None = field(default=None, compare=False)

    @property
    def on_samples(self) -> bool:
        """Whether the rows lie on the samples of a controller."""
        return self.subject is not None and self.subject.grid is not None


def subject_of(head: TableHead) -> Subject:
    """Return what the rows of a table are designs of.

    Returns
    -------
    Subject
        Plant, actuator, kind and options.

    Raises
    ------
    InvalidInputError
        If the head was read back from a file and nobody has made it anew.
    """
    if head.subject is None:
        raise InvalidInputError(
            "subject",
            None,
            "made from the specification first, by schemas.tables.with_subject",
            code="subject_not_made",
        )
    return head.subject
