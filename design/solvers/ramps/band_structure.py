"""How the fastest course over a band may lie: a cone program over grids of time and ratio."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic

import numpy as np

from design.formulations.ramped_band import RampedBandProblem
from design.solvers import clarabel
from design.solvers.budget import Budget
from design.solvers.clarabel import ConeProgram, CourseSteps
from design.solvers.convex_band.grid import MIN_RATIOS, PRESENT_WEIGHT, RATIOS_PER_PEAK, clusters
from design.solvers.outcome import Status
from design.solvers.ramps.band_optimality import (
    BandPoint,
    band_functionals,
    point_at,
    residuals,
)
from design.solvers.ramps.band_polish import polish
from design.solvers.ramps.course import Course, Slopes, course_of
from design.solvers.ramps.movable import AnyCourse
from design.solvers.ramps.structure import GridCourse, count_cells, switches_of
from design.types import FloatArray

DIPS = 24
"""Places of a dip that are compared."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BandCourse(Generic[AnyCourse]):
    """The course on a grid with the least residual over a band.

    Attributes
    ----------
    largest
        The largest residual on the grid [-].
    course
        The course of its switches.
    cell
        Distance of two times of the grid [rad].
    ratios
        Grid of the band, ascending, shape (k,) [-].
    """

    largest: float
    course: AnyCourse
    cell: float
    ratios: FloatArray


def ratios_of(problem: RampedBandProblem, duration: float) -> FloatArray:
    """Return a grid of the band, fine against the turn of a duration.

    Parameters
    ----------
    problem
        The band.
    duration
        Length of a course [rad].

    Returns
    -------
    FloatArray
        Ascending, edges included, shape (k,) [-].
    """
    lower, upper = problem.band
    turns = (upper - lower) * duration / math.pi
    return np.linspace(lower, upper, MIN_RATIOS + math.ceil(RATIOS_PER_PEAK * turns))


def least_course(
    problem: RampedBandProblem, slopes: Slopes, duration: float, fineness: float, budget: Budget
) -> BandCourse[Course] | None:
    """Return the course of a duration of least residual over the band.

    Parameters
    ----------
    problem, slopes
        The band, and the limits of the slope.
    duration
        End of the course [rad].
    fineness
        How many times finer than the first the grid of time is [-].
    budget
        The work is counted in it.

    Returns
    -------
    BandCourse or None
        None where Clarabel finds none: no course is as short.
    """
    ratios = ratios_of(problem, duration)
    functionals = band_functionals(problem.unit_pole, ratios)
    cells = count_cells(functionals, duration, fineness)
    cell = duration / cells
    integrals = functionals.integrals(np.linspace(0, duration, cells + 1))
    weights = np.diff(integrals, axis=1) / cell * functionals.scales(duration)[:, None]
    of_levels = weights - np.append(weights[:, 1:], np.zeros((ratios.size, 1)), axis=1)
    steps = CourseSteps(rise=slopes.up * cell, fall=slopes.down * cell, last=1.0)
    program = ConeProgram(
        offset=of_levels[:, -1],
        rows=of_levels[:, :-1],
        lowest=0.0,
        highest=1.0,
        unit_sum=False,
        steps=steps,
    )
    outcome = clarabel.solve(program)
    budget.spend(clarabel.work_of(program, outcome))
    if outcome.status is not Status.SOLVE_SUCCEEDED:
        return None
    levels = np.concatenate(([0.0], outcome.unknowns, [1.0]))
    grid_course = GridCourse(violation=0.0, levels=levels, cell=cell)
    course = course_of(switches_of(grid_course, slopes), slopes)
    if course.switches.size < 3:  # noqa: PLR2004 - a ramp alone has nothing to solve
        dipped = _dipped(problem, slopes, duration, ratios)
        course = course if dipped is None else dipped
    return BandCourse(largest=outcome.largest, course=course, cell=cell, ratios=ratios)


def start_of(
    problem: RampedBandProblem,
    found: BandCourse[AnyCourse],
    moved: Callable[[AnyCourse, FloatArray], AnyCourse],
    budget: Budget,
) -> tuple[BandPoint[AnyCourse], float] | None:
    """Polish the course of a grid and find the peaks that touch.

    Parameters
    ----------
    problem
        The band.
    found
        What the cone program found.
    moved
        The course within all limits with its times moved, or nearly so.
    budget
        The work is counted in it.

    Returns
    -------
    tuple of BandPoint and float, or None
        A start for Newton's method, and its largest residual [-]; None where there is none.
    """
    polished = polish(found.course, moved, problem.unit_pole, found.ratios, found.cell, budget)
    if polished is None:
        return None
    ratios, _ = clusters(found.ratios, polished.weights, PRESENT_WEIGHT)
    # A peak so near the edge that the grid cannot tell the two apart sits on the edge.
    low_edge = ratios < found.ratios[:2].mean()
    high_edge = ratios > found.ratios[-2:].mean()
    ratios[low_edge], ratios[high_edge] = found.ratios[0], found.ratios[-1]
    inner = ~(low_edge | high_edge)
    return point_at(polished.course, problem.unit_pole, ratios, inner), polished.largest


def _dipped(
    problem: RampedBandProblem, slopes: Slopes, duration: float, ratios: FloatArray
) -> Course | None:
    """Return the ramp with one dip, of the same end and least residual.

    It is shorter than a cell of the grid, which shows no switch.
    """
    dip = (duration - 1 / slopes.up) / (1 + slopes.down / slopes.up)
    earliest, latest = dip * slopes.down / slopes.up, 1 / slopes.up
    if dip <= 0 or earliest >= latest:
        return None
    courses = [
        course_of(np.array([0.0, begin, begin + dip]), slopes)
        for begin in np.linspace(earliest, latest, DIPS + 2)[1:-1].tolist()
    ]
    return min(courses, key=lambda one: float(residuals(one, problem.unit_pole, ratios).max()))
