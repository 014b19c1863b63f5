"""What solves a formulation, by the solver that it is for: not yet certified."""

from collections.abc import Callable, Iterator
from typing import Any

from design.formulations.bands import BandProblem, BandSearch
from design.formulations.equations import GapProblem
from design.formulations.formulation import ClosedForm, Convolution, Formulation, JointProblem
from design.solvers import search
from design.solvers.budget import Budget
from design.solvers.solution import Solution
from design.solvers.unity_band import search as unity_band
from design.solving import optima
from design.solving.behind_limits import SOLVERS_BEHIND_LIMITS
from design.solving.closed_form import solve_closed_form
from design.solving.convolution import convolve_solutions


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
    solver = SOLVERS[type(formulation)]
    yield from solver(formulation, Budget() if budget is None else budget)


def _convolution(formulation: Convolution, budget: Budget) -> Iterator[Solution]:
    yield convolve_solutions([next(solve(part, budget)) for part in formulation.parts])


SOLVERS: dict[type[Formulation], Callable[[Any, Budget], Iterator[Solution]]] = {
    ClosedForm: solve_closed_form,
    GapProblem: search.candidates,
    BandSearch: unity_band.solve,
    BandProblem: optima.solve_over_band,
    JointProblem: optima.solve_jointly,
    **SOLVERS_BEHIND_LIMITS,
    Convolution: _convolution,
}
"""What solves each class of formulation: one more solver is one more row."""
