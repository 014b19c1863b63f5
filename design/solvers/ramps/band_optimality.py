"""The conditions of optimality over a band: switches, peaks that touch, and their weights at once.

With ``F(q) = exp(s T) integral of r' exp(-s t)``, s the pole at the ratio q and T the end::

    ln |F(q_k)| = ln tolerance                            every peak touches
    d ln |F(q_k)| / dq = 0                                and is a peak, or sits on the band's edge
    sum_k weight_k d ln |F(q_k)| / dt_i + dT/dt_i = 0     no switch gains by moving
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from design.solvers.least_squares import least_squares
from design.solvers.ramps.course import Course, Slopes, course_of
from design.solvers.ramps.functionals import Functionals
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
class BandPoint:
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
    steps
        Steps of Newton's method that led there.
    """

    course: Course
    ratios: FloatArray
    inner: BoolArray
    weights: FloatArray
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


def residuals(course: Course, unit_pole: complex, ratios: FloatArray) -> FloatArray:
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
    course: Course, unit_pole: complex, ratios: FloatArray
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


def _left(course: Course, unit_pole: complex, ratios: FloatArray) -> _Left:
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


def find_weights(course: Course, unit_pole: complex, ratios: FloatArray) -> FloatArray:
    """Return the weights that fit the switches best.

    Parameters
    ----------
    course, unit_pole, ratios
        As of `residuals`, shape (m,).

    Returns
    -------
    FloatArray
        Shape (m,) [rad].
    """
    moves = _left(course, unit_pole, ratios).moves
    return least_squares(moves.T, -course.end_changes()[1:])


# Where it diverges, numbers overflow: what is not finite then ends it.
@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def solve_band_conditions(
    point: BandPoint,
    unit_pole: complex,
    band: tuple[float, float],
    tolerance: float,
    slopes: Slopes,
) -> BandPoint | None:
    """Solve the conditions of optimality from a point near by.

    Parameters
    ----------
    point
        Where Newton's method begins; it says too how many switches and peaks there are.
    unit_pole, band, tolerance, slopes
        The mode's pole over its frequency, the band, what every peak touches, and the limits.

    Returns
    -------
    BandPoint or None
        None where Newton's method fails, or ends with switches that coincide.
    """
    count = point.course.switches.size - 1
    moving = np.flatnonzero(point.inner)
    now, step = point, 0
    while step < NEWTON_STEPS:
        step += 1
        left = _left(now.course, unit_pole, now.ratios)
        change = _newton_step(now, left, unit_pole, moving, math.log(tolerance))
        if change is None:
            return None
        moves, drifts, weights = np.split(change, (count, count + moving.size))
        gaps, closing = np.diff(now.course.switches), np.diff(moves, prepend=0.0)
        shrinking = closing < 0
        share = KEPT_GAP * float(np.min(-gaps[shrinking] / closing[shrinking], initial=2.0))
        farthest = float(np.abs(moves).max(initial=0.0))
        share = min(1.0, share, FARTHEST_STEP_RAD / max(farthest, FARTHEST_STEP_RAD))
        reach = FARTHEST_PEAK * (band[1] - band[0])
        share *= min(1.0, reach / max(float(np.abs(drifts).max(initial=0.0)), reach))
        ratios = now.ratios.copy()
        ratios[moving] += share * drifts
        now = replace(
            now,
            course=course_of(now.course.switches + np.append(0.0, share * moves), slopes),
            ratios=ratios,
            weights=now.weights + share * weights,
        )
        limit = max(CONVERGED * min(1.0, gaps.min()), ROUNDING * now.course.end)
        if share == 1 and farthest < limit:
            break
    missed = residuals(now.course, unit_pole, now.ratios) / tolerance - 1
    gaps = np.diff(now.course.switches)
    if not np.abs(missed).max(initial=0.0) < MET or gaps.min(initial=math.inf) < MIN_GAP_RAD:
        return None
    return replace(now, steps=point.steps + step)


def _newton_step(
    now: BandPoint, left: _Left, unit_pole: complex, moving: IntArray, aim: float
) -> FloatArray | None:
    """Return the step of the switches after the first, of inner ratios, and of the weights."""
    m, n, p = now.ratios.size, now.course.switches.size - 1, moving.size
    ends = now.course.end_changes()[1:]
    weighted = (now.weights / left.vectors.conj()).astype(np.complex128)
    bent = now.course.bends(band_functionals(unit_pole, now.ratios), weighted)[1:, 1:]
    bent = bent - np.einsum("k,ki,kj->ij", now.weights, left.parts, left.parts).real
    matrix = np.zeros((m + p + n, n + p + m))
    matrix[:m, :n] = left.moves
    matrix[moving, n + np.arange(p)] = left.growths[moving]
    matrix[m : m + p, :n] = left.drifts[moving]
    matrix[m + np.arange(p), n + np.arange(p)] = left.bends[moving]
    matrix[m + p :, :n] = bent
    matrix[m + p :, n : n + p] = (now.weights[:, None] * left.drifts)[moving].T
    matrix[m + p :, n + p :] = left.moves.T
    values = np.concatenate((
        left.logarithms - aim,
        left.growths[moving],
        now.weights @ left.moves + ends,
    ))
    step = least_squares(matrix, -values, 1e-13)
    return step if np.isfinite(step).all() else None


def optimum_of(point: BandPoint, unit_pole: complex, tolerance: float) -> RampedOptimum:
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
        With ``c_k = weight_k V_k / |V_k|^2``, over what a later end is worth.
    """
    functionals = band_functionals(unit_pole, point.ratios)
    vectors = point.course.values(functionals)
    worth = 1 + float(point.weights @ (unit_pole.real * point.ratios))
    return RampedOptimum(
        course=point.course,
        functionals=functionals,
        targets=np.zeros_like(vectors),
        tolerance=tolerance,
        multipliers=point.weights / vectors.conj() / worth,
        iterations=point.steps,
    )
