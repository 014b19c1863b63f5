"""The command of one structure that keeps a tolerance over a band behind two lags and ends first.

A step is a cone program: the end, and the residual's vectors at its peaks and between, are linear
in the switches. The peaks are looked for anew after each. Near the optimum Newton's method brings
them to the tolerance.
"""

import math
from dataclasses import dataclass

import numpy as np

from design.solvers.cone_step import StepProgram, solve_step
from design.solvers.least_squares import least_squares
from design.solvers.outcome import Status
from design.solvers.ramps.unequal_conditions import solve_conditions, touching
from design.solvers.ramps.unequal_course import UnequalCourse
from design.solvers.ramps.unequal_peaks import BandOfTwoLags, Left
from design.solvers.ramps.unequal_program import ProgramEnd
from design.solvers.ramps.unequal_structure import HOLDS, Structure
from design.types import BoolArray, FloatArray

MAX_STEPS = 40
"""Cone programs of one structure; four are usual."""

STEP_WORK = 12_000.0
"""Work of one, of the peaks after it, and of its share of Newton's method [units]."""

RATIOS = 11
"""Even ratios at which the residual counts beside its peaks."""

RADIUS_RAD, MAX_RADIUS_RAD, MIN_RADIUS_RAD = 0.3, 0.5, 1e-7
"""How far a switch moves in the first step, in any, and in the last [rad]."""

PRICE = 10.0
"""Of a residual above the tolerance, over it: a few radians are usual at an optimum [rad]."""

GAINED, WELL, POORLY = 0.1, 0.7, 0.3
"""Shares of the gain foreseen: with less a step is not taken, with more the next may be longer,
with less shorter [-]."""

SHRINKS = 0.3
"""How long the next step is after one that is not taken [-]."""

NO_GAIN = 1e-11
"""Gain foreseen that is none [rad]."""

HOPELESS = 0.01
"""Share of the price of what is above that a step must gain, or nothing lowers that [-]."""

A_LOT = 1e-3
"""Excess over the tolerance of which this is asked [-]."""

NEAR_GAIN, NEAR_EXCESS = 0.02, 0.05
"""Gain foreseen, and excess, with which Newton's method is tried [rad], [-]."""

GAIN_BETWEEN = 0.3
"""How much smaller the first is when it is tried again [-]."""

TOUCHES = 0.05
"""Share of the tolerance by which a peak that touches it may be off before it is solved [-]."""

MAX_EXCHANGES = 5
"""How often peaks are exchanged in."""

NEARLY_HELD = 1e-4
"""Room of a bound that may hold [rad]."""

MARGIN = 1e-10
"""Peaks are put this far below the tolerance, so that rounding lifts none above it [-]."""

ABOVE = 1e-11
"""Excess over that at which a peak counts as above [-]."""

MAX_MISS = 1e-3
"""Excess that is mended where Newton's method finds no optimum [-]."""

MENDING_STEPS = 8


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Place:
    """A command on the way.

    Attributes
    ----------
    at
        Switches after the first, shape (n - 1,) [rad].
    course
        Its course.
    peaks
        Ratios of its peaks, shape (k,) [-].
    beyond
        Logarithms of their heights over the tolerance, shape (k,) [-].
    """

    at: FloatArray
    course: UnequalCourse
    peaks: FloatArray
    beyond: FloatArray

    @property
    def excess(self) -> float:
        """Return the largest residual above the tolerance, over it [-]."""
        return max(math.expm1(min(float(self.beyond.max()), 100.0)), 0.0)


def solve_band_program(
    band: BandOfTwoLags, switches: FloatArray, arrived: BoolArray, tolerance: float
) -> ProgramEnd:
    """Minimise the end over one structure.

    Parameters
    ----------
    band
        What is left.
    switches, arrived
        As of `solve_program`.
    tolerance
        Largest residual [-].

    Returns
    -------
    ProgramEnd
        A local optimum, or where the search for one ended.
    """
    structure = Structure(band.lags(np.ones(1)), switches, arrived)
    search = _Search(band, structure, tolerance * (1 - MARGIN))
    at = search.earliest()
    room, course = structure.room(at), structure.course(at)
    kept = float(band.peaks(course)[1].max()) <= math.log(tolerance)
    return ProgramEnd(
        course=course,
        is_solved=kept and float(room.min(initial=1.0)) > -HOLDS,
        at_kinks=room[switches.size - 1 :] < HOLDS,
        iterations=search.steps,
    )


class _Search:
    """The parts of the search over one structure."""

    def __init__(self, band: BandOfTwoLags, structure: Structure, aim: float) -> None:
        self.steps = 0
        self._band, self._structure, self._aim = band, structure, aim
        self._even = np.linspace(band.lower, band.upper, RATIOS)

    def earliest(self) -> FloatArray:
        """Return the switches after the first that end earliest, or where the search ended."""
        now = self._place(self._structure.start)
        radius, tried = RADIUS_RAD, NEAR_GAIN / GAIN_BETWEEN
        while self.steps < MAX_STEPS and radius > MIN_RADIUS_RAD:
            self.steps += 1
            step = self._step(now, radius)
            if step is None:
                break
            moves, foreseen = step
            if foreseen < max(NO_GAIN, HOPELESS * PRICE * now.excess * (now.excess > A_LOT)):
                break
            size = float(np.abs(moves).max())
            following = self._place(now.at + moves)
            shorter = now.course.end - following.course.end
            gained = (shorter + PRICE * (now.excess - following.excess)) / foreseen
            if gained < GAINED:
                radius = SHRINKS * size
                continue
            now = following
            if gained > WELL and size > 0.9 * radius:
                radius = min(2 * radius, MAX_RADIUS_RAD)
            elif gained < POORLY:
                radius = size / 2
            if foreseen < GAIN_BETWEEN * tried and now.excess < NEAR_EXCESS:
                tried = foreseen
                settled = self._settled(now)
                if settled is not None:
                    return settled
        settled = self._settled(now)
        return self._mended(now) if settled is None else settled

    def _place(self, at: FloatArray) -> _Place:
        course = self._structure.course(at)
        peaks, logarithms = self._band.peaks(course)
        return _Place(at=at, course=course, peaks=peaks, beyond=logarithms - math.log(self._aim))

    def _left(self, now: _Place, ratios: FloatArray) -> Left:
        return self._band.left(now.course.switches, self._structure.arrived, ratios)

    def _step(self, now: _Place, radius: float) -> tuple[FloatArray, float] | None:
        """Return a step, and what it is to gain; None where Clarabel fails."""
        structure = self._structure
        left = self._left(now, np.unique(np.concatenate((now.peaks, self._even))))
        ends = structure.end_changes(now.at)
        outcome = solve_step(
            StepProgram(
                end_changes=ends,
                vectors=left.vectors / self._aim,
                changes=left.changes / self._aim,
                room=np.maximum(structure.room(now.at), 0.0),
                room_changes=structure.room_changes(now.at),
                radius=radius,
                price=PRICE,
            )
        )
        if outcome.status is not Status.SOLVE_SUCCEEDED:
            return None
        gain = PRICE * (now.excess - outcome.above) - float(ends @ outcome.moves)
        return outcome.moves, gain

    def _settled(self, now: _Place) -> FloatArray | None:
        """Return the optimum near some switches, by Newton's method."""
        band, structure = self._band, self._structure
        bounds = structure.room(now.at) < NEARLY_HELD
        for _ in range(MAX_EXCHANGES):
            touched = now.peaks[now.beyond > -TOUCHES]
            if touched.size == 0:
                return None
            near = touching(band, structure, now.at, touched, bounds)
            if near.ratios.size == 0:
                return None
            at = solve_conditions(band, structure, now.at, near, self._aim)
            if at is None or structure.room(at).min(initial=1.0) < -HOLDS:
                return None
            now = self._place(at)
            if now.beyond.max() < ABOVE:
                return at
        return None

    def _mended(self, now: _Place) -> FloatArray:
        """Return the nearest switches of which no peak is above the tolerance."""
        structure = self._structure
        for _ in range(MENDING_STEPS):
            above = now.beyond > 0
            if not above.any() or now.beyond.max() > MAX_MISS:
                break
            room = structure.room(now.at)
            held = room < HOLDS
            changes = self._left(now, now.peaks[above]).moves
            step = least_squares(
                np.vstack((changes, structure.room_changes(now.at)[held])),
                np.append(now.beyond[above], room[held]),
                1e-13,
            )
            if not np.isfinite(step).all():
                break
            now = self._place(now.at - step)
        return now.at
