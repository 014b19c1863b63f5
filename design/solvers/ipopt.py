"""IPOPT by CasADi: each problem family built once a process, designs passed as parameters."""

import functools
import threading

from design.formulations.equations import GapProblem
from design.formulations.expressions import Model
from design.solvers.buffered import Buffered
from design.solvers.ipopt_options import OPTIONS, STATUS
from design.solvers.newton import instructions_of
from design.solvers.outcome import Outcome, Status
from design.types import FloatArray

ITERATION_WORK = 250.0
INSTRUCTION_WORK = 0.03
"""Work of an iteration, and in it of each instruction of equations and Jacobian [units]."""

_one_at_a_time = threading.Lock()
"""One CasADi function used by two threads crashes the process."""


class _NonlinearProgram:
    """The solver of one problem family."""

    def __init__(self, model: Model) -> None:
        import casadi as ca  # noqa: PLC0415

        parts = model.expressions()
        program = {
            "x": parts.unknowns,
            "p": parts.parameters,
            "f": parts.objective,
            "g": parts.equations,
        }
        self._solver = Buffered(
            ca.nlpsol("shaper", "ipopt", program, OPTIONS),
            ("x0", "p", "lbx", "ubx", "lbg", "ubg"),  # the equations stay 0
            ("x",),
        )

    def __call__(self, problem: GapProblem, start: FloatArray) -> Outcome:
        """Solve one problem of the family from one start."""
        inputs = self._solver.inputs
        inputs["x0"][:] = start
        inputs["p"][:] = problem.parameters
        inputs["lbx"][:], inputs["ubx"][:] = problem.bounds
        self._solver.run()
        stats = self._solver.stats()
        return Outcome(
            status=STATUS.get(stats["return_status"], Status.FAILED),
            unknowns=self._solver.outputs["x"].copy(),
            iterations=int(stats["iter_count"]),
            misses=tuple(stats["iterations"]["inf_pr"]) if "iterations" in stats else (),
        )


@functools.cache
def _program(model: Model) -> _NonlinearProgram:
    return _NonlinearProgram(model)


def work_of(model: Model, iterations: int) -> float:
    """Return the work of a number of iterations [units].

    Parameters
    ----------
    model, iterations
        The family of the problem that is solved, and iterations of IPOPT.

    Returns
    -------
    float
        Work by the iterations and by the size of the family's equations [units].
    """
    return iterations * _iteration_work(model)


@functools.cache
def _iteration_work(model: Model) -> float:
    return ITERATION_WORK + INSTRUCTION_WORK * instructions_of(model)


def solve(problem: GapProblem, start: FloatArray) -> Outcome:
    """Minimise the duration from one start.

    The solver of the problem's family is built at its first use in this process.

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
        return _program(problem.model)(problem, start)
