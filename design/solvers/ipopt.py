"""IPOPT by CasADi: each problem family built once a process, designs passed as parameters."""

import functools
import threading
from typing import Any

from design.formulations.equations import GapProblem, Model
from design.solvers.buffered import Buffered
from design.solvers.newton import instructions_of
from design.solvers.outcome import Outcome, Status
from design.types import FloatArray

STATUS = {
    "Solve_Succeeded": Status.SOLVE_SUCCEEDED,
    "Solved_To_Acceptable_Level": Status.FAILED,  # an acceptable level is not zero vibration
    "Infeasible_Problem_Detected": Status.INFEASIBLE,
    "Maximum_WallTime_Exceeded": Status.TIME_LIMIT,
    "Maximum_CpuTime_Exceeded": Status.TIME_LIMIT,
}
"""IPOPT's words for ours; any other is FAILED."""

OPTIONS: dict[str, Any] = {
    "print_time": False,
    "calc_lam_p": False,
    "show_eval_warnings": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    # The default ends with residuals near 1e-9, which is the limit of the certificate.
    "ipopt.tol": 1e-12,
    # Seeds are good and the solutions isolated: a large barrier only pushes them away first.
    "ipopt.mu_init": 1e-12,
    "ipopt.bound_mult_init_method": "mu-based",
    "ipopt.max_iter": 200,
    "ipopt.max_wall_time": 10.0,
}

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
    model
        The family of the problem that is solved.
    iterations
        Iterations of IPOPT.

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
