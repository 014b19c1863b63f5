"""Steps for several modes: Newton's method from many starts, spread over ever longer durations.

The equations have as many solutions as there are ways to order the steps, isolated each. Nothing
shows which is the fastest; a solution is found most easily from starts of about its own duration.
So starts are spread over a short duration first, then over longer ones, until a solution as short
as they are is found: after that longer ones are of no use.

With many steps, or with modes far apart, few starts lead to a solution. There the optimum of an
ideal drive is followed to the drive that is given, before any start, and starts are spread around
it. An ideal drive has the solutions of one whose two sets are alike, as one lag moves no zero.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.equations import GapProblem
from design.formulations.gaps import PERIOD_RAD, of_gaps
from design.formulations.steps_for_modes import LAGS, OF_A_MODE, StepsForModes, StepsProblem
from design.solvers import newton
from design.solvers.branches import (
    BRANCH_STARTS,
    describe_early_end,
    describe_search,
    fastest_first,
    unit_starts,
)
from design.solvers.budget import Budget
from design.solvers.continuation import follow
from design.solvers.ramps import search as ramps
from design.solvers.solution import Solution, SolverReport
from design.trace import TraceStep
from design.types import FloatArray

FIRST_PERIODS = {False: 0.4, True: 0.8}
"""Shortest duration over which starts are spread, without slopes and with them, in periods of the
slowest mode. Alone behind an ideal drive it takes a third of a period, 0.73 with its slope [-]."""

STRIDE = 1.5
"""Each duration over the one before: of random plants hardly any solution is found only between."""

STARTS_PER_GAP = 64
"""Starts over each duration, for each gap but one, up to all that there are."""

FREQUENCIES_APART = 5.0
"""Highest over lowest frequency from which on there are more starts, in proportion [-]."""

FAR_APART = 8.0
"""The same from which on the optimum of an ideal drive is followed [-]."""

MOST_GAPS = 6
"""Gaps beyond which it is followed, and all starts are tried where that is to no avail: one start
in a hundred leads to a solution then."""

NEWTON_STEPS = 12
"""Steps of Newton's method from a start: four of five that lead to a solution have by then."""

FASTEST = 64
"""Solutions for superposed steps from which those of a switched drive are looked for."""

SHARE_OF_STARTS = 5
"""Of so many starts for superposed steps, one is for a switched drive too; with modes far apart,
each is."""

IDEAL_WORK = 1e6
"""What the search for the optimum of an ideal drive may do [units]."""

MIN_SHARE = 1e-3
"""Shortest step from an ideal drive to the one given, over that way [-]."""

AROUND_IDEAL = 512
"""Starts around the optimum of an ideal drive, over each duration."""

SPREAD_SHARE = 0.5
"""Share of such a start that is spread, the rest being that optimum: of random triples with slopes
shares of 0.15 and 0.3 lead to fewer solutions [-]."""

AROUND, EVERYWHERE = "around_ideal_optimum", "spread_starts"
"""What starts are called."""

STRETCHES = (1.0, 1.25, 1.6, 1.8, 2.0)
"""Durations of such starts over that of the optimum: most solutions take 1 to 1.4 times as long."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Found:
    """Gaps that solve the equations, in order."""

    gaps_rad: FloatArray
    seed: str  # Name of its start

    @property
    def duration_rad(self) -> float:
        return float(self.gaps_rad.sum())


def solve_steps(problem: StepsProblem, budget: Budget) -> Iterator[Solution]:
    """Yield solutions in order of their duration.

    Parameters
    ----------
    problem
        The steps, and what they make zero.
    budget
        What the search may do: where it is spent, the search ends with what it has.

    Yields
    ------
    Solution
        As found by Newton's method, not yet certified.

    Raises
    ------
    InfeasibleDesignError
        When all solutions, if any, are used up: says how far was searched.
    """
    gaps = problem.gaps
    ideal = _ideal_gaps(problem, budget) if _is_hard(gaps) else None
    found = [] if ideal is None else list(_from_ideal(gaps, ideal, budget))
    tried = len(found)
    further = replace(gaps, horizon_rad=STRIDE * gaps.horizon_rad)
    longer: list[FloatArray] = []
    ends: newton.Roots | None = None
    for spread in _spreads(gaps, ideal, found):
        if budget.spent:
            break
        searched = _ends(problem, spread.starts, budget)
        if not len(searched.unknowns):
            break
        ends = searched
        tried += len(spread.starts)
        roots = list(fastest_first(further, ends))
        asked = [one for one in roots if one.sum() <= gaps.horizon_rad]
        found += [_Found(gaps_rad=one, seed=spread.seed) for one in asked]
        if spread.seed == AROUND:
            longer += roots[len(asked) :]
        budget.note(
            TraceStep(
                stage="seed",
                method="newton",
                start=spread.seed,
                outcome="searched",
                duration_s=spread.duration_rad / gaps.natural_frequency_rad_s,
                detail=f"{ends.converged.sum()} ends of {len(spread.starts)} starts, spread over "
                f"that duration, are roots; in order so far: {len(found)}",
            )
        )
        if min((one.duration_rad for one in found), default=math.inf) <= spread.duration_rad:
            break
    for one in sorted(found, key=lambda one: one.duration_rad):
        yield Solution(
            impulses=of_gaps(one.gaps_rad, gaps.natural_frequency_rad_s, gaps.amplitudes),
            solver=SolverReport(
                name="newton",
                status="solve_succeeded",
                iterations=NEWTON_STEPS,
                seed=one.seed,
                starts=tried,
            ),
        )
    besides = describe_early_end(gaps, budget) + ("" if found else _describe_longer(longer))
    raise InfeasibleDesignError(
        f"{describe_search(gaps, ends, tried)}{besides}",
        code="no_solution_found",
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Spread:
    """Starts that are spread over a duration."""

    starts: FloatArray  # Gaps, shape (m, n) [rad]
    duration_rad: float
    seed: str  # What they are called


def _spreads(
    problem: GapProblem, ideal: FloatArray | None, found: list[_Found]
) -> Iterator[_Spread]:
    """Yield starts in the order in which they are tried; what is found meanwhile is looked at."""
    if ideal is not None:
        yield from _around(problem, ideal)
        if found:  # hardly any solution elsewhere is shorter, of those of random triples none
            return
    yield from _everywhere(problem, found)


def _around(problem: GapProblem, ideal: FloatArray) -> Iterator[_Spread]:
    """Yield starts around the optimum of an ideal drive, over longer and longer durations."""
    optimum_rad = float(ideal.sum())
    even = optimum_rad * unit_starts(ideal.size)[:AROUND_IDEAL]
    starts = (1 - SPREAD_SHARE) * ideal + SPREAD_SHARE * even
    for stretch in STRETCHES:
        duration_rad = stretch * optimum_rad
        # What is found from starts of some duration may be somewhat shorter.
        if duration_rad > STRIDE * problem.horizon_rad:
            return
        yield _Spread(starts=stretch * starts, duration_rad=duration_rad, seed=AROUND)


def _everywhere(problem: GapProblem, found: list[_Found]) -> Iterator[_Spread]:
    """Yield starts that are spread evenly, over longer and longer durations."""
    count = _starts_of(problem, sought=not found)
    for number, duration_rad in enumerate(_horizons(problem, found)):
        rows = (number * count + np.arange(count)) % BRANCH_STARTS
        starts = duration_rad * unit_starts(problem.amplitudes.size - 1)[rows]
        yield _Spread(starts=starts, duration_rad=duration_rad, seed=EVERYWHERE)


def _describe_longer(roots: list[FloatArray]) -> str:
    """Say which duration is enough for the shortest of some solutions, if there is one."""
    if not roots:
        return ""
    # Rounded up, so that what is offered can be met.
    shortest = math.ceil(min(float(one.sum()) for one in roots) / PERIOD_RAD * 1e3) / 1e3
    return f"; max_duration_periods = {shortest:g} can be met"


def _apart(problem: GapProblem) -> float:
    """Return the highest over the lowest frequency [-]."""
    return float(problem.parameters[LAGS::OF_A_MODE].max())


def _is_hard(problem: GapProblem) -> bool:
    """Return whether few starts lead to a solution."""
    return problem.shortest_gaps_rad.size > MOST_GAPS or _apart(problem) > FAR_APART


def _starts_of(problem: GapProblem, *, sought: bool) -> int:
    """Return how many starts are spread over each duration, by whether nothing is found yet."""
    gaps = problem.shortest_gaps_rad.size
    if sought and gaps > MOST_GAPS:
        return BRANCH_STARTS
    usual = STARTS_PER_GAP * max(gaps - 1, 1) * max(_apart(problem) / FREQUENCIES_APART, 1.0)
    return min(math.ceil(usual / newton.LANES) * newton.LANES, BRANCH_STARTS)


def _horizons(problem: GapProblem, found: list[_Found]) -> list[float]:
    """Return the durations over which starts are spread, one after another [rad].

    None is far below a solution that is found already.
    """
    model = problem.model
    slopes = isinstance(model, StepsForModes) and model.slopes
    horizons = [PERIOD_RAD * FIRST_PERIODS[slopes]]
    while horizons[-1] * STRIDE < problem.horizon_rad:
        horizons.append(horizons[-1] * STRIDE)
    least = min((one.duration_rad / STRIDE for one in found), default=0.0)
    return [
        *(one for one in horizons if least < one < problem.horizon_rad),
        problem.horizon_rad,
    ]


def _ends(problem: StepsProblem, starts: FloatArray, budget: Budget) -> newton.Roots:
    """Return where Newton's method ends.

    A switched drive has three times the work of superposed steps, and fewer starts lead to its
    solutions: it is solved from theirs, and from some of the starts.
    """
    added, asked = problem.superposed, problem.gaps
    roots = newton.roots(
        added.model, starts, added.parameters, iterations=NEWTON_STEPS, budget=budget
    )
    if asked.model == added.model:
        return roots
    near = np.flatnonzero(roots.converged & (roots.unknowns > 0).all(axis=1))
    near = near[np.argsort(roots.unknowns[near].sum(axis=1))]
    stride = 1 if _apart(asked) > FAR_APART else SHARE_OF_STARTS
    return newton.roots(
        asked.model,
        np.concatenate((roots.unknowns[near][:FASTEST], starts[::stride])),
        asked.parameters,
        iterations=NEWTON_STEPS,
        budget=budget,
    )


def _ideal_gaps(problem: StepsProblem, budget: Budget) -> FloatArray | None:
    """Return the gaps of the optimum of an ideal drive; None where it has other steps."""
    part = budget.part(IDEAL_WORK)
    courses = list(islice(ramps.candidates(problem.ideal, part), 1))
    budget.spend(part.done)
    asked, added = problem.gaps, problem.superposed
    still = asked.parameters.copy()
    still[:LAGS] = 0.0
    for course in courses:
        switches = course.course.switches
        if switches.size == asked.amplitudes.size:
            return _root(added, np.diff(switches), still, budget)
    return None


def _from_ideal(asked: GapProblem, ideal: FloatArray, budget: Budget) -> Iterator[_Found]:
    """Yield the solution to which the optimum of an ideal drive leads, if to one.

    On the way one set becomes the other, the slower of the two, in which the drive begins.
    """
    accel, decel = slice(0, LAGS // 2), slice(LAGS // 2, LAGS)
    alike = asked.parameters.copy()
    slower = max(accel, decel, key=lambda one: float(alike[one][0]))
    alike[accel] = alike[decel] = asked.parameters[slower]
    start = _root(asked, ideal, alike, budget)
    end = None if start is None else _followed(asked, start, alike, budget)
    if end is not None and asked.allows(end):
        yield _Found(gaps_rad=end, seed="ideal_optimum")


def _followed(
    problem: GapProblem, start: FloatArray, solved: FloatArray, budget: Budget
) -> FloatArray | None:
    """Return the root to which one of other parameters leads; None if the path ends on the way."""

    def solve(guess: FloatArray, share: float) -> FloatArray | None:
        return _root(problem, guess, solved + share * (problem.parameters - solved), budget)

    path = follow(start, solve, MIN_SHARE)
    return path.unknowns if path.complete else None


def _root(
    problem: GapProblem, guess: FloatArray, parameters: FloatArray, budget: Budget
) -> FloatArray | None:
    """Return the root near a guess, its steps in order; None where there is none."""
    end = newton.roots(problem.model, guess[None], parameters, budget=budget)
    if not len(end.unknowns) or not end.converged[0] or not (end.unknowns[0] > 0).all():
        return None
    root: FloatArray = end.unknowns[0]
    return root
