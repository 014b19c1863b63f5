"""A design brought to a sample grid: its certificate, and what is lost of its claims."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from design.analysis.certificate import Claim
from design.analysis.claims_found import claim_over_band, shortfall_of, zeros_of
from design.analysis.drive_warnings import drive_warnings
from design.analysis.judge import Judgement, judge
from design.analysis.residual import residual_vibration
from design.analysis.residuals_of_many import residual_curve
from design.analysis.warnings import DesignWarning
from design.claims import ZERO_LIMITS, Promise
from design.errors import InfeasibleDesignError, InvalidInputError, SolverFailedError
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import Design
from design.sampling.claims_on_samples import MIN_STEP
from design.sampling.left import Band
from design.sampling.own_edges import edges_lost, to_own_edges
from design.sampling.sampled import MAX_DURATION_PERIODS, MIN_SEARCHED_SAMPLES, Sampled, sample
from design.sampling.sampled_free import (
    has_free_amplitudes,
    require_two_a_period,
    sample_free,
)
from design.solvers.budget import Budget

SAMPLE_TOLERANCE = 0.01
"""What a shaper on samples may leave before impulses are added, where nothing else is said: a fifth
of the usual 5 % [-]."""

AGREEMENT = 1e-9
"""Relative difference of two routes to one residual that is rounding [-]."""

CHECKED_IN_BAND = 2001
"""Frequencies at which a formula looks at a band, ends included."""

LONGER = 1.1
"""Duration on samples over that between them from which on a warning reports it [-]."""

BAND_AGREEMENT = 1e-3
"""What a peak may be above the highest of those, over it [-].

From one to the next a shaper of three periods turns by .01 rad, and between them is a peak higher
by the square of that: the rest is room for longer ones.
"""


def sampled_design(
    continuous: Design,
    modes: Mode | tuple[Mode, ...],
    actuator: Actuator,
    sample_time_s: float,
    *,
    tolerance: float | None = None,
    claimed: float | None = None,
    max_duration_periods: float = MAX_DURATION_PERIODS,
    between_levels: bool = False,
    budget: Budget | None = None,
) -> tuple[Design, Sampled]:
    """Return a design brought to a sample grid, with a separate certificate.

    Free amplitudes keep what the shaper claims; those of unity magnitude take the best samples. The
    residual of a sampled shaper, at the nominal frequency and over the bands of the shaper's own
    claims, is computed by formula; the judge recomputes it by simulation, for the actuator of the
    shaper's own certificate. One that holds for an ideal actuator only does so on samples, and a
    warning has the figure with the one given. Another says where the residual is above what the
    shaper claims, or for one that claims zero, above the sample tolerance.

    Parameters
    ----------
    continuous
        The shaper between the samples.
    modes, actuator
        The plant's modes, or its only one, and the drive.
    sample_time_s
        Sample time, at most half a period, and bounded as in `sample` and `sample_free` [s].
    tolerance
        What unity magnitude may leave before impulses are added, 0 to 1 [-]; None adds none.
    claimed
        Residual from which on a warning reports it, of a shaper that claims zero; the tolerance if
        None [-].
    max_duration_periods
        Longest command that is searched then [undamped periods].
    between_levels
        Whether a command of level 0 or 1 may as well be between them, as of
        `may_be_between_levels`.
    budget
        The work of programs is counted in it.

    Returns
    -------
    Design
        The shaper on samples.
    Sampled
        How it came there, and what other ways leave.

    Raises
    ------
    InvalidInputError
        As `sample` and `sample_free` do, and for several modes of unity magnitude.
    InfeasibleDesignError
        If no free amplitudes keep what the shaper claims, or over a band no command on the samples
        has less than an unshaped step.
    SolverFailedError
        If simulation does not confirm the residual that the formula gives.
    """
    modes = (modes,) if isinstance(modes, Mode) else modes
    certified_for: Actuator = Ideal() if continuous.for_ideal else actuator
    require_two_a_period(continuous.impulses, modes, sample_time_s)
    kept = claim_over_band(continuous.certificate)
    # Behind limits steps between two levels have ramps that do not add.
    linear = not (between_levels and isinstance(certified_for, RateLimited))
    if has_free_amplitudes(continuous.impulses, between_levels=between_levels and linear):
        sampled = _sample_free(continuous, modes, actuator, sample_time_s, certified_for, budget)
        if isinstance(certified_for, RateLimited) and not _keeps_claims(
            sampled.impulses, modes, certified_for, continuous
        ):
            # Ramps of equal steps had kept them; those of steps that are shared do not.
            continuous, certified_for = replace(continuous, for_ideal=True), Ideal()
    else:
        require_one_mode(modes, sample_time_s)
        sampled = sample(
            continuous.impulses,
            modes[0],
            actuator,
            sample_time_s,
            zeros_of(continuous.certificate),
            tolerance=tolerance,
            band=None if kept is None else kept.band,
            band_tolerance=0.0 if kept is None else kept.limit,
            max_duration_periods=max_duration_periods,
        )
    asked = _found_by_formula(sampled.impulses, modes, certified_for, continuous)
    judged = judge(sampled.impulses, modes, certified_for, asked, name="the sampled shaper")
    if not judged.certificate.verified:
        raise SolverFailedError(
            f"the sampled shaper differs from its formula: {shortfall_of(judged.certificate)}",
            code="sampled_unlike_formula",
        )
    proven = replace(
        continuous,
        impulses=sampled.impulses,
        residuals=tuple(residual_vibration(sampled.impulses, mode, actuator) for mode in modes),
        certificate=judged.certificate,
        warnings=(
            *_ideal_actuator_warnings(continuous, sampled),
            *_sample_warnings(
                continuous, sampled, judged, tolerance if claimed is None else claimed
            ),
            *drive_warnings(sampled.impulses, modes, actuator),
            *_longer_on_samples(continuous, sampled),
            *edges_lost(
                continuous.certificate.claims,
                continuous.impulses,
                sampled.impulses,
                modes,
                certified_for,
            ),
        ),
    )
    return proven, sampled


def _keeps_claims(
    command: Impulses, modes: tuple[Mode, ...], actuator: Actuator, continuous: Design
) -> bool:
    """Return whether residuals that a shaper claims are kept on samples."""
    for claim in continuous.certificate.claims:
        ratios = np.linspace(*(claim.band or (1.0, 1.0)), CHECKED_IN_BAND if claim.band else 1)
        curve = residual_curve(command, modes[claim.mode], actuator, ratios)
        counts = claim.quantity in {"residual", "band"}
        if counts and curve.max() > claim.limit * (1 + BAND_AGREEMENT):
            return False
    return True


def _sample_free(
    continuous: Design,
    modes: tuple[Mode, ...],
    actuator: Actuator,
    sample_time_s: float,
    certified_for: Actuator,
    budget: Budget | None,
) -> Sampled:
    """Return a shaper of free amplitudes on samples, over its whole band where it has one.

    Where no samples keep all of it, they keep what the shaper claims.

    Raises
    ------
    InfeasibleDesignError
        If no amplitudes keep that either, or an impulse is below rounding.
    """
    _require_steps(continuous.impulses)
    claimed = [promise_of(claim) for claim in continuous.certificate.claims]
    whole = [to_own_edges(one, continuous.impulses, modes, certified_for) for one in claimed]

    def on_samples(promises: list[Promise]) -> Sampled:
        return sample_free(
            continuous.impulses,
            promises,
            modes,
            actuator,
            sample_time_s,
            designed_for=certified_for,
            budget=budget,
        )

    try:
        return on_samples(whole)
    except InfeasibleDesignError:
        if whole == claimed:
            raise
        return on_samples(claimed)


def _require_steps(shaper: Impulses) -> None:
    """Check that no impulse is smaller than what counts as a step on samples.

    Raises
    ------
    InfeasibleDesignError
        If one is.
    """
    shares = np.abs(shaper.amplitudes / shaper.amplitudes.sum())
    if shares.min() <= MIN_STEP:
        raise InfeasibleDesignError(
            f"an impulse of the shaper is {shares.min():.3g} of its sum, and on samples none below "
            f"{MIN_STEP:g} counts: take a shaper that claims less, or none at a damping like this",
            code="impulse_below_rounding",
        )


def promise_of(claim: Claim) -> Promise:
    """Return what a claim promised."""
    return Promise(quantity=claim.quantity, limit=claim.limit, mode=claim.mode, band=claim.band)


def require_one_mode(modes: tuple[Mode, ...], sample_time_s: float) -> None:
    """Check that unity magnitude is asked of one mode only.

    Parameters
    ----------
    modes, sample_time_s
        The plant's modes, and the sample time [s].

    Raises
    ------
    InvalidInputError
        If there are several.
    """
    if len(modes) > 1:
        raise InvalidInputError(
            "sample_time_s",
            sample_time_s,
            "left out for num_multi, for convolved unity magnitude, and for any of several modes "
            "behind limits, which have no amplitudes to solve for: multi_umzv without limits has, "
            "between 0 and 1, and so have multi_zv and convolved of positive shapers",
            code="samples_of_one_mode",
        )


def _found_by_formula(
    command: Impulses, modes: tuple[Mode, ...], actuator: Actuator, continuous: Design
) -> tuple[Promise, ...]:
    """Return the residuals that a formula finds, for the judge: nominal, and over the bands."""
    asked = []
    for number, mode in enumerate(modes):
        own = residual_vibration(command, mode, actuator)
        limit = own * (1 + AGREEMENT) + ZERO_LIMITS["residual"]
        asked.append(Promise(quantity="residual", limit=limit, mode=number))
    for claim in continuous.certificate.claims:
        if claim.band is not None:
            ratios = np.linspace(*claim.band, CHECKED_IN_BAND)
            curve = residual_curve(command, modes[claim.mode], actuator, ratios)
            limit = float(curve.max()) * (1 + BAND_AGREEMENT)
            asked.append(replace(promise_of(claim), limit=limit))
    return tuple(asked)


def _ideal_actuator_warnings(continuous: Design, sampled: Sampled) -> Iterator[DesignWarning]:
    """Yield what a shaper that is proven for an ideal actuator costs behind the one given."""
    if continuous.for_ideal:
        yield DesignWarning(
            code="actuator_ignored",
            detail="the shaper is made, and its claims are proven, for an actuator that follows "
            f"its command; with the one given the residual is {100 * sampled.residual:.4g} % on "
            f"samples, {100 * sampled.continuous_residual:.4g} % between them",
        )


def _sample_warnings(
    continuous: Design, sampled: Sampled, judged: Judgement, tolerance: float | None
) -> Iterator[DesignWarning]:
    """Yield what of the shaper's claims is lost on samples."""
    limits: dict[tuple[int, Band | None], float] = {
        (claim.mode, claim.band): claim.limit
        for claim in continuous.certificate.claims
        if claim.band is not None
    }
    for claim in judged.certificate.claims:
        limit = limits.get((claim.mode, claim.band))
        if limit is not None and claim.value > limit * (1 + BAND_AGREEMENT):
            yield DesignWarning(
                code="tolerance_not_kept",
                detail=f"on samples the residual over the band is up to {claim.value:.4g}, "
                f"more than the tolerance of {limit:g}: take a shorter sample time, or design "
                "for a smaller tolerance"
                f"{'' if continuous.for_ideal else _searched_in_words(sampled)}",
            )
    if limits:
        return
    claimed = [
        claim.limit
        for claim in claims_on_samples(continuous, tolerance)
        if claim.quantity == "residual"
    ]
    if claimed and judged.residual > max(claimed) * (1 + AGREEMENT):
        yield DesignWarning(
            code="tolerance_not_kept",
            detail=f"on samples the residual is {100 * judged.residual:.4g} % of an unshaped step, "
            f"more than {100 * max(claimed):.4g} %: take a shorter sample time"
            f"{_searched_in_words(sampled)}",
        )


def _searched_in_words(sampled: Sampled) -> str:
    """Return what is proven of other commands on the samples."""
    searched = sampled.searched
    if searched is None or searched.searched < MIN_SEARCHED_SAMPLES:
        return ""
    told = (
        f"; proven: no command of unity magnitude of up to {searched.searched} samples has less "
        f"than {100 * searched.bound:.4g} %"
    )
    return told if searched.complete else f"{told}, and longer ones were not all searched"


def claims_on_samples(continuous: Design, tolerance: float | None) -> tuple[Claim, ...]:
    """Return what a shaper claims on samples.

    A residual that is claimed to be zero is claimed to be within the sample tolerance.

    Parameters
    ----------
    continuous
        The shaper between the samples.
    tolerance
        The sample tolerance [-]; `SAMPLE_TOLERANCE` if None.

    Returns
    -------
    tuple of Claim
        In the order of the shaper's certificate.
    """
    for_zero = SAMPLE_TOLERANCE if tolerance is None else tolerance
    return tuple(
        replace(claim, limit=for_zero) if claim.is_zero and claim.quantity == "residual" else claim
        for claim in continuous.certificate.claims
    )


def _longer_on_samples(continuous: Design, sampled: Sampled) -> Iterator[DesignWarning]:
    """Yield that impulses were added, where they take longer."""
    before_s = continuous.impulses.duration_s
    if sampled.impulses.duration_s <= LONGER * before_s:
        return
    if sampled.method == "free_amplitudes":
        if sampled.impulses.duration_s > before_s + sampled.sample_time_s:
            yield DesignWarning(
                code="longer_on_samples",
                detail=f"what the shaper claims takes {sampled.impulses.duration_s:.4g} s on "
                f"samples, in place of {before_s:.4g} s between them: take a shorter sample time",
            )
    elif sampled.nearest_residual is not None and len(sampled.tried) > 1:
        own = sampled.tried[0]
        yield DesignWarning(
            code="longer_on_samples",
            detail=f"{sampled.impulses.times_s.size} impulses take "
            f"{sampled.impulses.duration_s:.4g} s on samples, in place of {before_s:.4g} "
            f"s between them; {own.impulses} impulses have a residual of "
            f"{own.compared:.4g} there: a sample_tolerance of that keeps the shaper short",
        )
