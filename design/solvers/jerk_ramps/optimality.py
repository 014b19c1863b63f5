"""Newton's method on the conditions of optimality of a course of limited jerk.

Of all courses that meet the targets within the limits, the one that ends first has multipliers c of
the targets and prices of the conditions of its structure for which the end, with all of them added,
does not change with any event. In words: ``P(t) = Re sum conj(c_k) kernel_k(t)``, and N, the price
of the level at the end of a group. A function y with ``y' = P + N`` is zero where the jerk changes,
positive where it is at its upper limit and negative at the lower.
"""

from dataclasses import dataclass

import numpy as np

from design.solvers.jerk_ramps.events import EventCourse
from design.solvers.least_squares import least_squares
from design.solvers.ramps.functionals import Functionals
from design.types import ComplexArray, FloatArray

NEWTON_STEPS = 25

CONVERGED = 1e-12
"""Step of the events after which the next is rounding [rad]."""

FARTHEST_STEP_RAD = 0.3
"""Largest step of an event [rad]."""

MET = 1e-10
"""Largest miss of a target that counts as none, over the unshaped step [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stationary:
    """A course that meets its targets, and whose end no small change of it makes earlier.

    Attributes
    ----------
    course
        The course; an interval between two events may be negative, of a structure that is not
        the optimum's.
    multipliers
        c, shape (m,).
    prices
        Of the conditions of the structure, shape (c,).
    iterations
        Steps of Newton's method.
    """

    course: EventCourse
    multipliers: ComplexArray
    prices: FloatArray
    iterations: int


def solve_structure(
    course: EventCourse, functionals: Functionals, targets: ComplexArray
) -> Stationary | None:
    """Solve the conditions of optimality of one structure.

    By Newton's method, from a course near it.

    Parameters
    ----------
    course
        Where to begin.
    functionals, targets
        What is to be met, shape (m,).

    Returns
    -------
    Stationary or None
        None where Newton's method fails.
    """
    multipliers, prices = find_multipliers(course, functionals)
    iterations, settled = 0, False
    while not settled and iterations < NEWTON_STEPS:
        iterations += 1
        system, values = _conditions(course, functionals, targets, multipliers, prices)
        step = least_squares(system, -values, 1e-13)
        moves = step[: course.times.size - 1]
        farthest = float(np.abs(moves).max(initial=0.0))
        if not np.isfinite(step).all():
            return None
        share = min(1.0, FARTHEST_STEP_RAD / max(farthest, FARTHEST_STEP_RAD))
        course = course.moved(share * np.append(0.0, moves))
        count, m = moves.size, functionals.poles.size
        real, imaginary = step[count : count + m], step[count + m : count + 2 * m]
        multipliers = multipliers + share * (real + 1j * imaginary)
        prices = prices + share * step[count + 2 * m :]
        settled = share == 1 and farthest < CONVERGED * max(1.0, course.end)
    missed = np.abs(course.values(functionals) - targets) * functionals.scales(course.end)
    if not (missed.max() < MET and np.abs(course.conditions).max() < MET):
        return None
    multipliers, prices = find_multipliers(course, functionals)
    return Stationary(course=course, multipliers=multipliers, prices=prices, iterations=iterations)


def find_multipliers(
    course: EventCourse, functionals: Functionals
) -> tuple[ComplexArray, FloatArray]:
    """Return the multipliers and prices that fit a course best.

    Parameters
    ----------
    course
        The course.
    functionals
        What counts.

    Returns
    -------
    tuple of ComplexArray and FloatArray
        c, shape (m,), and the prices of the conditions, shape (c,).
    """
    changes = course.changes(functionals)[:, 1:]
    rows = np.vstack((changes.real, changes.imag, course.condition_changes[:, 1:]))
    ends = np.zeros(rows.shape[1])
    ends[-1] = -1.0
    found = least_squares(rows.T, ends)
    m = functionals.poles.size
    return found[:m] + 1j * found[m : 2 * m], found[2 * m :]


def _conditions(
    course: EventCourse,
    functionals: Functionals,
    targets: ComplexArray,
    multipliers: ComplexArray,
    prices: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the matrix of Newton's method and what is not met.

    Unknown are the events after the first, then real and imaginary parts of c, then the prices.
    """
    scales = functionals.scales(course.end)
    missed = (course.values(functionals) - targets) * scales
    changes = course.changes(functionals)[:, 1:]
    scaled = changes * scales[:, None]
    limits = course.condition_changes[:, 1:]
    rows = np.vstack((scaled.real, scaled.imag, limits))
    m, n, c = functionals.poles.size, course.times.size - 1, prices.size
    system = np.zeros((2 * m + c + n, n + 2 * m + c))
    system[: 2 * m + c, :n] = rows
    bends = course.bends(functionals, multipliers) + course.condition_bends(prices)
    system[2 * m + c :, :n] = bends[1:, 1:]
    system[2 * m + c :, n:] = np.vstack((changes.real, changes.imag, limits)).T
    still = (multipliers.conj() @ changes).real + prices @ limits
    still[-1] += 1.0
    return system, np.concatenate((missed.real, missed.imag, course.conditions, still))
