"""How the switches of the fastest course may lie, by a linear program over a time grid."""

from dataclasses import dataclass

import numpy as np

from design.solvers import highs
from design.solvers.ramps.course import Slopes
from design.solvers.ramps.functionals import Functionals
from design.types import ComplexArray, FloatArray

CELLS_PER_TURN = 24
"""Cells of the linear program, to a period of the fastest mode [-]."""

MIN_CELLS = 60
"""Cells of the first linear program, at least [-]."""

PRESENT = 0.05
"""Share of its limit below which a slope of the linear program may be of its grid alone [-]."""

POSSIBLE = 1e-9
"""Violation that counts as none, over the unshaped step [-]."""

PROGRAM_WORK, CELL_WORK, PAIR_WORK = 1500.0, 25.0, 0.033
"""Work of a linear program, of each of its cells, and of each pair of them [units]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GridCourse:
    """The course on a grid that misses the targets least.

    Attributes
    ----------
    violation
        By how much: 0 where the duration is long enough [-].
    levels
        The reference at the points of the grid, from 0, shape (k + 1,) [-].
    cell
        Distance of two points [rad].
    """

    violation: float
    levels: FloatArray
    cell: float

    @property
    def is_possible(self) -> bool:
        """Whether the targets are met."""
        return self.violation < POSSIBLE


def count_cells(
    functionals: Functionals,
    duration: float,
    fineness: float,
    *,
    per_turn: int = CELLS_PER_TURN,
    fewest: int = MIN_CELLS,
) -> int:
    """Return the number of cells of a grid.

    Parameters
    ----------
    functionals
        What counts, of one plant.
    duration
        Length of the grid [rad].
    fineness
        How many times finer than the first grid it is [-].
    per_turn, fewest
        Cells of the first grid, to a period of the fastest mode and at least [-].

    Returns
    -------
    int
        By the fastest mode and the length.
    """
    turns = duration * float(np.abs(functionals.poles).max()) / (2 * np.pi)
    return int(fineness * max(fewest, per_turn * turns))


def work_of(functionals: Functionals, duration: float, fineness: float) -> float:
    """Return the work of a linear program [units].

    Parameters
    ----------
    functionals
        What counts, of one plant.
    duration
        Length of the grid [rad].
    fineness
        How many times finer than the first grid it is [-].

    Returns
    -------
    float
        Work by the number of cells: the simplex method takes as many iterations [units].
    """
    cells = count_cells(functionals, duration, fineness)
    return PROGRAM_WORK + CELL_WORK * cells + PAIR_WORK * cells**2


def nearest_course(
    functionals: Functionals,
    targets: ComplexArray,
    slopes: Slopes,
    last: float,
    duration: float,
    fineness: float,
) -> GridCourse | None:
    """Return the course of a duration that misses the targets least.

    Parameters
    ----------
    functionals, targets
        What is to be met, shape (m,).
    slopes
        Limits of the slope.
    last
        Level at the end [-].
    duration
        Length of the grid [rad].
    fineness
        How many times finer than the first grid it is [-].

    Returns
    -------
    GridCourse or None
        None where no course reaches the last level in time.
    """
    cells = count_cells(functionals, duration, fineness)
    times = np.linspace(0, duration, cells + 1)
    cell = duration / cells
    # F is a sum over slopes; in the levels it is by how much the weights of two cells differ.
    weights = np.diff(functionals.integrals(times), axis=1) / cell
    weights = weights * functionals.scales(duration)[:, None]
    of_levels = weights - np.append(weights[:, 1:], np.zeros((weights.shape[0], 1)), axis=1)
    right = targets * functionals.scales(duration)
    swinging = functionals.real == 0
    found = highs.least_violation_of_course(
        np.vstack((of_levels.real, of_levels[swinging].imag)),
        np.concatenate((right.real, right[swinging].imag)),
        rise=slopes.up * cell,
        fall=slopes.down * cell,
        last=last,
    )
    if found is None:
        return None
    return GridCourse(violation=found.violation, levels=np.append(0.0, found.unknowns), cell=cell)


def switches_of(course: GridCourse, slopes: Slopes) -> FloatArray:
    """Return the switches of a command that a course on a grid follows.

    A cell in which the slope is between two of its values is where they change.

    Parameters
    ----------
    course
        The course.
    slopes
        Limits of the slope.

    Returns
    -------
    FloatArray
        Ascending from 0, shape (n,) [rad].
    """
    # A ramp shorter than a cell is a jump of the whole level.
    up, down = min(slopes.up * course.cell, 1.0), min(slopes.down * course.cell, 1.0)
    changes = np.diff(course.levels)
    shares = np.where(changes > 0, changes / up, changes / down)
    switches: list[float] = []
    rising = False
    for number, share in enumerate(shares.tolist()):
        if share < PRESENT if not rising else share > -PRESENT:
            continue
        before = float(shares[number - 1]) if number else 0.0
        full = abs(share) > 1 - PRESENT
        if full:
            begins = 0.0
        elif before * share < -(1 - PRESENT) * abs(share):  # turned within the cell
            change = float(changes[number])
            begins = ((up - change) if not rising else (change + down)) / (up + down)
        else:
            begins = 1 - abs(share)
        switches.append(course.cell * (number + begins))
        rising = not rising
    found = np.array(switches)
    since_first: FloatArray = found - found[:1]
    return since_first
