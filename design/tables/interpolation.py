"""Between the rows of a table: times by interpolation, and the residual that they may leave.

The times themselves bend like 1/w. The phases ``w t_i`` over the plant's frequency and over the
actuator's frequency against it bend little, as in `design.curve_fit`; those are interpolated, by
the cubic through the four nearest points along each axis (by all points, where there are fewer).

Neighbouring rows may be designs of different branches, with nothing to interpolate between them.
Every cell is tried in its middles, and one whose residual is too large there is closed. Tried all
over are those that may be the worst, those whose rows are far from each other, and those that reach
across a kink: behind limits the times bend where ramps begin to turn.
"""

import math
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from design.analysis.residuals_of_many import residuals_of_many
from design.errors import InvalidInputError
from design.fields import vary
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.model.plants.spring_mass import SpringMass
from design.tables.columns import amplitudes_of, names_of, require_no_samples, times_of
from design.tables.coordinates import coordinates, values_at
from design.tables.rows import Rows, TableHead, subject_of
from design.tables.stencil import IndexArray, first_of_stencil
from design.tables.turned_rows import cells_across_kinks, cells_of_far_rows, turned_ramps
from design.types import BoolArray, FloatArray

BOUND_MARGIN = 1.25
"""Over the worst residual at the middles. The error of a cubic at the middle of its cell is the
largest of the cell where the cell is inside an even grid, and 1/1.07 of it where it is the first or
the last; the rest is for uneven grids and for what the next order adds. Across a kink it is for
what is between two of the points tried."""

PARTS = 8
"""Parts of a cell along each axis, at whose ends it is tried all over, and then once more between
the points beside the largest. The error across a kink is nearly a straight line on either side of
it, and its top a sixteenth of the cell at most from a point tried at first [-]."""

NEARLY_WORST = 0.5
"""Share of the largest residual above which a cell may be the worst: where it is large in the
middles of two axes at once, the largest may be beside them [-]."""

CLOSED_ABOVE = 0.05
"""Residual in its middles that closes a cell: more than shapers are commonly allowed. There the
rows around are of two branches, or too far apart for an error to be of first order [-]."""

OneMode = Mode | Pendulum | SpringMass
"""Plants of one mode and one frequency."""

POINTS_AT_ONCE = 10_000
"""Points that are tried together, of a slab at least; their numbers fit into memory."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Interpolant:
    """Times of a shaper at any point of a table's grid.

    Attributes
    ----------
    names
        The fields, as ``plant.cable_length_m``, in the order of the axes.
    axes
        Values of each, increasing.
    phases
        ``w t_i`` at the points of the grid, shape (len(axes[0]), ..., impulses) [-].
    amplitudes
        Shape (impulses,) [-].
    plant, actuator
        What the fields are varied in.
    closed
        Cells that are not interpolated, one less along each axis than it has points.
    residual_bound
        What the interpolated times leave at most in all other cells, from their middles, with a
        margin; sampled. Of one or two fields `design.tables.proven_bound` proves one. Not a number
        if there is no such cell [-].
    """

    names: tuple[str, ...]
    axes: tuple[FloatArray, ...]
    phases: FloatArray
    amplitudes: FloatArray
    plant: OneMode
    actuator: Actuator
    closed: BoolArray
    residual_bound: float

    def times_s(self, points: FloatArray) -> FloatArray:
        """Return the times of the impulses at points of the table's range.

        Parameters
        ----------
        points
            Values of the fields, shape (m, len(names)), each in its own unit.

        Returns
        -------
        FloatArray
            Shape (m, impulses) [s]; not a number in a closed cell, nor next to a row that has no
            design.

        Raises
        ------
        InvalidInputError
            If a value is outside its axis: nothing is known there.
        """
        return _times_s(self, points)

    def residuals(self, points: FloatArray, times_s: FloatArray | None = None) -> FloatArray:
        """Return residuals at points, of interpolated times or of others.

        Parameters
        ----------
        points
            As of `times_s`.
        times_s
            Times in place of those that are interpolated, shape (m, impulses) [s].

        Returns
        -------
        FloatArray
            Shape (m,) [-]; not a number where the times are not.

        Raises
        ------
        InvalidInputError
            As of `times_s`.
        """
        return _residuals(self, points, _times_s(self, points) if times_s is None else times_s)


def interpolant(head: TableHead, rows: Rows) -> Interpolant:
    """Make an interpolant of a table over a grid, tried in every cell.

    Parameters
    ----------
    head, rows
        The whole table, as one run.

    Returns
    -------
    Interpolant
        With the largest residual that was found.

    Raises
    ------
    InvalidInputError
        If the rows are no grid or on samples, have no columns of times, have amplitudes that differ
        from row to row, or vary what is no field of plant or actuator.
    """
    names = tuple(names_of(head, "field"))
    subject = subject_of(head)
    require_no_samples(subject)
    foreign = [name for name in names if name.partition(".")[0] not in {"plant", "actuator"}]
    if foreign:
        raise InvalidInputError(
            "fields",
            foreign,
            "fields of plant or actuator, to interpolate",
            code="fields_not_interpolated",
        )
    if isinstance(subject.actuator, RateLimited):
        subject.actuator.require_straight_ramps()
    if not names:
        raise InvalidInputError("fields", [], "one or more, to interpolate", code="no_fields")
    if not isinstance(subject.plant, OneMode):
        raise InvalidInputError(
            "plant",
            subject.plant,
            "of one mode and frequency, to interpolate",
            code="plant_not_interpolated",
        )
    amplitudes = amplitudes_of(head, rows)[rows.designed]
    if not len(amplitudes):
        raise InvalidInputError(
            "rows", "none verified", "one or more verified, to interpolate", code="no_verified_row"
        )
    if np.any(amplitudes != amplitudes[:1]):
        raise InvalidInputError(
            "amplitudes",
            "other ones from row to row",
            "the same in all rows",
            code="amplitudes_vary",
        )
    axes, order = _grid(rows.fields)
    frequencies, _ = mode_of(subject.plant, list(names), rows.fields)
    phases = (times_of(head, rows) * frequencies[:, None])[order]
    made = Interpolant(
        names=names,
        axes=axes,
        phases=phases.reshape(*(axis.size for axis in axes), head.impulses),
        amplitudes=amplitudes[0],
        plant=subject.plant,
        actuator=subject.actuator,
        closed=np.zeros([max(axis.size - 1, 1) for axis in axes], dtype=bool),
        residual_bound=np.nan,
    )
    drives = [actuator_at(made, point) for point in rows.fields[order].tolist()]
    turned = turned_ramps(times_of(head, rows)[order], made.amplitudes, drives)
    across = cells_across_kinks(turned.reshape(made.phases.shape)) | cells_of_far_rows(made.phases)
    worst = _worst_of_cells(made)
    largest = float(np.max(worst[worst <= CLOSED_ABOVE], initial=0.0))
    worst = np.fmax(worst, _worst_all_over(made, across | (worst > NEARLY_WORST * largest)))
    closed = worst > CLOSED_ABOVE
    bound = BOUND_MARGIN * float(np.max(worst[worst <= CLOSED_ABOVE], initial=-np.inf))
    return replace(made, closed=closed, residual_bound=bound if bound >= 0 else np.nan)


def mode_of(plant: Plant, names: list[str], values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return natural frequency and damping ratio at many values of fields.

    Parameters
    ----------
    plant
        What the fields are varied in.
    names
        Names of the fields, as ``plant.cable_length_m``; those of other parts are passed over.
    values
        Their values, shape (m, len(names)).

    Returns
    -------
    tuple of FloatArray
        Natural frequencies, shape (m,) [rad/s], and damping ratios, shape (m,) [-].
    """

    def of(field: str) -> FloatArray:
        if f"plant.{field}" in names:
            return values[:, names.index(f"plant.{field}")]
        return np.full(len(values), float(getattr(plant, field)))

    if isinstance(plant, Pendulum):
        return np.sqrt(of("gravity_m_s2") / of("cable_length_m")), of("damping_ratio")
    if isinstance(plant, SpringMass):
        return np.sqrt(of("stiffness_n_m") / of("mass_kg")), of("damping_ratio")
    return of("natural_frequency_rad_s"), of("damping_ratio")


def _grid(fields: FloatArray) -> tuple[tuple[FloatArray, ...], IndexArray]:
    """Return the axes of a grid and the order of its rows, the last axis running fastest."""
    axes = tuple(np.unique(column) for column in fields.T)
    order = np.lexsort(fields.T[::-1])
    whole = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))
    if whole.shape != fields.shape or np.any(whole != fields[order]):
        raise InvalidInputError(
            "rows",
            f"{len(fields)} rows",
            f"all {len(whole)} points of a grid, each once",
            code="not_a_grid",
        )
    return axes, order


def _times_s(made: Interpolant, points: FloatArray) -> FloatArray:
    starts, weights, cells = [], [], []
    on_row = np.ones(len(points), dtype=bool)
    for name, axis, values in zip(made.names, made.axes, points.T, strict=True):
        outside = ~((values >= axis[0]) & (values <= axis[-1]))
        if outside.any():
            raise InvalidInputError(
                name,
                float(values[outside][0]),
                f"between {axis[0]:g} and {axis[-1]:g}",
                code="out_of_range",
            )
        cell = np.clip(np.searchsorted(axis, values, side="right") - 1, 0, max(axis.size - 2, 0))
        start, weight = _weights(coordinates(name, axis), coordinates(name, values), cell)
        starts.append(start)
        weights.append(weight)
        cells.append(cell)
        on_row &= (weight == 1).any(axis=1)
    phases = np.zeros((len(points), made.amplitudes.size))
    for corner in product(*(range(weight.shape[1]) for weight in weights)):
        share = np.ones(len(points))
        for offset, weight in zip(corner, weights, strict=True):
            share *= weight[:, offset]
        place = tuple(start + offset for start, offset in zip(starts, corner, strict=True))
        # A point that lies on a row has no use for its neighbours, which may have no design.
        phases += np.where(share[:, None] == 0, 0.0, share[:, None] * made.phases[place])
    phases[made.closed[tuple(cells)] & ~on_row] = np.nan
    frequencies, _ = mode_of(made.plant, list(made.names), points)
    return phases / frequencies[:, None]


def _weights(nodes: FloatArray, at: FloatArray, cell: IndexArray) -> tuple[IndexArray, FloatArray]:
    """Return where each point's stencil starts, shape (m,), and Lagrange's weights, (m, points)."""
    start, size = first_of_stencil(cell, nodes.size)
    stencil = nodes[start[:, None] + np.arange(size)]
    weights = np.ones((at.size, size))
    for mine, other in product(range(size), repeat=2):
        if mine != other:
            weights[:, mine] *= (at - stencil[:, other]) / (stencil[:, mine] - stencil[:, other])
    return start, weights


def _residuals(made: Interpolant, points: FloatArray, times: FloatArray) -> FloatArray:
    frequencies, dampings = mode_of(made.plant, list(made.names), points)
    poles = frequencies * (-dampings + 1j * np.sqrt(1 - dampings**2))
    drive = [index for index, name in enumerate(made.names) if name.startswith("actuator.")]
    _, first, of = np.unique(points[:, drive], axis=0, return_index=True, return_inverse=True)
    residuals = np.full(len(points), np.nan)
    known = ~np.isnan(times).any(axis=1)
    for number, point in enumerate(points[first].tolist()):
        actuator = actuator_at(made, point)
        here = np.flatnonzero((of.ravel() == number) & known)
        residuals[here] = residuals_of_many(times[here], made.amplitudes, poles[here], actuator)
    return residuals


def actuator_at(made: Interpolant, point: list[float]) -> Actuator:
    """Return the actuator at a point.

    Parameters
    ----------
    made
        What is interpolated.
    point
        Values of its fields, in their order.

    Returns
    -------
    Actuator
        With the values of its fields.
    """
    actuator = made.actuator
    for name, value in zip(made.names, point, strict=True):
        if name.startswith("actuator."):
            actuator = vary(actuator, name.split(".")[1:], value)
    return actuator


def _worst_all_over(made: Interpolant, which: BoolArray) -> FloatArray:
    """Return the worst residual tried all over some cells.

    Shape of `Interpolant.closed`; not a number in others.
    """
    worst = np.full(which.shape, np.nan)
    for cell in np.argwhere(which).tolist():
        starts, ends = np.array([
            coordinates(name, axis[[number, min(number + 1, axis.size - 1)]])
            for name, axis, number in zip(made.names, made.axes, cell, strict=True)
        ]).T
        largest, at = _largest_within(made, starts, ends)
        width = (ends - starts) / PARTS
        low, high = np.minimum(starts, ends), np.maximum(starts, ends)
        # Once more, finely, around where it is.
        around = (np.clip(at + side * width, low, high) for side in (-1, 1))
        worst[tuple(cell)] = np.fmax(largest, _largest_within(made, *around)[0])
    return worst


def _largest_within(
    made: Interpolant, starts: FloatArray, ends: FloatArray
) -> tuple[float, FloatArray]:
    """Return the largest residual at the points of a box, in coordinates, and where it is."""
    shares = np.linspace(0, 1, PARTS + 1)
    sides = starts[:, None] + (ends - starts)[:, None] * shares
    at = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, len(starts))
    points = np.column_stack([
        np.clip(values_at(name, column), axis[0], axis[-1])
        for name, axis, column in zip(made.names, made.axes, at.T, strict=True)
    ])
    residuals = made.residuals(points)
    largest = int(np.argmax(np.nan_to_num(residuals, nan=-1.0)))
    return float(residuals[largest]), at[largest]


def _worst_of_cells(made: Interpolant) -> FloatArray:
    """Return the worst residual tried in each cell, shape of `Interpolant.closed`.

    To first order the error at a point is a sum of one vector an axis, each growing from a row to
    the middle of the cell and back; its magnitude is convex in those, so the worst is where each
    axis is either on a row or in a middle. All such points are tried. Not a number in cells that
    have no times.
    """
    axes = []
    for name, axis in zip(made.names, made.axes, strict=True):
        x = coordinates(name, axis)
        # In the coordinate, not in the field: there the error is even about the middle.
        middles = values_at(name, (x[1:] + x[:-1]) / 2)
        axes.append(np.sort(np.concatenate((axis, middles))))
    inner = math.prod(axis.size for axis in axes[1:])
    parts = min(axes[0].size, -(-axes[0].size * inner // POINTS_AT_ONCE))
    slabs = []
    for part in np.array_split(axes[0], parts):
        slab = np.stack(np.meshgrid(part, *axes[1:], indexing="ij"), axis=-1)
        slabs.append(made.residuals(slab.reshape(-1, len(axes))))
    worst = np.concatenate(slabs).reshape([axis.size for axis in axes])
    for number, axis in enumerate(made.axes):
        if axis.size > 1:
            turned = np.moveaxis(worst, number, 0)
            inside = np.fmax(np.fmax(turned[:-1:2], turned[1::2]), turned[2::2])
            worst = np.moveaxis(inside, 0, number)
    return worst
