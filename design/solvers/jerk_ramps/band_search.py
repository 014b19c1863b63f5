"""The fastest course over a band behind a limit to the jerk: as without it, by other structures.

Without the limit the fastest ends a little earlier. Where the time to the steepest slope is short
the command that it follows is a start; else a cone program over a time grid shows one.
"""

import math
from collections.abc import Iterator
from typing import ClassVar

import numpy as np

from design.formulations.ramped_band import RampedBandProblem
from design.solvers import clarabel
from design.solvers.budget import Budget
from design.solvers.clarabel import ConeProgram, CourseSteps, Levels
from design.solvers.jerk_ramps.events import EventCourse, Limits, second_integrals
from design.solvers.jerk_ramps.exchange import signs_broken, staying, within_limits, without_touches
from design.solvers.jerk_ramps.following import course_following
from design.solvers.jerk_ramps.grid import GridCourse, switches_of
from design.solvers.jerk_ramps.optimality import Stationary
from design.solvers.jerk_ramps.rules import Weighed, entering_pieces
from design.solvers.jerk_ramps.search import JerkOptimum
from design.solvers.outcome import Status
from design.solvers.ramps.band_finder import BandFinder
from design.solvers.ramps.band_optimality import (
    BandPoint,
    band_functionals,
    multipliers_of,
    peak_changes,
    point_at,
)
from design.solvers.ramps.band_structure import BandCourse, ratios_of
from design.solvers.ramps.functionals import Functionals
from design.solvers.ramps.optimality import RampedOptimum
from design.solvers.ramps.structure import count_cells
from design.types import FloatArray

CELLS_PER_TURN = 80
"""Cells of the first cone program, to a period of the mode: with half as many, switches of short
jerk times are read so wrong that Newton's method fails more often [-]."""

MIN_CELLS = 160
"""Cells of the first cone program, at least [-]."""

SHORT_RAD = 0.3
"""Time to the steepest slope up to which the command without a limit to the jerk is a start
[rad]."""

LATER = 0.45
"""Of the time in which the slope turns at the limit of the jerk, by about what share the end is
later than without it [-]."""

FOLLOWED = 0.5
"""Largest relative distance of two tolerances between which that start is followed [-]."""


def candidates(
    problem: RampedBandProblem,
    limits: Limits,
    straight: tuple[RampedOptimum, float] | None,
    budget: Budget,
) -> Iterator[JerkOptimum]:
    """Yield courses that keep the tolerance and may be optimal.

    Parameters
    ----------
    problem
        The band. Its horizon is not heeded: what is beyond it is refused with its bound.
    limits
        Of slope and jerk.
    straight
        The fastest without a limit to the jerk, and an end before which there is none [rad].
    budget
        What the search may do.

    Yields
    ------
    JerkOptimum
        As reported by Newton's method; the caller stops at one that is proven.
    """
    ways = SmoothWays(problem, limits, budget)
    search = BandFinder(problem, ways, budget)
    alone = course_following(np.zeros(1), limits)
    turning = (limits.up + limits.down) / limits.jerk
    lowest, duration = alone.end, max(alone.end, math.pi)
    if straight is not None:
        fastest, bound = straight
        lowest = max(lowest, bound)
        duration = max(alone.end, fastest.end + LATER * turning)
        if max(limits.up, limits.down) / limits.jerk < SHORT_RAD:
            start = _start(problem, fastest, limits)
            largest = float(search.peaks(start.course)[1].max())
            for found in search.from_start(start, largest, FOLLOWED):
                yield ways.optimum(found, search.programs, "without_jerk_limit")
    for found in search.points(alone, duration, lowest):
        seed = "cone_program" if found.ratios.size else "one_ramp"
        yield ways.optimum(found, search.programs, seed)


def _start(
    problem: RampedBandProblem, straight: RampedOptimum, limits: Limits
) -> BandPoint[EventCourse]:
    """Return the course under the command of one without a limit to the jerk, and its peaks."""
    course = course_following(straight.course.switches, limits)
    ratios = (straight.functionals.poles / problem.unit_pole).real
    lower, upper = problem.band
    return point_at(course, problem.unit_pole, ratios, (ratios > lower) & (ratios < upper))


class SmoothWays:
    """Courses of limited slope and jerk.

    Parameters
    ----------
    problem
        The band.
    limits
        Of slope and jerk.
    budget
        What the search may do.
    """

    SOLVE_WORK: ClassVar[float] = 15_000.0

    def __init__(self, problem: RampedBandProblem, limits: Limits, budget: Budget) -> None:
        self._problem, self._limits, self._budget = problem, limits, budget

    def least(self, duration: float, fineness: float) -> BandCourse[EventCourse] | None:
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
        ratios = ratios_of(self._problem, duration)
        functionals = band_functionals(self._problem.unit_pole, ratios)
        cells = count_cells(
            functionals, duration, fineness, per_turn=CELLS_PER_TURN, fewest=MIN_CELLS
        )
        times, cell = np.linspace(0, duration, cells + 1), duration / cells
        weights = np.diff(second_integrals(functionals, times), n=2, axis=1) / cell
        most = self._limits.jerk * cell
        program = ConeProgram(
            offset=np.zeros(ratios.size, dtype=np.complex128),
            rows=weights * functionals.scales(duration)[:, None],
            lowest=-self._limits.down,
            highest=self._limits.up,
            unit_sum=False,
            steps=CourseSteps(rise=most, fall=most, last=0.0),
            levels=Levels(cell=cell, last=1.0),
        )
        outcome = clarabel.solve(program)
        self._budget.spend(clarabel.work_of(program, outcome))
        if outcome.status is not Status.SOLVE_SUCCEEDED:
            return None
        slopes = np.concatenate(([0.0], outcome.unknowns, [0.0]))
        grid_course = GridCourse(violation=0.0, slopes=slopes, cell=cell)
        switches = switches_of(grid_course, self._limits)
        if switches.size % 2 == 0:
            switches = np.zeros(1)
        course = course_following(switches, self._limits)
        return BandCourse(largest=outcome.largest, course=course, cell=cell, ratios=ratios)

    def moved(self, course: EventCourse, moves: FloatArray) -> EventCourse:
        """Return the course of the command with its events moved.

        Parameters
        ----------
        course
            The course.
        moves
            Of its times, shape (n,) [rad].

        Returns
        -------
        EventCourse
            Within all limits.
        """
        return course_following(course.moved(moves).switches, self._limits)

    def within_limits(self, found: BandPoint[EventCourse]) -> list[EventCourse] | None:
        """Return what to try where one passes limits; None if not."""
        return within_limits(found.course)

    def lacking(self, found: BandPoint[EventCourse]) -> Iterator[EventCourse]:
        """Yield courses with what one lacks; none if it is optimal."""
        yield from signs_broken(*self._stationary(found))

    def instead(self, failed: BandPoint[EventCourse]) -> Iterator[EventCourse]:
        """Yield what to try where a touch of 0 or 1 is one too many."""
        pole = self._problem.unit_pole
        changes, multipliers = peak_changes(failed.course, pole, failed.ratios)
        weighed = Weighed(changes=changes[:, 1:], multipliers=multipliers)
        functionals = band_functionals(pole, failed.ratios)
        yield from entering_pieces(failed.course, functionals, weighed)
        yield from staying(failed.course)
        yield from without_touches(failed.course)

    def _stationary(self, found: BandPoint[EventCourse]) -> tuple[Stationary, Functionals]:
        """Return a course as one of targets that the peaks are, and what these are linear in."""
        functionals, multipliers, worth = multipliers_of(found, self._problem.unit_pole)
        stationary = Stationary(
            course=found.course,
            multipliers=multipliers,
            prices=found.prices / worth,
            iterations=found.steps,
        )
        return stationary, functionals

    def optimum(self, found: BandPoint[EventCourse], programs: int, seed: str) -> JerkOptimum:
        """Return a course with what excludes shorter ones.

        Parameters
        ----------
        found
            A point that meets the conditions.
        programs
            Cone programs until then.
        seed
            Name of the start.

        Returns
        -------
        JerkOptimum
            With the multipliers of its peaks.
        """
        stationary, functionals = self._stationary(found)
        return JerkOptimum(
            found=stationary,
            functionals=functionals,
            targets=np.zeros_like(stationary.multipliers),
            tolerance=self._problem.tolerance,
            iterations=found.steps,
            programs=programs,
            seed=seed,
        )
