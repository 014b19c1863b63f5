"""Solutions held against what is promised of them, until one keeps it."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from design.analysis.certificate import Certificate
from design.analysis.insensitivity import insensitivity
from design.analysis.judge import Judgement, judge, shortfall_of
from design.analysis.rounding import require_doubles_to_hold
from design.claims import Promise, zeros
from design.errors import InfeasibleDesignError, SolverFailedError
from design.formulations.formulation import Convolution, Formulation
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.ranges import promises_over, require_over
from design.shapers.kind import ShaperKind
from design.solvers.budget import Budget
from design.solvers.solution import Solution
from design.trace import TraceStep

BAND_MARGIN = 1e-6
"""Share by which a band is reported narrower than found: its ends are within the tolerance [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Certified:
    """A solution that keeps what is promised of it.

    Attributes
    ----------
    solution
        What a solver answered with.
    judgement
        Its certificate, and what it does with the actuator given.
    """

    solution: Solution
    judgement: Judgement


def certify(
    solutions: Iterator[Solution],
    formulation: Formulation,
    kind: ShaperKind,
    plant: Plant,
    actuator: Actuator,
    budget: Budget,
) -> Certified:
    """Return the first solution that keeps what is promised of it.

    Parameters
    ----------
    solutions
        Those of the formulation, the likeliest optimum first.
    formulation
        What they solve.
    kind
        The shaper's.
    plant
        What moves.
    actuator
        What drives it.
    budget
        That of the search, which notes what is rejected and why.

    Returns
    -------
    Certified
        The solution, held against its promises.

    Raises
    ------
    InfeasibleDesignError
        If there is no solution, or its times are too long for doubles to hold what it claims.
    SolverFailedError
        If there are solutions, and none keeps its promises.
    """
    modes = plant.modes
    promises = promises_of(formulation, kind, modes)
    if isinstance(plant, Scheduled):
        promises = promises_over(plant, promises)
    unverified: Certificate | None = None
    others = 0
    try:
        for solution in solutions:
            kept = [
                _with_its_band(one, solution, modes, formulation.designed_for) for one in promises
            ]
            if None in kept:
                others += 1
                _note(budget, solution, "it is above the tolerance between its own zeros")
                continue
            judgement = judge(
                solution.impulses,
                modes,
                actuator,
                tuple(promise for promise in kept if promise is not None),
                name=kind.name,
                designed_for=formulation.designed_for,
            )
            certificate = judgement.certificate
            _note(budget, solution, shortfall_of(certificate))
            if certificate.verified:
                return Certified(solution=solution, judgement=judgement)
            if isinstance(plant, Scheduled):
                require_over(plant, kind.name, certificate)
            require_doubles_to_hold(solution.impulses, modes, certificate)
            unverified = certificate
    except InfeasibleDesignError as error:
        if unverified is None and others:
            raise InfeasibleDesignError(
                f"{error}; solutions rejected, above the tolerance inside the band: {others}",
                code=error.code,
            ) from None
        if unverified is None:
            raise
    if unverified is None:
        raise SolverFailedError(
            f"no solution of {kind.name} was found; that there is none is not proven",
            code="none_found_nor_excluded",
        )
    raise SolverFailedError(
        f"no solution of {kind.name} was verified; of the last one {shortfall_of(unverified)}",
        code="none_verified",
    )


def _note(budget: Budget, solution: Solution, shortfall: str) -> None:
    """Note that a solution was verified, or why it was rejected."""
    budget.note(
        TraceStep(
            stage="certify",
            method="certificate",
            start=solution.solver.seed,
            outcome="rejected" if shortfall else "verified",
            duration_s=solution.impulses.duration_s,
            detail=shortfall,
        )
    )


def promises_of(
    formulation: Formulation, kind: ShaperKind, modes: tuple[Mode, ...]
) -> tuple[Promise, ...]:
    """Return what is promised of a formulation's solutions.

    A formulation's own claims come first; without any its kind's count, each at zero in each mode.

    Parameters
    ----------
    formulation
        What is solved.
    kind
        The shaper's.
    modes
        The modes of the plant.

    Returns
    -------
    tuple of Promise
        With the numbers of the modes.
    """
    if formulation.claims:
        return formulation.claims
    names = kind.claims
    if isinstance(formulation, Convolution):
        names = formulation.zeros_of_parts
    return tuple(
        replace(promise, mode=number) for number in range(len(modes)) for promise in zeros(names)
    )


def _with_its_band(
    promise: Promise, solution: Solution, modes: tuple[Mode, ...], actuator: Actuator
) -> Promise | None:
    """Return a promise with the widest band around 1 that the impulses keep, where it has none.

    None if they pass the tolerance between their own zeros: then they solve the equations, and have
    another curve than these are to find.
    """
    if promise.quantity != "band" or promise.band is not None:
        return promise
    found = insensitivity(solution.impulses, modes[promise.mode], actuator, promise.limit)
    if found is None:
        return None
    lower, upper = found.searched_from_ratio, found.searched_to_ratio
    if ((solution.ratios < lower) | (solution.ratios > upper)).any():
        return None
    half_width = found.half_width * (1 - BAND_MARGIN)
    return replace(promise, band=(1 - half_width, 1 + half_width))
