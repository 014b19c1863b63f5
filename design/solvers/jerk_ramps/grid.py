"""How the fastest course of limited jerk may switch, by a linear program over a time grid."""

from dataclasses import dataclass

import numpy as np

from design.solvers import highs
from design.solvers.jerk_ramps.events import Limits, second_integrals
from design.solvers.ramps.functionals import Functionals
from design.solvers.ramps.structure import POSSIBLE, count_cells
from design.types import ComplexArray, FloatArray

CELLS_PER_TURN = 40
"""Cells of the linear program, to a period of the fastest mode [-]."""

MIN_CELLS = 80
"""Cells of the first linear program, at least [-]."""

PRESENT = 0.05
"""Share of its limit below which a jerk of the linear program may be of its grid alone [-]."""

AT_LEVEL = 1e-7
"""Distance from 0 or 1 within which the course of a linear program is there [-]."""

PROGRAM_WORK, CELL_WORK, PAIR_WORK = 5000.0, 100.0, 0.25
"""Work of a linear program, of each of its cells, and of each pair of these [units]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GridCourse:
    """The course on a grid that misses the targets least.

    Attributes
    ----------
    violation
        By how much: 0 where the duration is long enough [-].
    slopes
        Of the reference at the points of the grid, shape (k + 1,) [1/rad].
    cell
        Distance of two points [rad].
    """

    violation: float
    slopes: FloatArray
    cell: float

    @property
    def is_possible(self) -> bool:
        """Whether the targets are met."""
        return self.violation < POSSIBLE


def _count_cells(functionals: Functionals, duration: float, fineness: float) -> int:
    return count_cells(functionals, duration, fineness, per_turn=CELLS_PER_TURN, fewest=MIN_CELLS)


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
        Work by the number of cells [units].
    """
    cells = _count_cells(functionals, duration, fineness)
    return PROGRAM_WORK + CELL_WORK * cells + PAIR_WORK * cells**2


def nearest_course(
    functionals: Functionals,
    targets: ComplexArray,
    limits: Limits,
    last: float,
    duration: float,
    fineness: float,
) -> GridCourse | None:
    """Return the course of a duration that misses the targets least.

    Parameters
    ----------
    functionals, targets
        What is to be met, shape (m,).
    limits
        Of slope and jerk.
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
    cells = _count_cells(functionals, duration, fineness)
    times = np.linspace(0, duration, cells + 1)
    cell = duration / cells
    scales = functionals.scales(duration)
    # F is a sum over jumps of the jerk; in the slopes it is by second differences.
    weights = np.diff(second_integrals(functionals, times), n=2, axis=1) / cell * scales[:, None]
    right = targets * scales
    swinging = functionals.real == 0
    found = highs.least_violation_of_slopes(
        np.vstack((weights.real, weights[swinging].imag)),
        np.concatenate((right.real, right[swinging].imag)),
        cell=cell,
        slopes=(limits.up, limits.down),
        jerk=limits.jerk,
        last=last,
    )
    if found is None:
        return None
    slopes = np.concatenate(([0.0], found.unknowns, [0.0]))
    return GridCourse(violation=found.violation, slopes=slopes, cell=cell)


def switches_of(course: GridCourse, limits: Limits) -> FloatArray:
    """Return the switches of a command that a course on a grid follows.

    Parameters
    ----------
    course
        The course.
    limits
        Of slope and jerk.

    Returns
    -------
    FloatArray
        Ascending from 0, shape (n,) [rad].
    """
    slopes, cell = course.slopes, course.cell
    levels = np.concatenate(([0.0], np.cumsum((slopes[1:] + slopes[:-1]) / 2 * cell)))
    shares = np.diff(slopes) / (limits.jerk * cell)
    commands = _commands(slopes, shares, levels, limits)
    switches: list[float] = []
    on = False
    for number, wanted in enumerate(commands):
        if wanted == on:
            continue
        # Of a cell in between the new jerk takes the share that it has of the change.
        before = shares[number - 1] if number else 0.0
        after = shares[number]
        full = 1.0 if wanted else -1.0
        begun = 0.0 if number == 0 or before * full <= -(1 - PRESENT) else before * full
        late = 1 - min(abs(after), 1.0) if after * full > 0 else 0.0
        switches.append(cell * (number + late - max(begun, 0.0)))
        on = wanted
    found = np.array(switches)
    since_first: FloatArray = np.maximum.accumulate(found - found[:1])
    return since_first


def _commands(
    slopes: FloatArray, shares: FloatArray, levels: FloatArray, limits: Limits
) -> list[bool]:
    """Return whether the command is on in each cell."""
    commands: list[bool] = []
    on = False
    for number, share in enumerate(shares.tolist()):
        before, after = float(slopes[number]), float(slopes[number + 1])
        low, high = sorted((levels[number], levels[number + 1]))
        if before == after == 0:
            on = bool(low > 1 / 2)
        elif min(before, after) >= (1 - PRESENT / 10) * limits.up:
            on = True
        elif max(before, after) <= -(1 - PRESENT / 10) * limits.down:
            on = False
        elif share > PRESENT:
            on = True
        elif share < -PRESENT:
            on = False
        commands.append(on)
        if high > 1 - AT_LEVEL and after <= AT_LEVEL:
            _brake(commands, slopes, on=True)
            on = True
        elif low < AT_LEVEL and after >= -AT_LEVEL and number:
            _brake(commands, slopes, on=False)
            on = False
    return commands


def _brake(commands: list[bool], slopes: FloatArray, *, on: bool) -> None:
    """Let the command be that of the level at which a course arrives, since it began to brake."""
    number = len(commands) - 1
    while number >= 0 and commands[number] != on:
        moving = slopes[number] if on else -slopes[number]
        if moving <= 0:
            break
        commands[number] = on
        number -= 1
