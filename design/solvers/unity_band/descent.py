"""Steps to minimum time from one start: peaks exchanged in until none is above the tolerance.

A step minimises the duration over the disks in which the linearised vectors must stay, at the ends
of the band, at the peaks between them as they are now, and at a few ratios more (`disks`); the
Lagrangian's curvature is part of it, so that the last steps halve the digits that are wrong. Steps
are kept within a radius that adapts, and measured by the duration plus the price of what is above
the tolerance anywhere in the band (R. Fletcher, "Practical methods of optimization", 2nd ed.,
section 14.4: exact penalty, second-order correction).
"""

import math
from dataclasses import dataclass

import numpy as np

from design.errors import TimeLimitError
from design.formulations.bands import UnityBandProblem
from design.solvers.budget import Budget
from design.solvers.outcome import Status
from design.solvers.trust_region_step import DISKS, step_over_disks
from design.solvers.unity_band.family import Peaks, family_of
from design.types import FloatArray

AIM = 1e-9
"""Share of the tolerance by which a design stays below it: what is left of its last step [-]."""

FIXED = 7
"""Ratios that are always among the disks: cosines over the band, its ends included."""

ENDS = 2
"""The ends of the band come first among the ratios."""

NEAR = 0.2
"""A peak nearer than this to one of them stands for it, as a share of the half width [-]."""

FIRST_RADIUS_RAD = 0.3
MAX_RADIUS_RAD = 0.5
MIN_RADIUS_RAD = 1e-9
"""Bounds of the farthest that one gap moves in a step: a twentieth of a period at first [rad]."""

LAST_STEP_RAD = 1e-6
"""A step this short is the last: what it neglects is its square over the tolerance [rad]."""

LAST_GAIN_RAD = 1e-6
"""A step that gains less than this is one along a flat valley: what follows only restores [rad]."""

FIRMNESS = 1e5
"""Curvature that keeps steps from then on short, except for what is above the tolerance [1/rad]."""

MAX_STEPS = 40

MIN_CURVATURE = 1e-3
"""Of the Lagrangian along any direction: keeps each program convex [1/rad]."""

STEP_WORK = 10_000.0
"""Work of a step: of its programs, of vectors and curvature [units]."""

PRICES = (0.3, 1.0, 1e4)
"""Least, first and highest price of a square that is above the tolerance's by itself [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """The end of the steps from one start.

    Attributes
    ----------
    gaps_rad
        Gaps between the impulses, shape (n - 1,) [rad].
    highest
        Largest residual over the band, as a share of the tolerance [-].
    converged
        Whether that is within it.
    steps
        Steps taken.
    """

    gaps_rad: FloatArray
    highest: float
    converged: bool
    steps: int


class Descent:
    """Steps from one start."""

    def __init__(
        self, problem: UnityBandProblem, half_width: float, tolerance: float, budget: Budget
    ) -> None:
        self.family = family_of(problem.model)
        self.parameters = problem.parameters
        self.shortest = problem.shortest_gaps_rad
        self.half_width = half_width
        self.limit = tolerance * (1 - AIM)
        self.price = PRICES[1]
        self.budget = budget
        self.fixed = 1 - half_width * np.cos(np.linspace(0, np.pi, FIXED))
        self.firmness = 0.0
        self.multipliers = np.zeros((2, 0))  # ratios and multipliers of the last program

    def peaks(self, gaps: FloatArray) -> Peaks:
        """Return the peaks that gaps leave."""
        self.budget.spend(self.family.peaks_work(gaps, self.half_width))
        return self.family.peaks(gaps, self.parameters, self.half_width, self.limit)

    def run(self, start: FloatArray) -> Run:
        """Step until nothing is gained.

        Parameters
        ----------
        start
            Gaps to start from, shape (n - 1,) [rad].

        Returns
        -------
        Run
            Where the steps ended, within the tolerance or not.

        Raises
        ------
        TimeLimitError
            If IPOPT ran past its time in a step.
        """
        gaps = np.maximum(start, self.shortest)
        peaks = self.peaks(gaps)
        radius = FIRST_RADIUS_RAD
        taken = 0
        while taken < MAX_STEPS and radius > MIN_RADIUS_RAD and not self.budget.spent:
            taken += 1
            self.budget.spend(STEP_WORK)
            found = self._step(gaps, peaks, radius)
            if found is None:
                radius /= 4
                continue
            step, slack, promised, gained, after = found
            longest = float(np.abs(step).max())
            if gained > promised / 10 or longest <= LAST_STEP_RAD:
                gaps, peaks = gaps + step, after
                if gained > 0.7 * promised:
                    radius = min(2 * radius, MAX_RADIUS_RAD)
                self._reprice(slack, peaks.excess)
                if gained <= LAST_GAIN_RAD:
                    self.firmness = FIRMNESS
                if longest <= LAST_STEP_RAD and (peaks.excess <= AIM or self.price >= PRICES[2]):
                    break
            else:
                radius = min(radius, longest) / 3
        highest = math.sqrt(float(peaks.squares.max())) * (1 - AIM)
        return Run(gaps, highest, highest <= 1, taken)

    def _reprice(self, slack: float, excess: float) -> None:
        """Raise the price where a program would rather pay it, lower it where it need not."""
        least, _, highest = PRICES
        if slack > max(AIM, 0.1 * excess):
            self.price = min(10 * self.price, highest)
        elif slack <= AIM:
            enough = max(2 * float(self.multipliers[1].sum()), least)
            self.price = max(self.price / 3, min(self.price, enough))

    def _step(
        self, gaps: FloatArray, peaks: Peaks, radius: float
    ) -> tuple[FloatArray, float, float, float, Peaks] | None:
        """Return a step, its slack, what it promised and gained, and the peaks after it."""
        ratios = self._ratios(peaks)
        vectors, jacobians = (
            part / self.limit for part in self.family.vectors(gaps, self.parameters, ratios)
        )
        bounds = np.maximum(self.shortest - gaps, -radius), np.full(gaps.size, radius)
        bend = self._bend(gaps, ratios, jacobians)
        solved = self._solve_step(vectors, jacobians, bend, bounds)
        if solved is None:
            return None
        step, slack, multipliers = solved
        promised = self.price * (peaks.excess - slack) - float(step.sum() + step @ bend @ step / 2)
        after = self.peaks(gaps + step)
        gained = self.price * (peaks.excess - after.excess) - float(step.sum())
        if gained < promised / 2 and np.abs(step).max() > LAST_STEP_RAD:
            # What the linear vectors missed at the end of the step, taken into account.
            there = self.family.vectors(gaps + step, self.parameters, ratios)[0] / self.limit
            again = self._solve_step(there - jacobians @ step, jacobians, bend, bounds)
            if again is not None:
                other = self.peaks(gaps + again[0])
                better = self.price * (peaks.excess - other.excess) - float(again[0].sum())
                if better > gained:
                    step, _, multipliers = again
                    gained, after = better, other
        self.multipliers = np.vstack((ratios, multipliers))
        return step, slack, promised, gained, after

    def _ratios(self, peaks: Peaks) -> FloatArray:
        """Return the ends, the highest peaks, and fixed ratios where no peak is near."""
        highest = np.argsort(-peaks.squares[2:], kind="stable")[: DISKS - FIXED]
        moving = np.concatenate((peaks.ratios[:2], peaks.ratios[2:][highest]))
        apart = np.abs(self.fixed[:, None] - moving).min(axis=1) > NEAR * self.half_width
        return np.concatenate((moving, self.fixed[apart]))

    def _solve_step(
        self,
        vectors: FloatArray,
        jacobians: FloatArray,
        bend: FloatArray,
        bounds: tuple[FloatArray, FloatArray],
    ) -> tuple[FloatArray, float, FloatArray] | None:
        outcome, multipliers = step_over_disks(vectors, jacobians, bend, self.price, bounds)
        if outcome.status is Status.TIME_LIMIT:
            raise TimeLimitError(
                "ipopt ran past its time in a step over a band", code="band_step_past_time"
            )
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
        bend: FloatArray = (axes * np.maximum(values, MIN_CURVATURE)) @ axes.T - own
        return (bend if weights.any() else 0.0) + self.firmness * np.eye(gaps.size)
