"""Between the rows of a program: what it interpolates, and what residual its times have there.

A program does what `design.tables.interpolation` does: it joins the times of the four rows around
a value along each axis, by Lagrange's weights in a coordinate in which the phases are smooth. The
frequency that turns times into phases is the coordinate itself, up to a factor that falls out: a
program needs one root at most, and no frequency.

Its residual is bounded for all values between the rows by `design.tables.proven_bound`. Where that
proves nothing it is found at points, by the closed form. Where it is largest it is found once more
by the certificate's matrix exponentials. Single precision is played here, operation by operation,
as the program does it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from design.errors import InvalidInputError
from design.export.header import short_names
from design.export.program import Listing
from design.model.impulses import Impulses
from design.response.simulation import ringing_after
from design.tables.columns import names_of, times_of
from design.tables.coordinates import (
    Coordinate,
    coordinate_of,
    coordinates,
    scales_with_frequency,
    values_at,
)
from design.tables.interpolation import Interpolant, actuator_at, interpolant, mode_of
from design.tables.proven_bound.bound import residual_bound
from design.tables.proven_bound.stencils import GridAxis
from design.tables.rows import Rows, TableHead
from design.tables.stencil import first_of_stencil
from design.types import BoolArray, FloatArray

MAX_AXES = 2
"""Of a lookup: along three axes it would join the times of 64 rows at each call."""

POINTS_TRIED = 1_000
"""Points between the rows at which the residual is found, at least."""

MOST_POINTS_TRIED = 20_000
"""With more cells than a third of this, one point a cell."""

POINTS_BY_CERTIFICATE = 50
"""Those of the largest residual, at which the certificate's route finds it once more."""

MARGIN = 1.25
"""Over the largest residual at these points, where a cell has no proof:
`design.tables.interpolation` has the reasons [-]."""

ROUNDING_MARGIN = 2.0
"""Over the largest change by single precision at these points: rounding has no pattern [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LookupAxis:
    """One axis of a lookup.

    Attributes
    ----------
    field
        Its path, as ``plant.cable_length_m``.
    name
        Of the input in a program, as ``cable_length_m``.
    values
        Of the rows, increasing, shape (m,), each in the field's unit.
    """

    field: str
    name: str
    values: FloatArray

    @property
    def coordinate(self) -> Coordinate:
        """What its coordinate is of a value."""
        return coordinate_of(self.field)

    @property
    def scales(self) -> bool:
        """Whether the coordinate is the frequency of the plant, up to a factor."""
        return scales_with_frequency(self.field)

    @property
    def points(self) -> int:
        """Rows that are joined along it."""
        return first_of_stencil(np.zeros(1, dtype=int), self.values.size)[1]

    @property
    def before(self) -> int:
        """How many of these are before the cell, away from the ends."""
        return (self.points - 2) // 2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Lookup:
    """What a program interpolates.

    Attributes
    ----------
    axes
        One or two, the last running fastest along the rows.
    amplitudes
        Of all rows, shape (n,) [-].
    times_s
        Of the rows, shape (rows, n) [s].
    usable
        Which cells are interpolated, one less along each axis than it has values.
    unproven
        Cells of these without a proof of the residual, of the same shape.
    residual, residual_in_single
        Bounds of the residual of interpolated times, in double and in single precision [-]. The
        first is proven except in cells without a proof; what single precision adds is sampled.
    tried
        Points at which it was found.
    """

    axes: tuple[LookupAxis, ...]
    amplitudes: FloatArray
    times_s: FloatArray
    usable: BoolArray
    unproven: BoolArray
    residual: float
    residual_in_single: float
    tried: int


def lookup_of(head: TableHead, rows: Rows) -> Lookup | str:
    """Return what a program of a table interpolates, or why it does not.

    Parameters
    ----------
    head, rows
        The whole table, as one run.

    Returns
    -------
    Lookup or str
        A reason in words, where there is nothing to interpolate.
    """
    names = names_of(head, "field")
    if head.on_samples:
        return "on samples nothing is between two rows"
    if not 1 <= len(names) <= MAX_AXES:
        return f"the rows vary {len(names)} fields, not 1 or {MAX_AXES}"
    sizes = [np.unique(column).size for column in rows.fields.T]
    if 1 in sizes or math.prod(sizes) != len(rows.fields):
        return "the rows are no grid of 2 or more values along each axis"
    if np.any(np.diff(np.lexsort(rows.fields.T[::-1])) != 1):
        return "the values of the rows do not increase along each axis"
    try:
        made = interpolant(head, rows)
    except InvalidInputError as error:
        return str(error)
    axes = tuple(
        LookupAxis(field=field, name=name, values=values)
        for field, name, values in zip(made.names, short_names(made.names), made.axes, strict=True)
    )
    known = ~np.isnan(made.times_s(_between(axes, 1))).any(axis=1)
    usable = np.reshape(known, made.closed.shape)
    if not usable.any():
        return "too few rows beside each other have a design of one branch"
    points = _between(axes, _parts_of(usable))
    points = points[~np.isnan(made.times_s(points)).any(axis=1)]
    times_s = times_of(head, rows)
    residuals = made.residuals(points)
    in_single = times_by_lookup(axes, times_s, points, np.float32)
    rounded = np.abs(made.residuals(points, in_single) - residuals).max()
    largest = max(float(residuals.max()), _by_certificate(made, points, residuals))
    proven = residual_bound(
        [GridAxis(field=axis.field, values=axis.values) for axis in axes],
        times_s,
        usable,
        made.plant,
        made.actuator,
        made.amplitudes,
        found=largest,
    )
    bound = max(proven.largest, largest)
    if proven.unproven.any():
        bound = max(proven.largest, made.residual_bound, MARGIN * largest)
    return Lookup(
        axes=axes,
        amplitudes=made.amplitudes,
        times_s=times_s,
        usable=usable,
        unproven=proven.unproven,
        residual=bound,
        residual_in_single=bound + ROUNDING_MARGIN * float(rounded),
        tried=len(points),
    )


def times_by_lookup(
    axes: Sequence[LookupAxis],
    times_s: FloatArray,
    points: FloatArray,
    precision: type[np.floating[Any]],
) -> FloatArray:
    """Return the times that a program finds, operation by operation.

    Parameters
    ----------
    axes, times_s
        Of a `Lookup`.
    points
        Values along each axis, shape (m, axes), within the axes.
    precision
        What the program counts in.

    Returns
    -------
    FloatArray
        Shape (m, n) [s], whether or not the cell is usable.
    """
    rows = times_s.astype(precision)
    firsts, shares = [], []
    for axis, values in zip(axes, points.T, strict=True):
        first, own = _shares(axis, values.astype(precision))
        firsts.append(first)
        shares.append(own)
    times = np.zeros((len(points), times_s.shape[1]), dtype=precision)
    for corner in product(*(range(axis.points) for axis in axes)):
        row = np.zeros(len(points), dtype=int)
        share = np.ones(len(points), dtype=precision)
        for axis, first, own, offset in zip(axes, firsts, shares, corner, strict=True):
            row = row * axis.values.size + first + offset
            share = share * own[:, offset]
        times = times + share[:, None] * rows[row]
    return times.astype(np.float64)


def lookup_remarks(found: Lookup | str, name: str, *, in_single: bool) -> list[str]:
    """Return what the head of a program says of what is between its rows.

    Parameters
    ----------
    found
        A lookup, or why there is none.
    name
        Start of the names in the program.
    in_single
        Whether its numbers are of single precision.

    Returns
    -------
    list of str
        Lines of a comment.
    """
    if isinstance(found, str):
        return [f"no {name}_lookup between rows: {found}"]
    bound = found.residual_in_single if in_single else found.residual
    if math.isnan(bound):
        return [
            f"no bound of the residual of {name}_lookup: rows are too close in single precision"
        ]
    inputs = " and ".join(
        f"{axis.name} from {axis.values[0]:.6g} to {axis.values[-1]:.6g}" for axis in found.axes
    )
    said = [
        f"{name}_lookup, {inputs}: residual at most {up(bound)} of an unshaped step",
        *(f"   {line}" for line in _how_it_is_known(found)),
    ]
    return [*said, f"   {rounding_remark(found)}"] if in_single else said


def _how_it_is_known(found: Lookup) -> list[str]:
    """Return what is proven of a bound, and what is sampled."""
    cells, open_cells = int(found.usable.sum()), int(found.unproven.sum())
    sampled = [
        f"found at {found.tried} points between the rows, and more beside the worst: {MARGIN:g} "
        "times the",
        f"largest there; at the worst {min(POINTS_BY_CERTIFICATE, found.tried)} once more by the "
        "certificate's matrix exponentials",
    ]
    if not open_cells:
        return ["it is proven for every value there, with what rounding to double precision adds"]
    if open_cells == cells:
        return [*sampled, "it is sampled, not proven between these points"]
    return [
        f"it is proven in {cells - open_cells} of {cells} cells between rows, and sampled in the "
        "others:",
        *sampled,
    ]


def rounding_remark(found: Lookup) -> str:
    """Return what the head of a program says of single precision."""
    return (
        f"what single precision adds is sampled: {ROUNDING_MARGIN:g} times the largest at "
        f"{found.tried} points"
    )


def constants(rows: Listing, lookup: Lookup | None) -> int:
    """Return how many numbers the constants of a program are.

    Parameters
    ----------
    rows
        The rows.
    lookup
        What is between them, if anything.

    Returns
    -------
    int
        Columns, times and amplitudes, and the values of axes.
    """
    shared = rows.shared_amplitudes
    amplitudes = rows.amplitudes.size if shared is None else shared.size
    axes = 0 if lookup is None else sum(axis.values.size for axis in lookup.axes)
    return rows.numbers.size + rows.times_s.size + amplitudes + axes


def up(value: float) -> str:
    """Return a bound with two digits, rounded up."""
    if not (math.isfinite(value) and value > 0):
        return str(value)
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return f"{math.ceil(value / unit) * unit:.2g}"


def _shares(axis: LookupAxis, values: NDArray[Any]) -> tuple[NDArray[np.int_], NDArray[Any]]:
    """Return the first row that is joined, shape (m,), and the share of each, shape (m, points)."""
    rows = axis.values.astype(values.dtype)
    cell = np.clip(np.searchsorted(rows, values, side="right") - 1, 0, rows.size - 2)
    first, size = first_of_stencil(cell, rows.size)
    at, nodes = (_in_precision(axis, one) for one in (values, rows))
    stencil = nodes[first[:, None] + np.arange(size)]
    shares = stencil / at[:, None] if axis.scales else np.ones_like(stencil)
    for mine, other in product(range(size), repeat=2):
        if mine != other:
            shares[:, mine] *= (at - stencil[:, other]) / (stencil[:, mine] - stencil[:, other])
    return first, shares


def _in_precision(axis: LookupAxis, values: NDArray[Any]) -> NDArray[Any]:
    """Return coordinates by the operations of a program."""
    found = np.sqrt(values) if axis.coordinate in {"inverse_root", "root"} else values
    return np.reciprocal(found) if axis.coordinate.startswith("inverse") else found


def _parts_of(usable: BoolArray) -> int:
    """Return at how many points of each cell, along each axis, the residual is found: odd."""
    cells, axes = usable.size, usable.ndim
    parts = 2 * math.ceil(((POINTS_TRIED / cells) ** (1 / axes) - 1) / 2) + 1
    return max(parts, 3) if cells * 3**axes <= MOST_POINTS_TRIED else 1


def _between(axes: Sequence[LookupAxis], parts: int) -> FloatArray:
    """Return points inside each cell, the middle among them, shape (m, axes)."""
    columns = []
    for axis in axes:
        nodes = coordinates(axis.field, axis.values)
        inside = (np.arange(parts) + 0.5) / parts
        between = nodes[:-1, None] + np.diff(nodes)[:, None] * inside
        columns.append(values_at(axis.field, between.ravel()))
    return np.stack(np.meshgrid(*columns, indexing="ij"), axis=-1).reshape(-1, len(axes))


def _by_certificate(made: Interpolant, points: FloatArray, residuals: FloatArray) -> float:
    """Return the largest residual by the certificate's route, where that of the form is largest."""
    worst = points[np.argsort(residuals)[-POINTS_BY_CERTIFICATE:]]
    times = made.times_s(worst)
    frequencies, dampings = mode_of(made.plant, list(made.names), worst)
    found = [0.0]
    for row, point in enumerate(worst.tolist()):
        shaper = Impulses(times_s=times[row], amplitudes=made.amplitudes)
        actuator, frequency = actuator_at(made, point), frequencies[row : row + 1]
        ringing, unit, _ = ringing_after(shaper, actuator, frequency, float(dampings[row]))
        found.append(float(abs(ringing[0]) / abs(unit[0])))
    return max(found)
