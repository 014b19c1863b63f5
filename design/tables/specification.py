"""What a table is of: a design, the fields that vary, and the columns wanted."""

import json
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from design.checks import require_between
from design.errors import InvalidInputError
from design.fields import Axis, LongAxis, Path, vary
from design.model.actuators.registry import Actuator
from design.model.plants.modes import Modes
from design.model.plants.registry import Plant, SeveralModes
from design.model.plants.scheduled import Scheduled
from design.sampling.on_grid import SampleGrid, require_served
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.tables.row_amplitudes import impulses_of, shared_amplitudes
from design.tables.rows import GRID_FIELDS, Subject
from design.types import FloatArray

COLUMNS_ON_SAMPLES = ("samples", "duration_samples")
"""Results that a table on samples may hold besides: numbers of samples from the first on."""

COLUMNS = (
    "times_s",
    "amplitudes",
    "phases_rad",
    "duration_s",
    "residual",
    "slope",
    *COLUMNS_ON_SAMPLES,
)
"""Results that a table may hold. A phase is the plant's natural frequency times a time."""

DEFAULT_COLUMNS = ("times_s", "residual")

COLUMNS_WITH_AMPLITUDES = ("times_s", "amplitudes", "residual")
"""Where each row has separate amplitudes: on samples, and of most kinds but unity magnitude."""

WITH_AMPLITUDES = f"amplitudes, as {json.dumps(COLUMNS_WITH_AMPLITUDES)}"


MAX_ROWS = 10_000_000_000
"""Rows of one table: at 40 bytes a row, 400 GB of results."""

MAX_CHUNKS = 1_000_000
"""Chunks of one table; the store holds a record of each."""

MAX_CHUNK_ROWS = 1_000_000
"""Rows of one chunk, which a worker holds in memory."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TableSpecification:
    """A table of designs over axes that multiply, or over a list.

    Attributes
    ----------
    plant, actuator, kind, options
        The design in which fields are varied, as for `design.pipeline.design`.
    grid
        The samples of a controller on which impulses lie; None between samples.
    axes
        They multiply, the last runs fastest; empty where the designs are listed.
    listed
        In place of axes: the values of the fields, shape (rows, fields).
    listed_paths
        The fields of ``listed``.
    columns
        Of `COLUMNS`.
    chunk_rows
        Rows that are computed and stored at a time. Results depend on it no more than on anything
        else of the specification, and on nothing outside of it.
    impulses
        Of each row. Where the kind of shaper does not say how many, the table has one row, and None
        stands for what its design will have; `design.tables.compute.with_impulse_count` finds out.
        On samples each row has its own number, and this is None, or in heads the largest of them.

    Raises
    ------
    InvalidInputError
        If a field does not exist or is varied twice, a value breaks the rule of its field, or the
        table is empty or too large. Rules that bind several fields are found row by row.
    """

    plant: Plant
    actuator: Actuator
    kind: ShaperKind
    options: ShaperOptions | None
    grid: SampleGrid | None = None
    axes: tuple[Axis | LongAxis, ...] = ()
    listed: FloatArray | None = None
    listed_paths: tuple[Path, ...] = ()
    columns: tuple[str, ...] = DEFAULT_COLUMNS
    chunk_rows: int = 10_000
    impulses: int | None = None
    fields: tuple[Path, ...] = field(init=False)

    def __post_init__(self) -> None:
        if (self.listed is None) == (not self.axes):
            raise InvalidInputError(
                "axes",
                len(self.axes),
                "given, or listed designs in its place",
                code="no_axes",
            )
        if self.actuator.kind not in self.kind.actuators:
            raise InvalidInputError(
                "actuator.kind",
                self.actuator.kind,
                f"one that {self.kind.name} serves: {', '.join(self.kind.actuators)}",
                code="actuator_not_served",
            )
        paths = tuple(axis.path for axis in self.axes) if self.listed is None else self.listed_paths
        object.__setattr__(self, "fields", paths)
        for number, path in enumerate(self.fields):
            if path in self.fields[:number]:
                raise InvalidInputError(
                    f"axes.{number}.field",
                    "/".join(path),
                    "another field than those before it",
                    code="field_repeated",
                )
        self._check_shaper()
        self._check_columns()
        require_between("chunk_rows", self.chunk_rows, 1, MAX_CHUNK_ROWS)
        if self.listed is not None:
            if self.listed.shape[0] == 0:
                raise InvalidInputError(
                    "designs", 0, "a list of one or more designs", code="no_designs"
                )
            for path, values in zip(self.fields, self.listed.T, strict=True):
                self._check_values(path, values, lambda index: f"designs.{index}")
        for number, axis in enumerate(self.axes):
            if axis.values.size == 0:
                raise InvalidInputError(
                    f"axes.{number}.values", [], "one or more values", code="no_values"
                )
            place = f"axes.{number}.values"
            self._check_values(axis.path, axis.telling, lambda _, place=place: place)
        self._check_amplitudes()
        self._check_size()

    def _check_shaper(self) -> None:
        """Check that all rows have as many impulses, and note how many where the kind says."""
        several = isinstance(self.plant, SeveralModes)
        if several and not self.kind.serves_several:
            raise InvalidInputError(
                "design.plant.kind",
                "modes" if isinstance(self.plant, Modes) else "double_pendulum",
                f"a plant of one mode for {self.kind.name}",
                code="kind_of_one_mode_in_table",
            )
        if self.grid is not None:
            self._check_grid(self.grid)
            return
        if self.impulses is not None:
            return
        try:
            if isinstance(self.plant, Scheduled) and self.rows != 1:
                raise InvalidInputError(
                    "design.plant.kind",
                    "scheduled",
                    "a plant of one frequency where there are several rows: each row has its own",
                    code="range_in_many_rows",
                )
            found = impulses_of(self.plant, self.kind, self.options)
        except InvalidInputError:
            if self.rows != 1:
                raise
            found = None
        object.__setattr__(self, "impulses", found)

    def _check_grid(self, grid: SampleGrid) -> None:
        """Check that the designs can be brought to samples."""
        try:
            require_served(self.plant.modes, self.kind, self.options, grid.sample_time_s)
        except InvalidInputError as error:
            raise error.within("design.shaper") from None

    def _check_columns(self) -> None:
        if not self.columns:
            raise InvalidInputError(
                "columns", [], f"one or more of {', '.join(COLUMNS)}", code="no_columns"
            )
        for number, name in enumerate(self.columns):
            if name not in COLUMNS or name in self.columns[:number]:
                raise InvalidInputError(
                    f"columns.{number}",
                    name,
                    f"one of {', '.join(COLUMNS)}, each once",
                    code="unknown_column",
                )
            if name in COLUMNS_ON_SAMPLES and self.grid is None:
                raise InvalidInputError(
                    f"columns.{number}",
                    name,
                    "left out without sample_time_s in the shaper of the design",
                    code="column_without_samples",
                )
        if "phases_rad" in self.columns and isinstance(self.plant, SeveralModes | Scheduled):
            raise InvalidInputError(
                "columns",
                "phases_rad",
                "left out for a plant that has no one frequency",
                code="phases_without_frequency",
            )

    def _check_amplitudes(self) -> None:
        wanted = "amplitudes" not in self.columns and {"times_s", "phases_rad"} & set(self.columns)
        if wanted and not self.shared_amplitudes:
            raise InvalidInputError(
                "columns",
                list(self.columns),
                f"with {WITH_AMPLITUDES}: "
                + (
                    f"those of {self.kind.name} depend on the damping, or on a field"
                    if self.grid is None
                    else "on samples each row has its own"
                ),
                code="amplitudes_missing",
            )

    def _check_size(self) -> None:
        require_rows(self.rows)
        if self.chunks > MAX_CHUNKS:
            raise InvalidInputError(
                "chunk_rows",
                self.chunk_rows,
                f"at least {math.ceil(self.rows / MAX_CHUNKS)} for {self.rows} rows",
                code="chunks_too_small",
            )

    def _check_values(self, path: Path, values: FloatArray, place: Any) -> None:  # noqa: ANN401
        """Check the extremes: every rule of a field is an interval, some with 0 besides."""
        outside = np.flatnonzero(~np.isfinite(values))
        if outside.size:
            index = int(outside[0])
            raise InvalidInputError(place(index), float(values[index]), "finite", code="not_finite")
        extremes = [int(values.argmin()), int(values.argmax())]
        above_zero = np.flatnonzero(values > 0)
        if above_zero.size:
            extremes.append(int(above_zero[values[above_zero].argmin()]))
        for index in sorted(set(extremes)):
            value = float(values[index])
            try:
                self._with(path, value)
            except InvalidInputError as error:
                if error.name == "field":
                    where = place(index).removesuffix(".values")
                    raise error.within(where) from None
                raise error.at(place(index), value) from None

    def _with(self, path: Path, value: float) -> dict[str, Any]:
        parts, part, rest = self.subject.parts, self.subject.part_of(path), path[1:]
        if self.grid is None and path[0] == "shaper" and path[-1] in GRID_FIELDS:
            raise InvalidInputError(
                "field",
                "/".join(path),
                "varied where the shaper of the design has a sample_time_s too",
                code="samples_not_in_design",
            )
        if part not in parts or not rest:
            raise InvalidInputError(
                "field",
                "/".join(path),
                "a number of plant, actuator or shaper",
                code="field_not_tabulated",
            )
        return {part: vary(parts[part], rest, value)}

    @property
    def shared_amplitudes(self) -> tuple[float, ...]:
        """The amplitudes of all rows [-]; none where each row has its own."""
        if isinstance(self.plant, SeveralModes) or self.grid is not None:
            return ()
        options = [self.options]
        for number, path in enumerate(self.fields):
            if path[0] == "shaper":
                values = (
                    self.axes[number].telling if self.listed is None else self.listed[:, number]
                )
                options += [
                    vary(self.options, path[1:], float(end)) for end in (values.min(), values.max())
                ]
        found = {shared_amplitudes(self.kind, one) for one in options}
        return found.pop() if len(found) == 1 else ()

    @property
    def rows(self) -> int:
        """Number of rows."""
        if self.listed is not None:
            return int(self.listed.shape[0])
        return math.prod(axis.values.size for axis in self.axes)

    @property
    def chunks(self) -> int:
        """Number of chunks."""
        return -(-self.rows // self.chunk_rows)

    def chunk(self, number: int) -> tuple[int, int]:
        """Return the first row of a chunk, and that after its last."""
        first = number * self.chunk_rows
        return first, min(first + self.chunk_rows, self.rows)

    def field_values(self, start: int, stop: int) -> FloatArray:
        """Return the values of the varied fields in some rows.

        Parameters
        ----------
        start, stop
            Numbers of the first row and of the one after the last, from 0.

        Returns
        -------
        FloatArray
            Shape (stop - start, f), each in its field's unit.
        """
        if self.listed is not None:
            return self.listed[start:stop]
        sizes = [axis.values.size for axis in self.axes]
        places = np.unravel_index(np.arange(start, stop, dtype=np.int64), sizes)
        return np.stack(
            [axis.values[place] for axis, place in zip(self.axes, places, strict=True)], axis=1
        )

    def at(self, values: FloatArray) -> tuple[Plant, Actuator, ShaperOptions | None]:
        """Return plant, actuator and options of one row.

        Parameters
        ----------
        values
            Of the varied fields, shape (f,).

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
            If a value breaks its rule.
        """
        return self.subject.at(self.fields, values.tolist())

    @property
    def subject(self) -> Subject:
        """The design in which fields are varied."""
        return Subject(
            plant=self.plant,
            actuator=self.actuator,
            kind=self.kind,
            options=self.options,
            grid=self.grid,
        )


def require_rows(rows: int) -> None:
    """Raise InvalidInputError if a table would have too many rows.

    Parameters
    ----------
    rows
        Number of rows.

    Raises
    ------
    InvalidInputError
        If there are more than ``MAX_ROWS``; its rule says what to do instead.
    """
    if rows > MAX_ROWS:
        raise InvalidInputError(
            "axes",
            f"{rows:.3g} rows",
            f"of at most {MAX_ROWS:.0e} rows in all: take fewer points and interpolate, vary the "
            "ratio of two frequencies in place of both, or cut it into several tables",
            code="too_many_rows",
        )
