"""One design from request to proof.

plant + actuator -> formulation -> seeds -> solver -> impulses -> certificate -> residual, warnings
"""

import math
from dataclasses import dataclass, fields, replace
from typing import Any

from design.analysis.certificate import Certificate, certify, rounding_of
from design.analysis.insensitivity import insensitivity
from design.analysis.judge import DesignWarning, drive_warnings, judge, shortfall_of
from design.analysis.workable import require_workable
from design.claims import Promise, within, zeros
from design.errors import InfeasibleDesignError, InvalidInputError, SolverFailedError
from design.formulations.formulation import Convolution, Formulation
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.shapers.kind import ShaperKind
from design.solvers.budget import Budget
from design.solving.solve import Solution, SolverReport, solutions

BAND_MARGIN = 1e-6
"""Share by which a band is told narrower than found: its ends are within the tolerance [-]."""

BAND_OPTIONS = ("half_width", "lower_ratio", "upper_ratio")
"""Options that say which band a kind keeps."""


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


def design(
    plant: Plant,
    actuator: Actuator,
    kind: ShaperKind,
    options: Any = None,  # noqa: ANN401
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
    if actuator.kind not in kind.actuators:
        raise InvalidInputError(
            "actuator.kind",
            actuator.kind,
            f"one that {kind.name} serves: {', '.join(kind.actuators)}",
        )
    modes = plant.modes
    for mode in modes:
        require_workable(mode, actuator)
    options = kind.options() if options is None else options
    if isinstance(plant, Scheduled):
        options = _over_range(plant, options)
    formulation = kind.formulate(kind.case(modes, actuator, options))
    promises = promises_of(formulation, kind, modes)
    if isinstance(plant, Scheduled):
        promises = (*promises, *_promise_over_range(plant, promises))
    unverified: Certificate | None = None
    others = 0
    try:
        for solution in solutions(formulation, budget):
            impulses, designed_for = solution.impulses, formulation.designed_for
            told = [_with_its_band(one, solution, modes, designed_for) for one in promises]
            if None in told:
                others += 1
                continue
            asked = tuple(promise for promise in told if promise is not None)
            judged = judge(
                impulses, modes, actuator, asked, name=kind.name, designed_for=designed_for
            )
            certificate = judged.certificate
            if certificate.verified:
                return Design(
                    impulses=impulses,
                    residuals=judged.residuals,
                    certificate=certificate,
                    for_ideal=judged.for_ideal,
                    solver=solution.solver,
                    warnings=(*judged.warnings, *drive_warnings(impulses, modes, actuator)),
                    worst_in_range=_worst_in_range(impulses, plant, actuator),
                )
            if isinstance(plant, Scheduled):
                _require_over_range(kind, certificate)
            _require_doubles_to_hold(impulses, modes, certificate)
            unverified = certificate
    except InfeasibleDesignError as error:
        if unverified is None and others:
            raise InfeasibleDesignError(
                f"{error}; solutions rejected, above the tolerance inside the band: {others}"
            ) from None
        if unverified is None:
            raise
    if unverified is None:
        raise SolverFailedError(f"no solution of {kind.name} was found, and none was excluded")
    raise SolverFailedError(
        f"no solution of {kind.name} was verified; of the last one {shortfall_of(unverified)}"
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
        "to each other, or a kind that claims fewer derivatives, can be proved"
    )


def _over_range(plant: Scheduled, options: Any) -> Any:  # noqa: ANN401
    """Return the options with the plant's range as the band, of a kind that takes one."""
    if not hasattr(options, "half_width"):
        return options
    for option in fields(options):
        given = getattr(options, option.name)
        if option.name in BAND_OPTIONS and given != option.default:
            raise InvalidInputError(
                f"shaper.{option.name}",
                given,
                "left out for a scheduled plant, whose range of frequencies is the band",
            )
    try:
        return replace(options, half_width=plant.band[1] - 1)
    except InvalidInputError as error:
        raise InvalidInputError(
            "plant.to",
            f"{error.value:g} of it",
            f"such that the range's frequencies reach to either side of their middle {error.rule}",
        ) from None


def _promise_over_range(plant: Scheduled, promises: tuple[Promise, ...]) -> tuple[Promise, ...]:
    """Promise a kind's tolerance over the range; one without a band promises no more there."""
    limits = [promise.limit for promise in promises if promise.quantity == "band"]
    return tuple(within(limit, plant.band) for limit in sorted(limits)[-1:])


def _worst_in_range(impulses: Impulses, plant: Plant, actuator: Actuator) -> float | None:
    if not isinstance(plant, Scheduled):
        return None
    asked = within(math.inf, plant.band)
    return certify(impulses, plant.middle, actuator, (asked,)).claims[0].value


def _require_over_range(kind: ShaperKind, certificate: Certificate) -> None:
    """Raise InfeasibleDesignError if all that fails is the tolerance over the plant's range."""
    *own, over_range = certificate.claims
    if over_range.band is None or over_range.holds or not all(claim.holds for claim in own):
        return
    low, high = over_range.band
    raise InfeasibleDesignError(
        f"{kind.name} leaves {over_range.value:.4g} within the range of frequencies, {low:.4g} to "
        f"{high:.4g} of its middle, more than its tolerance {over_range.limit:g}: narrow the "
        "range, raise the tolerance, or take a kind with more humps"
    )


def promises_of(
    formulation: Formulation, kind: ShaperKind, modes: tuple[Mode, ...]
) -> tuple[Promise, ...]:
    """Return what a formulation says of each mode, and else what its kind does, each at zero."""
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
