"""IPOPT by CasADi: each problem family built once a process, designs passed as parameters."""

import functools
import threading
from typing import Any

import numpy as np

from design.shapers.problem import Model, Problem
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
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    # The default leaves residuals near 1e-9, which is the limit of the certificate.
    "ipopt.tol": 1e-12,
    # Seeds are good and the solutions isolated: a large barrier only pushes them away first.
    "ipopt.mu_init": 1e-8,
    "ipopt.bound_mult_init_method": "mu-based",
    "ipopt.max_iter": 200,
    "ipopt.max_wall_time": 10.0,
}

_one_at_a_time = threading.Lock()
"""One CasADi function used by two threads crashes the process."""


@functools.cache
def compiled(model: Model) -> Any:  # noqa: ANN401 - casadi ships no types
    """Return the solver of a problem family, built at its first use in this process."""
    import casadi as ca  # noqa: PLC0415

    parts = model.expressions()
    program = {
        "x": parts.unknowns,
        "p": parts.parameters,
        "f": parts.objective,
        "g": parts.equations,
    }
    return ca.nlpsol("shaper", "ipopt", program, OPTIONS)


def solve(problem: Problem, start: FloatArray) -> Outcome:
    """Minimise the duration from one start.

    Parameters
    ----------
    problem
        The problem.
    start
        Gaps to start from, shape (n - 1,) [rad].

    Returns
    -------
    Outcome
        Gaps and status; a claim of success is still to be verified.
    """
    with _one_at_a_time:
        solver = compiled(problem.model)
        answer = solver(
            x0=start,
            p=problem.parameters,
            lbx=problem.shortest_gaps_rad,
            ubx=problem.horizon_rad,
            lbg=0.0,
            ubg=0.0,
        )
        stats = solver.stats()
    return Outcome(
        status=STATUS.get(stats["return_status"], Status.FAILED),
        unknowns=np.asarray(answer["x"], dtype=np.float64).ravel(),
        iterations=int(stats["iter_count"]),
    )
