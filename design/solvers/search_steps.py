"""What a search notes of each step where it is watched."""

import math

import numpy as np

from design.formulations.equations import GapProblem
from design.formulations.seeds import Seed
from design.solvers.outcome import Outcome
from design.solvers.solution import Solution
from design.trace import TraceStep
from design.types import FloatArray


def _duration_s(problem: GapProblem, gaps_rad: FloatArray) -> float | None:
    """Return what gaps add up to; None where they ran away [s]."""
    with np.errstate(all="ignore"):
        duration = float(gaps_rad.sum()) / problem.natural_frequency_rad_s
    return duration if math.isfinite(duration) else None


def seed_step(
    problem: GapProblem, seed: Seed, sharpened: FloatArray | None, *, allowed: bool
) -> TraceStep:
    """Return what became of a seed before the solver itself starts there.

    Parameters
    ----------
    problem, seed
        The problem and its seed.
    sharpened, allowed
        Where Newton's method ends, None where a path ends before, and whether that is allowed.

    Returns
    -------
    TraceStep
        Of Newton's method.
    """
    gaps = seed.gaps_rad if sharpened is None else problem.split(sharpened)[0]
    if allowed:
        outcome, detail = "sharpened", ""
    elif sharpened is None:
        outcome, detail = "lost", "the path from what the seed solves ends on the way"
    else:
        outcome, detail = "rejected", "out of order, or longer than max_duration_periods"
    return TraceStep(
        stage="seed",
        method="newton",
        start=seed.name,
        outcome=outcome,
        duration_s=_duration_s(problem, gaps),
        detail=detail,
    )


def verdict_step(solution: Solution, shortfall: str) -> TraceStep:
    """Return that a solution was verified, or why it was rejected.

    Parameters
    ----------
    solution, shortfall
        The solution, and what it does not keep, in words; empty where it keeps all.

    Returns
    -------
    TraceStep
        Of the certificate.
    """
    return TraceStep(
        stage="certify",
        method="certificate",
        start=solution.solver.seed,
        outcome="rejected" if shortfall else "verified",
        duration_s=solution.impulses.duration_s,
        detail=shortfall,
    )


def attempt_step(problem: GapProblem, seed: str, outcome: Outcome, *, in_time: bool) -> TraceStep:
    """Return how the solver ended from one start.

    Parameters
    ----------
    problem, seed, outcome
        The problem, the name of the start, and what the solver answered with.
    in_time
        Whether that is within the problem's horizon.

    Returns
    -------
    TraceStep
        Of IPOPT.
    """
    return TraceStep(
        stage="solve",
        method="ipopt",
        start=seed,
        outcome=outcome.status if in_time else "rejected",
        iterations=outcome.iterations,
        duration_s=_duration_s(problem, problem.split(outcome.unknowns)[0]),
        misses=outcome.misses,
        detail="" if in_time else "longer than max_duration_periods",
    )
