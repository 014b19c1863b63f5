"""The command over a band that ends first behind limits and two lags, from that behind one lag."""

import math
from dataclasses import dataclass

import numpy as np

from design.formulations.unequal_band import UnequalBandProblem
from design.solvers.budget import Budget
from design.solvers.convex_band.duration import ripples_of
from design.solvers.ramps.band_polish import Seen, polish
from design.solvers.ramps.unequal_course import TwoLags
from design.trace import TraceStep
from design.types import FloatArray

RATIOS, RATIOS_PER_RADIAN = 15, 4.0
"""Frequencies at which the residual counts, at least and to a radian of its turn over the band."""

FINER = 12
"""How many times more of them show the peaks between."""

MAX_DURATIONS = 16
"""Ends that are tried."""

FIRST_STEP = 0.02
"""Share by which the second end is longer or shorter than the first [-]."""

MAX_STEP = 0.15
"""Share by which an end is longer than the one before, at most [-]."""

RADIUS_RAD = 0.2
"""How far a switch moves in the first step [rad]."""

POLISHES = 4
"""How often a polish begins again with the first radius."""

GAINED = 1e-7
"""Share of the residual that the last step of a polish gains, at most [-]."""

NARROW = 1e-9
"""Share of an end by which the next is another [-]."""

CLOSE = 1e-6
"""Share of the tolerance by which the residual is below it at the end [-]."""

MARGIN = 1e-6
"""Share of the tolerance that is kept for what lies between the finer ratios [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UnequalBandOptimum:
    """A command that keeps the tolerance, of which no small change ends earlier.

    Attributes
    ----------
    switches
        Ascending from 0, shape (n,) [rad].
    end
        When its last ramp ends [rad].
    durations
        How many ends were tried.
    """

    switches: FloatArray
    end: float
    durations: int


def fastest_over_band(
    problem: UnequalBandProblem, switches: FloatArray, budget: Budget
) -> UnequalBandOptimum | None:
    """Return the command that ends first, from the one behind one lag.

    Parameters
    ----------
    problem
        The band, the limits and the lags.
    switches
        The switches behind one lag, ascending from 0, shape (n,) [rad].
    budget
        What the search may do.

    Returns
    -------
    UnequalBandOptimum or None
        None where no end was found that keeps the tolerance.
    """
    if switches.size == 1:  # a ramp alone is answered by one lag
        end = TwoLags(problem.at(np.ones(1))).of(switches).end
        return UnequalBandOptimum(switches=switches, end=end, durations=0)
    search = _Search(problem, budget)
    aim = problem.alike.tolerance * (1 - MARGIN)
    for _ in range(FINER):
        found = search.shortest(switches, aim)
        if found is None:
            return None
        kept = problem.alike.tolerance * (1 - MARGIN / 2)
        beyond = search.largest_between(found.switches) / kept
        if beyond <= 1:
            return UnequalBandOptimum(
                switches=found.switches, end=found.end, durations=search.durations
            )
        # Peaks between the ratios: the tolerance is aimed at by as much less.
        aim, switches = aim / beyond * (1 - MARGIN), found.switches
    return None


class _Search:
    """The parts of one search, which count their work and note their steps."""

    def __init__(self, problem: UnequalBandProblem, budget: Budget) -> None:
        self.durations = 0
        self._problem, self._budget = problem, budget
        (lower, upper), turn = problem.alike.band, problem.alike.horizon_rad
        count = RATIOS + math.ceil(RATIOS_PER_RADIAN * (upper - lower) * min(turn, 8 * math.pi))
        self._lags = TwoLags(problem.at(np.linspace(lower, upper, count)))
        self._finer = TwoLags(problem.at(np.linspace(lower, upper, FINER * count)))

    def largest_between(self, switches: FloatArray) -> float:
        """Return the largest residual at the finer ratios [-]."""
        return _see(self._finer, switches).largest

    def shortest(self, switches: FloatArray, aim: float) -> Seen | None:
        """Return the command of the shortest end whose residual is the aim, by false position."""
        wanted, best = ripples_of(aim), None
        before = end = self._lags.of(switches).end
        low: tuple[float, float] | None = None
        high: tuple[float, float] | None = None
        for _ in range(MAX_DURATIONS):
            if self._budget.spent:
                break
            found = self._polished(switches, end)
            if found is None:
                return best
            if found.largest <= aim:
                high, best = (end, ripples_of(found.largest)), found
                if found.largest >= aim * (1 - CLOSE):
                    break
            else:
                low = (end, ripples_of(found.largest))
            if found.largest <= 2 * aim:
                switches = found.switches
            following = _next_end(low, high, wanted)
            if low is not None and high is not None and (end < following) == (before < end):
                following = (low[0] + high[0]) / 2  # twice on one side
            if abs(following - end) < NARROW * end:
                break
            before, end = end, following
        return best

    def _polished(self, switches: FloatArray, end: float) -> Seen | None:
        self.durations += 1
        found, largest = None, math.inf
        for _ in range(POLISHES):
            again = polish(
                lambda at: _see(self._lags, at),
                switches,
                RADIUS_RAD,
                self._budget,
                end=end,
                gained=GAINED,
            )
            if again is None or again.seen.largest > largest * (1 - GAINED):
                break
            found, largest, switches = again, again.seen.largest, again.seen.switches
        self._budget.note(
            TraceStep(
                stage="solve",
                method="clarabel",
                start="one_lag",
                outcome="failed" if found is None else "solve_succeeded",
                duration_s=end / self._problem.alike.natural_frequency_rad_s,
                detail=f"least residual over the band: {largest:.4g}",
            )
        )
        return None if found is None else found.seen


def _next_end(
    low: tuple[float, float] | None, high: tuple[float, float] | None, wanted: float
) -> float:
    """Return the end to try between one that is too short and one that is long enough."""
    if low is None and high is not None:
        return high[0] * (1 - FIRST_STEP)
    if high is None and low is not None:
        share = min(max((wanted - low[1]) / wanted, FIRST_STEP), MAX_STEP)
        return low[0] * (1 + share)
    if low is None or high is None or high[1] <= low[1]:
        return 0.0 if low is None or high is None else (low[0] + high[0]) / 2
    share = (wanted - low[1]) / (high[1] - low[1])
    return low[0] + min(max(share, 0.02), 1.0) * (high[0] - low[0])


def _see(lags: TwoLags, switches: FloatArray) -> Seen:
    course = lags.of(switches)
    turn = np.exp(lags.poles * course.end)
    vectors = turn * course.values
    return Seen(
        switches=switches,
        end=course.end,
        end_changes=course.end_changes[-1],
        vectors=vectors,
        changes=turn[:, None] * course.changes,
        drifts=lags.poles * vectors,
    )
