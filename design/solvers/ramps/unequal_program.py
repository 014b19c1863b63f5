"""The switches that end first behind two lags, as a program over one structure.

Which ramps arrive before the next switch is given. Then end, levels and rests are linear in the
switches, and what is left is smooth in them. SLSQP minimises the end; Newton's method brings what
is left down to rounding, along the bounds that hold.
"""

import math
import warnings
from dataclasses import dataclass

import numpy as np

from design.solvers.least_squares import least_squares
from design.solvers.ramps.unequal_course import TwoLags, UnequalCourse
from design.types import BoolArray, FloatArray

MAX_ITERATIONS = 60
"""Of SLSQP; four are usual."""

CHANGE = 1e-11
"""Change of the end at which SLSQP stops [rad]."""

POLISHING_STEPS = 12

STRUCTURES_NEAR = 2
"""Structures that are tried near a command: a ramp that arrives there may be turned here."""

HOLDS = 1e-7
"""Distance from a bound that counts as none [rad]."""

MENDED = 1e-4
"""Largest miss that Newton's method is to mend [-]."""

MET = 1e-11
"""Largest miss of a target that counts as none, over the unshaped step [-]."""

FARTHEST = 2.5
"""Latest switch that is tried, over the last at the start or a period [-]."""

AT_BOUND_RAD = 1e-5
"""A gap as near to its shortest is the shortest [rad]."""

ROUNDING_RAD = 1e-9
"""By which a gap may be shorter than the shortest [rad]."""

ITERATION_WORK = 1_000.0
"""Work of an iteration [units]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProgramEnd:
    """Where a program ends.

    Attributes
    ----------
    course
        The course there, of the structure given.
    is_solved
        Whether all targets are met within all bounds.
    at_kinks
        Ramps that arrive as the next switch comes: others structures begin there, shape (n - 1,).
    iterations
        Of SLSQP.
    """

    course: UnequalCourse
    is_solved: bool
    at_kinks: BoolArray
    iterations: int


class _Program:
    """Functions of the switches after the first, and their derivatives."""

    def __init__(self, lags: TwoLags, switches: FloatArray, arrived: BoolArray) -> None:
        self._lags, self._arrived = lags, arrived
        self._at, self._course = switches[1:], lags.of(switches, arrived)
        self._scales = np.exp(lags.poles.real * self._course.end)
        self._swinging = lags.poles != 0
        self._high = np.arange(switches.size - 1) % 2 == 0
        self._each = np.eye(switches.size)

    def course(self, at: FloatArray) -> UnequalCourse:
        if not np.array_equal(at, self._at):
            self._at = at.copy()
            self._course = self._lags.of(np.append(0.0, at), self._arrived)
        return self._course

    def end(self, at: FloatArray) -> float:
        return self.course(at).end

    def end_changes(self, at: FloatArray) -> FloatArray:
        return self.course(at).end_changes[-1, 1:]

    def misses(self, at: FloatArray) -> FloatArray:
        missed = (self.course(at).values - self._lags.targets) * self._scales
        return np.concatenate((missed.real, missed.imag[self._swinging]))

    def miss_changes(self, at: FloatArray) -> FloatArray:
        changes = self.course(at).changes[:, 1:] * self._scales[:, None]
        return np.concatenate((changes.real, changes.imag[self._swinging]))

    def room(self, at: FloatArray) -> FloatArray:
        """Return how far gaps are from 0, then rests and levels from their bounds."""
        course = self.course(at)
        rests = course.switches[1:] - course.ends[:-1]
        below = self._lags.ceiling - course.levels[:-1]
        below = np.where(self._high, below, course.levels[:-1])
        kinks = np.where(self._arrived[:-1], rests, below)
        return np.concatenate((np.diff(course.switches), kinks))

    def is_met(self, at: FloatArray, miss: float) -> bool:
        """Return whether all targets are met within a miss, and all bounds hold."""
        within = float(np.abs(self.misses(at)).max()) < miss
        return within and float(self.room(at).min(initial=1.0)) > -HOLDS

    def room_changes(self, at: FloatArray) -> FloatArray:
        course = self.course(at)
        rests = self._each[1:] - course.end_changes[:-1]
        changes = course.level_changes[:-1]
        below = np.where(self._high[:, None], -changes, changes)
        kinks = np.where(self._arrived[:-1, None], rests, below)
        return np.concatenate((np.diff(self._each, axis=0), kinks))[:, 1:]


def solve_program(lags: TwoLags, switches: FloatArray, arrived: BoolArray) -> ProgramEnd:
    """Minimise the end over one structure.

    Parameters
    ----------
    lags
        What is to be met.
    switches
        The start, ascending from 0, shape (n,) [rad].
    arrived
        Which ramps are over before the next switch, shape (n,).

    Returns
    -------
    ProgramEnd
        A local optimum, or where the search for one ended.
    """
    from scipy.optimize import minimize  # noqa: PLC0415 - takes longer to import than a design

    program = _Program(lags, switches, arrived)
    latest = FARTHEST * max(float(switches[-1]), 2 * math.pi)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        found = minimize(
            program.end,
            switches[1:],
            jac=program.end_changes,
            method="SLSQP",
            bounds=[(0.0, latest)] * (switches.size - 1),
            constraints=[
                {"type": "eq", "fun": program.misses, "jac": program.miss_changes},
                {"type": "ineq", "fun": program.room, "jac": program.room_changes},
            ],
            options={"maxiter": MAX_ITERATIONS, "ftol": CHANGE},
        )
    at: FloatArray = np.asarray(found.x, dtype=np.float64)
    room = program.room(at)
    if program.is_met(at, MENDED):
        at = _polished(program, at, room < HOLDS)
        room = program.room(at)
    return ProgramEnd(
        course=program.course(at),
        is_solved=program.is_met(at, MET),
        at_kinks=room[switches.size - 1 :] < HOLDS,
        iterations=int(found.nit),
    )


def solve_near(lags: TwoLags, switches: FloatArray) -> UnequalCourse | None:
    """Return the command near some switches that ends first.

    Parameters
    ----------
    lags
        What is to be met.
    switches
        Near those of a local optimum, ascending from 0, shape (n,) [rad].

    Returns
    -------
    UnequalCourse or None
        None where there is none of their structure.
    """
    start, arrived = switches, lags.of(switches).arrived
    for _ in range(STRUCTURES_NEAR):
        program = _Program(lags, switches, arrived)
        if program.misses(start[1:]).size < start.size - 1:
            break
        at = _polished(program, start[1:], np.zeros(2 * start.size - 2, dtype=np.bool_))
        if program.is_met(at, MET):
            return program.course(at)
        arrived = lags.of(np.append(0.0, np.maximum.accumulate(at))).arrived
    end = solve_program(lags, switches, arrived)
    return end.course if end.is_solved and not end.at_kinks.any() else None


def solve_last(
    lags: TwoLags, switches: FloatArray, given: int, shortest: FloatArray
) -> FloatArray | None:
    """Return the command near some switches of which the first are given.

    Gaps that are the shortest stay so; of the others each moves as little as it can.

    Parameters
    ----------
    lags
        What is to be met.
    switches
        Near those that meet it, ascending from 0, shape (n,) [rad].
    given
        How many of them stay.
    shortest
        The shortest gaps after those, shape (n - given,) [rad].

    Returns
    -------
    FloatArray or None
        Shape (n,) [rad]; None where Newton's method finds none with gaps as long.
    """
    at = switches
    free = np.diff(at)[given - 1 :] > shortest + AT_BOUND_RAD
    swinging = lags.poles != 0
    for _ in range(POLISHING_STEPS):
        course = lags.of(at)
        scales = np.exp(lags.poles.real * course.end)
        missed = (course.values - lags.targets) * scales
        if np.abs(missed).max() < MET / 100:
            break
        # A longer gap moves all switches after it.
        changes = np.cumsum(course.changes[:, : given - 1 : -1], axis=1)[:, ::-1] * scales[:, None]
        changes *= free
        step = least_squares(
            np.concatenate((changes.real, changes.imag[swinging])),
            np.concatenate((missed.real, missed.imag[swinging])),
            1e-13,
        )
        at = at - np.append(np.zeros(given), np.cumsum(step))
        if not (np.diff(at)[given - 1 :] >= shortest - ROUNDING_RAD).all():  # not a number is not
            return None
    return at if np.abs(missed).max() < MET else None


def _polished(program: _Program, at: FloatArray, held: BoolArray) -> FloatArray:
    """Return the nearest switches that miss nothing, along the bounds that are held."""
    for _ in range(POLISHING_STEPS):
        misses, changes = program.misses(at), program.miss_changes(at)
        if np.abs(misses).max() < MET / 100:
            break
        if misses.size + held.sum() <= at.size:
            misses = np.concatenate((misses, program.room(at)[held]))
            changes = np.concatenate((changes, program.room_changes(at)[held]))
        step = least_squares(changes, misses, 1e-13)
        if not np.isfinite(step).all():
            break
        at = at - step
    return at
