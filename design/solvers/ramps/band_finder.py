"""The search for a course over a band, of any sort: structures, and what of them is exchanged."""

import math
from collections.abc import Hashable, Iterable, Iterator
from typing import ClassVar, Generic, Protocol

import numpy as np

from design.formulations.ramped_band import RampedBandProblem
from design.solvers.budget import Budget
from design.solvers.convex_band.duration import ripples_of
from design.solvers.convex_band.peaks import SCAN_TURN_RAD
from design.solvers.ramps.band_optimality import (
    BandPoint,
    growths,
    point_at,
    residuals,
    solve_band_conditions,
)
from design.solvers.ramps.band_structure import BandCourse, start_of
from design.solvers.ramps.movable import AnyCourse
from design.trace import TraceStep
from design.types import FloatArray

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

SAME_DIGITS = 3
"""Digits of ratios to which peaks are compared with those tried before."""

SAME_PEAK = 0.02
"""Share of the band within which two peaks are one [-]."""

MIN_FOLLOWED_STEP = 2e-3
"""Relative step of the tolerance below which an optimum cannot be followed on [-]."""

PEAK_STEPS = 4
"""Newton's steps to a peak from the highest of three neighbours."""


class Ways(Protocol[AnyCourse]):
    """How courses of one sort are found, and what of a stationary one is not optimal."""

    SOLVE_WORK: ClassVar[float]
    """Work of solving the conditions once, and looking for peaks [units]."""

    def least(self, duration: float, fineness: float) -> BandCourse[AnyCourse] | None:
        """Return the course of least residual, on a grid.

        Parameters
        ----------
        duration
            Its end [rad].
        fineness
            How many times finer than the first the grid of time is [-].

        Returns
        -------
        BandCourse or None
            None where there is none: no course is as short.
        """

    def moved(self, course: AnyCourse, moves: FloatArray) -> AnyCourse:
        """Return the course with its times moved, or nearly so.

        Parameters
        ----------
        course
            The course.
        moves
            Of its times, shape (n,) [rad].

        Returns
        -------
        AnyCourse
            Within all limits.
        """

    def within_limits(self, found: BandPoint[AnyCourse]) -> list[AnyCourse] | None:
        """Return what to try where one passes limits; None if not."""

    def lacking(self, found: BandPoint[AnyCourse]) -> Iterator[AnyCourse]:
        """Yield courses with what one lacks; none if it is optimal."""

    def instead(self, failed: BandPoint[AnyCourse]) -> Iterator[AnyCourse]:
        """Yield what to try where none of a structure is stationary."""


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


def _named(point: BandPoint[AnyCourse]) -> Hashable:
    """Return the structure of a point and about where its peaks are."""
    return point.course.structure, tuple(np.round(point.ratios, SAME_DIGITS).tolist())


class BandFinder(Generic[AnyCourse]):
    """The search for courses of one sort, which counts its work and notes its steps.

    Parameters
    ----------
    problem
        The band, and the limits.
    ways
        How courses are found.
    budget
        What the search may do.
    """

    def __init__(self, problem: RampedBandProblem, ways: Ways[AnyCourse], budget: Budget) -> None:
        self.programs = 0
        self._problem, self._ways, self._budget = problem, ways, budget

    def points(
        self, alone: AnyCourse, duration: float, lowest: float | None = None
    ) -> Iterator[BandPoint[AnyCourse]]:
        """Yield courses that keep the tolerance and may be optimal.

        Parameters
        ----------
        alone
            A ramp without a switch more: where it keeps the tolerance nothing is faster.
        duration
            The first that is tried [rad].
        lowest
            One that is too short, if not only the ramp is known to be so [rad].

        Yields
        ------
        BandPoint
            With weights and prices.
        """
        problem = self._problem
        if self.peaks(alone)[1].max() <= problem.tolerance:
            yield point_at(alone, problem.unit_pole, np.zeros(0), np.zeros(0, dtype=bool))
            return
        wanted = ripples_of(problem.tolerance)
        for fineness, followed in PASSES:
            low, high = alone.end if lowest is None else lowest, math.inf
            before: tuple[float, float] | None = None
            for _ in range(MAX_DURATIONS):
                if self._budget.spent:
                    return
                found = self._least(duration, fineness)
                ripples = ripples_of(1.0 if found is None else found.largest)
                if found is not None and abs(ripples - wanted) < NEAR * wanted:
                    start = start_of(problem, found, self._ways.moved, self._budget)
                    if start is not None:
                        yield from self.from_start(*start, followed)
                low, high = (max(low, duration), high) if ripples < wanted else (low, duration)
                now = (duration, ripples)
                duration = _next_duration(before, now, wanted, low, high)
                before = now
                if high - low < CLOSE * low:
                    break

    def _least(self, duration: float, fineness: float) -> BandCourse[AnyCourse] | None:
        problem = self._problem
        self.programs += 1
        found = self._ways.least(duration, fineness)
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

    def from_start(
        self, start: BandPoint[AnyCourse], largest: float, followed: float
    ) -> Iterator[BandPoint[AnyCourse]]:
        """Yield what the conditions of optimality make of a start, if anything.

        Parameters
        ----------
        start
            A structure and peaks.
        largest
            Its largest residual [-].
        followed
            The largest relative distance of two tolerances between which it is followed [-].

        Yields
        ------
        BandPoint
            At most one.
        """
        problem = self._problem
        aim = problem.tolerance * (1 - DESIGN_MARGIN)
        found = self._exchange(start, aim)
        if found is None and abs(math.log(largest / aim)) < followed:
            found = self._follow(start, largest, aim)
        if found is None and self.peaks(start.course)[1].max() <= problem.tolerance:
            found = start  # a little later than the optimum, and good for a bound all the same
        if found is not None:
            yield found

    def _follow(
        self, start: BandPoint[AnyCourse], largest: float, tolerance: float
    ) -> BandPoint[AnyCourse] | None:
        """Follow an optimum from the residual that its end allows to the tolerance."""
        now: BandPoint[AnyCourse] | None = self._exchange(start, largest)
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

    def _exchange(
        self, start: BandPoint[AnyCourse], tolerance: float
    ) -> BandPoint[AnyCourse] | None:
        """Exchange peaks and times until none is above, idle or lacking."""
        waiting, kept_all = [start], None
        tried: set[Hashable] = set()
        for _ in range(MAX_EXCHANGES):
            if not waiting:
                break
            point = waiting.pop(0)
            tried.add(_named(point))
            found = self._solve(point, tolerance) if point.ratios.size else None
            if found is None:
                waiting += self._with_courses(point, self._ways.instead(point), tried)
                continue
            instead = self._ways.within_limits(found)
            if instead is not None:
                waiting = [*self._with_courses(found, instead, tried), *waiting]
                continue
            if kept_all is not None and found.course.end > kept_all.course.end:
                continue
            exchanged = self._with_peaks(found, tolerance)
            if exchanged is not None:
                waiting = [exchanged, *waiting]
                continue
            kept_all = found
            lacking = [*self._ways.lacking(found)]
            if not lacking:
                break
            waiting = [*self._with_courses(found, lacking, tried), *waiting]
        return kept_all

    def _with_courses(
        self,
        near: BandPoint[AnyCourse],
        courses: Iterable[AnyCourse],
        tried: set[Hashable],
    ) -> list[BandPoint[AnyCourse]]:
        """Return courses with the peaks of one near them, those of structures not yet tried."""
        pole = self._problem.unit_pole
        points = [point_at(course, pole, near.ratios, near.inner) for course in courses]
        return [point for point in points if _named(point) not in tried]

    def _with_peaks(
        self, found: BandPoint[AnyCourse], tolerance: float
    ) -> BandPoint[AnyCourse] | None:
        """Return a point without idle peaks and with those above; None if there are none."""
        lower, upper = self._problem.band
        outside = found.inner & ((found.ratios <= lower) | (found.ratios >= upper))
        kept = found.weights > 0
        ratios, values = self.peaks(found.course)
        above = values > tolerance * (1 + ABOVE)
        if kept.all() and not outside.any() and not above.any():
            return None
        held = np.clip(found.ratios, lower, upper)[kept]
        for ratio in ratios[above].tolist():
            near = np.abs(held - ratio) < SAME_PEAK * (upper - lower)
            held = np.append(held[~near], ratio)
        held = np.sort(held)
        inner = (held > lower) & (held < upper)
        return point_at(found.course, self._problem.unit_pole, held, inner)

    def _solve(self, point: BandPoint[AnyCourse], tolerance: float) -> BandPoint[AnyCourse] | None:
        problem = self._problem
        self._budget.spend(self._ways.SOLVE_WORK)
        found = solve_band_conditions(point, problem.unit_pole, problem.band, tolerance)
        self._budget.note(
            TraceStep(
                stage="solve",
                method="newton",
                start="cone_program",
                outcome="failed" if found is None else "solve_succeeded",
                iterations=0 if found is None else found.steps - point.steps,
                duration_s=(point if found is None else found).course.end
                / problem.natural_frequency_rad_s,
                detail=f"{point.course.gaps.size + 1} times, {point.ratios.size} peaks",
            )
        )
        return found

    def peaks(self, course: AnyCourse) -> tuple[FloatArray, FloatArray]:
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
