"""The times of a grid's course moved to where they leave least over a band, the end kept.

A step is a cone program of the residual's vectors, linear in the times. What that neglects is
small against the residual's own turn, so that a few steps are as good as many more cells.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic

import numpy as np

from design.solvers import clarabel
from design.solvers.budget import Budget
from design.solvers.clarabel import ConeProgram
from design.solvers.outcome import Status
from design.solvers.ramps.band_optimality import band_functionals, residuals
from design.solvers.ramps.movable import AnyCourse, Movable, kept_share
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

NEGLIGIBLE = 1e-10
"""Share of the largest singular value below which what is held is held already [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Polished(Generic[AnyCourse]):
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

    course: AnyCourse
    largest: float
    weights: FloatArray


def polish(
    course: AnyCourse,
    moved: Callable[[AnyCourse, FloatArray], AnyCourse],
    unit_pole: complex,
    ratios: FloatArray,
    radius: float,
    budget: Budget,
) -> Polished[AnyCourse] | None:
    """Move the times of a course to where they leave least, its end kept.

    Parameters
    ----------
    course
        Where to begin.
    moved
        The course within all limits with its times moved, or nearly so.
    unit_pole, ratios
        The mode's pole over its natural frequency, and where residuals count, shape (k,) [-].
    radius
        How far a time moves in the first step, about and at most [rad].
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
        share = kept_share(course.gaps, moves, KEPT_GAP)
        following = moved(course, np.append(0.0, share * moves))
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
    course: Movable, unit_pole: complex, ratios: FloatArray, radius: float, budget: Budget
) -> tuple[FloatArray, FloatArray] | None:
    """Return the step of the times after the first that keeps the end, and the weights."""
    functionals = band_functionals(unit_pole, ratios)
    turn = np.exp(functionals.poles * course.end)
    ways = _ways_that_keep_the_end(course)
    if not ways.size:
        return None
    program = ConeProgram(
        offset=turn * course.values(functionals),
        rows=radius * turn[:, None] * course.changes(functionals)[:, 1:] @ ways,
        lowest=-1.0,
        highest=1.0,
        unit_sum=False,
    )
    outcome = clarabel.solve(program)
    budget.spend(clarabel.work_of(program, outcome))
    if outcome.status is not Status.SOLVE_SUCCEEDED:
        return None
    return radius * ways @ outcome.unknowns, outcome.weights


def _ways_that_keep_the_end(course: Movable) -> FloatArray:
    """Return how the times after the first may move, shape (n - 1, f): end and structure stay."""
    held = np.vstack((course.condition_changes, course.end_changes()))[:, 1:]
    _, sizes, directions = np.linalg.svd(held)
    rank = int(np.count_nonzero(sizes > NEGLIGIBLE * sizes.max(initial=0.0)))
    ways: FloatArray = directions[rank:].T
    return ways
