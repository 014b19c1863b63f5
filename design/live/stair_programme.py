"""The staircase of a time whose deflection has the least peak: a linear programme."""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from design.live.staircase import Staircase, response_of
from design.types import FloatArray, IntArray

CELLS = 40
"""Steps of a staircase less one: the time is 1 % above that of a command that rises evenly."""

NO_STEP = 1e-7
"""Height below which a step is none: the tolerance of the programme [-]."""


class Stairs(NamedTuple):
    """A staircase.

    Attributes
    ----------
    time_s
        From its first step to its last [s].
    levels
        Of its cells, shape (CELLS,) [-].
    peak
        Largest deflection at the moments looked at, over an unshaped step's [-].
    sets
        The sets that were assumed, one a step, shape (CELLS + 1,).
    limit
        The limit that it was searched for [-].
    """

    time_s: float
    levels: FloatArray
    peak: float
    sets: IntArray
    limit: float


def least_peak(
    stairs: Staircase, target: float, time_s: float, given_sets: IntArray | None
) -> Stairs | None:
    """Return the staircase of a time with the least peak.

    Parameters
    ----------
    stairs
        The axis.
    target
        The level to end at, not negative [-].
    time_s
        From the first step to the last [s].
    given_sets
        Sets that the steps are held to by their signs; if None, as if both sets were the first.

    Returns
    -------
    Stairs or None
        None where none of that time ends at rest.
    """
    sets = np.zeros(CELLS + 1, dtype=np.int64) if given_sets is None else given_sets
    cell_s = time_s / CELLS
    response, level = response_of(stairs, cell_s, sets), stairs.axis.level
    steps = steps_of_levels()
    given = np.zeros(CELLS + 1)
    given[0], given[-1] = -level, target
    ends = response.vibration_by_steps
    start = response.vibration + ends @ given
    rows = ends @ steps
    moving = response.by_steps / stairs.units[:, None]
    offset = (response.deflection / stairs.units + moving @ given).ravel()
    by_levels = (moving @ steps).reshape(offset.size, CELLS)
    ones = np.ones((offset.size, 1))
    above = [np.hstack((by_levels, -ones)), np.hstack((-by_levels, -ones))]
    limits = [-offset, offset]
    if given_sets is not None:
        signs = np.where(sets == 0, -1.0, 1.0)
        above.append(np.hstack((signs[:, None] * steps, np.zeros((CELLS + 1, 1)))))
        limits.append(-signs * given)
    equal = np.hstack((np.concatenate((rows.real, rows.imag)), np.zeros((2 * len(rows), 1))))
    weights = np.append(np.zeros(CELLS), 1.0)
    highest = max(1.0, level, target)
    found = linprog(
        weights,
        A_ub=np.concatenate(above),
        b_ub=np.concatenate(limits),
        A_eq=equal,
        b_eq=-np.concatenate((start.real, start.imag)),
        bounds=[(0.0, highest)] * CELLS + [(0.0, None)],
        method="highs",
    )
    if found.x is None:
        return None
    return Stairs(time_s, found.x[:-1], float(found.x[-1]), sets, math.inf)


def steps_of_levels() -> FloatArray:
    """Return the matrix from levels to steps, shape (CELLS + 1, CELLS)."""
    return np.eye(CELLS + 1, CELLS) - np.eye(CELLS + 1, CELLS, -1)


def sets_of(stairs: Staircase, levels: FloatArray, target: float) -> IntArray:
    """Return the set that follows each step.

    Parameters
    ----------
    stairs
        The axis.
    levels
        Of the cells, shape (CELLS,) [-].
    target
        The level that the last step goes to [-].

    Returns
    -------
    IntArray
        One a step; a step of no height keeps the set in force, shape (CELLS + 1,).
    """
    steps = np.diff(np.concatenate(([stairs.axis.level], levels, [target])))
    sets = np.empty(steps.size, dtype=np.int64)
    force = stairs.axis.force
    for number, step in enumerate(steps.tolist()):
        if abs(step) > NO_STEP:
            force = 0 if step > 0 else 1
        sets[number] = force
    return sets
