"""A seed of another problem of the family, followed to the one that is asked."""

from design.formulations.equations import GapProblem
from design.solvers import newton
from design.solvers.budget import Budget
from design.solvers.continuation import follow
from design.types import FloatArray

MIN_SHARE = 1e-3
"""Shortest step from what a seed solves to what is asked, over that way [-]."""


def followed_seed(
    problem: GapProblem, gaps_rad: FloatArray, solves: FloatArray, budget: Budget
) -> FloatArray | None:
    """Return the root to which a seed leads.

    Parameters
    ----------
    problem
        The problem that is asked.
    gaps_rad
        Gaps of the seed, shape (n - 1,) [rad].
    solves
        Parameters of the family that they solve, shape (p,).
    budget
        That of the search, in which the work is counted.

    Returns
    -------
    FloatArray or None
        Unknowns, shape (n - 1 + r,) [rad], [-]; None if the path ends on the way.
    """

    def solve(guess: FloatArray, share: float) -> FloatArray | None:
        parameters = solves + share * (problem.parameters - solves)
        end = newton.roots(problem.model, guess[None], parameters, budget=budget)
        if not len(end.unknowns):
            return None
        return end.unknowns[0] if end.converged[0] and problem.allows(end.unknowns[0]) else None

    path = follow(problem.start(gaps_rad), solve, MIN_SHARE)
    return path.unknowns if path.complete else None
