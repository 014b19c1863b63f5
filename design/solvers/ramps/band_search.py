"""The fastest course of limited slope over a band: how its structures are found and exchanged."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import ClassVar

import numpy as np

from design.formulations.ramped_band import RampedBandProblem
from design.solvers.budget import Budget
from design.solvers.ramps.band_finder import BandFinder
from design.solvers.ramps.band_optimality import BandPoint, optimum_of
from design.solvers.ramps.band_structure import BandCourse, least_course
from design.solvers.ramps.course import Course, Slopes, course_of
from design.solvers.ramps.exchange import lacking_switches
from design.solvers.ramps.optimality import RampedOptimum
from design.types import FloatArray


class StraightWays:
    """Courses of limited slope."""

    SOLVE_WORK: ClassVar[float] = 5000.0

    def __init__(self, problem: RampedBandProblem, budget: Budget) -> None:
        self.slopes = Slopes(up=1 / problem.ramps_rad[0], down=1 / problem.ramps_rad[1])
        self._problem, self._budget = problem, budget

    def least(self, duration: float, fineness: float) -> BandCourse[Course] | None:
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
        return least_course(self._problem, self.slopes, duration, fineness, self._budget)

    def moved(self, course: Course, moves: FloatArray) -> Course:
        """Return the course with its switches moved.

        Parameters
        ----------
        course
            The course.
        moves
            Of its times, shape (n,) [rad].

        Returns
        -------
        Course
            Within all limits.
        """
        return course.moved(moves)

    def within_limits(self, _: BandPoint[Course], /) -> None:
        """Return None: any switches are within the limits."""

    def lacking(self, found: BandPoint[Course]) -> Iterator[Course]:
        """Yield the course with two switches that it lacks, if any."""
        optimum = optimum_of(found, self._problem.unit_pole, self._problem.tolerance)
        more = lacking_switches(optimum, optimum.functionals)
        if more is not None:
            yield course_of(more, self.slopes)

    def instead(self, _: BandPoint[Course], /) -> Iterator[Course]:
        """Yield nothing: another duration shows another structure."""
        yield from ()


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
    ways = StraightWays(problem, budget)
    search = BandFinder(problem, ways, budget)
    alone = course_of(np.zeros(1), ways.slopes)
    for found in search.points(alone, max(problem.ramps_rad[0], math.pi)):
        optimum = optimum_of(found, problem.unit_pole, problem.tolerance)
        seed = "cone_program" if found.ratios.size else "one_ramp"
        yield replace(optimum, programs=search.programs, seed=seed)
