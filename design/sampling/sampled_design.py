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
from design.claims import ZERO_LIMITS, Promise, within
from design.errors import SolverFailedError
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.pipeline import Design
from design.sampling.sampled import MAX_DURATION_PERIODS, Sampled, sample

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
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    *,
    tolerance: float | None = None,
    max_duration_periods: float = MAX_DURATION_PERIODS,
) -> tuple[Design, Sampled]:
    """Return a design brought to a sample grid, with a separate certificate.

    The residual of a sampled shaper, at the nominal frequency and over the band of the shaper's own
    claim if it has one, is computed by formula; the judge recomputes it by simulation, for the
    actuator of the shaper's own certificate. One that holds for an ideal actuator only does so on
    samples, and a warning has the figure with the one given. Another says where the residual is
    above what the shaper claims, or for one that claims zero, above the sample tolerance.

    Parameters
    ----------
    continuous
        The shaper between the samples.
    mode, actuator
        The plant's mode and its drive.
    sample_time_s
        Sample time, bounded as in `sample` [s].
    tolerance
        What unity magnitude may leave before impulses are added, 0 to 1 [-]; None adds none.
    max_duration_periods
        Longest command that is searched then [undamped periods].

    Returns
    -------
    Design
        The shaper on samples.
    Sampled
        How it came there, and what other ways leave.

    Raises
    ------
    InvalidInputError
        As `sample` does.
    SolverFailedError
        If simulation does not confirm the residual that the formula gives.
    """
    kept = claim_over_band(continuous.certificate)
    sampled = sample(
        continuous.impulses,
        mode,
        actuator,
        sample_time_s,
        zeros_of(continuous.certificate),
        tolerance=tolerance,
        band=None if kept is None else kept.band,
        max_duration_periods=max_duration_periods,
    )
    certified_for: Actuator = Ideal() if continuous.for_ideal else actuator
    own = residual_vibration(sampled.impulses, mode, certified_for)
    asked: tuple[Promise, ...] = (
        Promise(quantity="residual", limit=own * (1 + AGREEMENT) + ZERO_LIMITS["residual"]),
    )
    if kept is not None and kept.band is not None:
        ratios = np.linspace(*kept.band, CHECKED_IN_BAND)
        largest = float(residual_curve(sampled.impulses, mode, certified_for, ratios).max())
        asked = (*asked, within(largest * (1 + BAND_AGREEMENT), kept.band))
    judged = judge(sampled.impulses, (mode,), certified_for, asked, name="the sampled shaper")
    if not judged.certificate.verified:
        raise SolverFailedError(
            f"the sampled shaper differs from its formula: {shortfall_of(judged.certificate)}",
            code="sampled_unlike_formula",
        )
    proven = replace(
        continuous,
        impulses=sampled.impulses,
        residuals=(sampled.residual,),
        certificate=judged.certificate,
        warnings=(
            *_ideal_actuator_warnings(continuous, sampled),
            *_sample_warnings(continuous, sampled, judged, tolerance),
            *drive_warnings(sampled.impulses, (mode,), actuator),
            *_longer_on_samples(continuous, sampled),
        ),
    )
    return proven, sampled


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
    kept, over_band = claim_over_band(continuous.certificate), claim_over_band(judged.certificate)
    if kept is not None and over_band is not None:
        if over_band.value > kept.limit * (1 + BAND_AGREEMENT):
            yield DesignWarning(
                code="tolerance_not_kept",
                detail=f"on samples the residual over the band is up to {over_band.value:.4g}, "
                f"more than the tolerance of {kept.limit:g}: take a shorter sample time, or design "
                "for a smaller tolerance",
            )
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
    if searched is None:
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
    if (
        sampled.nearest_residual is not None
        and len(sampled.tried) > 1
        and sampled.impulses.duration_s > LONGER * before_s
    ):
        own = sampled.tried[0]
        yield DesignWarning(
            code="longer_on_samples",
            detail=f"{sampled.impulses.times_s.size} impulses take "
            f"{sampled.impulses.duration_s:.4g} s on samples, in place of {before_s:.4g} "
            f"s between them; {own.impulses} impulses have a residual of "
            f"{own.compared:.4g} there: a sample_tolerance of that keeps the shaper short",
        )
