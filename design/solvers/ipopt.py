"""IPOPT by CasADi: each problem family built once a process, designs passed as parameters."""

import functools
import threading

from design.formulations.equations import GapProblem
from design.formulations.expressions import Model
from design.solvers.ipopt_setup import STATUS, solver_of
from design.solvers.newton import instructions_of
from design.solvers.outcome import Outcome, Status
from design.types import FloatArray

ITERATION_WORK = 250.0
INSTRUCTION_WORK = 0.03
"""Work of an iteration, and in it of each instruction of equations and Jacobian [units]."""

_one_at_a_time = threading.Lock()
"""One CasADi function used by two threads crashes the process."""


@functools.cache
def iteration_work(model: Model) -> float:
    """Return the work of an iteration on a family of problems [units]."""
    return ITERATION_WORK + INSTRUCTION_WORK * instructions_of(model)


def solve(problem: GapProblem, start: FloatArray) -> Outcome:
    """Minimise the duration from one start.

    Parameters
    ----------
    problem
        The problem.
    start
        Unknowns to start from, shape (n - 1 + r,): gaps [rad], then ratios [-], if any.

    Returns
    -------
    Outcome
        Unknowns and status; a claim of success is still to be verified.
    """
    with _one_at_a_time:
        solver = solver_of(problem.model)
        inputs = solver.inputs
        inputs["x0"][:] = start
        inputs["p"][:] = problem.parameters
        inputs["lbx"][:], inputs["ubx"][:] = problem.bounds
        solver.run()
        stats = solver.stats()
        return Outcome(
            status=STATUS.get(stats["return_status"], Status.FAILED),
            unknowns=solver.outputs["x"].copy(),
            iterations=int(stats["iter_count"]),
            misses=tuple(stats["iterations"]["inf_pr"]) if "iterations" in stats else (),
        )
