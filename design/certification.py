"""Solutions held against what is promised of them, until one keeps it."""

from collections.abc import Iterator

from design.analysis.certificate import Certificate
from design.analysis.claims_found import raise_with_rejected, shortfall_of, unverified_error
from design.analysis.judge import Judgement, judge
from design.analysis.large_swing_certificate import judge_large_swing
from design.analysis.rounding import require_doubles_to_hold
from design.claims import ZERO_LIMITS, Promise
from design.errors import InfeasibleDesignError
from design.formulations.formulation import Convolution, Formulation
from design.formulations.large_swing import LargeSwingProblem
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.own_bands import with_own_band
from design.ranges import promises_over, require_over
from design.shapers.kind import ShaperKind
from design.solvers.budget import Budget
from design.solvers.search_steps import verdict_step
from design.solvers.solution import Solution


def certify(
    solutions: Iterator[Solution],
    formulation: Formulation,
    kind: ShaperKind,
    plant: Plant,
    actuator: Actuator,
    budget: Budget,
) -> tuple[Solution, Judgement]:
    """Return the first solution that keeps what is promised of it.

    Parameters
    ----------
    solutions, formulation, budget
        What solves the formulation, the likeliest optimum first; the budget of the search.
    kind, plant, actuator
        Kind of the shaper; what moves, and what drives it.

    Returns
    -------
    tuple of Solution and Judgement
        The solution, held against its promises.

    Raises
    ------
    InfeasibleDesignError
        If there is no solution, or its times are too long for doubles to hold what it claims.
    SolverFailedError
        If there are solutions, and none keeps its promises.
    """
    modes = plant.modes
    promises = _promises_of(formulation, kind, modes)
    if isinstance(plant, Scheduled):
        promises = promises_over(plant, promises)
    unverified: Certificate | None = None
    others = 0
    try:
        for solution in solutions:
            kept = [
                with_own_band(one, solution, modes, formulation.designed_for)
                if one.quantity == "band" and one.band is None
                else one
                for one in promises
            ]
            if None in kept:
                others += 1
                if budget.trace is not None:
                    shortfall = "it is above the tolerance between its own zeros"
                    budget.note(verdict_step(solution, shortfall))
                continue
            told = tuple(promise for promise in kept if promise is not None)
            judgement = (
                judge_large_swing(solution.impulses, formulation.swing, actuator, told)
                if isinstance(formulation, LargeSwingProblem)
                else judge(
                    solution.impulses, modes, actuator, told,
                    name=kind.name, designed_for=formulation.designed_for,
                )
            )  # fmt: skip
            certificate = judgement.certificate
            if budget.trace is not None:
                budget.note(verdict_step(solution, shortfall_of(certificate)))
            if certificate.verified:
                return solution, judgement
            if isinstance(plant, Scheduled):
                require_over(plant, kind.name, certificate)
            require_doubles_to_hold(solution.impulses, modes, certificate)
            unverified = certificate
    except InfeasibleDesignError as error:
        if unverified is None and others:
            raise_with_rejected(error, others)
        if unverified is None:
            raise
    refusal = unverified_error(kind.name, unverified)
    raise refusal


def _promises_of(
    formulation: Formulation, kind: ShaperKind, modes: tuple[Mode, ...]
) -> tuple[Promise, ...]:
    """Return what is promised of a formulation's solutions.

    A formulation's own claims come first; without any its kind's count, each at zero in each mode.
    """
    if formulation.claims:
        return formulation.claims
    names = kind.claims
    if isinstance(formulation, Convolution):
        names = formulation.zeros_of_parts
    return tuple(
        Promise(quantity=name, limit=ZERO_LIMITS[name], mode=number)
        for number in range(len(modes))
        for name in names
    )
