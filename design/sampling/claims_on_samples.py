"""Amplitudes on a given number of samples: the least violation of claims, or the nearest zeros."""

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from design.model.impulses import Impulses
from design.sampling.asked import Asked, Drive
from design.sampling.freedom import MAX_RELAXED, Freedom, freedoms, relaxed, takes_turns
from design.solvers import sample_program
from design.solvers.budget import Budget
from design.solvers.outcome import Status
from design.solvers.sample_program import SampleOutcome, SampleProgram
from design.types import BoolArray, ComplexArray, FloatArray

ACCURACY = 1e-7
"""Share by which a peak may be above those of a program: its own accuracy [-]."""

EXACT = 1e-13
"""Largest equation that counts as zero: a few hundred roundings of terms of size one [-]."""

NEARLY = 0.5
"""Largest equation, over what counts as zero, that still makes zero what is claimed to be, where a
step that is none would be needed for less [-]."""

SUMS_FIRST = 1e6
"""Weight of the sums of amplitudes where not all equations can hold [-]."""

ABSENT = (1e-6, 1e-7, 1e-8, 1e-9)
"""How near to a bound an unknown of a program is there; nearer where too few are then left [-]."""

MIN_STEP = 1e-10
"""Step that is none: `Impulses` would take it for one that does not accelerate [-]."""

TURN_RAD = 0.6
"""Turn of the first impulse from one ratio of a program to the next [rad]."""

FINER = 8
"""How many times closer peaks are looked for."""

MIN_RATIOS = 7
"""Ratios of a band, at least."""

MAX_RATIOS = 600
"""Ratios of a band beyond which no more are added."""

MAX_SETS = 4
"""How often steps are left out that would begin a set, and are none."""

ROUNDS = 4
"""Corrections by which equations come to hold to rounding, after the first without tiny steps."""

POLISHED = 1e-6
"""Share by which the largest residual may grow when unknowns at a bound are put there [-]."""

MET = 1 - 2 * POLISHED
"""What is left over its limits from which on they count as kept: what rounding adds afterwards is
still within them [-]."""

Ratios = list[list[FloatArray]]
"""Ratios of frequency at which each band of each mode is bounded."""


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """The least violation on a number of samples, and of what program."""

    program: SampleProgram
    outcome: SampleOutcome
    freedom: Freedom

    @property
    def value(self) -> float:
        """Violation over the limits; infinite without such a command."""
        return self.outcome.value if self.outcome.status is Status.SOLVE_SUCCEEDED else math.inf


@dataclass(frozen=True, slots=True, eq=False)
class NearestZero:
    """Amplitudes of all zeros.

    Attributes
    ----------
    freedom
        The samples that may have steps, and what these may be.
    amplitudes
        On these samples, shape (k,).
    is_exact
        Whether all zeros hold to rounding; where not, nearly.
    """

    freedom: Freedom
    amplitudes: FloatArray
    is_exact: bool


@dataclass(frozen=True, slots=True, eq=False)
class ClaimsOnSamples:
    """A shaper, what is asked of it on samples, and the drive."""

    impulses: Impulses
    asked: tuple[Asked, ...]
    drive: Drive
    budget: Budget

    @property
    def positions(self) -> FloatArray:
        """Times of the shaper from its first impulse on, shape (n,) [samples]."""
        times = self.impulses.times_s
        places: FloatArray = (times - times[0]) / self.drive.sample_time_s
        return places

    @property
    def largest_tolerance(self) -> float | None:
        """The largest tolerance asked; None where only zeros are [-]."""
        limits = [limit for one in self.asked for _, limit in one.bands]
        limits += [one.nominal for one in self.asked if one.nominal is not None]
        return max(limits, default=None)

    @property
    def zero_limits(self) -> FloatArray:
        """What counts as zero in each equation of a zero, shape (m,)."""
        limits: FloatArray = np.concatenate([one.zero_limits for one in self.asked])
        return limits

    def freedoms(self, last: int) -> list[Freedom]:
        """Return what amplitudes may be on samples, likeliest first."""
        band, alike = self._over_band, self.drive.has_one_set
        return list(freedoms(self.impulses, self.positions, last, band=band, alike=alike))

    def all_freedom(self, last: int) -> Freedom | None:
        """Return a freedom that has every command on some samples in it.

        Parameters
        ----------
        last
            Number of the last sample.

        Returns
        -------
        Freedom or None
            None where none is known.
        """
        band, alike = self._over_band, self.drive.has_one_set
        if takes_turns(self.impulses, band=band, alike=alike):
            known = last <= MAX_RELAXED and not self.drive.passes_state_on
            return relaxed(self.impulses, last) if known else None
        (freedom,) = self.freedoms(last)
        return freedom if freedom.complete else None

    @property
    def _over_band(self) -> bool:
        return any(one.bands for one in self.asked)

    def least(self, freedom: Freedom, *, decide: bool = False) -> Found:
        """Return the least violation of what is asked.

        Of the zeros where nothing else is.

        Parameters
        ----------
        freedom
            What amplitudes may be.
        decide
            Whether it ends as soon as it is known that the claims can, or cannot, be kept.

        Returns
        -------
        Found
            Its value is over the limits; it is of all frequencies of the bands, unless it was to
            decide.
        """
        ratios: Ratios = [
            [np.linspace(*band, self._count(one, band, freedom)) for band, _ in one.bands]
            for one in self.asked
        ]
        while True:
            program = self._program(freedom, ratios)
            outcome = sample_program.solve(program)
            self.budget.spend(outcome.work)
            found = Found(program, outcome, freedom)
            if not math.isfinite(found.value) or (decide and outcome.bound > 1.0):
                return found
            most = max((each.size for own in ratios for each in own), default=0)
            enough = max(found.value, MET) if decide else found.value
            if most > MAX_RATIOS or not self._add_peaks(found, ratios, enough):
                return found

    def _count(self, one: Asked, band: tuple[float, float], freedom: Freedom) -> int:
        turn = abs(one.mode.pole_rad_s) * self.drive.sample_time_s * float(freedom.samples[-1])
        return MIN_RATIOS + math.ceil(turn * (band[1] - band[0]) / TURN_RAD)

    def _add_peaks(self, found: Found, ratios: Ratios, enough: float) -> bool:
        """Add ratios at which enough, over a limit, is passed; return whether there were any."""
        freedom, added = found.freedom, False
        amplitudes = freedom.base + freedom.matrix @ found.outcome.unknowns
        for one, own in zip(self.asked, ratios, strict=True):
            for index, (band, limit) in enumerate(one.bands):
                grid = np.linspace(*band, FINER * self._count(one, band, freedom) + 1)

                def curve(at: FloatArray, one: Asked = one) -> FloatArray:
                    rows = self._vectors(one, at, freedom)
                    return np.abs(rows @ amplitudes)

                peaks = _peaks(curve, grid)
                above = peaks[curve(peaks) > enough * limit * (1 + ACCURACY)]
                together = np.union1d(own[index], above)
                added = added or together.size > own[index].size
                own[index] = together
        return added

    def _vectors(self, one: Asked, ratios: FloatArray, freedom: Freedom) -> ComplexArray:
        at = ratios.astype(np.complex128)
        return self.drive.vectors(one.mode, at, freedom.samples, freedom.signs)

    def _zeros(self, freedom: Freedom) -> ComplexArray:
        rows = [self.drive.zero_rows(one, freedom.samples, freedom.signs) for one in self.asked]
        together: ComplexArray = np.concatenate(rows)
        return together

    def _program(self, freedom: Freedom, ratios: Ratios) -> SampleProgram:
        rows: list[ComplexArray] = []
        limits: list[FloatArray] = []
        for one, own in zip(self.asked, ratios, strict=True):
            for (_, limit), each in zip(one.bands, own, strict=True):
                rows.append(self._vectors(one, each, freedom))
                limits.append(np.full(each.size, limit))
            if one.nominal is not None:
                rows.append(self._vectors(one, np.ones(1), freedom))
                limits.append(np.full(1, one.nominal))
        zeros = self._zeros(freedom)
        if not rows:  # what misses zero is what counts
            return _program(freedom, zeros, np.ones(len(zeros)), zeros[:0], None)
        return _program(freedom, np.concatenate(rows), np.concatenate(limits), zeros, None)

    def nearest_zero(self, freedom: Freedom) -> NearestZero | None:
        """Return amplitudes of all zeros, near the linear split.

        Parameters
        ----------
        freedom
            What amplitudes may be.

        Returns
        -------
        NearestZero or None
            None if no such amplitudes were found.
        """
        found = self._nearest(freedom)
        if found is None or freedom.signs is None or not self.drive.passes_state_on:
            return found
        # Which set is in force goes by the steps there are: without those that begin no set.
        begun = freedom
        for _ in range(MAX_SETS):
            begun = begun.restricted(_in_force(begun.signs, found.amplitudes))
            found = self._nearest(begun)
            if found is None:
                break
            if _in_force(begun.signs, found.amplitudes).all():
                return found
        return self._nearest(freedom.with_beginnings())

    def _nearest(self, freedom: Freedom) -> NearestZero | None:
        zeros = self._zeros(freedom)
        cost = freedom.cost / max(1.0, float(np.abs(freedom.cost).max()))
        program = _program(freedom, zeros[:0], np.zeros(0), zeros, cost)
        outcome = sample_program.solve(program)
        self.budget.spend(outcome.work)
        if outcome.status is not Status.SOLVE_SUCCEEDED:
            return None
        amplitudes = polished(program, freedom, outcome.unknowns, self.zero_limits)
        if amplitudes is None:
            return None
        missed = self._missed(freedom, amplitudes, zeros)
        if (missed > self.zero_limits).any():
            return None  # with steps left out that are none
        return NearestZero(freedom, amplitudes, bool(missed.max(initial=0.0) <= 2 * EXACT))

    def _missed(self, freedom: Freedom, amplitudes: FloatArray, zeros: ComplexArray) -> FloatArray:
        """Return what is left of zeros, ``zeros @ amplitudes``, seen at the last step instead."""
        if amplitudes[-1] != 0:
            return np.abs(zeros @ amplitudes)
        kept = slice(0, int(np.flatnonzero(amplitudes)[-1]) + 1)
        samples = freedom.samples[kept]
        signs = None if freedom.signs is None else freedom.signs[kept]
        rows = [self.drive.zero_rows(one, samples, signs) for one in self.asked]
        missed: FloatArray = np.abs(np.concatenate(rows) @ amplitudes[kept])
        return missed


def _program(
    freedom: Freedom,
    bounded: ComplexArray,
    limits: FloatArray,
    zeros: ComplexArray,
    cost: FloatArray | None,
) -> SampleProgram:
    return SampleProgram(
        bounded=bounded @ freedom.matrix,
        bounded_offset=bounded @ freedom.base,
        limits=limits,
        zero=zeros @ freedom.matrix,
        zero_offset=zeros @ freedom.base,
        equal=freedom.equal,
        right=freedom.right,
        below=freedom.below,
        most=freedom.most,
        highest=freedom.highest,
        cost=cost,
    )


def _in_force(signs: FloatArray | None, amplitudes: FloatArray) -> BoolArray:
    """Return which samples are not before the first step of their own set, shape (k,)."""
    if signs is None:
        return np.ones(amplitudes.size, dtype=np.bool_)
    runs = np.cumsum(np.diff(signs, prepend=signs[0]) != 0)
    begun: BoolArray = np.zeros(amplitudes.size, dtype=np.bool_)
    for run in range(int(runs[-1]) + 1):
        own = runs == run
        begun[own] = np.maximum.accumulate(amplitudes[own] != 0)
    return begun


def _peaks(curve: Callable[[FloatArray], FloatArray], ratios: FloatArray) -> FloatArray:
    """Return ends and peaks of a curve, each by the parabola through three points."""
    values = curve(ratios)
    before, here, after = values[:-2], values[1:-1], values[2:]
    inner = np.flatnonzero((here >= before) & (here >= after))
    rise, bend = (before - after)[inner], (before - 2 * here + after)[inner]
    flat = bend == 0
    move = np.where(flat, 0.0, rise / np.where(flat, 1.0, 2 * bend))
    places = ratios[inner + 1] + (ratios[1] - ratios[0]) * np.clip(move, -1.0, 1.0)
    found: FloatArray = np.concatenate((ratios[:1], places, ratios[-1:]))
    return found


def polished(
    program: SampleProgram,
    freedom: Freedom,
    unknowns: FloatArray,
    zero_limits: FloatArray,
    largest: float = math.inf,
) -> FloatArray | None:
    """Return amplitudes whose equations hold to rounding.

    Unknowns at a bound, within the accuracy of the program, stay there; the others take the
    smallest change that solves the equations. Where that would take a step that is none, as where
    half a period is off a whole number of samples by rounding, sums still hold to rounding, and
    zeros to half of what is allowed for a zero.

    Parameters
    ----------
    program, freedom
        The program and what it is of.
    unknowns
        Its solution, shape (n,).
    zero_limits
        What counts as zero in each vector that is to be, shape (m,).
    largest
        What its bounded vectors may be over their limits, at most [-].

    Returns
    -------
    FloatArray or None
        Shape (k,), of their signs; None where the equations do not hold.
    """
    sums = len(program.equal)
    equations = np.concatenate((program.equal, program.zero.real, program.zero.imag))
    sides = np.concatenate((program.right, -program.zero_offset.real, -program.zero_offset.imag))
    weights = np.where(np.arange(sides.size) < sums, SUMS_FIRST, 1.0)
    nearly = NEARLY * np.tile(zero_limits, 2)
    for within, absent in itertools.product((np.minimum(EXACT, nearly), nearly), ABSENT):
        low, high = unknowns < absent, unknowns > program.highest - absent
        values = np.where(low, 0.0, np.where(high, program.highest, unknowns))
        kept = ~(low | high)
        for _ in range(ROUNDS):
            missing = sides - equations @ values
            weighted = weights[:, None] * equations[:, kept]
            values[kept] += np.linalg.lstsq(weighted, weights * missing)[0]
            tiny = kept & (np.abs(values) <= MIN_STEP)
            values[tiny], kept[tiny] = 0.0, False
        vectors = np.abs(program.bounded @ values + program.bounded_offset)
        missing = np.abs(equations @ values - sides)
        if (
            missing[:sums].max(initial=0.0) <= EXACT
            and (missing[sums:] <= within).all()
            and (values >= 0).all()
            and (values <= program.highest).all()
            and (program.below @ values <= program.most + EXACT).all()
            and (vectors <= largest * program.limits).all()
        ):
            amplitudes = freedom.base + freedom.matrix @ values
            steps: FloatArray = np.where(np.abs(amplitudes) > MIN_STEP, amplitudes, 0.0)
            steps[np.argmax(steps)] += amplitudes.sum() - steps.sum()
            return steps
    return None
