"""Wire form of certificates: what a shaper claims, recomputed."""

from typing import Annotated, Literal, Self

from pydantic import Field, Strict

from design.analysis.certificate import Certificate, Claim
from schemas.base import Wire, leave_out_none


class ClaimOut(Wire):
    """One promise of the shaper, recomputed."""

    quantity: Annotated[str, Field(description="Name, such as residual, slope or band.")]
    value: Annotated[float, Field(description="Its value, recomputed.")]
    limit: Annotated[float, Field(description="Largest value that keeps the promise.")]
    mode: Annotated[
        int | None,
        leave_out_none("Number of the plant's mode, from 0; left out for the first mode."),
    ]
    band: Annotated[
        Annotated[tuple[float, float], Strict(strict=False)] | None,
        leave_out_none(
            "For band: its ends, as ratios of the mode's frequency; otherwise left out."
        ),
    ]

    @classmethod
    def from_design(cls, claim: Claim) -> Self:
        """Wrap the design record."""
        return cls.model_construct(
            quantity=claim.quantity,
            value=claim.value,
            limit=claim.limit,
            mode=claim.mode or None,
            band=claim.band,
        )


class CertificateOut(Wire):
    """What the shaper claims, recomputed by a route without its solver."""

    verified: Annotated[bool, Field(description="Whether every claim holds.")]
    method: Annotated[str, Field(description="How the claims were recomputed.")]
    actuator: Annotated[
        Literal["given", "ideal"],
        Field(
            description="Actuator for which the claims hold: the one given, or one that follows "
            "its command at once."
        ),
    ]
    claims: Annotated[list[ClaimOut], Field(description="Promises of the shaper, each recomputed.")]

    @classmethod
    def from_design(cls, certificate: Certificate, *, given: bool) -> Self:
        """Wrap the design record.

        Parameters
        ----------
        certificate, given
            The claims, recomputed, and whether for the actuator given; else for an ideal one.

        Returns
        -------
        Self
            All claims in their order.
        """
        return cls.model_construct(
            verified=certificate.verified,
            method=certificate.method,
            actuator="given" if given else "ideal",
            claims=[ClaimOut.from_design(claim) for claim in certificate.claims],
        )
