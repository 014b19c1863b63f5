"""The command over a band that ends first behind limits and two lags, from that behind one lag."""

from functools import partial

import numpy as np

from design.formulations.unequal_band import UnequalBandProblem
from design.solvers.budget import Budget
from design.solvers.ramps.unequal_band_program import STEP_WORK, solve_band_program
from design.solvers.ramps.unequal_course import TwoLags
from design.solvers.ramps.unequal_peaks import BandOfTwoLags
from design.solvers.ramps.unequal_search import Stage, UnequalOptimum, fastest_by_stages, led
from design.types import FloatArray

NEAR = 1.003
"""End, over that behind one lag, up to which a command is the likeliest: most are nearer [-]."""


def fastest_over_band(
    problem: UnequalBandProblem, switches: FloatArray, budget: Budget
) -> UnequalOptimum | None:
    """Return the command that ends first, from the one behind one lag.

    Parameters
    ----------
    problem
        The band, the limits and the lags.
    switches
        The switches behind one lag, ascending from 0, shape (n,) [rad].
    budget
        What the search may do.

    Returns
    -------
    UnequalOptimum or None
        None where no command was found that keeps the tolerance.
    """
    alike = problem.alike
    if switches.size == 1:  # a ramp alone is answered by one lag
        course = TwoLags(problem.at(np.ones(1), np.zeros(1))).of(switches)
        return UnequalOptimum(course=course, iterations=0, programs=0)

    def stage(share: float) -> Stage:
        band = BandOfTwoLags(
            lambda ratios, orders: TwoLags(led(problem.at(ratios, orders), share)),
            alike.unit_pole,
            alike.band,
        )
        solve = partial(solve_band_program, band, tolerance=alike.tolerance)
        return Stage(
            lags=band.lags(np.ones(1)), solve=solve, method="clarabel", iteration_work=STEP_WORK
        )

    return fastest_by_stages(stage, switches, alike.natural_frequency_rad_s, budget, near=NEAR)
