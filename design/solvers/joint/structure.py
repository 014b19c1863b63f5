"""How the impulses of the fastest command may lie, by a linear program over a time grid."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from design.solvers import highs
from design.solvers.joint.dual_function import PERIOD_RAD, ZERO, DualFunction
from design.types import ComplexArray, FloatArray

CELLS_PER_TURN = 20
"""Cells of the linear program, to a period of the fastest mode [-]."""

MIN_CELLS = 60
"""Cells of the first linear program, at least [-]."""

PROGRAM_WORK = 2500.0
CELL_WORK = 1.6
"""Work of a linear program, and of each of its cells and equations: with what follows from it
[units]."""

PRESENT = 0.01
"""Share of the largest below which a step of the linear program may be one of its grid alone [-].

Where modes are odd multiples of another, fewer impulses than equations do: the grid adds some.
"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GridObstacle:
    """What a linear program finds against a duration: c, and its own command.

    Attributes
    ----------
    vectors
        c, shape (m,) [-].
    grid
        Times of the grid, shape (k + 1,) [rad].
    unknowns
        Amplitudes at them, or the command between two of them, shape (k + 1,) or (k,) [-].
    """

    vectors: ComplexArray
    grid: FloatArray
    unknowns: FloatArray

    @property
    def cell(self) -> float:
        """Distance of two times of the grid [rad]."""
        return float(self.grid[1])


def _cells(dual: DualFunction, duration: float, fineness: float) -> int:
    """Return the number of cells of the grid of a linear program."""
    turns = duration * dual.fastest / PERIOD_RAD
    return int(fineness * max(MIN_CELLS, CELLS_PER_TURN * turns))


def work_of(dual: DualFunction, duration: float, fineness: float) -> float:
    """Return the work of a linear program and of what follows it [units].

    Parameters
    ----------
    dual
        The function P of the plant.
    duration
        The duration [rad].
    fineness
        How many times finer than the first the grid is [-].

    Returns
    -------
    float
        Work by the number of cells and modes [units].
    """
    equations = 2 * dual.poles.size
    return PROGRAM_WORK + CELL_WORK * equations * _cells(dual, duration, fineness)


def obstacle_to(dual: DualFunction, duration: float, fineness: float) -> GridObstacle | None:
    """Return the c that shows best that a duration is too short.

    Equations are scaled so that each is the vibration at the end.

    Parameters
    ----------
    dual
        The function P of the plant.
    duration
        The duration [rad].
    fineness
        How many times finer than the first the grid is [-].

    Returns
    -------
    GridObstacle or None
        None where a command on the grid has no vibration, or HiGHS finds no optimum.
    """
    cells = _cells(dual, duration, fineness)
    grid = np.linspace(0, duration, cells + 1)
    swings = dual.swings(grid)
    scaled = swings * np.exp(dual.poles.real * duration)[:, None]
    if dual.positive:
        matrix, right = scaled, np.zeros(dual.poles.size)
    else:
        matrix, right = np.diff(scaled), scaled[:, -1]
    solved = highs.least_violation(
        np.vstack((matrix.real, matrix.imag)),
        np.concatenate((right.real, right.imag)),
        sum_to_one=dual.positive,
    )
    if solved is None or solved.violation < ZERO:
        return None
    real, imaginary = np.split(solved.multipliers, 2)
    vectors = (real + 1j * imaginary) * np.exp(dual.poles.real * duration)
    if dual.positive:
        vectors = -vectors
    return GridObstacle(
        vectors=vectors / np.linalg.norm(vectors),
        grid=grid,
        unknowns=solved.unknowns,
    )


def structures(dual: DualFunction, obstacle: GridObstacle, duration: float) -> Iterator[FloatArray]:
    """Yield how the impulses may lie, by c and by the linear program.

    Parameters
    ----------
    dual
        The function P of the plant.
    obstacle
        What the linear program found.
    duration
        When the last impulse is, where the structure does not say otherwise [rad].

    Yields
    ------
    FloatArray
        Times of the impulses, ascending from 0, shape (n,) [rad].
    """
    turning = dual.zeros(obstacle.vectors, duration, 1)
    if not dual.positive:
        if turning.size % 2:
            yield np.concatenate(([0.0], turning, [duration]))
        switches = _switches(obstacle)
        if switches.size > 1:
            yield switches
        return
    lowest = turning[dual.pull(obstacle.vectors, turning, 2) > 0]
    support = obstacle.grid[obstacle.unknowns > ZERO]
    distances = np.abs(lowest[:, None] - support).min(axis=1, initial=np.inf)
    yield np.concatenate(([0.0], lowest[distances < 2 * obstacle.cell], [duration]))
    for least in (ZERO, PRESENT * float(obstacle.unknowns.max())):
        present = obstacle.grid[obstacle.unknowns > least]
        groups = np.flatnonzero(np.diff(present) > 1.5 * obstacle.cell) + 1
        centres = np.array([part.mean() for part in np.split(present, groups)])
        inner = (centres > obstacle.cell) & (centres < duration - obstacle.cell)
        yield np.concatenate(([0.0], centres[inner], [duration]))


def _switches(obstacle: GridObstacle) -> FloatArray:
    """Return when the linear program's own command goes up and down, to a cell [rad]."""
    high = np.concatenate(([False], obstacle.unknowns > 1 / 2, [True]))
    times = obstacle.grid[np.flatnonzero(high[1:] != high[:-1])]
    switches: FloatArray = times - times[0]
    return switches
