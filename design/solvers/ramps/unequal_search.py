"""The command that ends first behind limits and two lags, followed from one lag.

Behind one lag for both directions the fastest course is known. Its switches are a start for two
lags; where that is too far away the lags are led from one to the other in steps. From program to
program the structure is exchanged: a ramp that arrives just as the next switch comes may be turned
from there on, or may rest. Two switches that meet are dropped, and where as many switches as behind
one lag do not do, two more are tried.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from design.formulations.unequal_ramps import UnequalRampsProblem
from design.solvers.budget import Budget
from design.solvers.ramps.unequal_course import TwoLags, UnequalCourse
from design.solvers.ramps.unequal_program import ITERATION_WORK, ProgramEnd, solve_program
from design.trace import TraceStep
from design.types import BoolArray, FloatArray

MAX_PROGRAMS = 12
"""Structures that are tried from one start."""

FASTER = 1e-9
"""Share of the end by which another structure must be faster to be taken [-]."""

MEETING_RAD = 1e-6
"""Switches closer than this are none [rad]."""

MIN_SHARE = 1 / 64
"""Step of the way from one lag to two at which it is no longer followed [-]."""

PAIRS = 16
"""Places at which two more switches are tried."""

PAIR_WIDTH = 0.08
"""Their distance at first, over the end [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UnequalOptimum:
    """A command that meets its targets, of which no small change ends earlier.

    Attributes
    ----------
    course
        Its course.
    iterations, programs
        Of its programs, and how many there were.
    """

    course: UnequalCourse
    iterations: int
    programs: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stage:
    """What is solved on the way from one lag to two.

    Attributes
    ----------
    lags
        Those of the stage.
    solve
        From switches and the structure, shape (n,) each, to where its program ends.
    method
        What solves it.
    iteration_work
        Work of an iteration [units].
    """

    lags: TwoLags
    solve: Callable[[FloatArray, BoolArray], ProgramEnd]
    method: str
    iteration_work: float


def fastest_from(
    problem: UnequalRampsProblem, switches: FloatArray, budget: Budget
) -> UnequalOptimum | None:
    """Return the command that ends first, from the one behind one lag.

    Parameters
    ----------
    problem
        Targets, limits and lags.
    switches
        The switches behind one lag, ascending from 0, shape (n,) [rad].
    budget
        What the search may do.

    Returns
    -------
    UnequalOptimum or None
        None where no command was found that meets the targets.
    """

    def stage(share: float) -> Stage:
        lags = TwoLags(led(problem, share))
        return Stage(
            lags=lags,
            solve=partial(solve_program, lags),
            method="slsqp",
            iteration_work=ITERATION_WORK,
        )

    return fastest_by_stages(stage, switches, problem.natural_frequency_rad_s, budget)


def fastest_by_stages(
    stage: Callable[[float], Stage],
    switches: FloatArray,
    natural_frequency_rad_s: float,
    budget: Budget,
    near: float = math.inf,
) -> UnequalOptimum | None:
    """Return the command that ends first, from the one behind one lag.

    Parameters
    ----------
    stage
        From the share of the way to what is solved there.
    switches
        The switches behind one lag, ascending from 0, shape (n,) [rad].
    natural_frequency_rad_s
        Turns phases into times [rad/s].
    budget
        What the search may do.
    near
        End, over that behind one lag, beyond which the way there is followed all the same [-].

    Returns
    -------
    UnequalOptimum or None
        None where no command was found that keeps what is asked.
    """
    search = _Search(stage, natural_frequency_rad_s, budget)
    found = search.solve(1.0, switches)
    if found is None or found.end > near * stage(0.0).lags.of(switches).end:
        followed = search.follow(switches)
        if found is None or (followed is not None and followed.end < found.end):
            found = followed
    if found is None:
        return None
    return UnequalOptimum(course=found, iterations=search.iterations, programs=search.programs)


class _Search:
    """The parts of one search, which count their work and note their steps."""

    def __init__(
        self, stage: Callable[[float], Stage], natural_frequency_rad_s: float, budget: Budget
    ) -> None:
        self._stage, self._budget = stage, budget
        self._natural_frequency_rad_s = natural_frequency_rad_s
        self.iterations = self.programs = 0

    def solve(self, share: float, switches: FloatArray) -> UnequalCourse | None:
        """Return the best command near some switches, of one to two lags by a share."""
        stage = self._stage(share)
        arrived = stage.lags.of(switches).arrived
        best: UnequalCourse | None = None
        tried: set[bytes] = set()
        waiting = [(switches, arrived)]
        for _ in range(MAX_PROGRAMS):
            if not waiting or self._budget.spent:
                break
            start, structure = waiting.pop(0)
            if structure.tobytes() in tried:
                continue
            tried.add(structure.tobytes())
            end = self._program(stage, start, structure)
            better = end.is_solved and (best is None or end.course.end < best.end * (1 - FASTER))
            if better:
                best, waiting = end.course, []
            if better or best is None:
                at = np.maximum.accumulate(end.course.switches)
                waiting += [(at, flipped) for flipped in _flipped(structure, end.at_kinks)]
        return None if best is None else _without_meeting(stage.lags, best)

    def follow(self, switches: FloatArray) -> UnequalCourse | None:
        """Return the command that is led to from one lag, with more switches where they are due."""
        share, step, pairs = 0.0, 0.5, True
        while not self._budget.spent:
            ahead = min(1.0, share + step)
            found = self.solve(ahead, switches)
            if found is None and step <= MIN_SHARE and pairs:
                found, pairs = self._with_pair(1.0, switches), False
                ahead = 1.0
            if found is not None:
                if ahead == 1:
                    return found
                share, switches, step = ahead, found.switches, 2 * step
            elif step <= MIN_SHARE:
                return None
            else:
                step /= 4
        return None

    def _with_pair(self, share: float, switches: FloatArray) -> UnequalCourse | None:
        """Return the best command with two switches more."""
        last = self._stage(share).lags.of(switches).end
        best: UnequalCourse | None = None
        for place in np.linspace(0, last, PAIRS + 2)[1:-1].tolist():
            if self._budget.spent:
                break
            more = np.sort(np.append(switches, (place, place + PAIR_WIDTH * last)))
            found = self.solve(share, more)
            if found is not None and (best is None or found.end < best.end):
                best = found
        return best

    def _program(self, stage: Stage, switches: FloatArray, arrived: BoolArray) -> ProgramEnd:
        end = stage.solve(switches, arrived)
        self.programs += 1
        self.iterations += end.iterations
        self._budget.spend(stage.iteration_work * (end.iterations + 1))
        self._budget.note(
            TraceStep(
                stage="solve",
                method=stage.method,
                start="one_lag",
                outcome="solve_succeeded" if end.is_solved else "failed",
                iterations=end.iterations,
                duration_s=end.course.end / self._natural_frequency_rad_s,
                detail=f"{switches.size} switches",
            )
        )
        return end


def led(problem: UnequalRampsProblem, share: float) -> UnequalRampsProblem:
    """Return the problem with its braking set led from the other by a share.

    Parameters
    ----------
    problem
        Behind two lags.
    share
        Of the way [-].

    Returns
    -------
    UnequalRampsProblem
        Behind the accelerating one alone at 0.
    """
    if share == 1:
        return problem
    weights = np.array([0.0, share])
    first, second = problem.first_rad, problem.second_rad2
    return replace(
        problem,
        first_rad=first[0] + weights * (first[1] - first[0]),
        second_rad2=second[0] + weights * (second[1] - second[0]),
    )


def _flipped(arrived: BoolArray, at_kinks: BoolArray) -> list[BoolArray]:
    """Return the structures beside one, each beyond one kink."""
    structures = []
    for place in np.flatnonzero(at_kinks):
        other = arrived.copy()
        other[place] = ~other[place]
        structures.append(other)
    return structures


def _without_meeting(lags: TwoLags, course: UnequalCourse) -> UnequalCourse:
    """Return the course without pairs of switches that meet."""
    switches = course.switches
    while (near := np.flatnonzero(np.diff(switches) < MEETING_RAD)).size:
        switches = np.delete(switches, [near[0], near[0] + 1])
        switches = switches - switches[0]
    return course if switches.size == course.switches.size else lags.of(switches)
