"""A bound of the residual between the rows of a table, cell by cell, for all points at once.

Over a cell the residual's vector is an analytic function of the coordinates
(`design.tables.proven_bound.vectors`). Balls bound it on disks that are larger than the cell, and
so tell how many values of it suffice (`design.tables.proven_bound.chebyshev`). Cells on which the
disks say too little are halved, and so are those in which the order of the steps is not proven.

The rounding of a program is added: the running analysis of the same balls over the cell, from
phases that are off as `design.tables.proven_bound.stencils` derives it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from design.model.actuators.rate_limited import RateLimited, Unlimited
from design.model.actuators.registry import Actuator
from design.model.impulses import SAME_TIME, Impulses
from design.model.plants.pendulum import Pendulum
from design.model.plants.spring_mass import SpringMass
from design.tables.coordinates import coordinate_of, coordinates
from design.tables.interpolation import OneMode
from design.tables.proven_bound.balls import Ball, Number
from design.tables.proven_bound.cells import Cells
from design.tables.proven_bound.chebyshev import between_zeros, truncation, zeros
from design.tables.proven_bound.stencils import GridAxis, cells_of, in_bernstein
from design.tables.proven_bound.vectors import lags_of, plant_of, vector_of
from design.types import BoolArray, FloatArray, IntArray

REACHES = tuple(float(reach) for reach in np.geomspace(1.5, 1500.0, 16))
"""Disks that are tried, over half a cell: the best one is taken, cell by cell [-]."""

NEAREST_SINGULARITY = 0.8
"""Share of the way to where a coordinate vanishes, and with it the plant or a lag, or where the
plant's damping is 1; no disk reaches further [-]."""

DEGREES = (3, 4, 5, 6, 8, 10, 13, 17, 22)
"""Of polynomials that are tried along each axis."""

NEGLIGIBLE = 0.02
"""Share of the largest residual below which what a polynomial lacks is small enough [-]."""

TIGHT = 1.03
"""Bound over the largest value found from which on no more values are taken [-]."""

ZEROS_PER_DEGREE = (2, 4, 8)
"""Values along an axis, tried in turn: each time of cells that may still have the largest."""

MOST_HALVINGS = 5
"""Of a cell along each axis."""

MOST_PARTS = 50_000
"""Cells and parts of them, together: beyond, no cell is halved."""

FIRST_VALUES = 3
"""Along each axis of a cell: their residual says how much a polynomial may lack."""

VALUES_AT_ONCE = 200_000
"""Values that are found together: their numbers fit into memory."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ResidualBound:
    """What times between the rows leave at most, proven.

    Attributes
    ----------
    largest
        In all cells that are proven, for times of a program that counts in double precision; 0 if
        there is no such cell [-].
    in_single
        The same in single precision; infinite if rows are too close for it [-].
    found
        Largest residual found there [-].
    unproven
        Cells without a proof, shape of the cells.
    """

    largest: float
    in_single: float
    found: float
    unproven: BoolArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Command:
    """What is the same in all cells."""

    fields: tuple[str, ...]
    plant: OneMode
    actuator: Unlimited
    amplitudes: FloatArray

    @property
    def plant_fields(self) -> tuple[str, ...]:
        if isinstance(self.plant, Pendulum):
            return "plant.gravity_m_s2", "plant.cable_length_m"
        if isinstance(self.plant, SpringMass):
            return "plant.stiffness_n_m", "plant.mass_kg"
        return ("plant.natural_frequency_rad_s",)

    def given(self, field: str) -> float:
        """Return the coordinate of a field that no axis varies."""
        part: object = self.plant if field.startswith("plant.") else self.actuator
        for name in field.split(".")[1:]:
            part = getattr(part, name)
        return float(coordinates(field, np.array([part], dtype=np.float64))[0])

    def scale(self, axes: Sequence[GridAxis]) -> float:
        """Return the plant's frequency over the coordinates of axes that scale with it."""
        varied = [axis.field for axis in axes if axis.scales]
        return math.prod(self.given(field) for field in self.plant_fields if field not in varied)

    def vector(self, phases: Sequence[Number], at: Sequence[Number]) -> Number:
        """Return the residual's vector from phases and the coordinates of the axes."""
        on_balls = isinstance(phases[0], Ball)

        def coordinate(field: str) -> Number:
            if field in self.fields:
                return at[self.fields.index(field)]
            value = self.given(field)
            exact = not on_balls or coordinate_of(field) == "itself"
            return value if exact else Ball.near(np.array(value))

        frequency, pole = plant_of(coordinate, self.plant_fields)
        lags = lags_of(self.actuator, frequency, coordinate)
        each = np.arange(self.amplitudes.size, dtype=np.float64)
        accelerates = Impulses(times_s=each, amplitudes=self.amplitudes).accelerates
        switched = self.actuator.model == "switched"
        return vector_of(phases, self.amplitudes, accelerates, pole, lags, switched=switched)

    def on(self, cells: Cells, reach: FloatArray, off: FloatArray) -> Ball:
        """Return the vector on disks about the cells."""
        at = [cells.coordinate(axis, reach) for axis in range(len(self.fields))]
        # What overflows is without bound.
        with np.errstate(over="ignore", invalid="ignore"):
            found: Ball = self.vector(cells.balls(reach, off), at)
        return found

    def largest_at(self, cells: Cells, count: int) -> FloatArray:
        """Return the largest residual at zeros of Chebyshev's polynomial, shape (m,) [-]."""
        nodes = zeros(count)
        at_once = max(VALUES_AT_ONCE // nodes.size ** len(self.fields), 1)
        found = []
        for start in range(0, len(cells.number), at_once):
            part = cells.take(np.arange(start, min(start + at_once, len(cells.number))))
            vectors = self.vector(*part.values(nodes))
            found.append(np.abs(vectors).max(axis=1))
        return np.concatenate(found)

    def furthest(self, cells: Cells) -> FloatArray:
        """Return how far disks may reach, shape (m, axes) [-]."""
        limits = []
        for axis, field in enumerate(self.fields):
            middle = np.abs(cells.middles[:, axis])
            room = 1 - middle if field == "plant.damping_ratio" else middle
            limits.append(NEAREST_SINGULARITY * room / cells.halves[:, axis])
        return np.maximum(np.column_stack(limits), REACHES[0])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Proven:
    """Parts of cells that are proven, and what is known of each, shape (m,)."""

    cells: Cells
    tails: FloatArray  # What polynomials lack, of `DEGREES`, shape (m, degrees)
    errors: FloatArray  # What rounding adds, in double precision
    in_single: FloatArray  # And in single precision


def residual_bound(
    axes: Sequence[GridAxis],
    times_s: FloatArray,
    usable: BoolArray,
    plant: OneMode,
    actuator: Actuator,
    amplitudes: FloatArray,
) -> ResidualBound:
    """Return what times between the rows of a table leave at most.

    Parameters
    ----------
    axes
        One or two, the last running fastest along the rows.
    times_s
        Of the rows, shape (rows, n) [s].
    usable
        Cells that are interpolated, one less along each axis than it has values.
    plant, actuator
        What the axes are varied in.
    amplitudes
        Of all rows, shape (n,) [-].

    Returns
    -------
    ResidualBound
        For every point of the cells that are proven.
    """
    if isinstance(actuator, RateLimited):
        return ResidualBound(largest=0.0, in_single=0.0, found=0.0, unproven=usable)
    command = _Command(
        fields=tuple(axis.field for axis in axes),
        plant=plant,
        actuator=actuator,
        amplitudes=amplitudes,
    )
    cells = cells_of(axes, times_s, command.scale(axes), usable)
    unproven = np.zeros(usable.shape, dtype=np.bool_)
    proven, open_cells = _prove(command, cells)
    unproven.ravel()[open_cells] = True
    # A part says nothing of a cell that has another without a proof.
    proven = _of(proven, ~unproven.ravel()[proven.cells.number])
    if not proven.cells.number.size:
        return ResidualBound(largest=0.0, in_single=0.0, found=0.0, unproven=unproven)
    found, largest = _largest(command, proven)
    return ResidualBound(
        largest=float((largest + proven.errors).max()),
        in_single=float((largest + proven.in_single).max()),
        found=found,
        unproven=unproven,
    )


def _of(proven: _Proven, which: BoolArray) -> _Proven:
    return _Proven(
        cells=proven.cells.take(np.flatnonzero(which)),
        tails=proven.tails[which],
        errors=proven.errors[which],
        in_single=proven.in_single[which],
    )


def _prove(command: _Command, cells: Cells) -> tuple[_Proven, IntArray]:
    """Return parts of cells that are proven, and the numbers of cells that have others."""
    largest = float(command.largest_at(cells, FIRST_VALUES).max())
    done: list[_Proven] = []
    for halving in range(MOST_HALVINGS + 1):
        found = _parts(command, cells)
        last = halving == MOST_HALVINGS or 2 ** len(command.fields) * len(cells.number) > MOST_PARTS
        enough = found.tails[:, -1] <= largest * (1 if last else NEGLIGIBLE) + found.errors
        known = np.isfinite(found.errors) & enough
        done.append(_of(found, known))
        cells = cells.take(np.flatnonzero(~known))
        if last or not len(cells.number):
            break
        cells = cells.halved()
    together = _Proven(
        cells=Cells.joined([one.cells for one in done]),
        tails=np.concatenate([one.tails for one in done]),
        errors=np.concatenate([one.errors for one in done]),
        in_single=np.concatenate([one.in_single for one in done]),
    )
    return together, np.unique(cells.number)


def _parts(command: _Command, cells: Cells) -> _Proven:
    """Return what is known of cells; errors are infinite of those that are not proven."""
    ones = np.ones_like(cells.halves)
    errors, in_single = (
        np.where(_ordered(cells, off), command.on(cells, ones, off).error, np.inf)
        for off in (cells.off, cells.off_in_single)
    )
    tails = np.full((len(cells.number), len(DEGREES)), np.inf)
    furthest = command.furthest(cells)
    for reach in REACHES:
        disks = np.minimum(reach, furthest)
        largest = command.on(cells, disks, cells.off).size
        for place, degree in enumerate(DEGREES):
            tails[:, place] = np.minimum(tails[:, place], truncation(largest, disks, degree))
    return _Proven(cells=cells, tails=tails, errors=errors, in_single=in_single)


def _ordered(cells: Cells, off: FloatArray) -> BoolArray:
    """Return in which cells the steps stay in order and apart, at all points, shape (m,)."""
    one_way = in_bernstein(cells.phases[:, 1:] - cells.phases[:, :-1])
    gaps = in_bernstein(np.swapaxes(one_way, 2, 3)).min(axis=(2, 3))
    least = 10 * SAME_TIME * np.abs(cells.phases).sum(axis=(2, 3)).max(axis=1)
    ordered: BoolArray = np.all(gaps > off[:, 1:] + off[:, :-1] + least[:, None], axis=1)
    return ordered


def _largest(command: _Command, proven: _Proven) -> tuple[float, FloatArray]:
    """Return the largest residual found, and what it is at most in each part, shape (m,) [-]."""
    found = float(command.largest_at(proven.cells, FIRST_VALUES).max())
    enough = proven.tails <= NEGLIGIBLE * found + proven.errors[:, None]
    # The first degree that lacks little; where there is none, the one that lacks least.
    degree = np.where(enough.any(axis=1), enough.argmax(axis=1), proven.tails.argmin(axis=1))
    tail = np.take_along_axis(proven.tails, degree[:, None], axis=1)[:, 0]
    bounds = np.full(degree.size, np.inf)
    for per_degree in ZEROS_PER_DEGREE:
        loose = bounds > TIGHT * found
        for place in np.unique(degree[loose]).tolist():
            those = np.flatnonzero(loose & (degree == place))
            count = per_degree * DEGREES[place]
            largest = command.largest_at(proven.cells.take(those), count)
            found = max(found, float(largest.max()))
            factor = between_zeros(DEGREES[place], count, len(command.fields))
            at_zeros = largest + proven.errors[those] + tail[those]
            bounds[those] = np.minimum(bounds[those], factor * at_zeros + tail[those])
    return found, bounds
