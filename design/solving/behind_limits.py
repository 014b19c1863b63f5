"""What solves each class of formulation behind limits to acceleration."""

from collections.abc import Callable, Iterator
from typing import Any

from design.formulations.ramped import RampedProblem
from design.formulations.ramped_band import RampedBandProblem
from design.formulations.ramped_humps import RampedHumpsProblem
from design.formulations.unequal_band import UnequalBandProblem
from design.formulations.unequal_humps import UnequalHumpsProblem
from design.formulations.unequal_ramps import UnequalRampsProblem
from design.solvers.budget import Budget
from design.solvers.solution import Solution
from design.solving.ramped_humps import solve_humps_behind_limits
from design.solving.ramps import solve_band_behind_limits, solve_behind_limits
from design.solving.unequal_humps import solve_humps_behind_two_lags
from design.solving.unequal_ramps import solve_band_behind_two_lags, solve_behind_two_lags

SOLVERS_BEHIND_LIMITS: dict[type, Callable[[Any, Budget], Iterator[Solution]]] = {
    RampedProblem: solve_behind_limits,
    RampedBandProblem: solve_band_behind_limits,
    RampedHumpsProblem: solve_humps_behind_limits,
    UnequalRampsProblem: solve_behind_two_lags,
    UnequalBandProblem: solve_band_behind_two_lags,
    UnequalHumpsProblem: solve_humps_behind_two_lags,
}
"""One more is one more row."""
