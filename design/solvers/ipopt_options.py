"""How IPOPT is set, and what its words for the end of a run mean."""

from typing import Any

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
