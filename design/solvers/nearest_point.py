"""The point of a polyhedron nearest to another, by a dual active-set method, exact to rounding."""

from dataclasses import dataclass

import numpy as np

from design.types import FloatArray

EXACT = 1e-12
"""Largest equation that counts as met, its row of length 1 [-]."""

DEPENDENT = 1e-9
"""Length of a row, of length 1, without its part along the rows held, that counts as none [-]."""

MAX_STEPS_PER_ROW = 4
"""Steps of the method at most, for each inequality: it repeats none, rounding apart [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Polyhedron:
    """All x with ``equations x = wanted`` and ``bounds x >= least``.

    Attributes
    ----------
    equations, wanted
        Shapes (e, n) and (e,).
    bounds, least
        Shapes (b, n) and (b,); no row is zero.
    """

    equations: FloatArray
    wanted: FloatArray
    bounds: FloatArray
    least: FloatArray


def nearest_point(start: FloatArray, within: Polyhedron) -> FloatArray | None:
    """Return the point of a polyhedron nearest to another.

    Parameters
    ----------
    start
        That other point, shape (n,).
    within
        The polyhedron.

    Returns
    -------
    FloatArray or None
        Shape (n,); None where the polyhedron is empty, rounding apart.

    References
    ----------
    .. [1] D. Goldfarb, A. Idnani, "A numerically stable dual method for solving strictly convex
       quadratic programs", Mathematical Programming 27 (1983), section 3.

    Examples
    --------
    >>> half_plane = Polyhedron(
    ...     equations=np.ones((1, 2)), wanted=np.ones(1), bounds=np.eye(2), least=np.zeros(2)
    ... )
    >>> nearest_point(np.array([2.0, 0.5]), half_plane).round(12).tolist()
    [1.0, 0.0]
    """
    equations, wanted = _of_unit_rows(within.equations, within.wanted)
    bounds, least = _of_unit_rows(within.bounds, within.least)
    held: list[int] = []
    costs: list[float] = []
    point = _onto(start, equations, wanted)
    if _miss(point, equations, wanted) > EXACT:
        return None
    span = _independent(equations)
    for _ in range(MAX_STEPS_PER_ROW * len(bounds) + 1):
        short = least - bounds @ point
        short[held] = 0.0
        worst = int(np.argmax(short))
        if short[worst] <= EXACT:
            return _sharpened(start, equations, wanted, bounds[held], least[held], bounds, least)
        cost = 0.0
        while True:
            way, shares = _way_toward(bounds[worst], span, bounds[held])
            blocking = [
                costs[i] / shares[i] if shares[i] > EXACT else np.inf for i in range(len(held))
            ]
            first = int(np.argmin(blocking)) if held else -1
            until_free = blocking[first] if held else np.inf
            length = float(way @ bounds[worst])
            missing = float(least[worst] - bounds[worst] @ point)
            until_met = missing / length if length > DEPENDENT**2 else np.inf
            step = min(until_free, until_met)
            if not np.isfinite(step):
                return None
            costs = [old - step * share for old, share in zip(costs, shares, strict=True)]
            cost += step
            if np.isfinite(until_met):
                point = point + step * way
            if step == until_met:
                held.append(worst)
                costs.append(cost)
                break
            del held[first], costs[first]
    return None


def _of_unit_rows(rows: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    lengths = np.linalg.norm(rows, axis=1)
    lengths = np.where(lengths > 0, lengths, 1.0)
    return rows / lengths[:, None], values / lengths


def _way_toward(
    row: FloatArray, span: FloatArray, held: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return a row's part across those held, and its shares along the bounds among them.

    A bound on one unknown alone, held, fixes that unknown: it goes, and the rest is small.
    """
    alone = (held != 0).sum(axis=1) == 1
    fixed = np.argmax(held[alone] != 0, axis=1)
    free = np.ones(row.size, dtype=np.bool_)
    free[fixed] = False
    rows = np.concatenate((span, held[~alone]))
    basis, triangle = np.linalg.qr(rows[:, free].T)
    along = basis.T @ row[free]
    way = np.zeros(row.size)
    way[free] = row[free] - basis @ along
    # Of orthogonal directions what is left is rounding, which a second pass takes away.
    way[free] -= basis @ (basis.T @ way[free])
    by_row = np.linalg.solve(triangle, along)
    shares = np.zeros(len(held))
    shares[~alone] = by_row[len(span) :]
    shares[alone] = (row - by_row @ rows)[fixed] * held[alone, fixed]
    return way, shares


def _independent(rows: FloatArray) -> FloatArray:
    """Return orthogonal rows that span the same, shape (rank, n)."""
    _, sizes, across = np.linalg.svd(rows, full_matrices=False)
    spanning: FloatArray = across[sizes > DEPENDENT * sizes.max(initial=0.0)]
    return spanning


def _onto(point: FloatArray, rows: FloatArray, values: FloatArray) -> FloatArray:
    """Return the nearest point on all the rows, twice refined."""
    for _ in range(3):
        point = point + np.linalg.lstsq(rows, values - rows @ point)[0]
    return point


def _miss(point: FloatArray, rows: FloatArray, values: FloatArray) -> float:
    return float(np.abs(rows @ point - values).max(initial=0.0))


def _sharpened(
    start: FloatArray,
    equations: FloatArray,
    wanted: FloatArray,
    held: FloatArray,
    at: FloatArray,
    bounds: FloatArray,
    least: FloatArray,
) -> FloatArray | None:
    """Return the nearest point on the rows held, without the rounding of the way there."""
    rows, values = np.concatenate((equations, held)), np.concatenate((wanted, at))
    point = _onto(start, rows, values)
    sound = _miss(point, rows, values) <= EXACT and (bounds @ point - least).min() >= -10 * EXACT
    return point if sound else None
