"""The fastest command without vibration in several modes: structure first, then Newton's method.

A command of duration T whose vector ``V_k = sum A_i exp(-s_k t_i)`` is zero for every mode leaves
``sum A_i P(t_i) = 0``, whatever the c, with the function of time::

    P(t) = Re sum_k conj(c_k) exp(-s_k t)

Of positive amplitudes none is so short that P is still positive. Of a command u between 0 and 1
that is ``P(T) = integral of u P' <= rise of P``, so none is so short that P has fallen by less than
P(0). Every c gives a lower bound that way, and the best c the optimum: there positive impulses
stand where P touches zero, the command is 1 where P rises and 0 where it falls.

A linear program over a time grid, at a duration that is too short, finds the c that shows this
best; the bound that it gives is the next duration. Near the optimum c tells how many impulses there
are, and Newton's method solves for times, amplitudes and c at once, off the grid.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from operator import itemgetter

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.formulation import JointProblem
from design.model.impulses import ROUNDING
from design.solvers import highs
from design.solvers.budget import Budget
from design.types import LARGEST, ComplexArray, FloatArray

PERIOD_RAD = 2 * math.pi

POINTS_A_TURN = 24
"""Points of a search for zeros, to a period of the fastest mode [-]."""

CELLS_A_TURN = 20
"""Cells of the linear program, to a period of the fastest mode [-]."""

FEWEST_CELLS = 60
"""Cells of the first linear program, at least [-]."""

MOST_PROGRAMS = 60
"""Linear programs until the search is given up; a dozen do for six modes."""

PROGRAM_WORK = 2500.0
CELL_WORK = 1.6
"""Work of a linear program, and of each of its cells and equations: with what follows from it
[units]."""

FINEST = 8.0
"""How many times finer than at first the grid may become [-]."""

NEAR = 0.1
"""Step of the duration, over itself, from which on c is trusted with the structure [-]."""

NEWTON_STEPS = 30
CONVERGED = 1e-12
"""Step of times and amplitudes after which the next is rounding."""

ZERO = 1e-12
"""Largest vibration that counts as none, over the unshaped step [-]."""

SHORTEST_GAP_RAD = 1e-6
"""Impulses closer than this, in turns of the slowest mode, are one [rad]."""

CLOSE_ENOUGH = 1e-6
"""Gap between bound and duration, over the duration, at which nothing better is looked for [-]."""

FARTHEST_AHEAD = 8.0
"""How many times the last gain of the bound the next duration is beyond it, at most [-]."""

STRAYED = 2.0
"""Duration over that of its start beyond which Newton's method has lost its way [-]."""

LIFT = 1e-7
"""Height of P above zero at the impulses but the last; it costs the bound about as much [-]."""

PRESENT = 0.01
"""Share of the largest below which a step of the linear program may be one of its grid alone [-].

Where modes are odd multiples of another, fewer impulses than equations do: the grid adds some.
"""

MOST_DECAY = 600.0
"""Decay of the fastest decaying mode over the longest duration: its exponential is a number [-]."""

LONGEST_TURNS = 40.0
"""Longest duration that is searched, in periods of the slowest mode and one mode [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shortest:
    """A command without vibration, by the solver's word, and what stands against shorter ones.

    Attributes
    ----------
    times_rad, amplitudes
        Its impulses, shape (n,) each [rad], [-].
    vectors
        The c, shape (m,) [-].
    iterations
        Steps of Newton's method.
    programs
        Linear programs until then.
    """

    times_rad: FloatArray
    amplitudes: FloatArray
    vectors: ComplexArray
    iterations: int
    programs: int


def shortest(problem: JointProblem, budget: Budget | None = None) -> Iterator[Shortest]:
    """Yield the fastest command; where none is shown to be, the best that was found.

    Raises
    ------
    InfeasibleDesignError
        When all are used up, or the budget is spent; says how far was searched.
    """
    first = itemgetter(0)
    budget = Budget() if budget is None else budget
    search = _Search(problem.unit_poles, positive=problem.positive)
    low, high, fineness, ahead = search.first_bound_rad, math.inf, 1.0, 0.0
    duration = low
    best: Shortest | None = None
    strongest: tuple[float, ComplexArray] = (0.0, np.zeros(0, dtype=np.complex128))
    for programs in range(1, MOST_PROGRAMS + 1):
        if budget.spent:
            break
        budget.spend(search.work_of(duration, fineness))
        obstacle = search.obstacle_to(duration, fineness)
        gained = 0.0
        if obstacle is not None:
            excluded = search.bound_rad(obstacle.vectors)
            strongest = max(strongest, (excluded, obstacle.vectors), key=first)
            reached = max(duration, excluded)
            if reached < duration * (1 + NEAR):
                for times in search.structures(obstacle, reached):
                    found = search.sharpened(obstacle.vectors, times, programs)
                    if found is None:
                        continue
                    strongest = max(
                        strongest, (search.bound_rad(found.vectors), found.vectors), key=first
                    )
                    if best is None or found.times_rad[-1] < best.times_rad[-1]:
                        best = found
                    if best.times_rad[-1] <= strongest[0] * (1 + CLOSE_ENOUGH):
                        yield replace(best, vectors=strongest[1])
                        return
            gained = max(reached, strongest[0]) - low
            low += gained
        else:
            high = min(high, duration)
        if low > search.horizon_rad:
            break
        if high - low <= CLOSE_ENOUGH * low or 0 < gained <= CLOSE_ENOUGH * low:
            if fineness >= FINEST:
                break
            # What a coarse grid says of a duration is off by what it misses.
            fineness, high, ahead = 2 * fineness, math.inf, 0.0
            duration = max(strongest[0], search.first_bound_rad)
            low = duration
        elif high < math.inf:
            duration = (low + high) / 2
        else:
            # The c of a duration far too short says little: go ahead by more and more.
            duration, ahead = low + ahead * gained, min(max(2 * ahead, 1.0), FARTHEST_AHEAD)
    if best is not None:
        yield replace(best, vectors=strongest[1])
    modes = problem.unit_poles.size
    raise InfeasibleDesignError(
        f"no command found without vibration in {f'all {modes} modes' if modes > 1 else 'the mode'}"
        f": none is shorter than {strongest[0] / PERIOD_RAD:.6g} periods of the slowest, and "
        f"{programs} linear programs led to none{f'; {budget.in_words}' if budget.spent else ''}"
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Obstacle:
    """What a linear program finds against a duration: c, and its own command.

    Attributes
    ----------
    vectors
        c, shape (m,) [-].
    grid
        Times of the grid, shape (k + 1,) [rad].
    unknowns
        Amplitudes at them, or the command between two of them, shape (k + 1,) or (k,) [-].
    """

    vectors: ComplexArray
    grid: FloatArray
    unknowns: FloatArray

    @property
    def cell(self) -> float:
        """Distance of two times of the grid [rad]."""
        return float(self.grid[1])


class _Search:
    """The functions of time that belong to one plant."""

    def __init__(self, poles: ComplexArray, *, positive: bool) -> None:
        self.poles = poles
        self.positive = positive
        self.fastest = float(np.abs(poles).max())
        decay = max(float(np.abs(poles.real).max()), MOST_DECAY / LARGEST)
        self.horizon_rad = min(LONGEST_TURNS * PERIOD_RAD * poles.size, MOST_DECAY / decay)
        slowest = float(np.abs(poles).min())
        # A shaper of the slowest mode alone takes half a period, a third where steps go both ways.
        self.first_bound_rad = 0.99 * PERIOD_RAD / slowest / (2 if positive else 3)

    def swings(self, times: FloatArray, order: int = 0) -> ComplexArray:
        """Return ``exp(-s t)`` or its derivative in time, shape (m, n)."""
        s = self.poles[:, None]
        found: ComplexArray = (-s) ** order * np.exp(-s * times)
        return found

    def pull(self, vectors: ComplexArray, times: FloatArray, order: int = 0) -> FloatArray:
        """Return P or a derivative, shape (n,)."""
        found: FloatArray = (vectors.conj() @ self.swings(times, order)).real
        return found

    def cells(self, duration: float, fineness: float) -> int:
        """Return the number of cells of the grid of a linear program."""
        turns = duration * self.fastest / PERIOD_RAD
        return int(fineness * max(FEWEST_CELLS, CELLS_A_TURN * turns))

    def work_of(self, duration: float, fineness: float) -> float:
        """Return the work of a linear program, and of what follows from it [units]."""
        equations = 2 * self.poles.size
        return PROGRAM_WORK + CELL_WORK * equations * self.cells(duration, fineness)

    def obstacle_to(self, duration: float, fineness: float) -> _Obstacle | None:
        """Return the c that shows best that a duration is too short; None if it is not on the grid.

        Equations are scaled so that each is the vibration at the end.
        """
        cells = self.cells(duration, fineness)
        grid = np.linspace(0, duration, cells + 1)
        swings = self.swings(grid)
        scaled = swings * np.exp(self.poles.real * duration)[:, None]
        if self.positive:
            matrix, right = scaled, np.zeros(self.poles.size)
        else:
            matrix, right = np.diff(scaled), scaled[:, -1]
        solved = highs.least_violation(
            np.vstack((matrix.real, matrix.imag)),
            np.concatenate((right.real, right.imag)),
            sum_to_one=self.positive,
        )
        if solved is None or solved.violation < ZERO:
            return None
        real, imaginary = np.split(solved.multipliers, 2)
        vectors = (real + 1j * imaginary) * np.exp(self.poles.real * duration)
        if self.positive:
            vectors = -vectors
        return _Obstacle(
            vectors=vectors / np.linalg.norm(vectors),
            grid=grid,
            unknowns=solved.unknowns,
        )

    def zeros(self, vectors: ComplexArray, until: float, order: int) -> FloatArray:
        """Return where a derivative of P changes its sign, shape (k,) [rad]."""
        points = max(64, int(POINTS_A_TURN * self.fastest * until / PERIOD_RAD))
        times = np.linspace(0, until, points)
        values = self.pull(vectors, times, order)
        left = np.flatnonzero(values[:-1] * values[1:] < 0)
        low, high = times[left], times[left + 1]
        rising = values[left] < 0
        for _ in range(50):  # halves the step to its last digit
            middle = (low + high) / 2
            before = (self.pull(vectors, middle, order) < 0) == rising
            low, high = np.where(before, middle, low), np.where(before, high, middle)
        return (low + high) / 2

    def bound_rad(self, vectors: ComplexArray) -> float:
        """Return the duration that c excludes, as far as the search for zeros sees."""
        if self.pull(vectors, np.zeros(1))[0] <= 0:
            return 0.0
        until = 4 * self.first_bound_rad
        while True:
            found = self._bound_until(vectors, until)
            if found < until or until > self.horizon_rad:
                return found
            until *= 2

    def _bound_until(self, vectors: ComplexArray, until: float) -> float:
        turning = np.concatenate(([0.0], self.zeros(vectors, until, 1), [until]))
        heights = self.pull(vectors, turning)
        if self.positive:
            low = np.flatnonzero(heights <= 0)
            if not low.size:
                return until
            last, level = int(low[0]) - 1, 0.0
        else:
            falls = np.cumsum(np.maximum(heights[:-1] - heights[1:], 0))
            last = int(np.searchsorted(falls, heights[0]))
            if last == falls.size:
                return until
            level = float(heights[last + 1] + falls[last] - heights[0])
        low_end, high_end = float(turning[last]), float(turning[last + 1])
        for _ in range(60):
            middle = (low_end + high_end) / 2
            if self.pull(vectors, np.array([middle]))[0] > level:
                low_end = middle
            else:
                high_end = middle
        return low_end

    def structures(self, obstacle: _Obstacle, duration: float) -> Iterator[FloatArray]:
        """Yield how the impulses may lie, by c and then by the linear program, shape (n,) [rad]."""
        turning = self.zeros(obstacle.vectors, duration, 1)
        if not self.positive:
            if turning.size % 2:
                yield np.concatenate(([0.0], turning, [duration]))
            switches = _switches(obstacle)
            if switches.size > 1:
                yield switches
            return
        lowest = turning[self.pull(obstacle.vectors, turning, 2) > 0]
        support = obstacle.grid[obstacle.unknowns > ZERO]
        distances = np.abs(lowest[:, None] - support).min(axis=1, initial=np.inf)
        yield np.concatenate(([0.0], lowest[distances < 2 * obstacle.cell], [duration]))
        for least in (ZERO, PRESENT * float(obstacle.unknowns.max())):
            present = obstacle.grid[obstacle.unknowns > least]
            groups = np.flatnonzero(np.diff(present) > 1.5 * obstacle.cell) + 1
            centres = np.array([part.mean() for part in np.split(present, groups)])
            inner = (centres > obstacle.cell) & (centres < duration - obstacle.cell)
            yield np.concatenate(([0.0], centres[inner], [duration]))

    def sharpened(self, vectors: ComplexArray, times: FloatArray, programs: int) -> Shortest | None:
        """Solve the conditions of optimality from c and times near them; None where that fails."""
        amplitudes = np.where(np.arange(times.size) % 2 == 0, 1.0, -1.0)
        if self.positive:
            amplitudes = self._least_squares_amplitudes(times)
        iterations, farthest = 0, STRAYED * times[-1]
        while iterations < NEWTON_STEPS:
            iterations += 1
            step = self._newton_step(times, amplitudes, vectors)
            moved = step[: times.size - 1]
            gaps, changes = np.diff(times), np.diff(moved, prepend=0.0)
            closing = changes < 0
            share = min(1.0, 0.7 * float(np.min(-gaps[closing] / changes[closing], initial=2.0)))
            step = share * step
            times = times + np.concatenate(([0.0], step[: times.size - 1]))
            rest = step[times.size - 1 :]
            if self.positive:
                amplitudes = amplitudes + rest[: times.size]
                rest = rest[times.size :]
            real, imaginary = np.split(rest, 2)
            vectors = vectors + real + 1j * imaginary
            if times[-1] > farthest:
                return None
            if share == 1 and np.abs(step).max() < CONVERGED:
                break
        left = np.abs(self.swings(times) @ amplitudes) * np.exp(self.poles.real * times[-1])
        good = (
            left.max() < ZERO
            and np.diff(times).min() > SHORTEST_GAP_RAD
            and (amplitudes.min() > ROUNDING or not self.positive)
        )
        if not good:
            return None
        if self.positive:
            vectors = self._lifted(vectors, times)
        return Shortest(
            times_rad=times,
            amplitudes=amplitudes,
            vectors=vectors / np.linalg.norm(vectors),
            iterations=iterations,
            programs=programs,
        )

    def _lifted(self, vectors: ComplexArray, times: FloatArray) -> ComplexArray:
        """Return c with P a little above zero where it touched, so that it passes it once only."""
        swings = self.swings(times[:-1]).T
        rows = np.hstack((swings.real, swings.imag))
        real, imaginary = np.split(np.linalg.lstsq(rows, np.ones(times.size - 1), rcond=None)[0], 2)
        lifted: ComplexArray = vectors + LIFT * (real + 1j * imaginary)
        return lifted

    def _least_squares_amplitudes(self, times: FloatArray) -> FloatArray:
        swings = self.swings(times) * np.exp(self.poles.real * times[-1])[:, None]
        rows = np.vstack((swings.real, swings.imag, np.ones(times.size)))
        right = np.append(np.zeros(2 * self.poles.size), 1.0)
        found: FloatArray = np.linalg.lstsq(rows, right, rcond=None)[0]
        return found

    def _newton_step(
        self, times: FloatArray, amplitudes: FloatArray, vectors: ComplexArray
    ) -> FloatArray:
        """Return the step of times, of amplitudes if positive, and of c: real, then imaginary.

        Equations: V = 0; the amplitudes' sum; ``|c| = 1``; ``P' = 0`` at the inner impulses, and of
        positive amplitudes ``P = 0`` at all: one equation too many but consistent, for
        ``sum A_i P(t_i)`` is zero where V is. Least squares minds neither that nor a c that
        is not unique.
        """
        m, n = self.poles.size, times.size
        scale = np.exp(self.poles.real * times[-1])[:, None]
        swings, rates, bends = (self.swings(times, order) for order in range(3))
        left = (swings @ amplitudes) * scale[:, 0]
        c = vectors.conj()
        inner = slice(1, n - 1)
        own = n - 1 + n * self.positive  # unknowns ahead of c
        rows, values = [], []

        def add(block: FloatArray, value: FloatArray) -> None:
            rows.append(block)
            values.append(value)

        def derivative_in_c(columns: ComplexArray) -> FloatArray:
            return np.hstack((columns.real.T, columns.imag.T))

        vibration = np.zeros((m, own + 2 * m), dtype=np.complex128)
        vibration[:, : n - 1] = rates[:, 1:] * amplitudes[1:] * scale
        if self.positive:
            vibration[:, n - 1 : own] = swings * scale
        add(np.vstack((vibration.real, vibration.imag)), np.concatenate((left.real, left.imag)))
        flat = np.zeros((n - 2, own + 2 * m))
        flat[np.arange(n - 2), np.arange(n - 2)] = (c @ bends[:, inner]).real
        flat[:, own:] = derivative_in_c(rates[:, inner])
        add(flat, (c @ rates[:, inner]).real)
        if self.positive:
            total = np.zeros((1, own + 2 * m))
            total[0, n - 1 : own] = 1.0
            add(total, np.array([amplitudes.sum() - 1]))
            touching = np.zeros((n, own + 2 * m))
            touching[np.arange(1, n), np.arange(n - 1)] = (c @ rates[:, 1:]).real
            touching[:, own:] = derivative_in_c(swings)
            add(touching, (c @ swings).real)
        length = np.zeros((1, own + 2 * m))
        length[0, own:] = 2 * np.concatenate((vectors.real, vectors.imag))
        add(length, np.array([float((np.abs(vectors) ** 2).sum()) - 1]))
        found: FloatArray = np.linalg.lstsq(np.vstack(rows), -np.concatenate(values), rcond=1e-13)[
            0
        ]
        return found


def _switches(obstacle: _Obstacle) -> FloatArray:
    """Return when the linear program's own command goes up and down, to a cell [rad]."""
    high = np.concatenate(([False], obstacle.unknowns > 1 / 2, [True]))
    times = obstacle.grid[np.flatnonzero(high[1:] != high[:-1])]
    switches: FloatArray = times - times[0]
    return switches
