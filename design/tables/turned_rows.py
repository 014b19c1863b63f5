"""Where the ramps of a table's rows begin to turn: there the times have kinks.

Behind limits a ramp that is over before the next step has no say in what comes after; one that is
turned has. The times of the fastest shaper are smooth within either, and bend where rows go over
from one to the other. What is interpolated across such a bend may be worst anywhere in its cell.
"""

from collections.abc import Sequence

import numpy as np

from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.reference_ramps import reference
from design.tables.stencil import first_of_stencil
from design.types import BoolArray, FloatArray

FAR_RAD = 0.25
"""Difference of two rows' phases from which on they may be of two branches: then the error may be
small in the middle of a cell and large beside it [rad]."""

ROUNDING = 1e-9
"""Distance of the reference from the command that is rounding [-]."""


def turned_ramps(
    times_s: FloatArray, amplitudes: FloatArray, actuators: Sequence[Actuator]
) -> BoolArray:
    """Return which steps of each row turn a ramp that is not over.

    Parameters
    ----------
    times_s
        Times of the steps of each row, shape (m, n) [s]; not a number of rows without a design.
    amplitudes
        Their heights, the same in all rows, shape (n,) [-].
    actuators
        That of each row, m of them.

    Returns
    -------
    BoolArray
        Shape (m, n); none without limits.
    """
    turned = np.zeros(times_s.shape, dtype=np.bool_)
    levels = np.cumsum(amplitudes)
    for row, actuator in enumerate(actuators):
        if not isinstance(actuator, RateLimited) or np.isnan(times_s[row]).any():
            continue
        changes = reference(Impulses(times_s=times_s[row], amplitudes=amplitudes), actuator)
        reached = np.concatenate(([0.0], np.cumsum(changes.changes)))
        before = reached[np.searchsorted(changes.times_s, times_s[row, 1:], side="left")]
        turned[row, 1:] = np.abs(before - levels[:-1]) > ROUNDING
    return turned


def cells_across_kinks(turned: BoolArray) -> BoolArray:
    """Return the cells that are interpolated from rows that turn other ramps.

    Parameters
    ----------
    turned
        Which steps turn a ramp, at the points of a grid, shape (..., n).

    Returns
    -------
    BoolArray
        One less along each axis than it has points, at least one.
    """
    share = turned.astype(np.float64)
    across: BoolArray = np.any(
        _of_stencils(share, np.fmin) != _of_stencils(share, np.fmax), axis=-1
    )
    return across


def cells_of_far_rows(phases: FloatArray) -> BoolArray:
    """Return the cells that are interpolated from rows far from each other.

    Parameters
    ----------
    phases
        Phases of the steps at the points of a grid, shape (..., n) [rad].

    Returns
    -------
    BoolArray
        One less along each axis than it has points, at least one.
    """
    apart = _of_stencils(phases, np.fmax) - _of_stencils(phases, np.fmin)
    far: BoolArray = np.any(apart > FAR_RAD, axis=-1)
    return far


def _of_stencils(rows: FloatArray, joined: np.ufunc) -> FloatArray:
    """Return what all points that a cell is interpolated from come to, shape (..., n)."""
    found = rows
    for axis, points in enumerate(rows.shape[:-1]):
        first, size = first_of_stencil(np.arange(max(points - 1, 1)), points)
        stencils = np.take(found, first[:, None] + np.arange(size), axis=axis)
        found = joined.reduce(stencils, axis=axis + 1)
    return found
