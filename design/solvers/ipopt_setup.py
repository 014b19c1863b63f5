"""How IPOPT is set and built, and what its words for the end of a run mean."""

import functools
from typing import Any

from design.formulations.expressions import Model
from design.solvers.buffered import Buffered
from design.solvers.outcome import Status

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


@functools.cache
def solver_of(model: Model) -> Buffered:
    """Return IPOPT on a family of problems, built once in a process."""
    import casadi as ca  # noqa: PLC0415

    parts = model.expressions()
    program = {
        "x": parts.unknowns,
        "p": parts.parameters,
        "f": parts.objective,
        "g": parts.equations,
    }
    return Buffered(
        ca.nlpsol("shaper", "ipopt", program, OPTIONS),
        ("x0", "p", "lbx", "ubx", "lbg", "ubg"),  # the equations stay 0
        ("x",),
    )
