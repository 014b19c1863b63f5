"""The fastest shaper over a band with its lower bound: the solver's word, judged apart from it."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from design.analysis.exclusion import excludes
from design.errors import InfeasibleDesignError
from design.formulations.bands import BandProblem, Obstacle
from design.formulations.unity_magnitude import PERIOD_RAD
from design.solvers.budget import Budget
from design.solvers.convex_band.duration import EASIER, first_duration_rad, require_solvable
from design.solvers.convex_band.search import (
    BandOptimum,
    candidates,
    obstacle_at,
    obstacle_work,
    obstacles,
)
from design.types import FloatArray

SMALL_GAP = 1e-4
"""Gap at which the search ends: far below what a controller's clock can tell [-]."""

NO_FASTER = 0.01
"""Share of a wait by which nothing must be shorter [-]."""

LARGEST_OFFERED = 0.5
"""A tolerance above it is not worth to be offered instead: little is suppressed [-]."""

FAR_BEYOND = 1.5
"""Estimated duration over the horizon from which on it is not looked for [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fastest:
    """A shaper, and how much faster one could be at most.

    Attributes
    ----------
    times_rad
        Times of its impulses, shape (n,) [rad].
    amplitudes
        Their amplitudes, shape (n,) [-].
    lower_bound_rad
        No shaper of its class is as short as this or shorter [rad].
    iterations
        Steps of Newton's method.
    cone_programs
        Cone programs that led to it.
    """

    times_rad: FloatArray
    amplitudes: FloatArray
    lower_bound_rad: float
    iterations: int
    cone_programs: int

    @property
    def gap(self) -> float:
        """How far its duration may be above the shortest, over itself [-]."""
        duration = float(self.times_rad[-1])
        return (duration - self.lower_bound_rad) / duration


def fastest(problem: BandProblem, budget: Budget | None = None) -> Iterator[Fastest]:
    """Yield optima within a gap of 1e-4; if there is none, the one with the smallest gap.

    Raises
    ------
    InfeasibleDesignError
        If the fastest is longer than the horizon; says what would be met instead. If it has more
        impulses than can be solved for, or the budget is spent before one is found.
    SolverFailedError
        If a cone program was not solved.
    """
    budget = Budget() if budget is None else budget
    _require_long_enough(problem, budget)
    require_solvable(problem)
    best: Fastest | None = None
    answered = False
    bound = 0.0  # nothing is shorter than no time
    for found in candidates(problem, budget):
        if isinstance(found, Obstacle):
            bound = max(bound, found.duration_rad if _stands(problem, found) else 0.0)
        else:
            bound = max(bound, _lower_bound(problem, found, budget))
            if best is None or found.times_rad[-1] < best.times_rad[-1]:
                best = Fastest(
                    times_rad=found.times_rad,
                    amplitudes=found.amplitudes,
                    lower_bound_rad=bound,
                    iterations=found.iterations,
                    cone_programs=found.cone_programs,
                )
        if best is None:
            continue
        best = replace(best, lower_bound_rad=bound)
        if best.gap <= SMALL_GAP:
            _require_in_time(problem, best, budget)
            yield best
            best, answered = None, True
    if best is not None:
        _require_in_time(problem, best, budget)
        yield best
    elif not answered:
        _require_more_than_waiting(problem, budget)
        if budget.spent:
            lower, upper = problem.band
            raise InfeasibleDesignError(
                f"no shaper found that keeps a residual within {problem.tolerance:g} from "
                f"{lower:g} to {upper:g} of the natural frequency: {budget.in_words}"
            )


def _lower_bound(problem: BandProblem, candidate: BandOptimum, budget: Budget) -> float:
    for obstacle in obstacles(problem, candidate, budget):
        if _stands(problem, obstacle):
            return obstacle.duration_rad
    return 0.0


def _stands(problem: BandProblem, obstacle: Obstacle) -> bool:
    return excludes(
        problem.unit_pole,
        obstacle.ratios,
        obstacle.vectors,
        obstacle.duration_rad,
        problem.tolerance,
        problem.levels,
    )


def _require_long_enough(problem: BandProblem, budget: Budget) -> None:
    """Raise InfeasibleDesignError where a horizon is far too short, by a proof of its own."""
    needed = first_duration_rad(problem)
    if needed < FAR_BEYOND * problem.horizon_rad:
        return
    obstacle, least = obstacle_at(problem, problem.horizon_rad, budget)
    if not _stands(problem, obstacle):
        return
    lower, upper = problem.band
    tolerance = EASIER * least
    instead = f"; a tolerance of {tolerance:.4g} can be met" if tolerance < LARGEST_OFFERED else ""
    raise InfeasibleDesignError(
        f"max_duration_periods = {problem.horizon_rad / PERIOD_RAD:g} is too short for a residual "
        f"within {problem.tolerance:g} from {lower:g} to {upper:g} of the natural frequency: none "
        f"is as short (proven), undamped it takes about {needed / PERIOD_RAD:.2g} periods{instead}"
    )


def _require_more_than_waiting(problem: BandProblem, budget: Budget) -> None:
    """Raise InfeasibleDesignError where nothing is faster than to wait for the mode's damping.

    A step and one of no height after it: what rings has decayed by then.
    """
    decay, lower = -problem.unit_pole.real, problem.band[0]
    if decay == 0:
        return
    wait = -math.log(problem.tolerance) / (decay * lower)
    if budget.done + obstacle_work(problem, wait) > budget.most:
        return
    if _stands(problem, obstacle_at(problem, (1 - NO_FASTER) * wait, budget)[0]):
        raise InfeasibleDesignError(
            f"no shaper keeps a residual within {problem.tolerance:g} from {lower:g} to "
            f"{problem.band[1]:g} of the natural frequency faster, by more than "
            f"{100 * NO_FASTER:g} %, than {wait / PERIOD_RAD:.4g} periods of waiting for the "
            "mode's own damping (proven): a smaller tolerance needs one"
        )


def _require_in_time(problem: BandProblem, found: Fastest, budget: Budget) -> None:
    duration = float(found.times_rad[-1])
    if duration <= problem.horizon_rad:
        return
    lower, upper = problem.band
    known = (
        f"none is shorter than {found.lower_bound_rad / PERIOD_RAD:.6g} (proven)"
        if found.lower_bound_rad >= problem.horizon_rad
        else "no shorter one was found"
    )
    tolerance = EASIER * obstacle_at(problem, problem.horizon_rad, budget)[1]
    # What a grid allows is found where an optimum is found.
    offered = tolerance < LARGEST_OFFERED and found.gap <= SMALL_GAP
    instead = f" or a tolerance of {tolerance:.4g}" if offered else ""
    raise InfeasibleDesignError(
        f"max_duration_periods = {problem.horizon_rad / PERIOD_RAD:g} is too short for a residual "
        f"within {problem.tolerance:g} from {lower:g} to {upper:g} of the natural frequency: the "
        f"fastest shaper found takes {duration / PERIOD_RAD:.6g} periods, {known}; "
        f"max_duration_periods = {1.0001 * duration / PERIOD_RAD:.4f}{instead} can be met"
    )
