"""From a problem to candidates: seeds by IPOPT, then every branch within the horizon."""

from collections.abc import Iterator

from design.formulations.equations import GapProblem
from design.formulations.seeds import Seed
from design.solvers.attempt import attempt
from design.solvers.branches import branches
from design.solvers.budget import Budget
from design.solvers.followed_seed import followed_seed
from design.solvers.more_steps import with_more_steps
from design.solvers.near_root import root
from design.solvers.search_steps import seed_step
from design.solvers.solution import Solution
from design.types import FloatArray


def candidates(problem: GapProblem, budget: Budget | None = None) -> Iterator[Solution]:
    """Yield ordered solutions, the likeliest minimum first.

    Each solution comes from IPOPT, which starts at the problem's own seeds first. Newton's method
    sharpens the seeds, which halves the iterations of IPOPT, or follows them from what they solve.
    Every branch comes next, see `branches`, which says what is raised. Where the budget is spent,
    the search ends.

    Parameters
    ----------
    problem, budget
        The problem; what the search may do, that of one design if not given.

    Yields
    ------
    Solution
        As reported by the solver, with the start that led to it: not yet certified.
    """
    budget = Budget() if budget is None else budget
    tried = 0
    for seed in problem.seeds:
        tried += 1
        sharpened = _sharpen_seed(problem, seed, budget)
        allowed = sharpened is not None and bool(problem.allows(sharpened))
        if budget.trace is not None:
            budget.note(seed_step(problem, seed, sharpened, allowed=allowed))
        if sharpened is not None and allowed:
            yield from attempt(problem, sharpened, seed.name, tried, budget)
    everywhere = with_more_steps if problem.longer else branches
    yield from everywhere(problem, tried, budget)


def _sharpen_seed(problem: GapProblem, seed: Seed, budget: Budget) -> FloatArray | None:
    """Return where Newton's method ends from a seed: a root or not, within bounds or not.

    None if the seed is to be followed from what it solves, and the path ends on the way.
    """
    if seed.solves is not None:
        return followed_seed(problem, seed.gaps_rad, seed.solves, budget)
    return root(problem.model, problem.start(seed.gaps_rad), problem.parameters)
