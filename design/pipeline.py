"""One design from request to proof.

plant + actuator -> formulation -> seeds -> solver -> impulses -> certificate -> residual, warnings
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from design.actuators import SETTLED_SHARE, Actuator, unit_ramps_s
from design.analysis.certificate import Certificate, certify, zeros
from design.analysis.residual import require_workable, residual_vibration
from design.errors import InfeasibleDesignError, InvalidInputError, SolverFailedError
from design.fastest import fastest
from design.impulses import Impulses
from design.plants import Mode, Plant
from design.shapers.kind import ShaperKind
from design.shapers.problem import BandProblem, BandSearch, ClosedForm, Formulation
from design.solvers.exchange import BandCandidate, band_candidates
from design.solvers.search import Candidate, candidates

SLOW_ACTUATOR = 2.0
"""Corner frequency over the plant's below which the thesis advises against (eq. 3.41) [-]."""

SETTLED_MARGIN = 1e-6
"""A gap at its bound has settled: IPOPT relaxes bounds by 1e-8, times are rounded [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SolverReport:
    """How the impulses were found.

    Attributes
    ----------
    name
        ``ipopt``, ``clarabel``, ``closed_form``, or ``newton``: followed from a closed form.
    status
        How the run ended.
    iterations
        Iterations of the run that led to the design.
    seed
        Name of its start.
    starts
        Starts tried until then; cone programs of ``clarabel``.
    lower_bound_s
        No shaper of its class is as short: proven for all times; None where nothing is proven [s].
    gap
        How far the duration may be above the shortest, over itself; None likewise [-].
    """

    name: str
    status: str
    iterations: int
    seed: str
    starts: int
    lower_bound_s: float | None = None
    gap: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignWarning:
    """Something a user should know of a design that is right all the same."""

    code: str
    detail: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Design:
    """A verified shaper.

    Attributes
    ----------
    impulses
        The shaper.
    residual
        What it leaves with the actuator given, whatever it was designed for [-].
    certificate
        Its claims, recomputed for the actuator that it was designed for.
    solver
        How it was found.
    warnings
        What to know besides.
    """

    impulses: Impulses
    residual: float
    certificate: Certificate
    solver: SolverReport
    warnings: tuple[DesignWarning, ...]


def design(plant: Plant, actuator: Actuator, kind: ShaperKind, options: Any = None) -> Design:  # noqa: ANN401
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

    Returns
    -------
    Design
        The first candidate that the certificate verifies.

    Raises
    ------
    InvalidInputError
        If the shaper does not serve the actuator, or a value breaks its rule.
    InfeasibleDesignError
        If no such shaper was found; says how far was searched.
    SolverFailedError
        If the certificate verified none of the solutions found.

    Examples
    --------
    >>> from design.actuators import Ideal
    >>> from design.plants import Pendulum
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
    mode = plant.mode
    require_workable(mode, actuator)
    formulation = kind.formulate(mode, actuator, kind.options() if options is None else options)
    promises = formulation.claims or zeros(kind.claims)
    unverified: Certificate | None = None
    try:
        for impulses, report in solutions(formulation):
            certificate = certify(impulses, mode, formulation.designed_for, promises)
            if certificate.verified:
                return Design(
                    impulses=impulses,
                    residual=residual_vibration(impulses, mode, actuator),
                    certificate=certificate,
                    solver=report,
                    warnings=tuple(warnings_of(impulses, mode, actuator)),
                )
            unverified = certificate
    except InfeasibleDesignError:
        if unverified is None:
            raise
    raise SolverFailedError(
        f"no solution of {kind.name} was verified; of the last one {shortfall_of(unverified)}"
    )


def shortfall_of(certificate: Certificate | None) -> str:
    """Return what does not hold, in words."""
    claims = () if certificate is None else certificate.claims
    return ", ".join(
        f"the {claim.quantity} is {claim.value:.3g}, allowed {claim.limit:g}"
        for claim in claims
        if not claim.holds
    )


def solutions(formulation: Formulation) -> Iterator[tuple[Impulses, SolverReport]]:
    """Yield what solves a formulation, not yet verified; raises where no more is found."""
    if isinstance(formulation, ClosedForm):
        yield (
            formulation.impulses,
            SolverReport(
                name=formulation.method,
                status="solve_succeeded",
                iterations=0,
                seed="none",
                starts=0,
            ),
        )
        return
    if isinstance(formulation, BandProblem):
        yield from _band_solutions(formulation)
        return
    w = formulation.natural_frequency_rad_s
    found: Iterator[Candidate | BandCandidate] = (
        band_candidates(formulation)
        if isinstance(formulation, BandSearch)
        else candidates(formulation)
    )
    for candidate in found:
        phases = np.concatenate(([0.0], np.cumsum(candidate.gaps_rad)))
        yield (
            Impulses(times_s=phases / w, amplitudes=candidate.problem.amplitudes),
            SolverReport(
                name="ipopt",
                status="solve_succeeded",
                iterations=candidate.iterations,
                seed=candidate.seed,
                starts=candidate.starts,
            ),
        )


def _band_solutions(problem: BandProblem) -> Iterator[tuple[Impulses, SolverReport]]:
    w = problem.natural_frequency_rad_s
    for found in fastest(problem):
        yield (
            Impulses(times_s=found.times_rad / w, amplitudes=found.amplitudes),
            SolverReport(
                name="clarabel",
                status="solve_succeeded",
                iterations=found.iterations,
                seed="cone_program",
                starts=found.cone_programs,
                lower_bound_s=found.lower_bound_rad / w,
                gap=found.gap,
            ),
        )


def warnings_of(impulses: Impulses, mode: Mode, actuator: Actuator) -> Iterator[DesignWarning]:
    """Yield what to know of a command: switches that come too early, sets that are too slow."""
    gaps = impulses.times_s[1:] - impulses.times_s[:-1]
    ramps_s = dict(zip(("accel", "decel"), unit_ramps_s(actuator), strict=True))
    steps = zip(gaps.tolist(), impulses.accelerates.tolist(), strict=False)
    for number, (gap, rising) in enumerate(steps, start=1):
        name, lag = ("accel", actuator.accel_lag) if rising else ("decel", actuator.decel_lag)
        error = lag.step_error(max(gap - ramps_s[name], 0.0))
        if abs(error) > 1 - SETTLED_SHARE + SETTLED_MARGIN:
            yield DesignWarning(
                code="actuator_not_settled",
                detail=f"the {name} set has made {100 * (1 - error):.3g} % of switch {number} "
                f"when the next comes, {gap:.4g} s after it",
            )
    for name, corner in actuator.corner_frequencies_rad_s.items():
        if corner < SLOW_ACTUATOR * mode.natural_frequency_rad_s:
            yield DesignWarning(
                code="actuator_slow",
                detail=f"the {name} set's corner frequency, {corner:.4g} rad/s, is below twice the "
                f"plant's natural frequency, {mode.natural_frequency_rad_s:.4g} rad/s",
            )
