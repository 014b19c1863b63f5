"""The fastest shaper that keeps bands of frequencies within a tolerance, with proof of how fast.

A cone program over a time grid (`grid`) finds the structure. Newton's method on the conditions of
optimality (`optimality`) then moves times, amplitudes and peaks where they belong, off the grid.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from design.formulations.bands import BandProblem, Obstacle
from design.solvers import clarabel
from design.solvers.budget import Budget
from design.solvers.convex_band.duration import first_duration_rad, ripples_of
from design.solvers.convex_band.grid import (
    REFINED_PITCHES,
    closer_look,
    commands_of,
    even_grid,
    least_on_grid,
    structure,
)
from design.solvers.convex_band.optimality import Point, solve_conditions
from design.solvers.convex_band.peaks import follow_tolerance, optimum, peaks
from design.trace import TraceStep
from design.types import ComplexArray, FloatArray

CLOSE_DURATION = 1e-6
"""Relative width of the bracket around the duration at which the search ends [-]."""

KEPT_INSIDE = 0.1
"""Share of the bracket that is left on either side of the next duration [-]."""

EVEN_ONLY = 4
"""Durations tried on even grids before those are refined."""

COARSE = 0.03
"""Relative error of durations by which even grids bracket the one that is looked for [-]."""

USUAL_ITERATIONS = 25
"""Iterations of a cone program, about."""

STRUCTURE_SHARE = 0.6
"""Share of the budget after which the structure is not looked for further [-].

The rest is for a command of the grid's own steps, and for the proof of how short none is.
"""

ROUGH = (1e-3, 3e-3, 0.01, 0.03, 0.1)
ROUGH_FINENESS = 2
"""How much longer than the shortest a command of the grid's own cells may be, and the grid how many
times finer [-]."""

MAX_DURATIONS = 12
"""Durations tried in all."""

AWAY = (0.005, -0.005, 0.02, -0.02)
"""How far from the duration found the structure is looked at if none led to it [-]."""

SHORTENED = (0.003, 0.01, 0.03, 0.1)
"""By how much a duration is shortened where only a cone program can tell that it is short [-]."""

DESIGN_MARGIN = 1e-10
"""Peaks are put this far below the tolerance, so that rounding lifts none above it [-]."""

EASED = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
"""By how much the tolerance is eased for a duration that is just too short, least first [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BandOptimum:
    """An optimum as reported by the solver, not yet certified.

    Attributes
    ----------
    times_rad
        Times of the impulses, shape (n,) [rad].
    amplitudes
        Their amplitudes, shape (n,) [-].
    iterations
        Steps of Newton's method.
    cone_programs
        Cone programs solved until then.
    point
        What it is an optimum by; None for one of a grid's own steps.
    """

    times_rad: FloatArray
    amplitudes: FloatArray
    iterations: int
    cone_programs: int
    point: Point | None


def candidates(problem: BandProblem, budget: Budget) -> Iterator[BandOptimum | Obstacle]:
    """Yield optima, the likeliest first, and proofs met on the way.

    Optima further on take longer to find. Impulses or peaks may merge at the optimum itself. What
    comes from longer durations then ends just before it and is a shaper all the same; what comes
    from shorter durations is a proof. A grid shows no structure where a command may as well be
    between its limits. The steps of a grid then make a shaper that is a little longer.

    Parameters
    ----------
    problem
        The bands.
    budget
        What the search may do; its work is counted in it.

    Yields
    ------
    BandOptimum or Obstacle
        A shaper, or a function that stands against a duration.

    Raises
    ------
    SolverFailedError
        If Clarabel did not solve a cone program.
    """
    tolerance = problem.tolerance * (1 - DESIGN_MARGIN)
    duration, low, high = first_duration_rad(problem), 0.0, math.inf
    before: tuple[float, float] | None = None
    programs, met = 0, False
    enough = STRUCTURE_SHARE * budget.most
    refine = False
    for attempt in range(MAX_DURATIONS):
        if attempt >= EVEN_ONLY and not refine:
            # What even grids say of a duration is off by what they miss.
            refine, low, high = True, low * (1 - COARSE), high * (1 + COARSE)
        programs += 1 + refine * len(REFINED_PITCHES)
        least, best = _nearest(problem, duration, budget, refine=refine, follow=refine)
        if best is not None:
            told = _note_step(problem, *best, programs, budget)
            met = met or isinstance(told, BandOptimum)
            yield told
        if least > tolerance:
            low = max(low, duration)
        else:
            high = min(high, duration)
        now = (duration, ripples_of(least))
        duration = _next_duration(before, now, ripples_of(tolerance), low, high)
        if best is not None and not refine:
            # No optimum after all, for an impulse that the grid did not show: a closer look there.
            duration, refine = float(best[0].lags[-1]), True
        if high - low < CLOSE_DURATION * low or budget.done > enough:
            break
        before = now
    for share in AWAY:
        if budget.done > enough:
            break
        programs += 1 + len(REFINED_PITCHES)
        _, best = _nearest(problem, duration * (1 + share), budget, refine=True, follow=True)
        if best is not None:
            told = _note_step(problem, *best, programs, budget)
            met = met or isinstance(told, BandOptimum)
            yield told
    if not met:
        yield from _of_the_grid(problem, duration, programs, budget)


def _of_the_grid(
    problem: BandProblem, duration_rad: float, programs: int, budget: Budget
) -> Iterator[BandOptimum]:
    """Yield the command of a grid's own cells or points at the first duration that allows one."""
    for tried, longer in enumerate(ROUGH, start=1):
        if budget.spent:
            return
        grid = even_grid(problem, duration_rad * (1 + longer), ROUGH_FINENESS)
        for point in commands_of(problem, grid, budget):
            if peaks(problem, point)[2].max() <= problem.tolerance:
                yield replace(_candidate(point, programs + tried), point=None)
                return


def _nearest(
    problem: BandProblem, duration_rad: float, budget: Budget, *, refine: bool, follow: bool
) -> tuple[float, tuple[Point, float] | None]:
    """Return the least residual of a duration, and what its structure leads to."""
    tolerance = problem.tolerance * (1 - DESIGN_MARGIN)
    if refine:
        grid, found = closer_look(problem, duration_rad, budget)
    else:
        grid = even_grid(problem, duration_rad)
        found = least_on_grid(problem, grid, budget)
    budget.note(
        TraceStep(
            stage="bound",
            method="clarabel",
            start="refined_grid" if refine else "even_grid",
            outcome="too_short" if found.largest > tolerance else "may_be_possible",
            duration_s=duration_rad / problem.natural_frequency_rad_s,
            detail=f"least residual over the bands: {found.largest:.4g}",
        )
    )
    start = structure(problem, grid, found)
    if start is None:
        return found.largest, None
    best = optimum(problem, start, tolerance)
    if best is not None:
        return found.largest, (best, tolerance)
    if not follow:
        return found.largest, None
    return found.largest, follow_tolerance(problem, start, found.largest, tolerance, budget)


def _note_step(
    problem: BandProblem, point: Point, tolerance: float, programs: int, budget: Budget
) -> BandOptimum | Obstacle:
    beyond = tolerance > problem.tolerance
    budget.note(
        TraceStep(
            stage="solve",
            method="newton",
            start="cone_program",
            outcome="too_short" if beyond else "solve_succeeded",
            iterations=point.steps,
            duration_s=float(point.lags[-1]) / problem.natural_frequency_rad_s,
            detail=f"{point.amplitudes.size} impulses",
        )
    )
    return _obstacle(problem, point) if beyond else _candidate(point, programs)


def _candidate(point: Point, programs: int) -> BandOptimum:
    return BandOptimum(
        times_rad=point.lags[-1] - point.lags[::-1],
        amplitudes=point.amplitudes[::-1],
        iterations=point.steps,
        cone_programs=programs,
        point=point,
    )


def _next_duration(
    before: tuple[float, float] | None,
    now: tuple[float, float],
    wanted: float,
    low: float,
    high: float,
) -> float:
    """Return the duration to try next: secant through the last two, inside the bracket."""
    (duration, ripples), (other, others) = now, before or (0.0, 0.0)
    slope = (ripples - others) / (duration - other)
    guess = duration + (wanted - ripples) / slope if slope > 0 else 0.0
    if low == 0:
        return guess if duration / 2 < guess < duration else duration / 2
    if high == math.inf:
        return guess if duration < guess < 2 * duration else 1.2 * duration
    inside = KEPT_INSIDE * (high - low)
    return min(max(guess, low + inside), high - inside) if guess > 0 else (low + high) / 2


def obstacles(problem: BandProblem, candidate: BandOptimum, budget: Budget) -> Iterator[Obstacle]:
    """Yield obstacles to durations below that of an optimum.

    Each may prove that no shaper is as short as its duration. Later ones are of shorter durations,
    from cone programs.

    Parameters
    ----------
    problem
        The bands.
    candidate
        The optimum.
    budget
        The work of cone programs is counted in it.

    Yields
    ------
    Obstacle
        A function that stands against a shorter duration.

    Raises
    ------
    SolverFailedError
        If Clarabel did not solve a cone program.
    """
    longest = float(candidate.times_rad[-1])
    start = candidate.point
    for eased in EASED:
        point = start and solve_conditions(problem, start, problem.tolerance * (1 + eased))
        if point is not None and point.lags[-1] < longest:
            yield _obstacle(problem, point)
    for shortened in SHORTENED:
        yield obstacle_at(problem, longest * (1 - shortened), budget)[0]


def _obstacle(problem: BandProblem, point: Point) -> Obstacle:
    """Return the dual function of an optimum."""
    poles = problem.poles_at(point.bands, point.ratios)
    vector: ComplexArray = np.exp(np.multiply.outer(poles, point.lags))
    along = (vector @ point.amplitudes).conj()
    return Obstacle(
        duration_rad=float(point.lags[-1]),
        unit_poles=poles,
        vectors=point.weights * along / np.abs(along),
    )


def obstacle_work(problem: BandProblem, duration_rad: float) -> float:
    """Return about how much `obstacle_at` takes [units].

    Parameters
    ----------
    problem
        The bands.
    duration_rad
        The duration [rad].

    Returns
    -------
    float
        Work of a cone program of that duration with its usual iterations [units].
    """
    grid = even_grid(problem, duration_rad)
    ratios = sum(of_band.size for of_band in grid.ratios)
    return clarabel.ENTRY_WORK * USUAL_ITERATIONS * grid.lags.size * ratios


def obstacle_at(
    problem: BandProblem, duration_rad: float, budget: Budget
) -> tuple[Obstacle, float]:
    """Return an obstacle to a duration, from the cone program.

    Parameters
    ----------
    problem
        The bands.
    duration_rad
        The duration [rad].
    budget
        The work of the cone program is counted in it.

    Returns
    -------
    tuple of Obstacle and float
        What may prove that no shaper is so short, and about the least tolerance that the duration
        allows [-].

    Raises
    ------
    SolverFailedError
        If Clarabel did not solve the cone program.
    """
    grid = even_grid(problem, duration_rad)
    found = least_on_grid(problem, grid, budget)
    poles = grid.poles_of(problem)
    obstacle = Obstacle(duration_rad=duration_rad, unit_poles=poles, vectors=found.obstacle)
    return obstacle, found.largest
