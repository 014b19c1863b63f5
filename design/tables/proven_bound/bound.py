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
from dataclasses import dataclass, replace

import numpy as np

from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import SAME_TIME, Impulses
from design.model.plants.pendulum import Pendulum
from design.model.plants.spring_mass import SpringMass
from design.tables.coordinates import coordinate_of, coordinates
from design.tables.interpolation import OneMode
from design.tables.proven_bound.balls import Ball, Number
from design.tables.proven_bound.cells import Cells
from design.tables.proven_bound.chebyshev import between_zeros, truncation, zeros
from design.tables.proven_bound.ramps import Answers, Course, course, courses, ramps_by
from design.tables.proven_bound.stencils import GridAxis, cells_of, in_bernstein
from design.tables.proven_bound.vectors import Coordinates, lags_of, plant_of, steps_of, vector_of
from design.types import BoolArray, FloatArray, IntArray

REACHES = tuple(float(reach) for reach in np.geomspace(1.5, 1500.0, 16))
"""Disks that are tried, over half a cell: the best one is taken, cell by cell [-]."""

AT_REST = 1e-12
"""Share of all steps within which a level is 0, as of `design.model.ramps` [-]."""

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

MOST_HALVINGS = {1: 9, 2: 7}
"""Of a cell along each axis, by how many there are: so far a cell is halved at a kink, where two
courses are possible and one of them reaches beyond where it is true."""

FAR_REACHED = 1.2
"""Largest residual known over that of a course in a part, from which on it is not halved: it may be
a course beyond where it is true, but what it says there is no bound of all [-]."""

TOO_LOOSE = 2.0
"""That share from which on a cell of several courses is not called proven: a bound so far above
what happens says less than a sample [-]."""

MOST_PARTS = 6_000
"""Parts of cells that are looked at, courses apart: beyond, no cell is halved."""

ROUNDING = 1e-11
"""Of a residual: what rounding adds is small up to this, however small the residual is [-]."""

MOST_VALUES = 1_000_000
"""Values that are added for one degree in one turn, at most."""

FIRST_VALUES = 3
"""Along each axis of a cell: their residual says how much a polynomial may lack."""

DISKS_AT_ONCE = 8_000
"""Disks that are looked at together."""

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
    found
        Largest residual found there [-].
    unproven
        Cells without a proof, shape of the cells.
    """

    largest: float
    found: float
    unproven: BoolArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Command:
    """What is the same in all cells."""

    fields: tuple[str, ...]
    plant: OneMode
    actuator: Actuator
    amplitudes: FloatArray
    answers: Answers = ()  # Which ramps are turned; without limits there is nothing to ask

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
        coordinate = self.coordinates(at, on_balls=isinstance(phases[0], Ball))
        frequency, pole = plant_of(coordinate, self.plant_fields)
        if isinstance(self.actuator, RateLimited):
            ramps = ramps_by(self.answers, self.course(phases, frequency, coordinate))
            lags = lags_of(self.actuator.then, "actuator.then", frequency, coordinate)
        else:
            each = np.arange(self.amplitudes.size, dtype=np.float64)
            accelerates = Impulses(times_s=each, amplitudes=self.amplitudes).accelerates
            ramps = steps_of(phases, self.amplitudes, accelerates)
            lags = lags_of(self.actuator, "actuator", frequency, coordinate)
        return vector_of(ramps, pole, lags, switched=self.actuator.model == "switched")

    def coordinates(self, at: Sequence[Number], *, on_balls: bool) -> Coordinates:
        """Return the coordinate of every field, from those of the axes."""

        def coordinate(field: str) -> Number:
            if field in self.fields:
                return at[self.fields.index(field)]
            value = self.given(field)
            exact = not on_balls or coordinate_of(field) == "itself"
            return value if exact else Ball.near(np.array(value))

        return coordinate

    def course(
        self, phases: Sequence[Number], frequency: Number, coordinate: Coordinates
    ) -> Course:
        """Return the course of the reference behind limits."""
        levels = np.cumsum(self.amplitudes)
        levels[np.abs(levels) <= AT_REST * np.abs(self.amplitudes).sum()] = 0.0
        speed = frequency * coordinate("actuator.speed_m_s")
        rise, fall = (
            speed * coordinate(f"actuator.{one}_limit_m_s2") for one in ("accel", "decel")
        )
        return course(phases, levels.tolist(), rise, fall)

    def courses(self, cells: Cells) -> tuple[list[tuple[Answers, IntArray]], IntArray]:
        """Return what ramps may be turned in which cells, and in which others may be too."""
        if not isinstance(self.actuator, RateLimited):
            return [((), np.arange(len(cells.number)))], np.array([], dtype=np.intp)

        def following(places: IntArray) -> Course:
            some = cells.take(places)
            ones = np.ones_like(some.halves)
            coordinate = self.coordinates(some.coordinates(ones), on_balls=True)
            frequency, _ = plant_of(coordinate, self.plant_fields)
            return self.course(some.balls(ones), frequency, coordinate)

        return courses(len(cells.number), following)

    def on(self, cells: Cells, reach: FloatArray) -> Ball:
        """Return the vector on disks about the cells."""
        # What overflows is without bound.
        with np.errstate(over="ignore", invalid="ignore"):
            found: Ball = self.vector(cells.balls(reach), cells.coordinates(reach))
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
class _Known:
    """What is known of parts of cells that have one course, shape (m,)."""

    command: _Command
    cells: Cells
    tails: FloatArray  # What polynomials lack, of `DEGREES`, shape (m, degrees)
    errors: FloatArray  # What rounding adds, in double precision; infinite without a proof

    def where(self, which: BoolArray) -> "_Known":
        """Return what is known of some of the parts."""
        return _Known(
            command=self.command,
            cells=self.cells.take(np.flatnonzero(which)),
            tails=self.tails[which],
            errors=self.errors[which],
        )


def residual_bound(
    axes: Sequence[GridAxis],
    times_s: FloatArray,
    usable: BoolArray,
    plant: OneMode,
    actuator: Actuator,
    amplitudes: FloatArray,
    found: float = 0.0,
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
        What the axes are varied in; limits to the rate without one to the jerk.
    amplitudes
        Of all rows, shape (n,) [-].
    found
        Largest residual that is known of [-]. It says where a finer look is worth while, and
        nothing that is proven rests on it.

    Returns
    -------
    ResidualBound
        For every point of the cells that are proven.
    """
    command = _Command(
        fields=tuple(axis.field for axis in axes),
        plant=plant,
        actuator=actuator,
        amplitudes=amplitudes,
    )
    cells = cells_of(axes, times_s, command.scale(axes), usable)
    unproven = np.zeros(usable.shape, dtype=np.bool_)
    proven, open_cells = _prove(command, cells, found)
    unproven.ravel()[open_cells] = True
    # A part says nothing of a cell that has another without a proof.
    proven = [one.where(~unproven.ravel()[one.cells.number]) for one in proven]
    proven = [one for one in proven if one.cells.number.size]
    found = max(
        (float(one.command.largest_at(one.cells, FIRST_VALUES).max()) for one in proven),
        default=0.0,
    )
    largest = 0.0
    for one in proven:
        found, bounds = _largest(one, found)
        largest = max(largest, float((bounds + one.errors).max()))
    return ResidualBound(largest=largest, found=found, unproven=unproven)


def _prove(command: _Command, cells: Cells, found: float) -> tuple[list[_Known], IntArray]:
    """Return parts of cells that are proven, and the numbers of cells that have others."""
    done: list[_Known] = []
    most = MOST_HALVINGS[len(command.fields)]
    parts = -len(cells.number)
    for halving in range(most + 1):
        followed, others = command.courses(cells)
        if not followed:
            break
        parts += sum(places.size for _, places in followed)
        last = halving == most or parts > MOST_PARTS
        each = [
            _known_of(replace(command, answers=answers), cells.take(places))
            for answers, places in followed
        ]
        first = [one.command.largest_at(one.cells, FIRST_VALUES) for one in each]
        # A course that reaches too far may have any residual: what is known goes before.
        largest = found or max(float(one.max()) for one in first)
        counted = [places for _, places in followed]
        several = np.bincount(np.concatenate(counted), minlength=len(cells.number)) > 1
        known = np.ones(len(cells.number), dtype=np.bool_)
        known[others] = False
        for (_, places), one, residuals in zip(followed, each, first, strict=True):
            share = largest * (1 if last else NEGLIGIBLE)
            enough = (one.tails[:, -1] <= share + ROUNDING) & (one.errors <= share + ROUNDING)
            small = FAR_REACHED * residuals <= found
            loose = (found > 0) & (residuals > TOO_LOOSE * found)
            known[places] &= enough & (~several[places] | small | (last & ~loose))
        done += [one.where(known[places]) for (_, places), one in zip(followed, each, strict=True)]
        cells = cells.take(np.flatnonzero(~known))
        if last or not len(cells.number):
            break
        cells = cells.halved()
    return done, np.unique(cells.number)


def _known_of(command: _Command, cells: Cells) -> _Known:
    """Return what is known of cells of one course."""
    ones = np.ones_like(cells.halves)
    errors = np.where(_ordered(cells), command.on(cells, ones).error, np.inf)
    count, axes = cells.halves.shape
    tails = np.full((count, len(DEGREES)), np.inf)
    furthest = command.furthest(cells)
    # Of few cells many disks at once: each operation takes a while of its own.
    at_once = max(DISKS_AT_ONCE // max(count, 1), 1)
    for start in range(0, len(REACHES), at_once):
        reaches = np.array(REACHES[start : start + at_once])
        disks = np.minimum(reaches[:, None, None], furthest).reshape(-1, axes)
        several = cells.take(np.tile(np.arange(count), reaches.size))
        largest = command.on(several, disks).size
        for place, degree in enumerate(DEGREES):
            lacking = truncation(largest, disks, degree).reshape(reaches.size, count)
            tails[:, place] = np.minimum(tails[:, place], lacking.min(axis=0))
    return _Known(command=command, cells=cells, tails=tails, errors=errors)


def _ordered(cells: Cells) -> BoolArray:
    """Return in which cells the steps stay in order and apart, at all points, shape (m,)."""
    one_way = in_bernstein(cells.phases[:, 1:] - cells.phases[:, :-1])
    gaps = in_bernstein(np.swapaxes(one_way, 2, 3)).min(axis=(2, 3))
    least = 10 * SAME_TIME * np.abs(cells.phases).sum(axis=(2, 3)).max(axis=1)
    ordered: BoolArray = np.all(
        gaps > cells.off[:, 1:] + cells.off[:, :-1] + least[:, None], axis=1
    )
    return ordered


def _largest(known: _Known, found: float) -> tuple[float, FloatArray]:
    """Return the largest residual found, and what it is at most in each part, shape (m,) [-]."""
    command, cells = known.command, known.cells
    enough = known.tails <= NEGLIGIBLE * found + known.errors[:, None]
    # The first degree that lacks little; where there is none, the one that lacks least.
    degree = np.where(enough.any(axis=1), enough.argmax(axis=1), known.tails.argmin(axis=1))
    tail = np.take_along_axis(known.tails, degree[:, None], axis=1)[:, 0]
    bounds = np.full(degree.size, np.inf)
    for per_degree in ZEROS_PER_DEGREE:
        loose = bounds > TIGHT * found
        for place in np.unique(degree[loose]).tolist():
            those = np.flatnonzero(loose & (degree == place))
            count = per_degree * DEGREES[place]
            if per_degree > ZEROS_PER_DEGREE[0]:
                # Of very many only those with the largest bounds: the others keep theirs.
                most = MOST_VALUES // count ** len(command.fields)
                those = those[np.argsort(-bounds[those])[:most]]
            largest = command.largest_at(cells.take(those), count)
            found = max(found, float(largest.max()))
            factor = between_zeros(DEGREES[place], count, len(command.fields))
            at_zeros = largest + known.errors[those] + tail[those]
            bounds[those] = np.minimum(bounds[those], factor * at_zeros + tail[those])
    return found, bounds
