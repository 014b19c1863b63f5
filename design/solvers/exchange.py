"""Minimum time over a band of frequencies: peaks exchanged in until none is above the tolerance.

A step minimises the duration over the disks in which the linearised vectors must stay, at the ends
of the band, at the peaks between them as they are now, and at a few ratios more (`disks`); the
Lagrangian's curvature is part of it, so that the last steps halve the digits that are wrong. Steps
are kept within a radius that adapts, and measured by the duration plus the price of what is above
the tolerance anywhere in the band (R. Fletcher, "Practical methods of optimization", 2nd ed.,
section 14.4: exact penalty, second-order correction).
"""

import functools
import math
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from design.errors import InfeasibleDesignError, TimeLimitError
from design.shapers.problem import BandModel, BandSearch, Seed, UnityBandProblem
from design.solvers.buffered import Buffered
from design.solvers.disks import DISKS, step_over_disks
from design.solvers.outcome import Status
from design.types import BoolArray, FloatArray, IntArray

AIM = 1e-9
"""Share of the tolerance by which a design stays below it: what is left of its last step [-]."""

LANES = 64
"""Ratios that are looked at by one call of the compiled expressions."""

LONGEST_TURN_RAD = 0.1
"""Turn of the last impulse's phase from one ratio to the next, where peaks are looked for [rad]."""

PEAKS = 8
"""Peaks that are refined by one call."""

PEAK_STEPS = 4
"""Newton's steps to a peak from the highest of three neighbours."""

FIXED = 7
"""Ratios that are always among the disks: cosines over the band, its ends included."""

ENDS = 2
"""The ends of the band come first among the ratios."""

NEAR = 0.2
"""A peak nearer than this to one of them stands for it, as a share of the half width [-]."""

FIRST_RADIUS_RAD = 0.3
LARGEST_RADIUS_RAD = 0.5
SMALLEST_RADIUS_RAD = 1e-9
"""Bounds of the farthest that one gap moves in a step: a twentieth of a period at first [rad]."""

LAST_STEP_RAD = 1e-6
"""A step this short is the last: what it neglects is its square over the tolerance [rad]."""

LAST_GAIN_RAD = 1e-6
"""A step that gains less than this is one along a flat valley: what follows only restores [rad]."""

FIRMNESS = 1e5
"""Curvature that keeps steps from then on short, but for what is above the tolerance [1/rad]."""

MOST_STEPS = 40

LEAST_CURVATURE = 1e-3
"""Of the Lagrangian along any direction: keeps each program convex [1/rad]."""

PRICES = (0.3, 1.0, 1e4)
"""Least, first and highest price of a square that is above the tolerance's by itself [rad]."""

COMPARED = 2
"""Seeds of one number of impulses of whose designs the shorter is taken."""

FAR_MISS = 1.2
"""A run that ends with so many times the tolerance is no matter of where it began [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BandCandidate:
    """A design over a band by the solver's word, not yet verified.

    Attributes
    ----------
    problem
        What it solves.
    gaps_rad
        Gaps between its impulses, shape (n - 1,) [rad].
    seed
        Name of the start that led to it.
    iterations
        Steps from there.
    starts
        Starts tried so far, of fewer impulses too.
    """

    problem: UnityBandProblem
    gaps_rad: FloatArray
    seed: str
    iterations: int
    starts: int


@dataclass(frozen=True, slots=True, eq=False)
class _Peaks:
    """The ends of the band and the local maxima between them."""

    ratios: FloatArray
    squares: FloatArray  # of the residual over the tolerance's

    @property
    def excess(self) -> float:
        return max(float(self.squares.max()) - 1, 0.0)


class _Family:
    """What a family's impulses leave over a band, compiled."""

    def __init__(self, model: BandModel) -> None:
        import casadi as ca  # noqa: PLC0415

        parts = model.expressions()
        x, p, ratio, vector = parts.unknowns, parts.parameters, parts.ratio, parts.vibration
        self.size = int(x.numel())

        def compiled(lanes: int, names: str, given: list[Any], found: list[Any]) -> Buffered:
            inputs, outputs = (one.split() for one in names.split("->"))
            one = ca.Function("band", given, [ca.densify(part) for part in found], inputs, outputs)
            return Buffered(one.map(lanes), tuple(inputs), tuple(outputs))

        square = ca.sumsqr(vector)
        slope = ca.gradient(square, ratio)
        bend = ca.gradient(slope, ratio)
        self._squares = compiled(LANES, "x p ratio -> square", [x, p, ratio], [square])
        self._slopes = compiled(
            PEAKS, "x p ratio -> square slope bend", [x, p, ratio], [square, slope, bend]
        )
        self._vectors = compiled(
            DISKS, "x p ratio -> vector jacobian", [x, p, ratio], [vector, ca.jacobian(vector, x)]
        )
        weights = ca.SX.sym("weights", 2)
        self._curvatures = compiled(
            DISKS,
            "x p ratio weights -> hessian mixed bend",
            [x, p, ratio, weights],
            [
                ca.hessian(ca.dot(weights, vector), x)[0],
                ca.gradient(slope, x),
                ca.gradient(slope, ratio),
            ],
        )

    @staticmethod
    def _given(function: Buffered, x: FloatArray, p: FloatArray, ratios: FloatArray) -> None:
        """Write the inputs; lanes without a ratio repeat the nominal one."""
        each = function.inputs["ratio"]
        function.inputs["x"].reshape(each.size, -1)[:] = x
        function.inputs["p"].reshape(each.size, -1)[:] = p
        each[: ratios.size], each[ratios.size :] = ratios, 1.0

    def squares(self, x: FloatArray, p: FloatArray, ratios: FloatArray) -> FloatArray:
        """Return the squared residuals at a multiple of `LANES` ratios, shape (m,)."""
        found = np.empty(ratios.size)
        for first in range(0, ratios.size, LANES):
            part = slice(first, first + LANES)
            self._given(self._squares, x, p, ratios[part])
            self._squares.run()
            found[part] = self._squares.outputs["square"]
        return found

    def vectors(
        self, x: FloatArray, p: FloatArray, ratios: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return vectors, shape (m, 2), and Jacobians, shape (m, 2, n)."""
        self._given(self._vectors, x, p, ratios)
        self._vectors.run()
        vectors = self._vectors.outputs["vector"].reshape(DISKS, 2)[: ratios.size].copy()
        jacobians = self._vectors.outputs["jacobian"].reshape(DISKS, self.size, 2)
        return vectors, jacobians[: ratios.size].swapaxes(1, 2).copy()

    def curvature(
        self,
        x: FloatArray,
        p: FloatArray,
        ratios: FloatArray,
        weights: FloatArray,
        moving: BoolArray,
    ) -> FloatArray:
        """Return the second derivatives of weighted squares less ``2 J' J``, shape (n, n).

        The largest of a square over the ratio moves with x where it is a peak: that bends it by
        ``-m m' / b``, m and b the derivatives of its slope in ratio by x and by ratio.
        """
        vectors, _ = self.vectors(x, p, ratios)
        self._given(self._curvatures, x, p, ratios)
        each = self._curvatures.inputs["weights"].reshape(DISKS, 2)
        each[: ratios.size], each[ratios.size :] = 2 * weights[:, None] * vectors, 0.0
        self._curvatures.run()
        found = self._curvatures.outputs
        mixed = found["mixed"].reshape(DISKS, self.size)[: ratios.size]
        bend = found["bend"][: ratios.size]
        peaked = moving & (bend < 0)
        pulls = np.where(peaked, weights / np.where(peaked, -bend, 1.0), 0.0)
        own = found["hessian"].reshape(DISKS, self.size, self.size).sum(axis=0)
        curvature: FloatArray = own + np.einsum("k,ki,kj->ij", pulls, mixed, mixed)
        return curvature

    def peaks(self, x: FloatArray, p: FloatArray, half_width: float, limit: float) -> _Peaks:
        """Return ends and local maxima of the residual over a band."""
        turn = 2 * half_width * float(x.sum())
        blocks = 1 + int(turn / (LANES * LONGEST_TURN_RAD))
        ratios = np.linspace(1 - half_width, 1 + half_width, LANES * blocks)
        squares = self.squares(x, p, ratios)
        # An end that is higher than its neighbour may hide a peak between the two.
        padded = np.pad(squares, 1, constant_values=-np.inf)
        at = np.flatnonzero((squares >= padded[:-2]) & (squares >= padded[2:]))
        found, heights = ratios[at], squares[at]
        for first in range(0, at.size, PEAKS):
            part = slice(first, first + PEAKS)
            found[part], heights[part] = self._refined(x, p, ratios, at[part])
        inside = (found > ratios[0]) & (found < ratios[-1])
        return _Peaks(
            np.concatenate((ratios[[0, -1]], found[inside])),
            np.concatenate((squares[[0, -1]], heights[inside])) / limit**2,
        )

    def _refined(
        self, x: FloatArray, p: FloatArray, ratios: FloatArray, at: IntArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the maxima between the neighbours of some ratios, by Newton's method."""
        found = ratios[at]
        lowest, highest = ratios[np.maximum(at - 1, 0)], ratios[np.minimum(at + 1, ratios.size - 1)]
        for step in range(PEAK_STEPS + 1):
            self._given(self._slopes, x, p, found)
            self._slopes.run()
            square, slope, bend = (one[: at.size] for one in self._slopes.outputs.values())
            if step < PEAK_STEPS:
                down = bend < 0
                moved = found - np.where(down, slope / np.where(down, bend, -1.0), 0.0)
                found = np.clip(moved, lowest, highest)
        return found, square.copy()


_one_at_a_time = threading.Lock()


@functools.cache
def _family(model: BandModel) -> _Family:
    return _Family(model)


@dataclass(frozen=True, slots=True, eq=False)
class _Run:
    """The end of the steps from one start."""

    gaps_rad: FloatArray
    highest: float  # over the band, as a share of the tolerance
    converged: bool
    steps: int


class _Descent:
    """Steps from one start."""

    def __init__(self, problem: UnityBandProblem, half_width: float, tolerance: float) -> None:
        self.family = _family(problem.model)
        self.parameters = problem.parameters
        self.shortest = problem.shortest_gaps_rad
        self.half_width = half_width
        self.limit = tolerance * (1 - AIM)
        self.price = PRICES[1]
        self.fixed = 1 - half_width * np.cos(np.linspace(0, np.pi, FIXED))
        self.firmness = 0.0
        self.multipliers = np.zeros((2, 0))  # ratios and multipliers of the last program

    def peaks(self, gaps: FloatArray) -> _Peaks:
        return self.family.peaks(gaps, self.parameters, self.half_width, self.limit)

    def run(self, start: FloatArray) -> _Run:
        """Step until nothing is gained."""
        gaps = np.maximum(start, self.shortest)
        peaks = self.peaks(gaps)
        radius = FIRST_RADIUS_RAD
        taken = 0
        while taken < MOST_STEPS and radius > SMALLEST_RADIUS_RAD:
            taken += 1
            found = self._step(gaps, peaks, radius)
            if found is None:
                radius /= 4
                continue
            step, slack, promised, gained, after = found
            longest = float(np.abs(step).max())
            if gained > promised / 10 or longest <= LAST_STEP_RAD:
                gaps, peaks = gaps + step, after
                if gained > 0.7 * promised:
                    radius = min(2 * radius, LARGEST_RADIUS_RAD)
                self._reprice(slack, peaks.excess)
                if gained <= LAST_GAIN_RAD:
                    self.firmness = FIRMNESS
                if longest <= LAST_STEP_RAD and (peaks.excess <= AIM or self.price >= PRICES[2]):
                    break
            else:
                radius = min(radius, longest) / 3
        highest = math.sqrt(float(peaks.squares.max())) * (1 - AIM)
        return _Run(gaps, highest, highest <= 1, taken)

    def _reprice(self, slack: float, excess: float) -> None:
        """Raise the price where a program would rather pay it, lower it where it need not."""
        least, _, highest = PRICES
        if slack > max(AIM, 0.1 * excess):
            self.price = min(10 * self.price, highest)
        elif slack <= AIM:
            enough = max(2 * float(self.multipliers[1].sum()), least)
            self.price = max(self.price / 3, min(self.price, enough))

    def _step(
        self, gaps: FloatArray, peaks: _Peaks, radius: float
    ) -> tuple[FloatArray, float, float, float, _Peaks] | None:
        """Return a step, its slack, what it promised and gained, and the peaks after it."""
        ratios = self._ratios(peaks)
        vectors, jacobians = (
            part / self.limit for part in self.family.vectors(gaps, self.parameters, ratios)
        )
        bounds = np.maximum(self.shortest - gaps, -radius), np.full(gaps.size, radius)
        bend = self._bend(gaps, ratios, jacobians)
        solved = self._solved(vectors, jacobians, bend, bounds)
        if solved is None:
            return None
        step, slack, multipliers = solved
        promised = self.price * (peaks.excess - slack) - float(step.sum() + step @ bend @ step / 2)
        after = self.peaks(gaps + step)
        gained = self.price * (peaks.excess - after.excess) - float(step.sum())
        if gained < promised / 2 and np.abs(step).max() > LAST_STEP_RAD:
            # What the linear vectors missed at the end of the step, taken into account.
            there = self.family.vectors(gaps + step, self.parameters, ratios)[0] / self.limit
            again = self._solved(there - jacobians @ step, jacobians, bend, bounds)
            if again is not None:
                other = self.peaks(gaps + again[0])
                better = self.price * (peaks.excess - other.excess) - float(again[0].sum())
                if better > gained:
                    step, _, multipliers = again
                    gained, after = better, other
        self.multipliers = np.vstack((ratios, multipliers))
        return step, slack, promised, gained, after

    def _ratios(self, peaks: _Peaks) -> FloatArray:
        """Return the ends, the highest peaks, and fixed ratios where no peak is near."""
        highest = np.argsort(-peaks.squares[2:], kind="stable")[: DISKS - FIXED]
        moving = np.concatenate((peaks.ratios[:2], peaks.ratios[2:][highest]))
        apart = np.abs(self.fixed[:, None] - moving).min(axis=1) > NEAR * self.half_width
        return np.concatenate((moving, self.fixed[apart]))

    def _solved(
        self,
        vectors: FloatArray,
        jacobians: FloatArray,
        bend: FloatArray,
        bounds: tuple[FloatArray, FloatArray],
    ) -> tuple[FloatArray, float, FloatArray] | None:
        outcome, multipliers = step_over_disks(vectors, jacobians, bend, self.price, bounds)
        if outcome.status is Status.TIME_LIMIT:
            raise TimeLimitError("ipopt ran past its time in a step over a band")
        if outcome.status is not Status.SOLVE_SUCCEEDED:
            return None
        step = np.clip(outcome.unknowns[:-1], *bounds)
        return step, max(float(outcome.unknowns[-1]), 0.0), multipliers

    def _bend(self, gaps: FloatArray, ratios: FloatArray, jacobians: FloatArray) -> FloatArray:
        """Return the Lagrangian's second derivatives without those of the disks themselves.

        With the last multipliers, each given to the nearest ratio of this program. The whole, the
        disks' own ``2 sum(lambda J' J)`` included, is made positive along every direction.
        """
        weights = np.zeros(ratios.size)
        for ratio, multiplier in self.multipliers.T:
            weights[np.argmin(np.abs(ratios - ratio))] += max(multiplier, 0.0)
        own: FloatArray = 2 * np.einsum("k,kci,kcj->ij", weights, jacobians, jacobians)
        moving = (np.arange(ratios.size) >= ENDS) & np.isin(ratios, self.fixed, invert=True)
        per_square = weights / self.limit**2
        whole = own + self.family.curvature(gaps, self.parameters, ratios, per_square, moving)
        values, axes = np.linalg.eigh((whole + whole.T) / 2)
        bend: FloatArray = (axes * np.maximum(values, LEAST_CURVATURE)) @ axes.T - own
        return (bend if weights.any() else 0.0) + self.firmness * np.eye(gaps.size)


def band_candidates(search: BandSearch) -> Iterator[BandCandidate]:
    """Yield designs over a band, of the fewest impulses first.

    Of every number of impulses two seeds are compared; where one ends far above the tolerance, the
    others wait until more impulses have been tried.

    Raises
    ------
    InfeasibleDesignError
        When all candidates, if any, are used up: says what came nearest.
    TimeLimitError
        If the solver ran past its time.
    """
    runs = _Runs(search)
    later = []
    for problem in search.problems:
        tried, found = 0, []
        for seed in problem.seeds:
            run = runs.run(problem, seed)
            tried += 1
            found += runs.candidate(problem, seed, run)
            if run.highest > FAR_MISS or (found and tried >= COMPARED):
                break
        yield from sorted(found, key=lambda one: float(one.gaps_rad.sum()))
        later += [(problem, seed) for seed in problem.seeds[tried:]]
    for problem, seed in later:
        yield from runs.candidate(problem, seed, runs.run(problem, seed))
    raise InfeasibleDesignError(runs.searched())


class _Runs:
    """What was tried so far."""

    def __init__(self, search: BandSearch) -> None:
        self.search = search
        self.starts = 0
        self.nearest, self.late = math.inf, math.inf

    def run(self, problem: UnityBandProblem, seed: Seed) -> _Run:
        """Run from a seed."""
        self.starts += 1
        with _one_at_a_time:
            run = _Descent(problem, self.search.half_width, self.search.tolerance).run(
                seed.gaps_rad
            )
        self.nearest = min(self.nearest, run.highest)
        return run

    def candidate(self, problem: UnityBandProblem, seed: Seed, run: _Run) -> list[BandCandidate]:
        """Return the end of a run, if it is a candidate."""
        duration = float(run.gaps_rad.sum())
        if run.converged and duration > self.search.horizon_rad:
            self.late = min(self.late, duration)
        elif run.converged:
            return [
                BandCandidate(
                    problem=problem,
                    gaps_rad=run.gaps_rad,
                    seed=seed.name,
                    iterations=run.steps,
                    starts=self.starts,
                )
            ]
        return []

    def searched(self) -> str:
        """Say how far was searched, and what came nearest."""
        search, period = self.search, 2 * math.pi
        counts = sorted(problem.amplitudes.size for problem in search.problems)
        report = (
            f"no shaper of {' or '.join(map(str, counts))} impulses of unity magnitude was found "
            f"that leaves at most {search.tolerance:g} from {1 - search.half_width:.6g} to "
            f"{1 + search.half_width:.6g} of the frequency, within {search.horizon_rad / period:g} "
            f"periods in {self.starts} starts"
        )
        if self.late < math.inf:
            return f"{report}; the shortest takes {self.late / period:.6g} periods"
        return f"{report}; the nearest miss leaves {self.nearest * search.tolerance:.4g} there"
