"""From a whole move to candidates: seeds and pulse trains by IPOPT, coinciding steps dropped."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from design.errors import InfeasibleDesignError, TimeLimitError
from design.formulations.equations import GapProblem
from design.formulations.gaps import PERIOD_RAD
from design.formulations.whole_move import WholeMove, pulse_trains
from design.solvers import ipopt
from design.solvers.branches import spread_starts
from design.solvers.budget import Budget
from design.solvers.outcome import Status
from design.types import FloatArray

COINCIDE_RAD = 1e-4
"""Steps closer than this are one: a sixtieth of a thousandth of a period [rad]."""

STEP_WORK = 60.0
"""Work of each step of the move in an iteration, beside what that takes anyway [units]."""

CANDIDATE_WORK = 20_000.0
"""Work of what judges a move: its certificate, its travel [units]."""

SPREAD_STARTS = 12
"""Starts spread over the usual duration, where a move with fewer steps is looked for."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MoveCandidate:
    """A move as reported by the solver, not yet verified.

    Attributes
    ----------
    problem
        What it solves: that asked for, or the same with fewer steps.
    gaps_rad
        Gaps between its steps, shape (steps - 1,) [rad].
    """

    problem: GapProblem
    gaps_rad: FloatArray

    @property
    def duration_rad(self) -> float:
        """From the first step to the last [rad]."""
        return float(self.gaps_rad.sum())


class _Search:
    """Starts of one search, counted."""

    def __init__(self, budget: Budget) -> None:
        self.starts = 0
        self.budget = budget

    def solve_runs(self, problem: GapProblem, seeds: list[FloatArray]) -> Iterator[FloatArray]:
        """Yield the ends of the runs that the solver calls solved."""
        for seed in seeds:
            if self.budget.spent:
                return
            self.starts += 1
            outcome = ipopt.solve(problem, np.maximum(seed, problem.shortest_gaps_rad))
            iteration = ipopt.ITERATION_WORK + STEP_WORK * problem.amplitudes.size
            self.budget.spend(iteration * outcome.iterations)
            if outcome.status is Status.TIME_LIMIT:
                raise TimeLimitError(
                    f"ipopt ran past its time at start {self.starts} of a move",
                    code="move_past_time",
                )
            in_time = outcome.unknowns.sum() <= problem.horizon_rad
            if outcome.status is Status.SOLVE_SUCCEEDED and in_time:
                yield outcome.unknowns

    def with_fewer_steps(
        self, problem: GapProblem, gaps_rad: FloatArray
    ) -> Iterator[MoveCandidate]:
        """Yield the move without its coinciding steps, if that can be solved, then as it is.

        Steps up and down at one moment leave something only in the superposed model, where each
        is answered by another set: no drive can follow them.
        """
        fewer = _with_two_steps_fewer(problem)
        if gaps_rad.min() <= COINCIDE_RAD and fewer is not None:
            for end in self.solve_runs(fewer, [_without_shortest(gaps_rad)]):
                yield from self.with_fewer_steps(fewer, end)
        yield MoveCandidate(problem=problem, gaps_rad=gaps_rad)

    def everywhere(self, problem: GapProblem, usual_rad: float) -> Iterator[MoveCandidate]:
        """Yield what seeds and trains lead to, then what fewer steps do."""
        seeds = [*(seed.gaps_rad for seed in problem.seeds), *pulse_trains(problem)]
        for end in self.solve_runs(problem, seeds):
            yield from self.with_fewer_steps(problem, end)
        fewer = _with_two_steps_fewer(problem)
        while fewer is not None:
            spread = spread_starts(replace(fewer, horizon_rad=usual_rad))[:SPREAD_STARTS]
            for end in self.solve_runs(fewer, [*pulse_trains(fewer), *spread]):
                yield MoveCandidate(problem=fewer, gaps_rad=end)
            fewer = _with_two_steps_fewer(fewer)


def move_candidates(
    problem: GapProblem, usual_rad: float, budget: Budget | None = None
) -> Iterator[MoveCandidate]:
    """Yield moves, the likeliest minimum first.

    IPOPT starts at the problem's own seeds, then at trains of pulses, then with fewer steps. Where
    two steps coincide, the move is solved again without them.

    Parameters
    ----------
    problem
        A whole move.
    usual_rad
        What the move should not take longer than: local minima may be several periods longer, and
        come last, with what has coinciding steps still [rad].
    budget
        What the search may do; that of one design if not given.

    Yields
    ------
    MoveCandidate
        A move and the problem that it solves, not yet verified.

    Raises
    ------
    InfeasibleDesignError
        When all candidates, if any, are used up: says how many starts were tried.
    TimeLimitError
        If the solver ran past its time.
    """
    search = _Search(Budget() if budget is None else budget)
    usual_rad = min(usual_rad, problem.horizon_rad)
    put_off = []
    for candidate in search.everywhere(problem, usual_rad):
        search.budget.spend(CANDIDATE_WORK)
        if candidate.gaps_rad.min() > COINCIDE_RAD and candidate.duration_rad <= usual_rad:
            yield candidate
        else:
            put_off.append(candidate)
    yield from sorted(
        put_off, key=lambda one: (one.gaps_rad.min() <= COINCIDE_RAD, one.duration_rad)
    )
    travel_s = float(problem.parameters[-1]) / problem.natural_frequency_rad_s
    raise InfeasibleDesignError(
        f"no move on levels 0 and 1 was found that travels {travel_s:.6g} s times its speed within "
        f"{problem.horizon_rad / PERIOD_RAD:.4g} periods, in {search.starts} starts"
        f"{f'; {search.budget.in_words}' if search.budget.spent else ''}",
        code="no_move_found",
    )


def _with_two_steps_fewer(problem: GapProblem) -> GapProblem | None:
    """Return the same move with two steps less; None if there would be more equations than gaps."""
    model = problem.model
    if not isinstance(model, WholeMove) or model.steps - 2 <= model.equations:
        return None
    return replace(
        problem,
        model=replace(model, steps=model.steps - 2),
        amplitudes=problem.amplitudes[:-2],
        shortest_gaps_rad=problem.shortest_gaps_rad[:-2],
    )


def _without_shortest(gaps_rad: FloatArray) -> FloatArray:
    """Return the gaps without the two steps around the shortest of them."""
    times = np.concatenate(([0.0], np.cumsum(gaps_rad)))
    first = int(np.argmin(gaps_rad))
    return np.diff(np.delete(times, [first, first + 1]))
