"""The conditions of optimality over a band behind two lags, by Newton's method.

Over one structure the end T is linear in the switches x. With h_k the logarithm of the k-th peak's
height, b_j the bounds that hold and multipliers of at least 0::

    h_k(x) = ln tolerance,   b_j(x) = 0,   dT/dx + sum_k weight_k dh_k/dx = sum_j price_j db_j/dx

A peak moves with the switches: ``d2h/dx2 = L_xx - L_xq L_qx / L_qq``, L = ln |F| and q its ratio.
"""

from dataclasses import dataclass

import numpy as np

from design.solvers.least_squares import least_squares
from design.solvers.ramps.unequal_course import UnequalCourse
from design.solvers.ramps.unequal_peaks import BESIDE, BandOfTwoLags
from design.solvers.ramps.unequal_structure import Structure
from design.types import BoolArray, FloatArray

NEWTON_STEPS = 12
"""Steps at most; four are usual."""

CONVERGED = 1e-10
"""Step at which they end [rad]."""

MET = 1e-11
"""Largest miss of the tolerance that counts as none, over it [-]."""

FARTHEST_STEP_RAD = 0.4
"""How far a switch moves in a step [rad]."""

FARTHEST_PEAK = 0.1
"""Share of the band that a peak moves in a step [-]."""

CONVEX = 1e-7
"""Share of the largest curvature by which one may be below 0 at an optimum [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Touching:
    """What holds at an optimum.

    Attributes
    ----------
    ratios
        Of the peaks that touch the tolerance, shape (k,) [-].
    weights
        How the end falls with the logarithm of each one's tolerance, shape (k,) [rad].
    held
        Which bounds of the structure hold, shape (2 n - 2,).
    """

    ratios: FloatArray
    weights: FloatArray
    held: BoolArray


def touching(
    band: BandOfTwoLags,
    structure: Structure,
    at: FloatArray,
    ratios: FloatArray,
    bounds: BoolArray,
) -> Touching:
    """Return which peaks and bounds hold an end back.

    Parameters
    ----------
    band, structure
        What is left, of which commands.
    at
        Switches after the first, shape (n - 1,) [rad].
    ratios
        Peaks that touch the tolerance or nearly do, shape (k,) [-].
    bounds
        Bounds that nearly hold, shape (2 n - 2,).

    Returns
    -------
    Touching
        By least squares with weights of at least 0.
    """
    from scipy.optimize import nnls  # noqa: PLC0415 - takes longer to import than a design

    left = band.left(np.append(0.0, at), structure.arrived, ratios)
    places = np.flatnonzero(bounds)
    pulls = np.vstack((left.moves, -structure.room_changes(at)[places]))
    weights = nnls(pulls.T, -structure.end_changes(at))[0]
    pulling = weights > 0
    held = np.zeros(bounds.size, dtype=np.bool_)
    held[places[pulling[ratios.size :]]] = True
    peaks = pulling[: ratios.size]
    return Touching(ratios=ratios[peaks], weights=weights[: ratios.size][peaks], held=held)


def solve_conditions(
    band: BandOfTwoLags, structure: Structure, start: FloatArray, near: Touching, tolerance: float
) -> FloatArray | None:
    """Return the switches at which the conditions hold.

    Parameters
    ----------
    band, structure
        What is left, of which commands.
    start
        Switches after the first, shape (n - 1,) [rad].
    near
        What holds near the optimum.
    tolerance
        Height of the peaks [-].

    Returns
    -------
    FloatArray or None
        Switches after the first, shape (n - 1,) [rad]; None where no minimum is found.
    """
    at, ratios, weights = start, near.ratios, near.weights
    farthest = FARTHEST_PEAK * (band.upper - band.lower)
    for _ in range(NEWTON_STEPS):
        course = structure.course(at)
        ratios = band.refined(course, ratios, 2, farthest)
        left = band.left(course.switches, structure.arrived, ratios)
        missed = np.append(left.logarithms - np.log(tolerance), structure.room(at)[near.held])
        fixed = np.vstack((left.moves, -structure.room_changes(at)[near.held]))
        bends = _bends(band, course, ratios, weights)
        count = at.size
        system = np.block([[bends, fixed.T], [fixed, np.zeros((missed.size, missed.size))]])
        # The bounds are counted as what is left: from above.
        missed[ratios.size :] *= -1
        right = -np.append(structure.end_changes(at), missed)
        solved = least_squares(system, right, 1e-14)
        moves, weights = solved[:count], solved[count : count + ratios.size]
        if not np.isfinite(solved).all():
            return None
        size = float(np.abs(moves).max())
        if size < CONVERGED and np.abs(missed).max() < MET:
            least = (solved[count:] > 0).all() and _is_least(bends, fixed)
            return at if least else None
        at = at + moves * min(1.0, FARTHEST_STEP_RAD / size)
        if not (np.diff(at, prepend=0.0) >= 0).all():
            return None
    return None


def _bends(
    band: BandOfTwoLags, course: UnequalCourse, ratios: FloatArray, weights: FloatArray
) -> FloatArray:
    """Return the curvature of the weighted heights in the switches, shape (n - 1, n - 1)."""
    # Of F alone, which turns little, differences are quotients; ln |F| bends more than they hold.
    switches, arrived = course.switches, course.arrived
    here, beside = (band.left(switches, arrived, at) for at in (ratios, ratios + BESIDE))
    over = 1 / here.vectors
    parts, slopes = here.changes * over[:, None], here.slopes * over
    count = switches.size - 1
    bends = np.empty((count, count))
    for which in range(count):
        moved = switches.copy()
        moved[1 + which] += BESIDE
        there = band.left(moved, arrived, ratios)
        bent = (there.changes - here.changes) / BESIDE * over[:, None]
        bends[which] = weights @ (bent - parts[:, [which]] * parts).real
    drifts = (here.slope_changes * over[:, None] - parts * slopes[:, None]).real
    inner = (ratios > band.lower) & (ratios < band.upper)
    curved = ((beside.slopes - here.slopes) / BESIDE * over - slopes**2).real
    bends -= (drifts[inner].T * (weights / curved)[inner]) @ drifts[inner]
    return (bends + bends.T) / 2


def _is_least(bends: FloatArray, fixed: FloatArray) -> bool:
    """Return whether no move along what holds shortens the end."""
    _, sizes, axes = np.linalg.svd(fixed)
    free = axes[int((sizes > 1e-9 * sizes.max(initial=0.0)).sum()) :]
    if not free.size:
        return True
    curvatures = np.linalg.eigvalsh(free @ bends @ free.T)
    return bool(curvatures[0] > -CONVEX * np.abs(bends).max())
