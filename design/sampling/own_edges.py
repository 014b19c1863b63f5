"""The band in which a shaper is insensitive, and what of it is lost on samples.

Between samples a shaper of humps claims its tolerance from its first zero to its last; its curve
stays within it some way beyond. On samples the claim alone would be kept by a shorter shaper that
loses that part.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from design.analysis.certificate import Claim
from design.analysis.insensitivity import Insensitivity, insensitivity
from design.analysis.residuals_of_many import residual_curve
from design.analysis.sensitivity import SensitivityRange
from design.analysis.warnings import DesignWarning
from design.claims import Promise
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode

NARROWER = 0.9
"""Distance of an edge from 1 on samples, over that between them, that a warning reports [-]."""

USUAL_TOLERANCE = SensitivityRange().tolerance
"""Residual of the band of a shaper that claims zeros [-]."""

ZERO = 1e-6
"""Residual at the end of a band that is a zero of the curve, and its rounding [-]."""


def to_own_edges(
    promise: Promise, impulses: Impulses, modes: tuple[Mode, ...], actuator: Actuator
) -> Promise:
    """Return a promise over all of the band that a shaper keeps.

    Parameters
    ----------
    promise
        Any; one over a band that ends at zeros of the curve is widened.
    impulses, modes, actuator
        The shaper between samples, the modes of the plant, and the drive it is designed for.

    Returns
    -------
    Promise
        Of the same tolerance.
    """
    if promise.band is None or not _has_zeros_at(
        promise.band, impulses, modes[promise.mode], actuator
    ):
        return promise
    found = insensitivity(impulses, modes[promise.mode], actuator, promise.limit)
    if found is None or found.lower_ratio is None or found.upper_ratio is None:
        return promise
    return replace(promise, band=(found.lower_ratio, found.upper_ratio))


def edges_lost(
    claims: tuple[Claim, ...],
    before: Impulses,
    after: Impulses,
    modes: tuple[Mode, ...],
    actuator: Actuator,
) -> Iterator[DesignWarning]:
    """Yield what is lost of the insensitive band on samples.

    It is the band within the tolerance of a shaper of humps, and within 5 % of one that claims
    zeros. One that was asked for a band keeps that by its claim.

    Parameters
    ----------
    claims
        Of the shaper between samples.
    before, after
        The shaper between samples, and on them.
    modes, actuator
        The modes of the plant, and the drive the shaper is designed for.

    Yields
    ------
    DesignWarning
        Both bands, where an edge has come nearer to 1 by more than a tenth of its distance.
    """
    for number, mode in enumerate(modes):
        tolerance = _tolerance(claims, number, before, mode, actuator)
        if tolerance is None:
            continue
        there = insensitivity(before, mode, actuator, tolerance)
        here = insensitivity(after, mode, actuator, tolerance)
        if there is None or here is None or not _is_narrower(here, there):
            continue
        where = f" in mode {number}" if len(modes) > 1 else ""
        yield DesignWarning(
            code="narrower_on_samples",
            detail=f"on samples the residual{where} is within {100 * tolerance:.4g} % from "
            f"{here.searched_from_ratio:.4g} to {here.searched_to_ratio:.4g} of the frequency, "
            f"between them from {there.searched_from_ratio:.4g} to {there.searched_to_ratio:.4g}: "
            "take a shorter sample time",
        )


def _tolerance(
    claims: tuple[Claim, ...], number: int, before: Impulses, mode: Mode, actuator: Actuator
) -> float | None:
    """Return the tolerance of the band in a mode; None where the claim itself is over it all."""
    over_band = [one for one in claims if one.mode == number and one.band is not None]
    for claim in over_band:
        if claim.band is not None and _has_zeros_at(claim.band, before, mode, actuator):
            return claim.limit
    return None if over_band else USUAL_TOLERANCE


def _is_narrower(here: Insensitivity, there: Insensitivity) -> bool:
    return 1 - here.searched_from_ratio < NARROWER * (
        1 - there.searched_from_ratio
    ) or here.searched_to_ratio - 1 < NARROWER * (there.searched_to_ratio - 1)


def _has_zeros_at(
    band: tuple[float, float], impulses: Impulses, mode: Mode, actuator: Actuator
) -> bool:
    """Return whether the curve is zero at both ends of a band."""
    return bool((residual_curve(impulses, mode, actuator, np.array(band)) < ZERO).all())
