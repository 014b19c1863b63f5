"""One design from request to proof: check, formulate, solve, certify, describe."""

from dataclasses import dataclass, replace

from design.analysis.certificate import Certificate
from design.analysis.drive_warnings import drive_warnings
from design.analysis.judge import Judgement
from design.analysis.warnings import DesignWarning
from design.analysis.workable import require_workable
from design.certification import certify
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.large_swing import SwingFigures
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.ranges import options_over, worst_over
from design.shapers.kind import DesignCase, KindOf, Options
from design.shapers.refusals import refuse_actuator
from design.solvers.budget import Budget
from design.solvers.solution import Solution, SolverReport
from design.solving.solve import solve


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Design:
    """A verified shaper."""

    impulses: Impulses  # The shaper
    residuals: tuple[float, ...]  # In each mode with the actuator given, whatever it is for [-]
    certificate: Certificate  # Its claims, recomputed: for the actuator given if they hold there
    for_ideal: bool  # Whether it is for an ideal one, as not all hold with the one given
    solver: SolverReport  # How it was found
    warnings: tuple[DesignWarning, ...]  # What to know besides
    # Largest residual in the range of a scheduled plant with the actuator given; else None [-]
    worst_in_range: float | None = None
    large_swing: SwingFigures | None = None  # Of claims and residual of the nonlinear crane

    @property
    def residual(self) -> float:
        """Its largest residual in any mode with the actuator given [-]."""
        return max(self.residuals)


def design(
    plant: Plant,
    actuator: Actuator,
    kind: KindOf[Options],
    options: Options | None = None,
    budget: Budget | None = None,
) -> Design:
    """Design a shaper and prove it.

    Parameters
    ----------
    plant, actuator
        What moves, and what drives it.
    kind, options, budget
        Entry of the registry; its parameters; what its search may do: the usual ones if not given.

    Returns
    -------
    Design
        The first candidate that the certificate verifies.

    Raises
    ------
    InvalidInputError
        If the shaper does not serve the actuator, or a value breaks its rule.
    InfeasibleDesignError
        If no such shaper was found, saying how far was searched, or its times are too long for
        doubles to hold what it claims.
    SolverFailedError
        If the certificate verified none of the solutions found.
    """
    budget = Budget() if budget is None else budget
    case = check(plant, actuator, kind, options)
    formulation = kind.formulate(case)
    solutions = solve(formulation, budget)
    solution, judgement = certify(solutions, formulation, kind, plant, actuator, budget)
    return describe(solution, judgement, plant, actuator)


def check(
    plant: Plant, actuator: Actuator, kind: KindOf[Options], options: Options | None
) -> DesignCase[Options]:
    """Return the case to formulate, if the kind serves it.

    Parameters
    ----------
    plant, actuator, kind, options
        As of `design`.

    Returns
    -------
    DesignCase
        Modes, actuator and options, with the plant's range as band.

    Raises
    ------
    InvalidInputError
        If the kind does not serve the actuator, the drive's resonance is the plant's, or an option
        does not go with the plant.
    """
    if actuator.kind not in kind.actuators:
        refuse_actuator(kind, actuator)
    for mode in plant.modes:
        require_workable(mode, actuator)
    case = replace(kind.case(plant.modes, actuator, options), plant=plant)
    if isinstance(plant, Scheduled):
        return replace(case, options=options_over(plant, case.options))
    return case


def describe(solution: Solution, judgement: Judgement, plant: Plant, actuator: Actuator) -> Design:
    """Return what is to be known of a certified solution.

    Parameters
    ----------
    solution, judgement, plant, actuator
        The solution and what was found of it; what moves, and what drives it.

    Returns
    -------
    Design
        With warnings of the judge and of the drive.
    """
    return Design(
        impulses=solution.impulses,
        residuals=judgement.residuals,
        certificate=judgement.certificate,
        for_ideal=judgement.for_ideal,
        solver=solution.solver,
        warnings=(*judgement.warnings, *drive_warnings(solution.impulses, plant.modes, actuator)),
        worst_in_range=worst_over(plant, solution.impulses, actuator)
        if isinstance(plant, Scheduled)
        else None,
        large_swing=judgement.large_swing,
    )
