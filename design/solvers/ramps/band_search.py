"""The fastest course over a band: a cone program's structure, Newton's method, peaks exchanged."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from design.formulations.ramped_band import RampedBandProblem
from design.solvers.budget import Budget
from design.solvers.convex_band.duration import ripples_of
from design.solvers.convex_band.peaks import SCAN_TURN_RAD
from design.solvers.ramps.band_optimality import (
    BandPoint,
    find_weights,
    growths,
    optimum_of,
    residuals,
    solve_band_conditions,
)
from design.solvers.ramps.band_structure import BandCourse, least_course, start_of
from design.solvers.ramps.course import Course, Slopes, course_of
from design.solvers.ramps.exchange import lacking_switches
from design.solvers.ramps.optimality import RampedOptimum
from design.trace import TraceStep
from design.types import BoolArray, FloatArray

PASSES = ((1.0, 0.05), (3.0, 0.05), (1.0, math.inf), (9.0, math.inf))
"""How many times finer than the first each grid of time is, and the largest relative distance of
two tolerances between which an optimum is followed [-]."""

MAX_DURATIONS = 10
"""Durations tried on each grid."""

FIRST_STEP = 1.15
"""Quotient of the first two durations [-]."""

NEAR = 0.2
"""Distance of the ripples of a duration from those asked at which its structure is used [-]."""

CLOSE = 3e-4
"""Relative width of the bracket of durations at which a grid says no more [-]."""

KEPT_INSIDE = 0.02
"""Share of the bracket within which of its ends it is halved [-]."""

DESIGN_MARGIN = 1e-10
"""Peaks are put this far below the tolerance, so that rounding lifts none above it [-]."""

ABOVE = 1e-11
"""Excess over the tolerance at which a peak counts as above: below the margin [-]."""

MAX_EXCHANGES = 10
"""How often peaks or switches are exchanged."""

SAME_PEAK = 0.02
"""Share of the band within which two peaks are one [-]."""

MIN_FOLLOWED_STEP = 2e-3
"""Relative step of the tolerance below which an optimum cannot be followed on [-]."""

PEAK_STEPS = 4
"""Newton's steps to a peak from the highest of three neighbours."""

SOLVE_WORK = 5000.0
"""Work of solving the conditions once, and looking for peaks [units]."""


def candidates(problem: RampedBandProblem, budget: Budget) -> Iterator[RampedOptimum]:
    """Yield courses that keep the tolerance and may be optimal.

    Parameters
    ----------
    problem
        The band, and the limits. Its horizon is not heeded: what is beyond it is refused with its
        bound.
    budget
        What the search may do.

    Yields
    ------
    RampedOptimum
        As reported by Newton's method; the caller stops at one that is proven.
    """
    search = _Search(problem, budget)
    alone = course_of(np.zeros(1), search.slopes)
    if search.peaks(alone)[1].max() <= problem.tolerance:
        yield search.of_one_ramp(alone)
        return
    wanted = ripples_of(problem.tolerance)
    duration = max(problem.ramps_rad[0], math.pi)
    for fineness, followed in PASSES:
        low, high = problem.ramps_rad[0], math.inf
        before: tuple[float, float] | None = None
        for _ in range(MAX_DURATIONS):
            if budget.spent:
                return
            found = search.least(duration, fineness)
            ripples = ripples_of(1.0 if found is None else found.largest)
            if found is not None and abs(ripples - wanted) < NEAR * wanted:
                yield from search.optima(found, followed)
            low, high = (max(low, duration), high) if ripples < wanted else (low, duration)
            now = (duration, ripples)
            duration = _next_duration(before, now, wanted, low, high)
            before = now
            if high - low < CLOSE * low:
                break


def _next_duration(
    before: tuple[float, float] | None,
    now: tuple[float, float],
    wanted: float,
    low: float,
    high: float,
) -> float:
    """Return the duration to try next: secant through the last two, inside the bracket."""
    guess = now[0] * (FIRST_STEP if now[1] < wanted else 1 / FIRST_STEP)
    if before is not None and (now[1] - before[1]) * (now[0] - before[0]) > 0:
        guess = now[0] + (wanted - now[1]) * (now[0] - before[0]) / (now[1] - before[1])
    if high == math.inf:
        return min(max(guess, 1.001 * low), 2 * low)
    inside = KEPT_INSIDE * (high - low)
    if not low + inside < guess < high - inside:
        return (low + high) / 2
    return guess


class _Search:
    """The parts of one search, which count their work and note their steps."""

    def __init__(self, problem: RampedBandProblem, budget: Budget) -> None:
        self.programs = 0
        self.slopes = Slopes(up=1 / problem.ramps_rad[0], down=1 / problem.ramps_rad[1])
        self._problem, self._budget = problem, budget

    def of_one_ramp(self, alone: Course) -> RampedOptimum:
        """Return a ramp that keeps the tolerance by itself: nothing is faster."""
        none = BandPoint(
            course=alone, ratios=np.zeros(0), inner=np.zeros(0, dtype=bool), weights=np.zeros(0)
        )
        optimum = optimum_of(none, self._problem.unit_pole, self._problem.tolerance)
        return replace(optimum, seed="one_ramp")

    def least(self, duration: float, fineness: float) -> BandCourse | None:
        """Return the course of least residual, on a grid; None if the duration is too short."""
        problem = self._problem
        self.programs += 1
        found = least_course(problem, self.slopes, duration, fineness, self._budget)
        largest = 1.0 if found is None else found.largest
        self._budget.note(
            TraceStep(
                stage="bound",
                method="clarabel",
                start="cone_program",
                outcome="too_short" if largest > problem.tolerance else "may_be_possible",
                duration_s=duration / problem.natural_frequency_rad_s,
                detail=f"least residual over the band: {largest:.4g}",
            )
        )
        return found

    def optima(self, grid_course: BandCourse, followed: float) -> Iterator[RampedOptimum]:
        """Yield what the conditions of optimality make of a structure, if anything."""
        problem = self._problem
        polished = start_of(problem, self.slopes, grid_course, self._budget)
        if polished is None:
            return
        start, largest = polished
        aim = problem.tolerance * (1 - DESIGN_MARGIN)
        found = self._exchange(start, aim)
        if found is None and abs(math.log(largest / aim)) < followed:
            found = self._follow(start, largest, aim)
        if found is None and self.peaks(start.course)[1].max() <= problem.tolerance:
            found = start  # a little later than the optimum, and good for a bound all the same
        if found is not None:
            optimum = optimum_of(found, problem.unit_pole, problem.tolerance)
            yield replace(optimum, programs=self.programs, seed="cone_program")

    def _follow(self, start: BandPoint, largest: float, tolerance: float) -> BandPoint | None:
        """Follow an optimum from the residual that its end allows to the tolerance."""
        now = self._exchange(start, largest)
        level, target = math.log(largest), math.log(tolerance)
        step = target - level
        while now is not None and level != target:
            following = target if abs(target - level) <= abs(step) else level + step
            further = self._exchange(now, math.exp(following))
            if further is not None:
                now, level = further, following
                step *= 2
            elif abs(step) < MIN_FOLLOWED_STEP or self._budget.spent:
                return None
            else:
                step /= 2
        return now

    def _exchange(self, start: BandPoint, tolerance: float) -> BandPoint | None:
        """Exchange peaks and switches until none is above, idle or lacking."""
        point, problem = start, self._problem
        kept_all = None
        for _ in range(MAX_EXCHANGES):
            found = self._solve(point, tolerance) if point.ratios.size else None
            if found is None or (kept_all is not None and found.course.end > kept_all.course.end):
                break
            lower, upper = problem.band
            outside = found.inner & ((found.ratios <= lower) | (found.ratios >= upper))
            kept = found.weights > 0
            ratios, values = self.peaks(found.course)
            above = values > tolerance * (1 + ABOVE)
            if not kept.all() or outside.any() or above.any():
                point = self._with_peaks(found, kept, ratios[above])
                continue
            kept_all = found
            optimum = optimum_of(found, problem.unit_pole, tolerance)
            more = lacking_switches(optimum, optimum.functionals)
            if more is None:
                break
            point = replace(found, course=course_of(more, self.slopes))
        return kept_all

    def _with_peaks(self, found: BandPoint, kept: BoolArray, above: FloatArray) -> BandPoint:
        """Return a point without idle peaks and with those above the tolerance."""
        lower, upper = self._problem.band
        held = np.clip(found.ratios, lower, upper)[kept]
        for ratio in above.tolist():
            near = np.abs(held - ratio) < SAME_PEAK * (upper - lower)
            held = np.append(held[~near], ratio)
        held = np.sort(held)
        weights = find_weights(found.course, self._problem.unit_pole, held)
        return replace(
            found,
            ratios=held,
            inner=(held > lower) & (held < upper),
            weights=np.maximum(weights, 0.0),
        )

    def _solve(self, point: BandPoint, tolerance: float) -> BandPoint | None:
        problem = self._problem
        self._budget.spend(SOLVE_WORK)
        found = solve_band_conditions(
            point, problem.unit_pole, problem.band, tolerance, self.slopes
        )
        self._budget.note(
            TraceStep(
                stage="solve",
                method="newton",
                start="cone_program",
                outcome="failed" if found is None else "solve_succeeded",
                iterations=0 if found is None else found.steps - point.steps,
                duration_s=(point if found is None else found).course.end
                / problem.natural_frequency_rad_s,
                detail=f"{point.course.switches.size} switches, {point.ratios.size} peaks",
            )
        )
        return found

    def peaks(self, course: Course) -> tuple[FloatArray, FloatArray]:
        """Return the local maxima of the residual over the band, edges included."""
        (lower, upper), pole = self._problem.band, self._problem.unit_pole
        turn = (upper - lower) * course.end
        grid = np.linspace(lower, upper, 9 + math.ceil(turn / SCAN_TURN_RAD))
        values = residuals(course, pole, grid)
        padded = np.pad(values, 1, constant_values=-math.inf)
        tops = np.flatnonzero((values >= padded[:-2]) & (values >= padded[2:]))
        pitch, ratios = grid[1] - grid[0], grid[tops]
        edges = np.array([lower, upper])
        # A peak may lie between an edge and its neighbour: it does if the residual rises inward.
        inward = growths(course, pole, edges)[0] * np.array([1, -1]) > 0
        ratios = np.append(ratios, edges[inward] + (np.array([0.5, -0.5]) * pitch)[inward])
        moving = (ratios > lower) & (ratios < upper)
        for _ in range(PEAK_STEPS):
            slope, bend = growths(course, pole, ratios)
            falling = moving & (bend < 0)
            step = np.where(falling, -slope / np.where(falling, bend, 1.0), 0.0)
            ratios = np.clip(ratios + np.clip(step, -pitch, pitch), lower, upper)
        return ratios, residuals(course, pole, ratios)
