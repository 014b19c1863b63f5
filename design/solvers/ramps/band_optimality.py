"""The conditions of optimality over a band: switches, peaks that touch, and their weights at once.

With ``F(q) = exp(s T) integral of r' exp(-s t)``, s the pole at the ratio q and T the end::

    ln |F(q_k)| = ln tolerance                            every peak touches
    d ln |F(q_k)| / dq = 0                                and is a peak, or sits on the band's edge
    sum_k weight_k d ln |F(q_k)| / dt_i + dT/dt_i = 0     no switch gains by moving

Where the course has conditions of its structure they are met too, and each has a price that adds to
the last.
"""

import math
from dataclasses import dataclass, field, replace
from typing import Generic

import numpy as np

from design.solvers.least_squares import evened_least_squares, least_squares
from design.solvers.ramps.course import Course
from design.solvers.ramps.functionals import Functionals
from design.solvers.ramps.movable import AnyCourse, Movable, kept_share
from design.solvers.ramps.optimality import (
    CONVERGED,
    FARTHEST_STEP_RAD,
    MIN_GAP_RAD,
    NEWTON_STEPS,
    ROUNDING,
    RampedOptimum,
)
from design.types import BoolArray, ComplexArray, FloatArray, IntArray

BESIDE = 1e-5
"""Distance of two ratios over which a derivative of the Jacobian is a quotient [-]."""

KEPT_GAP = 0.7
"""Share of a gap that one step closes at most [-]."""

FARTHEST_PEAK = 0.25
"""Share of the band that a peak moves in a step, at most [-]."""

MET = 1e-9
"""Largest miss of the tolerance that counts as none, over it [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BandPoint(Generic[AnyCourse]):
    """A course and the peaks of its residual that touch the tolerance.

    Attributes
    ----------
    course
        The course.
    ratios
        Frequency ratios of the peaks, ascending, shape (m,) [-].
    inner
        Which of them lie inside the band and may move, shape (m,).
    weights
        By how much the end moves with the logarithm of each one's tolerance, shape (m,) [rad].
    prices
        The same of the conditions of the course, shape (c,).
    steps
        Steps of Newton's method that led there.
    """

    course: AnyCourse
    ratios: FloatArray
    inner: BoolArray
    weights: FloatArray
    prices: FloatArray = field(default_factory=lambda: np.zeros(0))
    steps: int = 0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Left:
    """The residual of a course at some ratios, and how it changes, over F itself.

    Attributes
    ----------
    logarithms, growths, bends
        ln |F| and its derivatives in the ratio, shape (m,).
    moves, drifts
        Derivatives of ln |F| in each switch, and those in the ratio too, shape (m, n).
    vectors
        ``integral of r' exp(-s t)``, shape (m,).
    parts
        Its derivatives in each switch over itself, shape (m, n).
    """

    logarithms: FloatArray
    growths: FloatArray
    bends: FloatArray
    moves: FloatArray
    drifts: FloatArray
    vectors: ComplexArray
    parts: ComplexArray


def band_functionals(unit_pole: complex, ratios: FloatArray) -> Functionals:
    """Return the residuals at some ratios, linear in the slope.

    Parameters
    ----------
    unit_pole
        The mode's pole over its natural frequency [-].
    ratios
        Frequency ratios, shape (m,) [-].

    Returns
    -------
    Functionals
        Of order 0, m of them.
    """
    return Functionals(unit_pole * ratios, np.zeros(ratios.size))


def _slope_functionals(unit_pole: complex, ratios: FloatArray) -> Functionals:
    return Functionals(unit_pole * ratios, np.ones(ratios.size))


def residuals(course: Movable, unit_pole: complex, ratios: FloatArray) -> FloatArray:
    """Return the residual of a course at some ratios.

    Parameters
    ----------
    course
        The course.
    unit_pole
        The mode's pole over its natural frequency [-].
    ratios
        Frequency ratios, shape (m,) [-].

    Returns
    -------
    FloatArray
        ``|F|``, shape (m,) [-].
    """
    functionals = band_functionals(unit_pole, ratios)
    left: FloatArray = np.abs(course.values(functionals)) * functionals.scales(course.end)
    return left


def growths(
    course: Movable, unit_pole: complex, ratios: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the first and second derivative of ln |F| in the ratio.

    Parameters
    ----------
    course, unit_pole, ratios
        As of `residuals`, shape (m,).

    Returns
    -------
    tuple of FloatArray
        Shape (m,) each.
    """
    at, below, above = (ratios, ratios - BESIDE, ratios + BESIDE)
    vectors = course.values(band_functionals(unit_pole, at))
    slopes = unit_pole * course.values(
        _slope_functionals(unit_pole, np.concatenate((at, below, above)))
    )
    slope, low, high = np.split(slopes, 3)
    rho = slope / vectors
    bends = ((high - low) / (2 * BESIDE) / vectors - rho**2).real
    return rho.real + unit_pole.real * course.end, bends


def _left(course: Movable, unit_pole: complex, ratios: FloatArray) -> _Left:
    functionals = band_functionals(unit_pole, ratios)
    vectors = course.values(functionals)
    parts = course.changes(functionals)[:, 1:] / vectors[:, None]
    slopes = _slope_functionals(unit_pole, ratios)
    rho = unit_pole * course.values(slopes) / vectors
    turned = unit_pole * course.changes(slopes)[:, 1:] / vectors[:, None]
    ends = course.end_changes()[1:]
    growing, bends = growths(course, unit_pole, ratios)
    return _Left(
        logarithms=np.log(np.abs(vectors)) + unit_pole.real * ratios * course.end,
        growths=growing,
        bends=bends,
        moves=parts.real + np.multiply.outer(unit_pole.real * ratios, ends),
        drifts=(turned - rho[:, None] * parts).real + unit_pole.real * ends,
        vectors=vectors,
        parts=parts,
    )


def peak_changes(
    course: Movable, unit_pole: complex, ratios: FloatArray
) -> tuple[FloatArray, ComplexArray]:
    """Return how ln |F| changes at some ratios, and what weighs it.

    Parameters
    ----------
    course, unit_pole, ratios
        As of `residuals`, shape (m,).

    Returns
    -------
    tuple of FloatArray and ComplexArray
        Derivatives in each time, shape (m, n), and the multipliers of the peaks' functionals that a
        unit of each weight is, shape (m, m).
    """
    left = _left(course, unit_pole, ratios)
    moves = np.hstack((np.zeros((ratios.size, 1)), left.moves))
    return moves, np.diag(1 / left.vectors.conj())


def point_at(
    course: AnyCourse, unit_pole: complex, ratios: FloatArray, inner: BoolArray
) -> BandPoint[AnyCourse]:
    """Return a course and peaks with the weights and prices that fit best.

    Parameters
    ----------
    course, unit_pole, ratios
        As of `residuals`, shape (m,).
    inner
        Which of the ratios lie inside the band, shape (m,).

    Returns
    -------
    BandPoint
        Weights below 0 are 0.
    """
    rows = np.vstack((_left(course, unit_pole, ratios).moves, course.condition_changes[:, 1:]))
    found = least_squares(rows.T, -course.end_changes()[1:])
    weights, prices = np.split(found, [ratios.size])
    return BandPoint(
        course=course,
        ratios=ratios,
        inner=inner,
        weights=np.maximum(weights, 0.0),
        prices=prices,
    )


# Where it diverges, numbers overflow: what is not finite then ends it.
@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def solve_band_conditions(
    point: BandPoint[AnyCourse],
    unit_pole: complex,
    band: tuple[float, float],
    tolerance: float,
) -> BandPoint[AnyCourse] | None:
    """Solve the conditions of optimality from a point near by.

    Parameters
    ----------
    point
        Where Newton's method begins; it says too how many times and peaks there are.
    unit_pole, band, tolerance
        The mode's pole over its frequency, the band, and what every peak touches.

    Returns
    -------
    BandPoint or None
        None where Newton's method fails, or ends with switches that coincide.
    """
    count = point.course.gaps.size
    moving = np.flatnonzero(point.inner)
    now, step = point, 0
    while step < NEWTON_STEPS:
        step += 1
        left = _left(now.course, unit_pole, now.ratios)
        change = _newton_step(now, left, unit_pole, moving, math.log(tolerance))
        if change is None:
            return None
        parts = np.cumsum([count, moving.size, now.ratios.size])
        moves, drifts, weights, prices = np.split(change, parts)
        farthest = float(np.abs(moves).max(initial=0.0))
        share = min(
            _kept_share(now.course, moves), FARTHEST_STEP_RAD / max(farthest, FARTHEST_STEP_RAD)
        )
        reach = FARTHEST_PEAK * (band[1] - band[0])
        share *= min(1.0, reach / max(float(np.abs(drifts).max(initial=0.0)), reach))
        ratios = now.ratios.copy()
        ratios[moving] += share * drifts
        limit = _rounding(now.course)
        now = replace(
            now,
            course=now.course.moved(np.append(0.0, share * moves)),
            ratios=ratios,
            weights=now.weights + share * weights,
            prices=now.prices + share * prices,
        )
        if share == 1 and farthest < limit:
            break
    missed = np.abs(residuals(now.course, unit_pole, now.ratios) / tolerance - 1)
    if not np.append(missed, np.abs(now.course.conditions)).max(initial=0.0) < MET:
        return None
    if now.course.keeps_order and now.course.gaps.min(initial=math.inf) < MIN_GAP_RAD:
        return None
    return replace(now, steps=point.steps + step)


def _kept_share(course: Movable, moves: FloatArray) -> float:
    return kept_share(course.gaps, moves, KEPT_GAP) if course.keeps_order else 1.0


def _rounding(course: Movable) -> float:
    """Return the step after which the next is rounding [rad]."""
    if not course.keeps_order:
        return CONVERGED * max(1.0, course.end)
    return max(CONVERGED * min(1.0, float(course.gaps.min())), ROUNDING * course.end)


def _newton_step(
    now: BandPoint[AnyCourse], left: _Left, unit_pole: complex, moving: IntArray, aim: float
) -> FloatArray | None:
    """Return the step of the times after the first, of inner ratios, of weights and prices."""
    m, n, p = now.ratios.size, now.course.gaps.size, moving.size
    ends, conditions = now.course.end_changes()[1:], now.course.condition_changes[:, 1:]
    weighted = (now.weights / left.vectors.conj()).astype(np.complex128)
    bent = now.course.bends(band_functionals(unit_pole, now.ratios), weighted)
    bent = (bent + now.course.condition_bends(now.prices))[1:, 1:]
    bent = bent - np.einsum("k,ki,kj->ij", now.weights, left.parts, left.parts).real
    matrix = np.zeros((m + p + n + len(conditions), n + p + m + len(conditions)))
    matrix[:m, :n] = left.moves
    matrix[moving, n + np.arange(p)] = left.growths[moving]
    matrix[m : m + p, :n] = left.drifts[moving]
    matrix[m + np.arange(p), n + np.arange(p)] = left.bends[moving]
    still = slice(m + p, m + p + n)
    matrix[still, :n] = bent
    matrix[still, n : n + p] = (now.weights[:, None] * left.drifts)[moving].T
    matrix[still, n + p : n + p + m] = left.moves.T
    matrix[still, n + p + m :] = conditions.T
    matrix[m + p + n :, :n] = conditions
    values = np.concatenate((
        left.logarithms - aim,
        left.growths[moving],
        now.weights @ left.moves + now.prices @ conditions + ends,
        now.course.conditions,
    ))
    # Conditions are steep in the times of a limited jerk: truncated, they would not be met.
    if len(conditions):
        step = evened_least_squares(matrix, -values)
    else:
        step = least_squares(matrix, -values, 1e-13)
    return step if np.isfinite(step).all() else None


def multipliers_of(
    point: BandPoint[AnyCourse], unit_pole: complex
) -> tuple[Functionals, ComplexArray, float]:
    """Return functionals, multipliers, and what a later end is worth.

    Parameters
    ----------
    point
        A point that meets the conditions.
    unit_pole
        The mode's pole over its natural frequency [-].

    Returns
    -------
    tuple
        F, ``c_k = weight_k V_k / |V_k|^2`` over that worth, shape (m,), and the worth: prices over
        it are those of a problem whose targets do not change with the end.
    """
    functionals = band_functionals(unit_pole, point.ratios)
    vectors = point.course.values(functionals)
    worth = 1 + float(point.weights @ (unit_pole.real * point.ratios))
    return functionals, point.weights / vectors.conj() / worth, worth


def optimum_of(point: BandPoint[Course], unit_pole: complex, tolerance: float) -> RampedOptimum:
    """Return a point with the multipliers that exclude shorter courses.

    Parameters
    ----------
    point
        A point that meets the conditions.
    unit_pole, tolerance
        The mode's pole over its natural frequency, and what its peaks touch [-].

    Returns
    -------
    RampedOptimum
        With the multipliers of `multipliers_of`.
    """
    functionals, multipliers, _ = multipliers_of(point, unit_pole)
    return RampedOptimum(
        course=point.course,
        functionals=functionals,
        targets=np.zeros_like(multipliers),
        tolerance=tolerance,
        multipliers=multipliers,
        iterations=point.steps,
    )
