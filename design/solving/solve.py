"""What solves a formulation, by the solver that it is for: not yet certified."""

from collections.abc import Iterator

from design.formulations.formulation import Formulation
from design.solvers.budget import Budget
from design.solvers.solution import Solution
from design.solving.by_formulation import solver_of


def solve(formulation: Formulation, budget: Budget | None = None) -> Iterator[Solution]:
    """Yield what solves a formulation, the likeliest optimum first.

    No impulse of a solution is as small as rounding, and no two are at one time.

    Parameters
    ----------
    formulation, budget
        A closed form or a problem; what the search may do, that of one design if not given.

    Yields
    ------
    Solution
        With the report of its solver.

    Raises
    ------
    InfeasibleDesignError, SolverFailedError, TimeLimitError
        Where no more is found, says how far was searched; if a solver stopped without an answer.
    """
    kind: type = type(formulation)
    yield from solver_of(kind)(formulation, Budget() if budget is None else budget)
