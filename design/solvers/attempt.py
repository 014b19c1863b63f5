"""IPOPT from one start: an ordered solution, or none."""

from collections.abc import Iterator

from design.errors import TimeLimitError
from design.formulations.equations import GapProblem
from design.formulations.gaps import of_gaps
from design.solvers import ipopt
from design.solvers.budget import Budget
from design.solvers.outcome import Status
from design.solvers.search_steps import attempt_step
from design.solvers.solution import Solution, SolverReport
from design.types import FloatArray

JUDGING_WORK = 5_000.0
"""Work of what judges a candidate: certificates, insensitivities [units]."""


def attempt(
    problem: GapProblem, start: FloatArray, seed: str, tried: int, budget: Budget
) -> Iterator[Solution]:
    """Yield the solution to which IPOPT comes from a start, if to one.

    Parameters
    ----------
    problem, start, seed
        The problem, unknowns to start from, see `ipopt.solve`, and their name.
    tried, budget
        Starts tried so far, this one included; the budget of the search.

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
    budget.spend(JUDGING_WORK + outcome.iterations * ipopt.iteration_work(problem.model))
    if outcome.status is Status.TIME_LIMIT:
        raise TimeLimitError(f"ipopt ran past its time from seed {seed!r}", code="seed_past_time")
    gaps, ratios = problem.split(outcome.unknowns)
    in_time = bool(gaps.sum() <= problem.horizon_rad)
    if budget.trace is not None:
        budget.note(attempt_step(problem, seed, outcome, in_time=in_time))
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
