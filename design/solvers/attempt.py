"""IPOPT from one start: an ordered solution, or none."""

import math
from collections.abc import Iterator

import numpy as np

from design.errors import TimeLimitError
from design.formulations.equations import GapProblem
from design.formulations.gaps import of_gaps
from design.solvers import ipopt
from design.solvers.budget import Budget
from design.solvers.outcome import Status
from design.solvers.solution import Solution, SolverReport
from design.trace import TraceStep
from design.types import FloatArray

JUDGING_WORK = 5_000.0
"""Work of what judges a candidate: certificates, insensitivities [units]."""


def attempt(
    problem: GapProblem, start: FloatArray, seed: str, tried: int, budget: Budget
) -> Iterator[Solution]:
    """Yield the solution to which IPOPT comes from a start, if to one.

    Parameters
    ----------
    problem
        The problem.
    start
        Unknowns to start from, shape (n - 1 + r,): gaps [rad], then ratios [-], if any.
    seed
        Name of the start.
    tried
        Starts tried so far, this one included.
    budget
        That of the search, in which the work is counted.

    Yields
    ------
    Solution
        At most one, not yet certified.

    Raises
    ------
    TimeLimitError
        If IPOPT ran past its time.
    """
    outcome = ipopt.solve(problem, start)
    budget.spend(JUDGING_WORK + ipopt.work_of(problem.model, outcome.iterations))
    if outcome.status is Status.TIME_LIMIT:
        raise TimeLimitError(f"ipopt ran past its time from seed {seed!r}", code="seed_past_time")
    gaps, ratios = problem.split(outcome.unknowns)
    in_time = bool(gaps.sum() <= problem.horizon_rad)
    budget.note(
        TraceStep(
            stage="solve",
            method="ipopt",
            start=seed,
            outcome=outcome.status if in_time else "rejected",
            iterations=outcome.iterations,
            duration_s=duration_s(problem, gaps),
            misses=outcome.misses,
            detail="" if in_time else "longer than max_duration_periods",
        )
    )
    if outcome.status is Status.SOLVE_SUCCEEDED and in_time:
        yield Solution(
            impulses=of_gaps(gaps, problem.natural_frequency_rad_s, problem.amplitudes),
            solver=SolverReport(
                name="ipopt",
                status="solve_succeeded",
                iterations=outcome.iterations,
                seed=seed,
                starts=tried,
            ),
            ratios=ratios,
        )


def duration_s(problem: GapProblem, gaps_rad: FloatArray) -> float | None:
    """Return what gaps add up to; None where they ran away [s].

    Parameters
    ----------
    problem
        The problem, whose frequency turns gaps into times.
    gaps_rad
        Shape (n - 1,) [rad].

    Returns
    -------
    float or None
        From the first impulse to the last [s].
    """
    with np.errstate(all="ignore"):
        duration = float(gaps_rad.sum()) / problem.natural_frequency_rad_s
    return duration if math.isfinite(duration) else None
