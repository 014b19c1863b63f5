"""Which solver is for which class of formulation, by name: its module is imported at first use."""

from collections.abc import Callable, Iterator
from functools import cache
from importlib import import_module
from typing import Any

from design.formulations.bands import BandProblem, BandSearch
from design.formulations.equations import GapProblem
from design.formulations.formulation import ClosedForm, Convolution, JointProblem
from design.formulations.large_swing import LargeSwingProblem
from design.formulations.ramped import RampedProblem
from design.formulations.ramped_band import RampedBandProblem
from design.formulations.ramped_humps import RampedHumpsProblem
from design.formulations.steps_for_modes import StepsProblem
from design.formulations.unequal_band import UnequalBandProblem
from design.formulations.unequal_humps import UnequalHumpsProblem
from design.formulations.unequal_ramps import UnequalRampsProblem
from design.solvers.budget import Budget
from design.solvers.solution import Solution

SOLVERS: dict[type, str] = {
    ClosedForm: "design.solving.closed_form:solve_closed_form",
    GapProblem: "design.solvers.search:candidates",
    BandSearch: "design.solvers.unity_band.search:solve",
    BandProblem: "design.solving.optima:solve_over_band",
    JointProblem: "design.solving.optima:solve_jointly",
    StepsProblem: "design.solvers.steps_for_modes:solve_steps",
    LargeSwingProblem: "design.solving.large_swing:solve_large_swing",
    RampedProblem: "design.solving.ramps:solve_behind_limits",
    RampedBandProblem: "design.solving.ramps:solve_band_behind_limits",
    RampedHumpsProblem: "design.solving.ramped_humps:solve_humps_behind_limits",
    UnequalRampsProblem: "design.solving.unequal_ramps:solve_behind_two_lags",
    UnequalBandProblem: "design.solving.unequal_ramps:solve_band_behind_two_lags",
    UnequalHumpsProblem: "design.solving.unequal_humps:solve_humps_behind_two_lags",
    Convolution: "design.solving.convolution:solve_convolution",
}
"""What solves each class of formulation: one more solver is one more row."""


@cache
def solver_of(formulation: type) -> Callable[[Any, Budget], Iterator[Solution]]:
    """Return the solver of a class of formulations.

    Parameters
    ----------
    formulation
        The class.

    Returns
    -------
    Callable
        From a formulation and what the search may do to solutions, the likeliest optimum first.
    """
    module, _, name = SOLVERS[formulation].partition(":")
    solver: Callable[[Any, Budget], Iterator[Solution]] = getattr(import_module(module), name)
    return solver
