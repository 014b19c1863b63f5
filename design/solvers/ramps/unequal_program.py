"""The switches that end first behind two lags, as a program over one structure.

Which ramps arrive before the next switch is given. Then end, levels and rests are linear in the
switches, and what is left is smooth in them. SLSQP minimises the end; Newton's method brings what
is left down to rounding, along the bounds that hold.
"""

from dataclasses import dataclass

import numpy as np

from design.solvers.least_squares import least_squares
from design.solvers.ramps.unequal_course import TwoLags, UnequalCourse
from design.solvers.ramps.unequal_structure import HOLDS, Structure, earliest
from design.types import BoolArray, FloatArray

MAX_ITERATIONS = 60
"""Of SLSQP; four are usual."""

POLISHING_STEPS = 12

STRUCTURES_NEAR = 2
"""Structures that are tried near a command: a ramp that arrives there may be turned here."""

MENDED = 1e-4
"""Largest miss that Newton's method is to mend [-]."""

MET = 1e-11
"""Largest miss of a target that counts as none, over the unshaped step [-]."""

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
    """What is missed over one structure."""

    def __init__(self, lags: TwoLags, switches: FloatArray, arrived: BoolArray) -> None:
        self.structure = Structure(lags, switches, arrived)
        self._targets = lags.targets
        self._scales = np.exp(lags.poles.real * self.structure.end(switches[1:]))
        self._swinging = lags.poles != 0

    def misses(self, at: FloatArray) -> FloatArray:
        missed = (self.structure.course(at).values - self._targets) * self._scales
        return np.concatenate((missed.real, missed.imag[self._swinging]))

    def miss_changes(self, at: FloatArray) -> FloatArray:
        changes = self.structure.course(at).changes[:, 1:] * self._scales[:, None]
        return np.concatenate((changes.real, changes.imag[self._swinging]))

    def is_met(self, at: FloatArray, miss: float) -> bool:
        """Return whether all targets are met within a miss, and all bounds hold."""
        within = float(np.abs(self.misses(at)).max()) < miss
        return within and float(self.structure.room(at).min(initial=1.0)) > -HOLDS


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
    program = _Program(lags, switches, arrived)
    structure = program.structure
    at, iterations = earliest(structure, "eq", program.misses, program.miss_changes, MAX_ITERATIONS)
    room = structure.room(at)
    if program.is_met(at, MENDED):
        at = _polished(program, at, room < HOLDS)
        room = structure.room(at)
    return ProgramEnd(
        course=structure.course(at),
        is_solved=program.is_met(at, MET),
        at_kinks=room[switches.size - 1 :] < HOLDS,
        iterations=iterations,
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
            return program.structure.course(at)
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
            misses = np.concatenate((misses, program.structure.room(at)[held]))
            changes = np.concatenate((changes, program.structure.room_changes(at)[held]))
        step = least_squares(changes, misses, 1e-13)
        if not np.isfinite(step).all():
            break
        at = at - step
    return at
