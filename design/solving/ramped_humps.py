"""Shapers with humps behind limits: zeros spread until the humps between have their height."""

import math
from collections.abc import Iterator

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.gaps import PERIOD_RAD
from design.formulations.ramped_humps import RampedHumpsProblem
from design.solvers.budget import Budget
from design.solvers.jerk_ramps.search import JerkOptimum
from design.solvers.least_squares import least_squares
from design.solvers.ramps import search
from design.solvers.ramps.band_optimality import growths, residuals
from design.solvers.ramps.movable import Movable
from design.solvers.ramps.optimality import RampedOptimum
from design.solvers.solution import Solution
from design.solving.course_solutions import solution_of
from design.solving.jerk_ramps import proven_jerk_ramps
from design.solving.ramps import proven_ramps
from design.types import FloatArray

MAX_STEPS = 40
"""Steps of Newton's method on the zeros."""

BESIDE = 1e-6
"""Change of the logarithm of a zero's distance from 1 over which derivatives are quotients [-]."""

FARTHEST_STEP, MIN_STEP = 0.3, 1e-4
"""Largest step of such a logarithm, and the least that is tried where others are no better [-]."""

SOLVE_WORK = 3000.0
"""Work of a course beside its search: of its proof and its humps [units]."""

MET = 1e-9
"""Miss of the height and of the peak's place, over the height, at which it ends [-]."""

HUMP_POINTS = 33
"""Points between two zeros at which a hump is looked for."""

PEAK_STEPS = 4
"""Newton's steps to a peak from the highest of three neighbours."""


def solve_humps_behind_limits(problem: RampedHumpsProblem, budget: Budget) -> Iterator[Solution]:
    """Yield the shaper with humps behind limits.

    Of the courses with its zeros it is the fastest. No bound is said: with other zeros humps may
    be as high in less time.

    Parameters
    ----------
    problem
        The humps, and the limits.
    budget
        What the search may do.

    Yields
    ------
    Solution
        The shaper.

    Raises
    ------
    InfeasibleDesignError
        If the humps do not come to their height, or the shaper ends after the horizon.
    """
    found, _ = spread(problem, budget)
    require_humps_in_time(problem, found.course.end)
    yield solution_of(found, problem.natural_frequency_rad_s, "highs")


def require_humps_in_time(problem: RampedHumpsProblem, end_rad: float) -> None:
    """Check that the shaper ends within the horizon.

    Parameters
    ----------
    problem
        What was looked for.
    end_rad
        When it ends [rad].

    Raises
    ------
    InfeasibleDesignError
        If that is after the horizon.
    """
    if end_rad > problem.horizon_rad:
        raise InfeasibleDesignError(
            f"the course of the reference with the humps asked ends after "
            f"{end_rad / PERIOD_RAD:.6g} periods, later than max_duration_periods and "
            f"both ramps, {problem.horizon_rad / PERIOD_RAD:.6g} periods in all",
            code="ramped_humps_exceed_duration",
        )


def spread(
    problem: RampedHumpsProblem, budget: Budget
) -> tuple[RampedOptimum | JerkOptimum, tuple[float, float]]:
    """Return the fastest course whose humps have their height.

    Parameters
    ----------
    problem
        The humps, and the limits.
    budget
        What the search may do.

    Returns
    -------
    tuple of RampedOptimum or JerkOptimum, and two float
        Of the courses with its zeros the fastest, and the outer zeros' frequency ratios [-].

    Raises
    ------
    InfeasibleDesignError
        If the humps do not come to their height, or no course has such zeros.
    """
    refusal = _none_found(problem)
    places = np.log(np.abs(np.array(problem.zeros) - 1))
    found = _at(problem, places, None, budget)
    missed = _misses(problem, places, found.course)
    for _ in range(MAX_STEPS):
        if np.abs(missed).max() < MET:
            return found, _zeros(places)
        jacobian = np.empty((2, 2))
        for which in range(2):
            beside = places + BESIDE * np.eye(2)[which]
            course = _at(problem, beside, found, budget).course
            jacobian[:, which] = (_misses(problem, beside, course) - missed) / BESIDE
        step = least_squares(jacobian, -missed)
        if not np.isfinite(step).all():
            raise refusal
        step *= FARTHEST_STEP / max(float(np.abs(step).max()), FARTHEST_STEP)
        while True:
            following = _at(problem, places + step, found, budget)
            there = _misses(problem, places + step, following.course)
            if np.abs(there).sum() < np.abs(missed).sum():
                places, found, missed = places + step, following, there
                break
            if np.abs(step).max() < MIN_STEP:
                raise refusal
            step = step / 2
    raise refusal


def _none_found(problem: RampedHumpsProblem) -> InfeasibleDesignError:
    return InfeasibleDesignError(
        f"no course of the reference within the limits was found whose residual has "
        f"{'a hump' if problem.humps == 1 else 'two humps'} of {problem.tolerance:g}: "
        "num_si keeps a tolerance over a band of frequencies behind any limits",
        code="no_ramped_humps_found",
    )


def _at(
    problem: RampedHumpsProblem,
    places: FloatArray,
    near: RampedOptimum | JerkOptimum | None,
    budget: Budget,
) -> RampedOptimum | JerkOptimum:
    """Return the fastest course with zeros at some places."""
    below, above = _zeros(places)
    seeds = () if near is None else (near.course.switches,)
    ramped = problem.with_zeros(below, above, seeds)
    budget.spend(SOLVE_WORK)
    found: tuple[RampedOptimum | JerkOptimum, float] | None
    if ramped.jerk is None:
        found = next(proven_ramps(ramped, search.candidates(ramped, budget), budget), None)
    else:
        found = next(proven_jerk_ramps(ramped, ramped.jerk, budget), None)
    if found is None:
        raise InfeasibleDesignError(
            f"no course of the reference was found without residual at {below:.4g} and "
            f"{above:.4g} of the frequency: {budget.in_words}",
            code="no_ramped_zeros_found",
        )
    return found[0]


def _zeros(places: FloatArray) -> tuple[float, float]:
    """Return the zeros' frequency ratios from the logarithms of their distances from 1."""
    below, above = np.exp(places).tolist()
    return 1 - min(below, 0.99), 1 + above


def _misses(problem: RampedHumpsProblem, places: FloatArray, course: Movable) -> FloatArray:
    """Return by how much the humps miss height and place, shape (2,) [-]."""
    pole, tolerance = problem.unit_pole, problem.tolerance
    if problem.humps == 1:
        nominal = np.ones(1)
        height = float(residuals(course, pole, nominal)[0])
        slope = float(growths(course, pole, nominal)[0][0])
        return np.array([math.log(height / tolerance), slope])
    below, above = _zeros(places)
    heights = [_hump(course, pole, *between) for between in ((below, 1.0), (1.0, above))]
    return np.log(np.array(heights) / tolerance)


def _hump(course: Movable, unit_pole: complex, lower: float, upper: float) -> float:
    """Return the height of the hump between two zeros [-]."""
    ratios = np.linspace(lower, upper, HUMP_POINTS)
    highest = int(np.argmax(residuals(course, unit_pole, ratios)))
    peak = ratios[[min(max(highest, 1), HUMP_POINTS - 2)]]
    pitch = ratios[1] - ratios[0]
    for _ in range(PEAK_STEPS):
        slope, bend = growths(course, unit_pole, peak)
        if bend[0] < 0:
            peak = peak + np.clip(-slope / bend, -pitch, pitch)
    return float(residuals(course, unit_pole, peak)[0])
