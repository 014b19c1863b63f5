"""One design from request to proof: check, formulate, solve, certify, describe."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from design.analysis.certificate import Certificate, rounding_of
from design.analysis.insensitivity import insensitivity
from design.analysis.judge import (
    DesignWarning,
    Judgement,
    drive_warnings,
    judge,
    shortfall_of,
)
from design.analysis.workable import require_workable
from design.claims import Promise, zeros
from design.errors import InfeasibleDesignError, InvalidInputError, SolverFailedError
from design.formulations.formulation import Convolution, Formulation
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.ranges import options_over, promises_over, require_over, worst_over
from design.shapers.kind import DesignCase, KindOf, Options, ShaperKind
from design.solvers.budget import Budget
from design.solvers.solution import Solution, SolverReport
from design.solving.solve import solve
from design.trace import TraceStep

BAND_MARGIN = 1e-6
"""Share by which a band is reported narrower than found: its ends are within the tolerance [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Design:
    """A verified shaper.

    Attributes
    ----------
    impulses
        The shaper.
    residuals
        What it leaves in each mode with the actuator given, whatever it was designed for [-].
    certificate
        Its claims, recomputed: for the actuator given if they hold there.
    for_ideal
        Whether they are for an ideal actuator, as they do not all hold with the one given.
    solver
        How it was found.
    warnings
        What to know besides.
    worst_in_range
        Of a scheduled plant, the most that it leaves at any frequency of the range, with the
        actuator given; None of others [-].
    """

    impulses: Impulses
    residuals: tuple[float, ...]
    certificate: Certificate
    for_ideal: bool
    solver: SolverReport
    warnings: tuple[DesignWarning, ...]
    worst_in_range: float | None = None

    @property
    def residual(self) -> float:
        """The most that it leaves in any mode with the actuator given [-]."""
        return max(self.residuals)


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
    plant
        What moves.
    actuator
        What drives it.
    kind
        Entry of the registry.
    options
        Its parameters, an instance of ``kind.options``; its defaults if not given.
    budget
        What its search may do; that of one design if not given.

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

    Examples
    --------
    >>> from design.model.actuators.ideal import Ideal
    >>> from design.model.plants.pendulum import Pendulum
    >>> from design.shapers.registry import SHAPERS
    >>> crane = Pendulum(cable_length_m=0.8)
    >>> design(crane, Ideal(), SHAPERS["umzvd"]).certificate.verified
    True
    """
    budget = Budget() if budget is None else budget
    case = check(plant, actuator, kind, options)
    formulation = kind.formulate(case)
    solutions = solve(formulation, budget)
    certified = certify(solutions, formulation, kind, plant, actuator, budget)
    return describe(certified, plant, actuator)


def check(
    plant: Plant, actuator: Actuator, kind: KindOf[Options], options: Options | None
) -> DesignCase[Options]:
    """Return the case to formulate, if the kind serves it.

    Parameters
    ----------
    plant, actuator
        What moves, and what drives it.
    kind
        Kind of the shaper.
    options
        Its parameters; None for the kind's own.

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
        raise InvalidInputError(
            "actuator.kind",
            actuator.kind,
            f"one that {kind.name} serves: {', '.join(kind.actuators)}",
            code="actuator_not_served",
        )
    modes = plant.modes
    for mode in modes:
        require_workable(mode, actuator)
    case = kind.case(modes, actuator, options)
    return replace(case, options=options_over(plant, case.options))


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
    promises = promises_over(plant, promises_of(formulation, kind, modes))
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
            require_over(plant, kind.name, certificate)
            _require_doubles_to_hold(solution.impulses, modes, certificate)
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
            f"no solution of {kind.name} was found, and none was excluded",
            code="none_found_nor_excluded",
        )
    raise SolverFailedError(
        f"no solution of {kind.name} was verified; of the last one {shortfall_of(unverified)}",
        code="none_verified",
    )


def describe(certified: Certified, plant: Plant, actuator: Actuator) -> Design:
    """Return what is to be known of a certified solution.

    Parameters
    ----------
    certified
        The solution and what was found of it.
    plant, actuator
        What moves, and what drives it.

    Returns
    -------
    Design
        With warnings of the judge and of the drive.
    """
    impulses, judgement = certified.solution.impulses, certified.judgement
    return Design(
        impulses=impulses,
        residuals=judgement.residuals,
        certificate=judgement.certificate,
        for_ideal=judgement.for_ideal,
        solver=certified.solution.solver,
        warnings=(*judgement.warnings, *drive_warnings(impulses, plant.modes, actuator)),
        worst_in_range=worst_over(plant, impulses, actuator),
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


def _require_doubles_to_hold(
    impulses: Impulses, modes: tuple[Mode, ...], certificate: Certificate
) -> None:
    """Refuse a command of which all that does not hold can be rounding."""
    failing = [claim for claim in certificate.claims if not claim.holds]
    for claim in failing:
        if not claim.is_zero or claim.value > rounding_of(claim, impulses, modes[claim.mode]):
            return
    claim = failing[0]
    phase = modes[claim.mode].natural_frequency_rad_s * impulses.duration_s
    raise InfeasibleDesignError(
        f"the {claim.quantity.replace('_', ' ')} of mode {claim.mode} cannot be proved zero: the "
        f"command lasts {phase / math.tau:.4g} of that mode's periods, and the rounding of "
        f"double precision makes {claim.value:.3g} of it (limit {claim.limit:g}). Modes nearer "
        "to each other, or a kind that claims fewer derivatives, can be proved",
        code="rounding_above_claim",
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
