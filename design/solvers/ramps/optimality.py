"""Newton's method on the conditions of optimality: the switches and their multipliers at once.

Of a course that meets its targets and ends first, a small change of the switches that keeps the
targets does not end earlier: ``Re sum conj(c_k) dF_k/dt_i + dT/dt_i = 0`` for some c. In words, the
function ``P(t) = Re sum conj(c_k) kernel_k(t)``, shifted by a constant in each group of switches,
is zero where the slope changes.
"""

import math
from dataclasses import dataclass

import numpy as np

from design.solvers.least_squares import evened_least_squares, least_squares
from design.solvers.ramps.course import Course, Slopes, course_of
from design.solvers.ramps.functionals import Functionals
from design.types import ComplexArray, FloatArray

NEWTON_STEPS = 40

CONVERGED = 1e-12
"""Step of the switches after which the next is rounding, over the shortest gap or 1 rad [-]."""

ROUNDING = 4e-16
"""Rounding of a switch, over the duration [-]."""

FARTHEST_STEP_RAD = 0.5
"""Largest step of a switch [rad]."""

MET = 1e-10
"""Largest miss of a target that counts as none, beside what the rounding of switches makes, over
the unshaped step [-]."""

MIN_GAP_RAD, MIN_GAP_RAMPS = 1e-9, 1e-3
"""Switches closer than this, or than this share of the shorter ramp, are one [rad], [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RampedOptimum:
    """A course that meets its targets, and the multipliers that exclude shorter ones.

    ``|F_k - g_k| exp(Re(s_k) T)`` is at most the tolerance, 0 where targets are met exactly.

    Attributes
    ----------
    course
        The course.
    functionals, targets, tolerance
        F, g, shape (m,), and the tolerance [-].
    multipliers
        c, shape (m,): ``-Re conj(c) dF`` is by how much the end moves with the targets.
    iterations
        Steps of Newton's method.
    programs
        Linear programs until then.
    seed
        Name of the start.
    """

    course: Course
    functionals: Functionals
    targets: ComplexArray
    tolerance: float
    multipliers: ComplexArray
    iterations: int
    programs: int = 0
    seed: str = "linear_program"

    @property
    def end(self) -> float:
        """When the last ramp ends [rad]."""
        return self.course.end


def find_multipliers(course: Course, functionals: Functionals) -> ComplexArray:
    """Return the c that fits the switches best.

    Parameters
    ----------
    course
        The course.
    functionals
        What counts.

    Returns
    -------
    ComplexArray
        Shape (m,).
    """
    changes = course.changes(functionals)[:, 1:]
    rows = np.hstack((changes.real.T, changes.imag.T))
    found = least_squares(rows, -course.end_changes()[1:])
    real, imaginary = np.split(found, 2)
    multipliers: ComplexArray = real + 1j * imaginary
    return multipliers


# Where it diverges, numbers overflow: what is not finite then ends it.
@np.errstate(over="ignore", invalid="ignore")
def solve_conditions(
    switches: FloatArray, functionals: Functionals, targets: ComplexArray, slopes: Slopes
) -> RampedOptimum | None:
    """Solve the conditions of optimality from switches near them.

    Parameters
    ----------
    switches
        Phases to begin with, ascending from 0, shape (n,) [rad].
    functionals, targets
        What is to be met, shape (m,).
    slopes
        Limits of the slope.

    Returns
    -------
    RampedOptimum or None
        None where Newton's method fails, or ends with switches that coincide.
    """
    count = switches.size - 1
    course = course_of(switches, slopes)
    multipliers = find_multipliers(course, functionals)
    iteration = 0
    while count and iteration < NEWTON_STEPS:
        iteration += 1
        step = _newton_step(course, multipliers, functionals, targets)
        if not np.isfinite(step).all():
            return None
        moves, rest = step[:count], step[count:]
        gaps, changes = np.diff(course.switches), np.diff(moves, prepend=0.0)
        closing = changes < 0
        share = 0.7 * float(np.min(-gaps[closing] / changes[closing], initial=2.0))
        farthest = float(np.abs(moves).max())
        share = min(1.0, share, FARTHEST_STEP_RAD / max(farthest, FARTHEST_STEP_RAD))
        course = course_of(course.switches + np.append(0.0, share * moves), slopes)
        real, imaginary = np.split(rest, 2)
        multipliers = multipliers + share * (real + 1j * imaginary)
        if share == 1 and farthest < max(CONVERGED * min(1.0, gaps.min()), ROUNDING * course.end):
            break
    scales = functionals.scales(course.end)
    missed = np.abs(course.values(functionals) - targets) * scales
    rounding = np.abs(course.changes(functionals)).sum(axis=1) * scales * ROUNDING * course.end
    closest = min(MIN_GAP_RAD, MIN_GAP_RAMPS / max(slopes.up, slopes.down))
    gaps = np.diff(course.switches)
    if not (missed < MET + rounding).all() or gaps.min(initial=math.inf) < closest:
        return None
    return RampedOptimum(
        course=course,
        functionals=functionals,
        targets=targets,
        tolerance=0.0,
        multipliers=find_multipliers(course, functionals),
        iterations=iteration,
    )


def _newton_step(
    course: Course, multipliers: ComplexArray, functionals: Functionals, targets: ComplexArray
) -> FloatArray:
    """Return the step of the switches after the first, then of c: real, then imaginary parts.

    Least squares minds no c that is not unique: where fewer switches than targets do.
    """
    scales = functionals.scales(course.end)
    missed = (course.values(functionals) - targets) * scales
    changes = course.changes(functionals)[:, 1:]
    scaled = changes * scales[:, None]
    m, n = changes.shape
    matrix = np.zeros((2 * m + n, n + 2 * m))
    matrix[:m, :n], matrix[m : 2 * m, :n] = scaled.real, scaled.imag
    matrix[2 * m :, :n] = course.bends(functionals, multipliers)[1:, 1:]
    matrix[2 * m :, n:] = np.hstack((changes.real.T, changes.imag.T))
    still = (multipliers.conj() @ changes).real + course.end_changes()[1:]
    values = np.concatenate((missed.real, missed.imag, still))
    return evened_least_squares(matrix, -values, 1e-13)
