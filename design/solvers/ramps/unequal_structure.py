"""Commands behind two lags of one structure: which ramps arrive before the next switch is given.

End, levels and rests are then linear in the switches, and what is left is smooth in them.
"""

import math
import warnings
from collections.abc import Callable

import numpy as np

from design.solvers.ramps.unequal_course import TwoLags, UnequalCourse
from design.types import BoolArray, FloatArray

HOLDS = 1e-7
"""Distance from a bound that counts as none [rad]."""

CHANGE = 1e-11
"""Change of the end at which SLSQP stops [rad]."""

FARTHEST = 2.5
"""Latest switch that is tried, over the last at the start or a period [-]."""


class Structure:
    """Functions of the switches after the first, and their derivatives."""

    def __init__(self, lags: TwoLags, switches: FloatArray, arrived: BoolArray) -> None:
        self.arrived = arrived
        self.start = switches[1:]
        self._lags = lags
        self._at, self._course = self.start, lags.of(switches, arrived)
        self._high = np.arange(switches.size - 1) % 2 == 0
        self._each = np.eye(switches.size)

    def course(self, at: FloatArray) -> UnequalCourse:
        """Return the course under a command."""
        if not np.array_equal(at, self._at):
            self._at = at.copy()
            self._course = self._lags.of(np.append(0.0, at), self.arrived)
        return self._course

    def end(self, at: FloatArray) -> float:
        """Return when the last ramp ends [rad]."""
        return self.course(at).end

    def end_changes(self, at: FloatArray) -> FloatArray:
        """Return the derivatives of the end, shape (n - 1,) [-]."""
        return self.course(at).end_changes[-1, 1:]

    def room(self, at: FloatArray) -> FloatArray:
        """Return how far gaps are from 0, then rests and levels from their bounds."""
        course = self.course(at)
        rests = course.switches[1:] - course.ends[:-1]
        below = self._lags.ceiling - course.levels[:-1]
        below = np.where(self._high, below, course.levels[:-1])
        kinks = np.where(self.arrived[:-1], rests, below)
        return np.concatenate((np.diff(course.switches), kinks))

    def room_changes(self, at: FloatArray) -> FloatArray:
        """Return their derivatives, shape (2 n - 2, n - 1)."""
        course = self.course(at)
        rests = self._each[1:] - course.end_changes[:-1]
        changes = course.level_changes[:-1]
        below = np.where(self._high[:, None], -changes, changes)
        kinks = np.where(self.arrived[:-1, None], rests, below)
        return np.concatenate((np.diff(self._each, axis=0), kinks))[:, 1:]


def earliest(
    structure: Structure,
    kind: str,
    kept: Callable[[FloatArray], FloatArray],
    kept_changes: Callable[[FloatArray], FloatArray],
    most: int,
) -> tuple[FloatArray, int]:
    """Return where SLSQP ends when it minimises the end within the bounds.

    Parameters
    ----------
    structure
        The commands, and where to begin.
    kind
        `eq` if something is kept at 0, `ineq` if above it.
    kept, kept_changes
        That, shape (m,), and its derivatives, shape (m, n - 1).
    most
        Iterations at most.

    Returns
    -------
    tuple of FloatArray and int
        The switches after the first, and how many iterations led there.
    """
    from scipy.optimize import minimize  # noqa: PLC0415 - takes longer to import than a design

    start = structure.start
    latest = FARTHEST * max(float(start.max(initial=0.0)), 2 * math.pi)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        found = minimize(
            structure.end,
            start,
            jac=structure.end_changes,
            method="SLSQP",
            bounds=[(0.0, latest)] * start.size,
            constraints=[
                {"type": kind, "fun": kept, "jac": kept_changes},
                {"type": "ineq", "fun": structure.room, "jac": structure.room_changes},
            ],
            options={"maxiter": most, "ftol": CHANGE},
        )
    return np.asarray(found.x, dtype=np.float64), int(found.nit)
