"""A closed form as a solution: nothing is searched."""

from collections.abc import Iterator

from design.formulations.formulation import ClosedForm
from design.solvers.budget import Budget
from design.solvers.solution import Solution, SolverReport
from design.solving.distinct_steps import distinct_steps
from design.trace import TraceStep


def solve_closed_form(formulation: ClosedForm, budget: Budget) -> Iterator[Solution]:
    """Yield the impulses of a closed form.

    Parameters
    ----------
    formulation
        The closed form.
    budget
        That of the search, which notes it.

    Yields
    ------
    Solution
        The only one.
    """
    budget.note(
        TraceStep(
            stage="solve",
            method=formulation.method,
            start="none",
            outcome="solve_succeeded",
            duration_s=formulation.impulses.duration_s,
        )
    )
    yield Solution(
        impulses=distinct_steps(formulation.impulses),
        solver=SolverReport(
            name=formulation.method,
            status="solve_succeeded",
            iterations=0,
            seed="none",
            starts=0,
        ),
    )
