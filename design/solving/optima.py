"""The fastest shapers over a band and for several modes, each with its bound."""

from collections.abc import Iterator

from design.analysis.shortest import excluded_duration_rad
from design.errors import InfeasibleDesignError
from design.formulations.bands import BandProblem, Obstacle
from design.formulations.formulation import JointProblem
from design.solvers.budget import Budget
from design.solvers.convex_band.duration import require_solvable
from design.solvers.convex_band.search import BandOptimum, candidates, obstacles
from design.solvers.joint.search import shortest
from design.solvers.solution import Solution
from design.solving.band_limits import (
    proves_exclusion,
    require_in_time,
    require_long_enough,
    require_more_than_waiting,
)
from design.solving.bounded import SMALL_GAP, Bounded
from design.trace import TraceStep


def solve_jointly(problem: JointProblem, budget: Budget) -> Iterator[Solution]:
    """Yield the fastest command without vibration in any mode.

    Parameters
    ----------
    problem
        The modes, and the sign of the steps.
    budget
        What the search may do.

    Yields
    ------
    Solution
        With its bound; the next if one is not certified.

    Raises
    ------
    InfeasibleDesignError
        When all are used up, or the budget is spent; says how far was searched.
    """
    w = problem.natural_frequency_rad_s
    for found in shortest(problem, budget):
        duration = float(found.times_rad[-1])
        bound = excluded_duration_rad(
            problem.unit_poles, found.vectors, duration, positive=problem.positive
        )
        bounded = Bounded(
            times_rad=found.times_rad,
            amplitudes=found.amplitudes,
            lower_bound_rad=bound,
            gap=1 - bound / duration,
            iterations=found.iterations,
            programs=found.programs,
        )
        budget.note(
            TraceStep(
                stage="bound",
                method="proof",
                start="linear_program",
                outcome="proved",
                duration_s=bound / w,
                detail="no command is as short",
            )
        )
        yield bounded.solution(w, name="highs", seed="linear_program")


def solve_over_band(problem: BandProblem, budget: Budget) -> Iterator[Solution]:
    """Yield the fastest shaper over bands, with its bound.

    Parameters
    ----------
    problem
        What is to be kept over the bands.
    budget
        What the search may do.

    Yields
    ------
    Solution
        With its bound; the next if one is not certified.

    Raises
    ------
    InfeasibleDesignError
        If the fastest is longer than the horizon; says what would be met instead. If it has more
        impulses than can be solved for, or the budget is spent before one is found.
    SolverFailedError
        If a cone program was not solved.
    """
    for found in _band_optima(problem, budget):
        w = problem.natural_frequency_rad_s
        yield found.solution(w, name="clarabel", seed="cone_program")


def _band_optima(problem: BandProblem, budget: Budget) -> Iterator[Bounded]:
    """Yield optima within `SMALL_GAP`; if there is none, the one with the smallest gap."""
    require_long_enough(problem, budget)
    require_solvable(problem)
    best: BandOptimum | None = None
    answered = False
    bound = 0.0  # nothing is shorter than no time
    for found in candidates(problem, budget):
        if isinstance(found, Obstacle):
            bound = max(
                bound, found.duration_rad if proves_exclusion(problem, found, budget) else 0.0
            )
        else:
            bound = max(bound, _lower_bound(problem, found, budget))
            if best is None or found.times_rad[-1] < best.times_rad[-1]:
                best = found
        if best is None:
            continue
        proved = _attach_bound(best, bound)
        if proved.gap <= SMALL_GAP:
            require_in_time(problem, proved, budget)
            yield proved
            best, answered = None, True
    if best is not None:
        proved = _attach_bound(best, bound)
        require_in_time(problem, proved, budget)
        yield proved
    elif not answered:
        require_more_than_waiting(problem, budget)
        if budget.spent:
            raise InfeasibleDesignError(
                f"no shaper was found that keeps {problem.asked}: {budget.in_words}",
                code="band_search_out_of_budget",
            )


def _attach_bound(found: BandOptimum, lower_bound_rad: float) -> Bounded:
    duration = float(found.times_rad[-1])
    return Bounded(
        times_rad=found.times_rad,
        amplitudes=found.amplitudes,
        lower_bound_rad=lower_bound_rad,
        gap=(duration - lower_bound_rad) / duration,
        iterations=found.iterations,
        programs=found.cone_programs,
    )


def _lower_bound(problem: BandProblem, candidate: BandOptimum, budget: Budget) -> float:
    for obstacle in obstacles(problem, candidate, budget):
        if proves_exclusion(problem, obstacle, budget):
            return obstacle.duration_rad
    return 0.0
