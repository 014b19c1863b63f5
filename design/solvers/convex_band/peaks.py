"""Peaks exchanged over bands until none is above the tolerance, and optima followed along it."""

import math
from dataclasses import replace

import numpy as np

from design.formulations.bands import BandProblem, PoleBand
from design.solvers.budget import Budget
from design.solvers.convex_band.optimality import Point, solve_conditions
from design.types import ComplexArray, FloatArray, IntArray

MAX_EXCHANGES = 8
"""How often peaks are exchanged before the grid is refined."""

ABOVE = 1e-11
"""Excess over the tolerance at which a peak counts as above: below the margin [-]."""

SCAN_TURN_RAD = math.pi / 16
"""Turn of the last impulse between two points of the search for peaks [rad]."""

FIRST_WEIGHT = 1e-3
"""Cost of a peak that was not among the touching ones before, over that of all [-]."""

EXCHANGED_WORK = 5000.0
"""Work of exchanging peaks at one tolerance, a few steps of Newton's method each [units]."""

MIN_FOLLOWED_STEP = 1e-5
"""Relative step of the tolerance below which an optimum cannot be followed on [-]."""


def optimum(problem: BandProblem, point: Point, tolerance: float) -> Point | None:
    """Exchange peaks until the held ones are those that touch.

    No peak is then above the tolerance, and every held peak has a weight above zero.

    Parameters
    ----------
    problem
        The bands.
    point
        Where Newton's method begins.
    tolerance
        Largest residual over the bands [-].

    Returns
    -------
    Point or None
        The optimum; None where Newton's method fails, `MAX_EXCHANGES` are not enough, or an
        amplitude that must be positive is not.
    """
    ends = np.array([(one.lower, one.upper) for one in problem.bands])
    for _ in range(MAX_EXCHANGES):
        found = solve_conditions(problem, point, tolerance)
        if found is None:
            return None
        kept = found.weights > 0
        lower, upper = ends[found.bands].T
        outside = found.inner & ((found.ratios <= lower) | (found.ratios >= upper))
        bands, ratios, values = peaks(problem, found)
        above = values > tolerance * (1 + ABOVE)
        if kept.all() and not outside.any() and not above.any():
            return found if (problem.levels or found.amplitudes.min() > 0) else None
        if outside.any():
            ratios_held = np.clip(found.ratios, lower, upper)
            inner = found.inner & ~outside
        else:
            ratios_held, inner = found.ratios, found.inner
        held, free_to_move, weights = ratios_held[kept], inner[kept], found.weights[kept]
        places = found.bands[kept]
        for band, ratio in zip(bands[above].tolist(), ratios[above].tolist(), strict=True):
            at_edge = ratio in ends[band]
            pitch = problem.bands[band].width / 50
            near = np.flatnonzero((places == band) & (np.abs(held - ratio) < pitch))
            if near.size:
                held[near[0]] = ratio
                free_to_move[near[0]] = not at_edge
            else:
                places = np.append(places, band)
                held = np.append(held, ratio)
                free_to_move = np.append(free_to_move, not at_edge)
                weights = np.append(weights, FIRST_WEIGHT)
        order = np.lexsort((held, places))
        point = replace(
            found,
            bands=places[order],
            ratios=held[order],
            inner=free_to_move[order],
            weights=weights[order] / weights.sum(),
        )
    return None


def follow_tolerance(
    problem: BandProblem, point: Point, from_tolerance: float, tolerance: float, budget: Budget
) -> tuple[Point, float] | None:
    """Follow an optimum from one tolerance towards another.

    Parameters
    ----------
    problem
        The band.
    point
        Where Newton's method begins at ``from_tolerance``.
    from_tolerance
        The tolerance that the duration of the point allows [-].
    tolerance
        The tolerance that is asked [-].
    budget
        The work of exchanges is counted in it.

    Returns
    -------
    tuple of Point and float, or None
        The last optimum and its tolerance [-], another than asked where impulses or peaks merge, or
        where the budget is spent; None where there is no optimum at ``from_tolerance``.
    """
    now = optimum(problem, point, from_tolerance)
    if now is None:
        return None
    level, target = math.log(from_tolerance), math.log(tolerance)
    step = target - level
    while level != target and abs(step) >= MIN_FOLLOWED_STEP and not budget.spent:
        budget.spend(EXCHANGED_WORK)
        aim = target if abs(target - level) <= abs(step) else level + step
        further = optimum(problem, now, math.exp(aim))
        if further is None:
            step /= 2
        else:
            now, level = further, aim
            step *= 2
    return now, math.exp(level)


def peaks(problem: BandProblem, point: Point) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return the local maxima of the residual over each band, edges included.

    Newton's method refines them from a grid.

    Parameters
    ----------
    problem
        The bands.
    point
        The impulses.

    Returns
    -------
    tuple of IntArray, FloatArray and FloatArray
        Numbers of their bands, ratios of the maxima and residuals there, shape (k,) each [-].
    """
    found = [_peaks_of(band, point) for band in problem.bands]
    return (
        np.repeat(np.arange(len(found)), [ratios.size for ratios, _ in found]),
        np.concatenate([ratios for ratios, _ in found]),
        np.concatenate([values for _, values in found]),
    )


def _peaks_of(band: PoleBand, point: Point) -> tuple[FloatArray, FloatArray]:
    lower, upper = band.lower, band.upper
    turn = band.width * abs(band.unit_pole) * float(point.lags[-1])
    grid = np.linspace(lower, upper, 9 + math.ceil(turn / SCAN_TURN_RAD))
    values = _residuals(band, point, grid)
    left = np.concatenate(([-math.inf], values[:-1]))
    right = np.concatenate((values[1:], [-math.inf]))
    tops = np.flatnonzero((values >= left) & (values >= right))
    ratios = grid[tops]
    moving = (tops > 0) & (tops < grid.size - 1)
    pitch = grid[1] - grid[0]
    # A peak may lie between an edge and its neighbour: it does if the residual rises inward.
    inward = np.array([grid[0], grid[-1]])
    slopes = _growth(band, point, inward)[0] * np.array([1, -1])
    hidden = inward[slopes > 0] + np.array([0.5, -0.5])[slopes > 0] * pitch
    ratios, moving = np.append(ratios, hidden), np.append(moving, np.full(hidden.size, True))
    for _ in range(4):  # Newton's method on the slope: four steps from a fine grid are enough
        slope, bend = _growth(band, point, ratios)
        step = np.where(moving & (bend < 0), -slope / np.where(bend < 0, bend, 1.0), 0.0)
        ratios = np.clip(ratios + np.clip(step, -pitch, pitch), lower, upper)
    return ratios, _residuals(band, point, ratios)


def _growth(band: PoleBand, point: Point, ratios: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the first and second derivative of ln |F| in the ratio."""
    turned = np.exp(np.multiply.outer(band.unit_pole * ratios, point.lags)) * point.amplitudes
    vector = turned.sum(axis=1)
    rho = band.unit_pole * (turned @ point.lags) / vector
    rho2 = band.unit_pole**2 * (turned @ point.lags**2) / vector
    return rho.real, (rho2 - rho**2).real


def _residuals(band: PoleBand, point: Point, ratios: FloatArray) -> FloatArray:
    turned: ComplexArray = np.exp(np.multiply.outer(band.unit_pole * ratios, point.lags))
    return np.abs(turned @ point.amplitudes)
