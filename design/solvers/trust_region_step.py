"""Convex programs over disks by IPOPT: the step of a design whose vibration must stay small."""

import functools
import threading
from typing import Any

import numpy as np

from design.solvers import ipopt_setup
from design.solvers.buffered import Buffered
from design.solvers.outcome import Outcome, Status
from design.types import FloatArray

DISKS = 16
"""Disks of a program."""

OPTIONS: dict[str, Any] = {
    **ipopt_setup.OPTIONS,
    # Convex and scaled to one: from the middle of the cone, a dozen iterations.
    "ipopt.mu_init": 1e-2,
    "ipopt.bound_mult_init_method": "constant",
    "ipopt.tol": 1e-10,
    "ipopt.max_iter": 80,
    # A disk is kept, not widened by the default's 1e-8.
    "ipopt.bound_relax_factor": 0.0,
}

ROOM = 0.1
"""Slack above the least that the start needs, so that it lies inside the cones [-]."""

_one_at_a_time = threading.Lock()


class _StepSolver:
    """The solver for one number of unknowns."""

    def __init__(self, unknowns: int) -> None:
        import casadi as ca  # noqa: PLC0415

        step, slack = ca.SX.sym("step", unknowns), ca.SX.sym("slack")
        vectors = ca.SX.sym("vectors", 2, DISKS)
        jacobians = ca.SX.sym("jacobians", 2, unknowns * DISKS)
        curvature, price = ca.SX.sym("curvature", unknowns, unknowns), ca.SX.sym("price")
        moved = vectors + ca.horzcat(*(
            part @ step for part in ca.horzsplit(jacobians, unknowns)
        ))  # fmt: skip
        objective = ca.sum1(step) + ca.bilin(curvature, step, step) / 2 + price * slack
        program = {
            "x": ca.vertcat(step, slack),
            "p": ca.vertcat(*(ca.vec(one) for one in (vectors, jacobians, curvature, price))),
            "f": objective,
            "g": ca.sum1(moved * moved).T - slack,
        }
        self._solver = Buffered(
            ca.nlpsol("disks", "ipopt", program, OPTIONS),
            ("x0", "p", "lbx", "ubx", "lbg", "ubg"),
            ("x", "lam_g"),
        )

    def __call__(
        self,
        vectors: FloatArray,
        jacobians: FloatArray,
        curvature: FloatArray,
        price: float,
        bounds: tuple[FloatArray, FloatArray],
    ) -> tuple[Outcome, FloatArray]:
        used = len(vectors)
        parts = (np.zeros((DISKS, 2)), np.zeros((DISKS, *jacobians.shape[:0:-1])))
        parts[0][:used] = vectors
        parts[1][:used] = jacobians.swapaxes(1, 2)
        inputs = self._solver.inputs
        inputs["p"][:] = np.concatenate([*(one.ravel() for one in (*parts, curvature)), [price]])
        inputs["x0"][:-1] = 0.0
        inputs["x0"][-1] = max(float(np.square(vectors).sum(axis=1).max()) - 1, 0.0) + ROOM
        inputs["lbx"][:-1], inputs["ubx"][:-1] = bounds
        inputs["lbx"][-1], inputs["ubx"][-1] = 0.0, np.inf
        inputs["lbg"][:] = -np.inf
        inputs["ubg"][:used] = 1.0
        inputs["ubg"][used:] = np.inf
        self._solver.run()
        stats = self._solver.stats()
        outcome = Outcome(
            status=ipopt_setup.STATUS.get(stats["return_status"], Status.FAILED),
            unknowns=self._solver.outputs["x"].copy(),
            iterations=int(stats["iter_count"]),
        )
        return outcome, self._solver.outputs["lam_g"][:used].copy()


@functools.cache
def _program(unknowns: int) -> _StepSolver:
    return _StepSolver(unknowns)


def step_over_disks(
    vectors: FloatArray,
    jacobians: FloatArray,
    curvature: FloatArray,
    price: float,
    bounds: tuple[FloatArray, FloatArray],
) -> tuple[Outcome, FloatArray]:
    """Minimise a convex quadratic in a step over disks.

    The step d and its slack s solve::

        min sum(d) + d' B d / 2 + price * s,    |v_k + J_k d|^2 <= 1 + s,    s >= 0

    Parameters
    ----------
    vectors
        Vectors v, shape (m, 2) with m <= `DISKS`, over the tolerance [-].
    jacobians
        Their derivatives J, shape (m, 2, n) [1/rad].
    curvature
        Positive semidefinite matrix B, shape (n, n) [1/rad].
    price
        Of the slack s, that makes every program feasible [rad].
    bounds
        Lower and upper bounds of d, shape (n,) each, that contain 0 [rad].

    Returns
    -------
    tuple of Outcome and FloatArray
        The step d and behind it the slack s; the multipliers of the disks, shape (m,) [rad].
    """
    with _one_at_a_time:
        program = _program(jacobians.shape[2])
        return program(vectors, jacobians, curvature, price, bounds)
