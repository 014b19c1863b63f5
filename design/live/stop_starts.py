"""Where Newton's method on a stop starts: the least way on a grid, a linear programme.

It takes both sets of a drive for one, whose G is given; then it is exact except for the grid.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from design.live.stop_case import Pulse, StopCase
from design.types import ComplexArray, FloatArray

CELLS_OF_PERIOD = 48
"""Cells of the grid in a period of the slowest mode [-]."""

CELLS_OF_QUICKEST = 24
"""Cells in a period of the quickest mode at least [-]."""

MAX_CELLS = 3000
"""Cells at most."""

BOUND_FINENESS = 16
"""Times that the grid of a bound is finer [-]."""

SIDES = 32
"""Sides of the polygon for a circle: it is 0.5 % larger."""

OFF = 1e-7
"""Level of a cell below which it is off: the solver's tolerance [-]."""


class Start(NamedTuple):
    """Pulses, and the least share of an unshaped step's swing that can be left on the grid."""

    pulses: list[Pulse]
    share: float


def starting_pulses(
    case: StopCase, gains: ComplexArray, radii: FloatArray, fineness: int = 1
) -> list[Pulse] | None:
    """Return pulses of the least way on a grid.

    Parameters
    ----------
    case
        State, modes and end.
    gains
        G of the drive at each pole, shape (m,) [-].
    radii
        What may remain of each mode at the end, shape (m,) [-].
    fineness
        Times that the grid has as many cells as usual.

    Returns
    -------
    list of Pulse or None
        None where every command has a larger residual.
    """
    edges, columns, state = _grid(case, gains, fineness)
    ways = np.diff(edges)
    if np.any(radii > 0):
        sides, given = _sides(columns, state)
        limits = np.repeat(radii, SIDES) - given
        found = linprog(ways, A_ub=sides, b_ub=limits, bounds=(0, 1), method="highs")
    else:
        both = np.concatenate((columns.real, columns.imag))
        wanted = -np.concatenate((state.real, state.imag))
        found = linprog(ways, A_eq=both, b_eq=wanted, bounds=(0, 1), method="highs")
    return None if found.x is None else _pulses(edges, found.x)


def least_swing(case: StopCase, gains: ComplexArray) -> Start:
    """Return the command on a grid with the least residual.

    Parameters
    ----------
    case, gains
        As of `starting_pulses`.

    Returns
    -------
    Start
        Its pulses, and the share of an unshaped step's swing that remains in the worst mode.
    """
    edges, columns, state = _grid(case, gains, 1)
    sides, given = _sides(columns, state)
    units = np.repeat(np.abs(case.gains[0]), SIDES)
    weights = np.append(np.zeros(edges.size - 1), 1.0)
    bounds = [(0.0, 1.0)] * (edges.size - 1) + [(0.0, None)]
    rows = np.column_stack((sides, -units))
    found = linprog(weights, A_ub=rows, b_ub=-given, bounds=bounds, method="highs")
    return Start(_pulses(edges, found.x[:-1]), float(found.x[-1]))


def pulses_by_pulls(case: StopCase, gains: ComplexArray, pulls: ComplexArray) -> list[Pulse]:
    """Return when full speed makes ``way + Re(conj(pulls) vibration)`` less.

    Parameters
    ----------
    case, gains
        As of `starting_pulses`.
    pulls
        Of each mode, shape (m,) [s].

    Returns
    -------
    list of Pulse
        From root to root.
    """
    edges, cost = _costs(case, gains, pulls, 1)
    lit = cost < 0
    roots = np.flatnonzero(lit[1:] != lit[:-1])
    shares = cost[roots] / (cost[roots] - cost[roots + 1])
    times = (edges[roots] + shares * (edges[roots + 1] - edges[roots])).tolist()
    if lit[0]:
        times.insert(0, 0.0)
    if lit[-1]:
        times.append(case.end_s)
    return list(zip(times[::2], times[1::2], strict=True))


def least_added_way(case: StopCase, gains: ComplexArray, pulls: ComplexArray) -> float:
    """Return the least weighted way that a command can add [s].

    Parameters
    ----------
    case, gains, pulls
        As of `pulses_by_pulls`.

    Returns
    -------
    float
        What ``way + Re(conj(pulls) vibration)`` gains where that is below 0, on a grid of
        `BOUND_FINENESS`.
    """
    edges, cost = _costs(case, gains, pulls, BOUND_FINENESS)
    return float(np.trapezoid(np.minimum(cost, 0.0), edges))


def _costs(
    case: StopCase, gains: ComplexArray, pulls: ComplexArray, fineness: int
) -> tuple[FloatArray, FloatArray]:
    """Return edges of cells, and what full speed there adds to way and weighted vibration."""
    edges = _edges(case, fineness)
    turned = np.exp(case.poles_rad_s[:, None] * (case.end_s - edges))
    return edges, 1 + ((np.conj(pulls) * gains * case.poles_rad_s) @ turned).real


def _edges(case: StopCase, fineness: int) -> FloatArray:
    """Return the edges of the cells."""
    cells = (
        fineness
        * case.end_s
        / (2 * np.pi)
        * max(CELLS_OF_PERIOD * case.slowest_rad_s, CELLS_OF_QUICKEST * case.quickest_rad_s)
    )
    return np.linspace(0.0, case.end_s, min(max(int(np.ceil(cells)), 8), MAX_CELLS) + 1)


def _grid(
    case: StopCase, gains: ComplexArray, fineness: int
) -> tuple[FloatArray, ComplexArray, ComplexArray]:
    """Return edges of cells, what each adds at the end if it is on, and what is there if not."""
    edges = _edges(case, fineness)
    turned = np.exp(case.poles_rad_s[:, None] * (case.end_s - edges))
    off = case.switches_of([])
    state = case.left_by(off.times_s, off.levels).vibration
    return edges, gains[:, None] * (turned[:, :-1] - turned[:, 1:]), state


def _sides(columns: ComplexArray, state: ComplexArray) -> tuple[FloatArray, FloatArray]:
    """Return how far cells and the state reach toward each side of a polygon a mode."""
    toward = np.exp(-2j * np.pi * np.arange(SIDES) / SIDES)
    rows = (toward[None, :, None] * columns[:, None, :]).real
    return rows.reshape(-1, columns.shape[1]), (toward * state[:, None]).real.ravel()


def _pulses(edges: FloatArray, levels: FloatArray) -> list[Pulse]:
    """Return the pulses of levels, those between 0 and 1 as parts of a cell that are on."""
    lit = levels > OFF
    bounds = np.flatnonzero(np.diff(lit, prepend=False, append=False)).reshape(-1, 2)
    pulses: list[Pulse] = []
    for first, beyond in bounds.tolist():
        cell = edges[1] - edges[0]
        on, off = float(edges[first]), float(edges[beyond])
        if beyond - first == 1:
            # Alone: in the middle of its cell, unless that is at either end.
            spare = (1 - levels[first]) * cell
            shares = (0.0, 1.0) if on == 0 else (1.0, 0.0) if off == edges[-1] else (0.5, 0.5)
            pulses.append((on + shares[0] * spare, off - shares[1] * spare))
            continue
        on += float(1 - levels[first]) * cell
        off -= float(1 - levels[beyond - 1]) * cell
        pulses.append((on, off))
    return pulses
