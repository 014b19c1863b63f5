"""Newton's method on the equations of a problem family, many starts at once."""

import contextlib
import functools
import math
import threading
from dataclasses import dataclass

import numpy as np

from design.formulations.expressions import Model
from design.solvers.budget import Budget
from design.solvers.buffered import Buffered
from design.types import BoolArray, FloatArray

LANES = 64
"""Designs evaluated by one call of the compiled expressions."""

MAX_STEP_RAD = 0.7
"""Longest step of any unknown: a tenth of a period keeps it near the branch of its start [rad]."""

TOLERANCE = 1e-12
"""Largest equation that counts as zero: two orders above rounding [-]."""

INSTRUCTION_WORK = 0.004
"""Work of one instruction of compiled expressions in one lane [units]."""

LINEAR_WORK = 100.0
"""Work of the linear equations of all lanes, and around them [units]."""

_one_at_a_time = threading.Lock()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Roots:
    """Ends of many runs.

    Attributes
    ----------
    unknowns
        Where each ended, shape (m, n) [rad].
    misses
        Largest equation there, shape (m,) [-].
    """

    unknowns: FloatArray
    misses: FloatArray

    @property
    def converged(self) -> BoolArray:
        """Which ends are roots, shape (m,)."""
        return self.misses <= TOLERANCE


class _Equations:
    """Equations and Jacobian of a family over `LANES` designs."""

    def __init__(self, model: Model) -> None:
        import casadi as ca  # noqa: PLC0415

        parts = model.expressions()
        x, p, g = parts.unknowns, parts.parameters, parts.equations
        one = ca.Function(
            "equations", [x, p], [g, ca.densify(ca.jacobian(g, x))], ["x", "p"], ["g", "jacobian"]
        )
        self.instructions = int(one.n_instructions())
        self._function = Buffered(one.map(LANES), ("x", "p"), ("g", "jacobian"))
        size, count, equations = x.shape[0], p.shape[0], g.shape[0]
        # CasADi is column-major: lane by lane, and within the Jacobian column by column.
        self._unknowns = self._function.inputs["x"].reshape(LANES, size)
        self._parameters = self._function.inputs["p"].reshape(LANES, count)
        self._values = self._function.outputs["g"].reshape(LANES, equations)
        self._jacobians = self._function.outputs["jacobian"].reshape(LANES, size, equations)

    def __call__(
        self, unknowns: FloatArray, parameters: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return equations, shape (m, e), and Jacobians, shape (m, e, n), for m <= LANES."""
        count = len(unknowns)
        self._unknowns[:count] = unknowns
        self._parameters[:count] = parameters
        self._unknowns[count:] = unknowns[-1]
        self._parameters[count:] = parameters[-1]
        self._function.run()
        return self._values[:count].copy(), self._jacobians[:count].swapaxes(1, 2)


@functools.cache
def _equations(model: Model) -> _Equations:
    return _Equations(model)


def instructions_of(model: Model) -> int:
    """Return the number of instructions of a family's equations.

    Those of the Jacobian count too. The equations are compiled at their first use in this process.
    """
    with _one_at_a_time:
        return _equations(model).instructions


def roots(
    model: Model,
    starts: FloatArray,
    parameters: FloatArray,
    *,
    iterations: int = 30,
    budget: Budget | None = None,
) -> Roots:
    """Run Newton's method from every start.

    Parameters
    ----------
    model
        The problem family.
    starts
        Unknowns to start from, shape (m, n) [rad].
    parameters
        Parameters, shape (p,) for all or (m, p) for each.
    iterations
        Most steps of each.
    budget
        What may be done: as soon as it is spent, no more starts are begun. None for all.

    Returns
    -------
    Roots
        All ends, converged or not, in the order of the starts; of those begun.
    """
    budget = Budget(most=math.inf) if budget is None else budget
    unknowns = np.array(starts, dtype=np.float64)
    each = np.broadcast_to(parameters, (len(unknowns), parameters.shape[-1]))
    misses = np.full(len(unknowns), np.inf)
    begun = 0
    with _one_at_a_time:
        equations = _equations(model)
        work = LINEAR_WORK + INSTRUCTION_WORK * LANES * equations.instructions
        while begun < len(unknowns) and not budget.spent:
            part = slice(begun, begun + LANES)
            unknowns[part], misses[part], evaluations = _run(
                equations, unknowns[part], each[part], iterations
            )
            budget.spend(evaluations * work)
            begun += LANES
    return Roots(unknowns=unknowns[:begun], misses=misses[:begun])


def _steps(jacobians: FloatArray, values: FloatArray) -> FloatArray:
    """Return Newton's steps, shape (m, n), of many lanes; of fewer equations the shortest."""
    if jacobians.shape[1] == jacobians.shape[2]:
        # A hair on the diagonal, in size of the lane's largest entry, keeps a singular lane from
        # stopping the others. Two unknowns that have become one, or all impulses nearly at one
        # time, it may be short of: the shortest step stops no other lane.
        largest = np.abs(jacobians).max(axis=(1, 2), keepdims=True)
        jacobians = jacobians + np.maximum(1e-14 * largest, 1e-300) * np.eye(values.shape[1])
        with contextlib.suppress(np.linalg.LinAlgError):
            regular: FloatArray = np.linalg.solve(jacobians, values[..., None])[..., 0]
            return regular
    shortest: FloatArray = (np.linalg.pinv(jacobians) @ values[..., None])[..., 0]
    return shortest


def _run(
    equations: _Equations, unknowns: FloatArray, parameters: FloatArray, iterations: int
) -> tuple[FloatArray, FloatArray, int]:
    """Return where lanes end, their largest equations there, and how often all were evaluated."""
    active = np.arange(len(unknowns))
    misses = np.full(len(unknowns), np.inf)
    for iteration in range(iterations + 1):
        values, jacobians = equations(unknowns[active], parameters[active])
        misses[active] = np.abs(values).max(axis=1)
        going = (misses[active] > TOLERANCE / 10) & np.isfinite(misses[active])
        if iteration == iterations or not going.any():
            break
        active = active[going]
        # A lane that has left the numbers is lost anyway.
        lanes = np.nan_to_num(jacobians[going], nan=0.0, posinf=0.0, neginf=0.0)
        steps = _steps(lanes, values[going])
        longest = np.abs(steps).max(axis=1, keepdims=True)
        unknowns[active] -= steps * np.minimum(1.0, MAX_STEP_RAD / np.maximum(longest, 1e-300))
    return unknowns, misses, iteration + 1


@functools.cache
def rootfinder(model: Model) -> Buffered:
    """Return CasADi's own rootfinder of a family, for one start at a time."""
    import casadi as ca  # noqa: PLC0415

    parts = model.expressions()
    finder = ca.rootfinder(
        "root",
        "newton",
        {"x": parts.unknowns, "p": parts.parameters, "g": parts.equations},
        {
            "abstol": TOLERANCE / 10,
            "max_iter": 12,
            "error_on_fail": False,
            "line_search": False,
            "show_eval_warnings": False,
        },
    )
    return Buffered(finder, ("x0", "p"), ("x",))
