"""Wire form of tables: the specification in, the state of a job out."""

import hashlib
import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, Field, ValidationError

from design.curve_fit.fit_range import plants_at_ends
from design.errors import InvalidInputError
from design.export.program import DEFAULT_TITLE
from design.fields import Axis, EvenRange, LongAxis, Path, Spacing
from design.tables.row_amplitudes import shared_amplitudes
from design.tables.rows import Real, Subject, TableHead
from design.tables.specification import (
    COLUMNS,
    COLUMNS_ON_SAMPLES,
    COLUMNS_WITH_AMPLITUDES,
    DEFAULT_COLUMNS,
    MAX_CHUNK_ROWS,
    MAX_ROWS,
    TableSpecification,
    require_rows,
)
from design.types import FloatArray
from schemas.actuators import ActuatorIn
from schemas.base import Wire, name_field
from schemas.fits import FitIn
from schemas.plants import PlantIn
from schemas.pointers import path_of
from schemas.samples import grid_of, refuse_samples
from schemas.shapers import ShaperIn
from schemas.units import all_in_si
from schemas.varied import VariedInRequest

MAX_TABLE_AXIS_POINTS = 10_000_000
"""Points of one axis; its values are held in memory."""


CHUNK_ROWS = 10_000
"""Rows of a chunk where nothing else is said."""

CHUNK_ROWS_ON_SAMPLES = 100
"""The same on samples, where a row takes up to half a second: a chunk is a minute at most."""

NO_POLYNOMIALS_ON_SAMPLES = (
    "on samples times are whole numbers, which no polynomial follows: take the nearest row"
)
"""Why a table on samples has no fit."""


def _on_samples(given: dict[str, Any]) -> bool:
    """Return whether the design that was validated before has a sample time."""
    design = given.get("design")
    return isinstance(design, TableDesign) and design.shaper.sample_time_s is not None


def _columns(given: dict[str, Any]) -> list[str]:
    return list(COLUMNS_WITH_AMPLITUDES if _amplitudes_vary(given) else DEFAULT_COLUMNS)


def _amplitudes_vary(given: dict[str, Any]) -> bool:
    """Return whether each row has separate amplitudes, where that follows from the kind."""
    design = given.get("design")
    if _on_samples(given) or not isinstance(design, TableDesign):
        return _on_samples(given)
    try:
        kind, options = design.shaper.shaper_kind(), design.shaper.options()
        several = len(design.plant.to_design().modes) > 1
    except InvalidInputError:  # which is said when the table is made
        return False
    return several or not shared_amplitudes(kind, options)


def _chunk_rows(given: dict[str, Any]) -> int:
    return CHUNK_ROWS_ON_SAMPLES if _on_samples(given) else CHUNK_ROWS


class TableDesign(Wire):
    """The design in which fields are varied."""

    plant: PlantIn
    actuator: ActuatorIn
    shaper: ShaperIn

    def to_design(self) -> Subject:
        """Build the design record."""
        with name_field("plant"):
            plant = self.plant.to_design()
        with name_field("actuator"):
            actuator = self.actuator.to_design()
        with name_field("shaper"):
            options, grid = self.shaper.options(), grid_of(self.shaper)
        return Subject(
            plant=plant,
            actuator=actuator,
            kind=self.shaper.shaper_kind(),
            options=options,
            grid=grid,
        )


class TableAxis(VariedInRequest):
    """One field and its values: ``from``, ``to`` and ``points``, or ``values``."""

    field: Annotated[
        str,
        Field(
            pattern="^/(plant|actuator|shaper)/",
            description="JSON pointer of the number that the axis varies.",
        ),
    ]
    from_: Annotated[
        float | None, Field(alias="from", description="First value, in the field's unit.")
    ] = None
    to: Annotated[float | None, Field(description="Last value, in the field's unit.")] = None
    points: Annotated[int | None, Field(ge=1, le=MAX_ROWS, description="Number of values.")] = None
    spacing: Annotated[
        Spacing,
        Field(description="chebyshev: points of the second kind, both ends among them."),
    ] = "linear"
    values: Annotated[
        list[float] | None, Field(description="Values in place of from, to and points.")
    ] = None

    def to_design(self) -> Axis | LongAxis:
        """Build the design record.

        Returns
        -------
        Axis or LongAxis
            The latter of a range, whose values are made as they are needed.

        Raises
        ------
        InvalidInputError
            If values and a range are given, half a range, an empty one, or one of too many points.
        """
        path = path_of(self.field)
        if self.values is None:
            return LongAxis(path=path, values=self._range())
        if (self.from_, self.to, self.points) != (None, None, None):
            raise InvalidInputError(
                "values", "values and a range", "given alone", code="values_and_range"
            )
        return Axis(path=path, values=np.array(self.values, dtype=np.float64))

    @property
    def size(self) -> int:
        """Number of its values, before any is made."""
        return len(self.values) if self.values is not None else self.points or 0

    def _range(self) -> EvenRange:
        if self.from_ is None or self.to is None or self.points is None:
            raise InvalidInputError(
                "from",
                self.from_,
                "given with to and points, or values in their place",
                code="range_incomplete",
            )
        if self.points > MAX_TABLE_AXIS_POINTS:
            raise InvalidInputError(
                "points",
                self.points,
                f"at most {MAX_TABLE_AXIS_POINTS} on one axis",
                code="too_many_points",
            )
        return EvenRange(self.from_, self.to, self.points, self.spacing)


class Tolerances(Wire):
    """How far a number may drift before a checked table counts as changed."""

    # What a row of a table and the single design may differ by; another processor differs less.
    absolute: Annotated[float, Field(ge=0, description="Absolute, in the unit of the column.")] = (
        1e-10
    )
    relative: Annotated[float, Field(ge=0, description="Relative to the number [-].")] = 1e-10


class TableRequest(Wire):
    """Body of `POST /v1/tables`."""

    title: Annotated[
        str,
        Field(
            min_length=1,
            max_length=100,
            pattern="^[^\\x00-\\x1f\\x7f]*$",
            description="Title in every file. Names in programs are made from it, or from the "
            "name of the file where it is not given.",
        ),
    ] = DEFAULT_TITLE
    design: TableDesign
    axes: Annotated[
        list[TableAxis] | None, Field(description="Axes of a grid: their points multiply.")
    ] = None
    designs: Annotated[
        list[dict[str, Any]] | None,
        AfterValidator(all_in_si),
        Field(description="In place of axes: objects that are each merged over design."),
    ] = None
    designs_file: Annotated[
        str | None,
        Field(description="Designs from a file, JSON Lines or CSV; on the command line only."),
    ] = None
    columns: Annotated[
        list[str],
        Field(
            default_factory=_columns,
            description=f"One or more of {', '.join(COLUMNS)}; {', '.join(COLUMNS_ON_SAMPLES)} on "
            f"samples only. If not given, {', '.join(DEFAULT_COLUMNS)}, and amplitudes where "
            "each row has its own.",
        ),
    ]
    chunk_rows: Annotated[
        int,
        Field(
            default_factory=_chunk_rows,
            ge=1,
            le=MAX_CHUNK_ROWS,
            description=f"Rows computed and stored at a time; {CHUNK_ROWS} if not given, on "
            f"samples {CHUNK_ROWS_ON_SAMPLES}.",
        ),
    ]
    tolerances: Tolerances = Tolerances()
    fit: Annotated[
        FitIn | None, Field(description="Polynomials, for the formats that hold programs.")
    ] = None
    real: Annotated[
        Real | None,
        Field(description="Type of numbers in Structured Text; LREAL if not given."),
    ] = None

    def to_design(self) -> TableSpecification:
        """Build the design record; every fault of the request is found here.

        Returns
        -------
        TableSpecification
            The table, not yet computed.

        Raises
        ------
        InvalidInputError
            If a field breaks its rule; the path leads from the request on.
        """
        if self.designs_file is not None:
            raise InvalidInputError(
                "designs_file",
                self.designs_file,
                "left out over HTTP: give designs in its place",
                code="file_over_http",
            )
        if (self.axes is None) == (self.designs is None):
            both = "neither" if self.axes is None else "both"
            raise InvalidInputError(
                "axes", both, "given, or designs in its place", code="axes_or_designs"
            )
        with name_field("design"):
            subject = self.design.to_design()
        if self.fit is not None and subject.grid is not None:
            with name_field("design"), name_field("shaper"):
                refuse_samples(subject.grid.sample_time_s, NO_POLYNOMIALS_ON_SAMPLES)
        if self.fit is not None:
            with name_field("fit"):
                plants_at_ends(subject.plant, self.fit.to_design(self.design.plant.kind))
        require_rows(math.prod(axis.size for axis in self.axes or ()))  # before any is made
        paths, listed = (
            _listed_fields(self.designs, subject) if self.designs is not None else ((), None)
        )
        return TableSpecification(
            plant=subject.plant,
            actuator=subject.actuator,
            kind=subject.kind,
            options=subject.options,
            grid=subject.grid,
            axes=tuple(_axis(number, axis) for number, axis in enumerate(self.axes or ())),
            listed=listed,
            listed_paths=paths,
            columns=tuple(self.columns),
            chunk_rows=self.chunk_rows,
        )


def sha256_of(specification: str) -> str:
    """Return the hash that files name a specification by."""
    return hashlib.sha256(specification.encode()).hexdigest()


def with_subject(head: TableHead) -> TableHead:
    """Return a head that was read back, with what its rows are designs of.

    Returns
    -------
    TableHead
        With a subject made from its specification.

    Raises
    ------
    InvalidInputError
        If its specification is none.
    """
    try:
        request = TableRequest.model_validate_json(head.specification_json)
    except ValidationError as error:
        first = error.errors()[0]
        raise InvalidInputError(
            ("specification", *map(str, first["loc"])),
            first["input"],
            first["msg"],
            code="unreadable_specification",
        ) from None
    return replace(head, subject=request.to_design().subject)


def _axis(number: int, axis: TableAxis) -> Axis | LongAxis:
    with name_field(f"axes.{number}"):
        return axis.to_design()


def _listed_fields(
    designs: list[dict[str, Any]], subject: Subject
) -> tuple[tuple[Path, ...], FloatArray]:
    """Return the fields that listed designs vary, in order of appearance, and their values."""
    lines = [dict(_numbers(design, (), number)) for number, design in enumerate(designs)]
    paths = tuple(dict.fromkeys(path for line in lines for path in line))
    if not paths and len(designs) != 1:
        raise InvalidInputError(
            "designs",
            len(designs),
            "one or more; where more than one, they vary something",
            code="nothing_varies",
        )
    values = np.empty((len(lines), len(paths)))
    for column, path in enumerate(paths):
        inner: Any = subject.parts.get(subject.part_of(path))
        for name in path[1:]:
            inner = _inner(inner, name)
        # What a line does not name stays as it is in the design; a wrong name is found later.
        usual = float(inner) if isinstance(inner, int | float) else np.nan
        values[:, column] = [line.get(path, usual) for line in lines]
        if inner is None:
            first = next(number for number, line in enumerate(lines) if path in line)
            raise InvalidInputError(
                ("designs", str(first), *path),
                lines[first][path],
                "the name of a number",
                code="not_a_number",
            )
    return paths, values


def _inner(record: Any, name: str) -> Any:  # noqa: ANN401
    if isinstance(record, tuple):
        return record[int(name)] if name.isdecimal() and int(name) < len(record) else None
    return getattr(record, name, None)


def _numbers(here: Any, path: Path, number: int) -> Iterator[tuple[Path, float]]:  # noqa: ANN401
    if isinstance(here, dict):
        for name, inner in here.items():
            yield from _numbers(inner, (*path, name), number)
    elif isinstance(here, list):
        for place, inner in enumerate(here):
            yield from _numbers(inner, (*path, str(place)), number)
    elif isinstance(here, int | float) and not isinstance(here, bool):
        yield path, float(here)
    else:
        raise InvalidInputError(
            ("designs", str(number), *path), here, "a number", code="varied_not_a_number"
        )
