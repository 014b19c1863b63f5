"""Humps of one height behind limits and two lags, followed from one lag by Newton's method.

Unknown are the switches x and the outer zeros q; equations, with F as in `unequal_peaks`::

    F(q) = 0 at both outer zeros
    one hump:  ln |F(1)| = ln tolerance,  d ln |F| / dq = 0 at 1
    two humps: F(1) = 0,  ln |F| = ln tolerance at the peak on either side

Behind one lag there are as many switches as equations, or two more: then the nearest are taken.
"""

from dataclasses import dataclass

import numpy as np

from design.formulations.unequal_humps import UnequalHumpsProblem
from design.solvers.budget import Budget
from design.solvers.least_squares import least_squares
from design.solvers.ramps.unequal_course import TwoLags, UnequalCourse
from design.solvers.ramps.unequal_peaks import BandOfTwoLags
from design.solvers.ramps.unequal_search import led
from design.trace import TraceStep
from design.types import FloatArray

NEWTON_STEPS = 10
"""Steps at most to a share of the way; four are usual."""

MET = 1e-11
"""Largest miss of an equation that counts as none: of a residual, a logarithm or its slope [-]."""

FARTHEST_STEP = 0.3
"""How far a switch or a zero moves in a step [rad], [-]."""

FARTHEST = 0.6
"""How far they move in all, from share to share [rad], [-]."""

MIN_SHARE = 1 / 64
"""Step of the way from one lag to two at which it is no longer followed [-]."""

RANGE = (0.01, 3.0)
"""Where zeros and peaks are looked for, ratios of the frequency [-]."""

HUMP_POINTS = 33
"""Ratios between two zeros at which a hump is looked for."""

STEP_WORK = 3_000.0
"""Work of a step [units]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Humps:
    """A command with humps.

    Attributes
    ----------
    course
        Its course.
    zeros
        Frequency ratios of the outer zeros [-].
    steps, stages
        Steps of Newton's method that led there, and how often it was started.
    """

    course: UnequalCourse
    zeros: FloatArray
    steps: int
    stages: int


def follow_humps(
    problem: UnequalHumpsProblem, switches: FloatArray, zeros: FloatArray, budget: Budget
) -> Humps | None:
    """Return the command with humps that is led to from one lag.

    Parameters
    ----------
    problem
        The humps, the limits and the lags.
    switches
        Those behind one lag, ascending from 0, shape (n,) [rad].
    zeros
        Its outer zeros, ratios of the frequency, shape (2,) [-].
    budget
        What the search may do.

    Returns
    -------
    Humps or None
        None where it cannot be followed.
    """
    now, count, stages = np.concatenate((switches[1:], zeros)), 0, 0
    share, step = 0.0, 1.0
    while share < 1 and not budget.spent:
        ahead = min(1.0, share + step)
        equations = _Equations(problem, ahead)
        found, steps = equations.solve(now)
        count, stages = count + steps, stages + 1
        budget.spend(STEP_WORK * steps)
        budget.note(
            TraceStep(
                stage="solve",
                method="newton",
                start="one_lag",
                outcome="failed" if found is None else "solve_succeeded",
                iterations=steps,
                detail=f"{ahead:.4g} of the way to two lags",
            )
        )
        if found is not None:
            now, share, step = found, ahead, 2 * step
        elif step <= MIN_SHARE:
            return None
        else:
            step /= 4
    if share < 1:
        return None
    course = equations.course(now)
    return Humps(course=course, zeros=now[-2:], steps=count, stages=stages)


class _Equations:
    """The equations after a share of the way."""

    def __init__(self, problem: UnequalHumpsProblem, share: float) -> None:
        alike = problem.alike
        self._humps, self._tolerance = alike.humps, alike.tolerance
        self._band = BandOfTwoLags(
            lambda ratios, orders: TwoLags(led(problem.at(ratios, orders), share)),
            alike.unit_pole,
            RANGE,
        )
        self._lags = self._band.lags(np.ones(1))

    def course(self, unknowns: FloatArray) -> UnequalCourse:
        """Return the course under the switches among the unknowns."""
        return self._lags.of(np.append(0.0, unknowns[:-2]))

    def solve(self, start: FloatArray) -> tuple[FloatArray | None, int]:
        """Return the unknowns near some by Newton's method, if there are any, and its steps."""
        unknowns = start
        for step in range(1, NEWTON_STEPS + 1):
            missed, changes = self._missed(unknowns)
            if not np.isfinite(missed).all():
                break
            if np.abs(missed).max() < MET:
                return unknowns, step
            moves = least_squares(changes, -missed, 1e-13)
            size = float(np.abs(moves).max())
            unknowns = unknowns + moves * min(1.0, FARTHEST_STEP / max(size, FARTHEST_STEP))
            if not self._in_order(unknowns) or np.abs(unknowns - start).max() > FARTHEST:
                break
        return None, step

    def _in_order(self, unknowns: FloatArray) -> bool:
        below, above = unknowns[-2:]
        ascending = bool((np.diff(unknowns[:-2], prepend=0.0) > 0).all())
        return ascending and RANGE[0] < below < 1 < above < RANGE[1]

    def _missed(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what the equations miss, shape (m,), and its derivatives, shape (m, n + 1)."""
        course, (below, above) = self.course(unknowns), unknowns[-2:].tolist()
        zeros = [below, above] if self._humps == 1 else [below, above, 1.0]
        tops = np.ones(1) if self._humps == 1 else self._peaks(course, below, above)
        left = self._band.left(
            course.switches, course.arrived, np.concatenate((np.array(zeros), tops))
        )
        zeroed = len(zeros)
        places = np.zeros((zeroed, 2), dtype=np.complex128)
        places[0, 0], places[1, 1] = left.slopes[:2]
        of_zeros = np.hstack((left.changes[:zeroed], places))
        missed = [left.vectors[:zeroed].real, left.vectors[:zeroed].imag]
        changes = [of_zeros.real, of_zeros.imag]
        missed.append(left.logarithms[zeroed:] - np.log(self._tolerance))
        changes.append(np.pad(left.moves[zeroed:], ((0, 0), (0, 2))))
        if self._humps == 1:
            over = 1 / left.vectors[-1]
            missed.append(left.growths[-1:])
            turned = left.slope_changes[-1] - left.changes[-1] * left.slopes[-1] * over
            changes.append(np.pad((turned * over).real, (0, 2))[None])
        return np.concatenate(missed), np.concatenate(changes)

    def _peaks(self, course: UnequalCourse, below: float, above: float) -> FloatArray:
        """Return the ratios of the highest residual between the zeros on either side, (2,)."""
        found = []
        for lower, upper in ((below, 1.0), (1.0, above)):
            ratios = np.linspace(lower, upper, HUMP_POINTS)
            logarithms = self._band.left(course.switches, course.arrived, ratios).logarithms
            highest = int(np.argmax(logarithms[1:-1])) + 1
            pitch = (upper - lower) / (HUMP_POINTS - 1)
            found.append(self._band.refined(course, ratios[[highest]], 4, pitch))
        return np.concatenate(found)
