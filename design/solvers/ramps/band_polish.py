"""The switches of a grid's course moved to where they leave least over a band, the end kept.

A step is a cone program of the residual's vectors, linear in the switches. What that neglects is
small against the residual's own turn, so that a few steps are as good as many more cells.
"""

from dataclasses import dataclass

import numpy as np

from design.solvers import clarabel
from design.solvers.budget import Budget
from design.solvers.clarabel import ConeProgram
from design.solvers.outcome import Status
from design.solvers.ramps.band_optimality import band_functionals, residuals
from design.solvers.ramps.course import Course, Slopes, course_of
from design.types import FloatArray

MAX_POLISHED = 12
"""Steps at most."""

SHRINKS = 3.0
"""By how much the radius shrinks after a step that gains nothing [-]."""

MIN_RADIUS = 1e-4
"""Share of the first radius at which the steps end [-]."""

GAINED = 1e-4
"""Share of the residual that the last step gained, at most [-]."""

KEPT_GAP = 0.8
"""Share of a gap that one step closes at most [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Polished:
    """The course of least residual over a band, of its structure and end.

    Attributes
    ----------
    course
        The course.
    largest
        The largest residual at the ratios [-].
    weights
        What the bound of each ratio costs, shape (k,).
    """

    course: Course
    largest: float
    weights: FloatArray


def polish(
    course: Course,
    unit_pole: complex,
    ratios: FloatArray,
    slopes: Slopes,
    radius: float,
    budget: Budget,
) -> Polished | None:
    """Move the switches of a course to where they leave least, its end kept.

    Parameters
    ----------
    course
        Where to begin.
    unit_pole, ratios
        The mode's pole over its natural frequency, and where residuals count, shape (k,) [-].
    slopes
        Limits of the slope.
    radius
        How far a switch moves in the first step, at most [rad].
    budget
        The work is counted in it.

    Returns
    -------
    Polished or None
        None where Clarabel fails at once.
    """
    last_radius = MIN_RADIUS * radius
    largest = float(residuals(course, unit_pole, ratios).max())
    found = None
    for _ in range(MAX_POLISHED):
        step = _step(course, unit_pole, ratios, radius, budget)
        if step is None:
            break
        moves, weights = step
        gaps, closing = np.diff(course.switches), np.diff(moves, prepend=0.0)
        shrinking = closing < 0
        share = KEPT_GAP * float(np.min(-gaps[shrinking] / closing[shrinking], initial=2.0))
        following = course_of(course.switches + np.append(0.0, min(1.0, share) * moves), slopes)
        left = float(residuals(following, unit_pole, ratios).max())
        if left < largest:
            gained = largest - left
            course, largest = following, left
            found = Polished(course=course, largest=largest, weights=weights)
            if gained < GAINED * largest:
                break
        else:
            radius /= SHRINKS
            if found is None:
                found = Polished(course=course, largest=largest, weights=weights)
        if radius < last_radius:
            break
    return found


def _step(
    course: Course, unit_pole: complex, ratios: FloatArray, radius: float, budget: Budget
) -> tuple[FloatArray, FloatArray] | None:
    """Return the step of the switches after the first that keeps the end, and the weights."""
    functionals = band_functionals(unit_pole, ratios)
    turn = np.exp(functionals.poles * course.end)
    changes = turn[:, None] * course.changes(functionals)[:, 1:]
    ends = course.end_changes()[1:]
    # The last switch always moves the end: it makes up for what the others do to it.
    makes_up = -ends[:-1] / ends[-1]
    program = ConeProgram(
        offset=turn * course.values(functionals),
        rows=radius * (changes[:, :-1] + np.multiply.outer(changes[:, -1], makes_up)),
        lowest=-1.0,
        highest=1.0,
        unit_sum=False,
    )
    outcome = clarabel.solve(program)
    budget.spend(clarabel.work_of(program, outcome))
    if outcome.status is not Status.SOLVE_SUCCEEDED:
        return None
    moves = radius * outcome.unknowns
    return np.append(moves, makes_up @ moves), outcome.weights
