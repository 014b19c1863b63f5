"""From a problem that has no solution to the same with more steps."""

import functools
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.equations import GapProblem
from design.formulations.expressions import Model
from design.formulations.gaps import of_gaps
from design.solvers import newton
from design.solvers.attempt import attempt
from design.solvers.branches import branches, fastest_first, spread_starts
from design.solvers.budget import Budget
from design.solvers.least_squares import least_squares
from design.solvers.solution import Solution
from design.types import FloatArray

MORE_STARTS = 256
"""Starts of Newton's method for each number of steps."""

MAX_ENDS = 6
"""Its fastest ends at which IPOPT starts."""

NEWTON_STEPS = 12

RANK = 1e-13
"""Smallest direction that counts, over the largest [-]."""

AT_BOUND_RAD = 1e-5
"""A gap as near to its shortest is the shortest [rad]."""


def with_more_steps(problem: GapProblem, tried: int, budget: Budget) -> Iterator[Solution]:
    """Yield the solutions of every branch, then those with more steps.

    With more steps there are more unknowns than equations. Newton's shortest steps lead from many
    starts to many commands; from the fastest of them IPOPT minimises the duration. The fewest steps
    come first.

    Parameters
    ----------
    problem
        The problem, with the longer ones that stand in for it.
    tried, budget
        Starts tried so far; what the search may do.

    Yields
    ------
    Solution
        As reported by the solver, not yet certified.

    Raises
    ------
    InfeasibleDesignError
        When all solutions, if any, are used up: that of the problem, and what else was searched.
    """
    try:
        yield from branches(problem, tried, budget)
    except InfeasibleDesignError as error:
        for longer in problem.longer:
            yield from _of_more(longer, tried, budget)
        counts = ", ".join(f"{one.amplitudes.size}" for one in problem.longer)
        raise InfeasibleDesignError(
            f"{error}; nor was one of {counts} steps found", code=error.code
        ) from error


def _of_more(problem: GapProblem, tried: int, budget: Budget) -> list[Solution]:
    starts = spread_starts(problem)[:MORE_STARTS]
    ends = newton.roots(problem.model, starts, problem.parameters, budget=budget)
    found: list[Solution] = []
    for gaps in islice(fastest_first(problem, ends), MAX_ENDS):
        if budget.spent:
            break
        found += attempt(problem, gaps, "more_steps", tried + len(starts), budget)
    sharp = [_sharpen(problem, one) for one in found]
    return sorted(sharp, key=lambda one: one.impulses.duration_s)


def _sharpen(problem: GapProblem, found: Solution) -> Solution:
    """Return the same with the equations met to rounding."""
    gaps = np.diff(found.impulses.times_s) * problem.natural_frequency_rad_s
    sharp = nearest_root(problem.model, gaps, problem.parameters, problem.shortest_gaps_rad)
    if not problem.allows(sharp):
        return found
    steps = of_gaps(sharp, problem.natural_frequency_rad_s, problem.amplitudes)
    return replace(found, impulses=steps)


def nearest_root(
    model: Model, gaps_rad: FloatArray, parameters: FloatArray, shortest_rad: FloatArray
) -> FloatArray:
    """Return where Newton's shortest steps end: a root, or not.

    Gaps that are the shortest stay so.

    Parameters
    ----------
    model, parameters
        A family with fewer equations than gaps; the parameters of the problem, shape (p,).
    gaps_rad, shortest_rad
        Gaps to start from, and their lower bounds, shape (n,) [rad].

    Returns
    -------
    FloatArray
        Gaps, shape (n,) [rad]; not numbers where there is no root.
    """
    free = gaps_rad > shortest_rad + AT_BOUND_RAD
    gaps = np.where(free, gaps_rad, shortest_rad)
    for _ in range(NEWTON_STEPS):
        values, changes = (np.array(one) for one in _equations(model)(gaps, parameters))
        if not np.isfinite(changes).all():
            break
        if np.abs(values).max() < newton.TOLERANCE:
            return gaps
        gaps = gaps - least_squares(changes * free, values[:, 0], RANK)
    return np.full(gaps.size, np.nan)


@functools.cache
def _equations(model: Model) -> Callable[..., Any]:
    """Return what gives equations and Jacobian."""
    import casadi as ca  # noqa: PLC0415 - a third of a second that --help must not pay

    parts = model.expressions()
    x, p, g = parts.unknowns, parts.parameters, parts.equations
    compiled: Callable[..., Any] = ca.Function(
        "equations", [x, p], [g, ca.densify(ca.jacobian(g, x))]
    )
    return compiled
