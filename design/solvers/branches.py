"""Every branch of a problem: starts spread over its horizon, and the roots that they lead to."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.equations import GapProblem
from design.solvers import newton
from design.solvers.attempt import attempt
from design.solvers.budget import Budget
from design.solvers.solution import Solution
from design.trace import TraceStep
from design.types import FloatArray

BRANCH_STARTS = 1024
"""Starts of the search over all branches."""

HORIZONS_PERIODS = (3.0, 10.0, 30.0)
"""Horizons that are searched before a longer one [-]."""

SAME_ROOT_RAD = 1e-6
"""Roots closer than this are one [rad]."""


def branches(problem: GapProblem, tried: int, budget: Budget) -> Iterator[Solution]:
    """Yield the solution of each branch, after the seeds have not done.

    IPOPT starts at every root that Newton's method finds from `BRANCH_STARTS` starts spread over
    the horizon. Shorter horizons come first, and of each the fastest root. At last IPOPT starts at
    the seeds as they are. Where the budget is spent, the search ends.

    Parameters
    ----------
    problem
        The problem.
    tried
        Starts tried so far.
    budget
        What the search may do.

    Yields
    ------
    Solution
        As reported by the solver, with the start that led to it: not yet certified.

    Raises
    ------
    InfeasibleDesignError
        When all solutions, if any, are used up: says how far was searched.
    """
    searched = problem
    spread: newton.Roots | None = None
    for horizon_rad in _horizons(problem):
        within = replace(problem, horizon_rad=horizon_rad)
        starts = problem.start(spread_starts(within))
        found = newton.roots(problem.model, starts, problem.parameters, budget=budget)
        if not len(found.unknowns):
            break
        searched, spread = within, found
        tried += len(found.unknowns)
        budget.note(
            TraceStep(
                stage="seed",
                method="newton",
                start="branch_search",
                outcome="searched",
                duration_s=horizon_rad / problem.natural_frequency_rad_s,
                detail=f"{found.converged.sum()} of {len(found.unknowns)} starts, spread over "
                "that duration, lead to roots",
            )
        )
        for unknowns in fastest_first(within, found):
            if budget.spent:
                break
            yield from attempt(within, unknowns, "branch_search", tried, budget)
    for seed in problem.seeds:
        if not budget.spent:
            start = problem.start(seed.gaps_rad)
            yield from attempt(problem, start, seed.name, tried, budget)
    raise InfeasibleDesignError(
        describe_search(searched, spread, tried) + describe_early_end(problem, budget),
        code="no_solution_found",
    )


def describe_early_end(problem: GapProblem, budget: Budget) -> str:
    """Say that a search ended before its end, if it did.

    Parameters
    ----------
    problem, budget
        The problem, and what its search might do.

    Returns
    -------
    str
        To be added to `describe_search`; empty where the search came to its end.
    """
    if not budget.spent:
        return ""
    return (
        f"; durations up to {problem.horizon_rad / (2 * np.pi):g} periods were not searched to the "
        f"end: {budget.in_words}"
    )


def _horizons(problem: GapProblem) -> list[float]:
    """Return the horizons that are searched one after another, the problem's own last [rad].

    Starts spread over a long horizon are sparse: what is fast is looked for first.
    """
    least = float(problem.shortest_gaps_rad.sum())
    shorter = [2 * np.pi * periods for periods in HORIZONS_PERIODS]
    return [
        *(rad for rad in shorter if 1.5 * least < rad < problem.horizon_rad),
        problem.horizon_rad,
    ]


def spread_starts(problem: GapProblem) -> FloatArray:
    """Return ordered starts spread evenly over the horizon.

    The starts are a Kronecker sequence on the generalised golden ratio, sorted into times: the same
    for every run and machine.

    Parameters
    ----------
    problem
        The problem, with its horizon and shortest gaps.

    Returns
    -------
    FloatArray
        Gaps of the starts, shape (`BRANCH_STARTS`, n - 1) [rad].
    """
    free = problem.horizon_rad - problem.shortest_gaps_rad.sum()
    starts: FloatArray = problem.shortest_gaps_rad + free * unit_starts(
        problem.shortest_gaps_rad.size
    )
    return starts


def unit_starts(count: int) -> FloatArray:
    """Return the gaps of `spread_starts` over a horizon of 1.

    Parameters
    ----------
    count
        Gaps of a start.

    Returns
    -------
    FloatArray
        Gaps, shape (`BRANCH_STARTS`, count) [-].
    """
    golden = 2.0
    for _ in range(60):  # Newton's steps to the root of g^(n+1) = g + 1
        power = math.prod([golden] * count)
        golden -= (golden * power - golden - 1) / ((count + 1) * power - 1)
    # Products: powers of the library differ in their last digit from machine to machine.
    steps = np.cumprod(np.full(count, 1 / golden))
    unit = np.sort((0.5 + np.arange(1, BRANCH_STARTS + 1)[:, None] * steps) % 1.0, axis=1)
    gaps: FloatArray = np.diff(unit, axis=1, prepend=0.0)
    return gaps


def fastest_first(problem: GapProblem, ends: newton.Roots) -> Iterator[FloatArray]:
    """Yield the distinct roots within the problem's bounds, by duration.

    Parameters
    ----------
    problem, ends
        The problem, and where Newton's method ends.

    Yields
    ------
    FloatArray
        Unknowns, shape (n,): gaps [rad], then ratios [-], if any.
    """
    durations = problem.split(ends.unknowns)[0].sum(axis=1)
    usable = np.flatnonzero(ends.converged & problem.allows(ends.unknowns))
    last = -np.inf
    for index in usable[np.argsort(durations[usable])]:
        if durations[index] - last > SAME_ROOT_RAD:
            last = durations[index]
            yield ends.unknowns[index]


def describe_search(problem: GapProblem, ends: newton.Roots | None, starts: int) -> str:
    """Say how far was searched, and what came nearest.

    Parameters
    ----------
    problem, ends, starts
        The problem, where the starts searched last ended, and how many there were in all.

    Returns
    -------
    str
        A sentence without its stop.
    """
    period = 2 * np.pi
    report = (
        f"no ordered solution with duration <= {problem.horizon_rad / period:g} periods "
        f"in {starts} starts"
    )
    if ends is None:
        return report
    roots, ratios = problem.split(ends.unknowns[ends.converged])
    if roots.size == 0:
        best = np.nanargmin(ends.misses)
        return f"{report}; nearest miss: an equation off by {ends.misses[best]:.3g}"
    # How far out of its bounds a root is: the worst gap or ratio, or what it takes beyond the
    # horizon.
    short = (problem.shortest_gaps_rad - roots).max(axis=1)
    late = roots.sum(axis=1) - problem.horizon_rad
    away = np.maximum(problem.ratios.lowest - ratios, ratios - problem.ratios.highest)
    misses = np.maximum(np.maximum(short, late), away.max(axis=1, initial=-np.inf))
    best = np.argmin(misses)
    times = ", ".join(f"{phase / period:.6g}" for phase in np.cumsum(roots[best]))
    nearest = f"{report}; nearest miss: the solution with switches at 0, {times} periods"
    if not ratios.shape[1]:
        return nearest
    where = ", ".join(f"{ratio:.4g}" for ratio in ratios[best])
    return f"{nearest}, its zeros and peaks at {where} of the frequency"
