"""One shaper after another: each step of the one shaped by the other."""

import functools
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.formulation import Convolution
from design.model.impulses import Impulses
from design.solvers.budget import Budget
from design.solvers.solution import Solution
from design.solving.distinct_steps import distinct_steps
from design.solving.solve import solve

OVER_RANGE = 1e-9
"""What a command may be out of range by: rounding of its amplitudes [-]."""


def solve_convolution(formulation: Convolution, budget: Budget) -> Iterator[Solution]:
    """Yield the shapers of the parts convolved.

    Parameters
    ----------
    formulation, budget
        The parts, and what the searches may do.

    Yields
    ------
    Solution
        The one of the first solution of each part.
    """
    yield convolve_solutions([next(solve(part, budget)) for part in formulation.parts])


def convolve_solutions(solved: list[Solution]) -> Solution:
    """Convolve a solution for each mode.

    Parameters
    ----------
    solved
        The solutions, in the order of the modes; at least one.

    Returns
    -------
    Solution
        Of all modes; its report adds up the iterations and starts of the parts.

    Raises
    ------
    InfeasibleDesignError
        If the command would be below 0 or above full speed.
    """
    impulses = functools.reduce(_convolve, (one.impulses for one in solved))
    levels = np.cumsum(impulses.amplitudes)
    low, high = float(levels.min()), float(levels.max())
    if low < -OVER_RANGE or high > 1 + OVER_RANGE:
        raise InfeasibleDesignError(
            f"the convolved command would go from {low:.6g} to {high:.6g} of full speed, beyond 0 "
            "to 1; multi_umzv solves all modes jointly within that range",
            code="convolved_beyond_full_speed",
        )
    report = replace(
        solved[0].solver,
        iterations=sum(one.solver.iterations for one in solved),
        starts=sum(one.solver.starts for one in solved),
    )
    return Solution(impulses=impulses, solver=report)


def _convolve(first: Impulses, second: Impulses) -> Impulses:
    """Return each step of one shaper shaped by the other; small steps may count."""
    times = np.add.outer(first.times_s, second.times_s).ravel()
    amplitudes = np.multiply.outer(first.amplitudes, second.amplitudes).ravel()
    order = np.argsort(times, kind="stable")
    return distinct_steps(Impulses(times_s=times[order], amplitudes=amplitudes[order]))
