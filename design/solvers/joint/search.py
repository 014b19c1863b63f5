"""The fastest command without vibration in several modes: structure first, then Newton's method.

A command of duration T whose vector ``V_k = sum A_i exp(-s_k t_i)`` is zero for every mode has
``sum A_i P(t_i) = 0``, whatever the c, with the function of time::

    P(t) = Re sum_k conj(c_k) exp(-s_k t)

Of positive amplitudes none is so short that P is still positive. Of a command u between 0 and 1
that is ``P(T) = integral of u P' <= rise of P``, so none is so short that P has fallen by less than
P(0). Every c gives a lower bound that way, and the best c the optimum: there positive impulses
stand where P touches zero, the command is 1 where P rises and 0 where it falls.

A linear program over a time grid, at a duration that is too short, finds the c that shows this
best; the bound that it gives is the next duration. Near the optimum c shows how many impulses there
are, and Newton's method solves for times, amplitudes and c at once, off the grid.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from operator import itemgetter

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.formulation import JointProblem
from design.solvers.budget import Budget
from design.solvers.joint.dual_function import PERIOD_RAD, DualFunction
from design.solvers.joint.optimality import NEWTON_STEPS, Shortest, sharpen
from design.solvers.joint.structure import obstacle_to, structures, work_of
from design.trace import TraceStep
from design.types import ComplexArray, FloatArray

MAX_PROGRAMS = 60
"""Linear programs until the search is given up; a dozen do for six modes."""

MAX_REFINEMENT = 8.0
"""How many times finer than at first the grid may become [-]."""

NEAR = 0.1
"""Step of the duration, over itself, from which on c is trusted with the structure [-]."""

CLOSE_ENOUGH = 1e-6
"""Gap between bound and duration, over the duration, at which nothing better is looked for [-]."""

MAX_STRIDE = 8.0
"""How many times the last gain of the bound the next duration is beyond it, at most [-]."""


def shortest(problem: JointProblem, budget: Budget | None = None) -> Iterator[Shortest]:
    """Yield the fastest command, or the best found where none is proven.

    Parameters
    ----------
    problem
        The modes, and whether amplitudes are positive.
    budget
        What the search may do; that of one design if not given.

    Yields
    ------
    Shortest
        One command at most, with the c of the strongest bound.

    Raises
    ------
    InfeasibleDesignError
        When all are used up, or the budget is spent; says how far was searched.
    """
    first = itemgetter(0)
    budget = Budget() if budget is None else budget
    dual = DualFunction(problem.unit_poles, positive=problem.positive)
    low, high, fineness, ahead = dual.first_bound_rad, math.inf, 1.0, 0.0
    duration = low
    best: Shortest | None = None
    strongest: tuple[float, ComplexArray] = (0.0, np.zeros(0, dtype=np.complex128))
    for programs in range(1, MAX_PROGRAMS + 1):
        if budget.spent:
            break
        budget.spend(work_of(dual, duration, fineness))
        obstacle = obstacle_to(dual, duration, fineness)
        budget.note(
            TraceStep(
                stage="bound",
                method="highs",
                start="linear_program",
                outcome="may_be_possible" if obstacle is None else "too_short",
                duration_s=duration / problem.natural_frequency_rad_s,
                detail=f"grid {fineness:g} times as fine as the first",
            )
        )
        gained = 0.0
        if obstacle is not None:
            excluded = dual.bound_rad(obstacle.vectors)
            strongest = max(strongest, (excluded, obstacle.vectors), key=first)
            reached = max(duration, excluded)
            if reached < duration * (1 + NEAR):
                for times in structures(dual, obstacle, reached):
                    found = sharpen(dual, obstacle.vectors, times, programs)
                    budget.note(_trace_newton(problem, times, found))
                    if found is None:
                        continue
                    strongest = max(
                        strongest, (dual.bound_rad(found.vectors), found.vectors), key=first
                    )
                    if best is None or found.times_rad[-1] < best.times_rad[-1]:
                        best = found
                    if best.times_rad[-1] <= strongest[0] * (1 + CLOSE_ENOUGH):
                        yield replace(best, vectors=strongest[1])
                        return
            gained = max(reached, strongest[0]) - low
            low += gained
        else:
            high = min(high, duration)
        if low > dual.horizon_rad:
            break
        if high - low <= CLOSE_ENOUGH * low or 0 < gained <= CLOSE_ENOUGH * low:
            if fineness >= MAX_REFINEMENT:
                break
            # What a coarse grid says of a duration is off by what it misses.
            fineness, high, ahead = 2 * fineness, math.inf, 0.0
            duration = max(strongest[0], dual.first_bound_rad)
            low = duration
        elif high < math.inf:
            duration = (low + high) / 2
        else:
            # The c of a duration far too short says little: go ahead by more and more.
            duration, ahead = low + ahead * gained, min(max(2 * ahead, 1.0), MAX_STRIDE)
    if best is not None:
        yield replace(best, vectors=strongest[1])
    modes = problem.unit_poles.size
    raise InfeasibleDesignError(
        "no command was found without vibration in "
        f"{f'all {modes} modes' if modes > 1 else 'the mode'}: none is shorter than "
        f"{strongest[0] / PERIOD_RAD:.6g} periods of the slowest mode, and {programs} linear "
        f"programs led to none{f'; {budget.in_words}' if budget.spent else ''}",
        code="no_joint_command_found",
    )


def _trace_newton(problem: JointProblem, times: FloatArray, found: Shortest | None) -> TraceStep:
    """Return what Newton's method made of a structure."""
    return TraceStep(
        stage="solve",
        method="newton",
        start="linear_program",
        outcome="failed" if found is None else "solve_succeeded",
        iterations=NEWTON_STEPS if found is None else found.iterations,
        duration_s=float(times[-1] if found is None else found.times_rad[-1])
        / problem.natural_frequency_rad_s,
        detail=f"{times.size} impulses",
    )
