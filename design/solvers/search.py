"""From a problem to candidates: seeds by IPOPT, then every branch within the horizon."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from design.errors import InfeasibleDesignError, TimeLimitError
from design.formulations.equations import GapProblem, Seed
from design.solvers import ipopt, newton
from design.solvers.budget import Budget
from design.solvers.continuation import follow
from design.solvers.outcome import Status
from design.solvers.solution import Solution, SolverReport, of_gaps
from design.trace import TraceStep
from design.types import FloatArray

BRANCH_STARTS = 1024
"""Starts of the search over all branches."""

HORIZONS_PERIODS = (3.0, 10.0, 30.0)
"""Horizons that are searched before a longer one [-]."""

MIN_SHARE = 1e-3
"""Shortest step from what a seed solves to what is asked, over that way [-]."""

JUDGING_WORK = 5_000.0
"""Work of what judges a candidate: certificates, insensitivities [units]."""

SAME_ROOT_RAD = 1e-6
"""Roots closer than this are one [rad]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OrderedSolution:
    """An ordered solution as reported by the solver, not yet certified.

    Attributes
    ----------
    problem
        What it solves.
    gaps_rad
        Gaps between impulses, shape (n - 1,) [rad].
    ratios
        Frequency ratios that were unknown too, shape (r,) [-].
    seed
        Name of the start that led to it.
    iterations
        The solver's iterations from there.
    starts
        Starts tried so far, this one included.
    """

    problem: GapProblem
    gaps_rad: FloatArray
    ratios: FloatArray
    seed: str
    iterations: int
    starts: int


def solve(problem: GapProblem, budget: Budget) -> Iterator[Solution]:
    """Yield ordered solutions, the likeliest minimum first.

    Parameters
    ----------
    problem
        The problem.
    budget
        What the search may do; its work is counted in it.

    Yields
    ------
    Solution
        Impulses and the report of the solver, not yet certified.

    Raises
    ------
    InfeasibleDesignError
        When all candidates, if any, are used up: says how far was searched.
    TimeLimitError
        If IPOPT ran past its time.
    """
    w = problem.natural_frequency_rad_s
    for found in candidates(problem, budget):
        yield Solution(
            impulses=of_gaps(found.gaps_rad, w, found.problem.amplitudes),
            solver=SolverReport(
                name="ipopt",
                status="solve_succeeded",
                iterations=found.iterations,
                seed=found.seed,
                starts=found.starts,
            ),
            ratios=found.ratios,
        )


def candidates(problem: GapProblem, budget: Budget | None = None) -> Iterator[OrderedSolution]:
    """Yield ordered solutions, the likeliest minimum first.

    Each solution comes from IPOPT, which starts at the problem's own seeds first. Newton's method
    sharpens the seeds, which halves the iterations of IPOPT, or follows them from what they solve.
    IPOPT next starts at every root that Newton's method finds from `BRANCH_STARTS` starts spread
    over the horizon. Shorter horizons come first, and of each the fastest root. At last IPOPT
    starts at the seeds as they are. Where the budget is spent, the search ends.

    Parameters
    ----------
    problem
        The problem.
    budget
        What the search may do; that of one design if not given.

    Yields
    ------
    Candidate
        A solution by the solver's word, with the start that led to it.

    Raises
    ------
    InfeasibleDesignError
        When all candidates, if any, are used up: says how far was searched.
    TimeLimitError
        If IPOPT ran past its time.
    """
    budget = Budget() if budget is None else budget
    tried = 0
    for seed in problem.seeds:
        tried += 1
        sharpened = _sharpen_seed(problem, seed, budget)
        allowed = sharpened is not None and bool(problem.allows(sharpened))
        budget.note(_seed_step(problem, seed, sharpened, allowed=allowed))
        if sharpened is not None and allowed:
            yield from _solve_from(problem, sharpened, seed.name, tried, budget)
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
        for unknowns in _ordered_fastest_first(within, found):
            if budget.spent:
                break
            yield from _solve_from(within, unknowns, "branch_search", tried, budget)
    for seed in problem.seeds:
        if not budget.spent:
            start = problem.start(seed.gaps_rad)
            yield from _solve_from(problem, start, seed.name, tried, budget)
    raise InfeasibleDesignError(
        _describe_search(searched, spread, tried) + _describe_early_end(problem, budget),
        code="no_solution_found",
    )


def _describe_early_end(problem: GapProblem, budget: Budget) -> str:
    """Say that a search ended before its end, if it did."""
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


def _sharpen_seed(problem: GapProblem, seed: Seed, budget: Budget) -> FloatArray | None:
    """Return where Newton's method ends from a seed: a root or not, within bounds or not.

    None if the seed is to be followed from what it solves, and the path ends on the way.
    """
    start, solves = problem.start(seed.gaps_rad), seed.solves
    if solves is None:
        return newton.root(problem.model, start, problem.parameters)

    def solve(guess: FloatArray, share: float) -> FloatArray | None:
        parameters = solves + share * (problem.parameters - solves)
        end = newton.roots(problem.model, guess[None], parameters, budget=budget)
        if not len(end.unknowns):
            return None
        return end.unknowns[0] if end.converged[0] and problem.allows(end.unknowns[0]) else None

    path = follow(start, solve, MIN_SHARE)
    return path.unknowns if path.complete else None


def _solve_from(
    problem: GapProblem, start: FloatArray, seed: str, tried: int, budget: Budget
) -> Iterator[OrderedSolution]:
    outcome = ipopt.solve(problem, start)
    budget.spend(JUDGING_WORK + ipopt.work_of(problem.model, outcome.iterations))
    if outcome.status is Status.TIME_LIMIT:
        raise TimeLimitError(f"ipopt ran past its time from seed {seed!r}", code="seed_past_time")
    gaps, ratios = problem.split(outcome.unknowns)
    in_time = bool(gaps.sum() <= problem.horizon_rad)
    budget.note(
        TraceStep(
            stage="solve",
            method="ipopt",
            start=seed,
            outcome=outcome.status if in_time else "rejected",
            iterations=outcome.iterations,
            duration_s=_duration_s(problem, gaps),
            misses=outcome.misses,
            detail="" if in_time else "longer than max_duration_periods",
        )
    )
    if outcome.status is Status.SOLVE_SUCCEEDED and in_time:
        yield OrderedSolution(
            problem=problem,
            gaps_rad=gaps,
            ratios=ratios,
            seed=seed,
            iterations=outcome.iterations,
            starts=tried,
        )


def _seed_step(
    problem: GapProblem, seed: Seed, sharpened: FloatArray | None, *, allowed: bool
) -> TraceStep:
    """Return what became of a seed before the solver itself starts there."""
    gaps = seed.gaps_rad if sharpened is None else problem.split(sharpened)[0]
    if allowed:
        outcome, detail = "sharpened", ""
    elif sharpened is None:
        outcome, detail = "lost", "the path from what the seed solves ends on the way"
    else:
        outcome, detail = "rejected", "out of order, or longer than max_duration_periods"
    return TraceStep(
        stage="seed",
        method="newton",
        start=seed.name,
        outcome=outcome,
        duration_s=_duration_s(problem, gaps),
        detail=detail,
    )


def _duration_s(problem: GapProblem, gaps_rad: FloatArray) -> float | None:
    """Return what gaps add up to; None where they ran away [s]."""
    with np.errstate(all="ignore"):
        duration = float(gaps_rad.sum()) / problem.natural_frequency_rad_s
    return duration if math.isfinite(duration) else None


def _ordered_fastest_first(problem: GapProblem, ends: newton.Roots) -> Iterator[FloatArray]:
    """Distinct roots within the problem's bounds, by duration."""
    durations = problem.split(ends.unknowns)[0].sum(axis=1)
    usable = np.flatnonzero(ends.converged & problem.allows(ends.unknowns))
    last = -np.inf
    for index in usable[np.argsort(durations[usable])]:
        if durations[index] - last > SAME_ROOT_RAD:
            last = durations[index]
            yield ends.unknowns[index]


def _describe_search(problem: GapProblem, ends: newton.Roots | None, starts: int) -> str:
    """Say how far was searched, and what came nearest; nothing did where there was no start."""
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
