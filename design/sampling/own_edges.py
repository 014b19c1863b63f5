"""The band that a shaper of humps really keeps, and what of it is lost on samples.

Between samples such a shaper claims its tolerance from its first zero to its last; its curve stays
within it some way beyond. On samples the claim alone would be kept by a shorter shaper that loses
that part.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from design.analysis.certificate import Claim
from design.analysis.insensitivity import insensitivity
from design.analysis.residuals_of_many import residual_curve
from design.analysis.warnings import DesignWarning
from design.claims import Promise
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode

NARROWER = 0.95
"""Distance of an edge from 1 on samples, over that between them, that a warning reports [-]."""

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
    """Yield what of the band of a shaper of humps is lost on samples.

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
        Both bands, where an edge has come nearer by more than 5 % of its distance.
    """
    for claim in claims:
        promise = Promise(
            quantity=claim.quantity, limit=claim.limit, mode=claim.mode, band=claim.band
        )
        wide = to_own_edges(promise, before, modes, actuator)
        if wide == promise or wide.band is None:
            continue
        found = insensitivity(after, modes[claim.mode], actuator, claim.limit)
        if found is None:
            continue
        kept = (found.searched_from_ratio, found.searched_to_ratio)
        if 1 - kept[0] < NARROWER * (1 - wide.band[0]) or kept[1] - 1 < NARROWER * (
            wide.band[1] - 1
        ):
            yield DesignWarning(
                code="narrower_on_samples",
                detail=f"on samples the residual is within {100 * claim.limit:.4g} % from "
                f"{kept[0]:.4g} to {kept[1]:.4g} of the frequency, between them from "
                f"{wide.band[0]:.4g} to {wide.band[1]:.4g}: take a shorter sample time",
            )


def _has_zeros_at(
    band: tuple[float, float], impulses: Impulses, mode: Mode, actuator: Actuator
) -> bool:
    """Return whether the curve is zero at both ends of a band."""
    return bool((residual_curve(impulses, mode, actuator, np.array(band)) < ZERO).all())
