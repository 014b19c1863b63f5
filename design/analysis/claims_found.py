"""What the claims of a certificate found: in words, which are zeros, which is over a band."""

from typing import NoReturn

from design.analysis.certificate import Certificate, Claim
from design.claims import Quantity
from design.errors import InfeasibleDesignError, SolverFailedError

IN_WORDS = {
    "residual": "the residual is {value}",
    "slope": "its slope over the frequency is {value} of a step",
    "second_derivative": "its second derivative is {value} of a step",
    "third_derivative": "its third derivative is {value} of a step",
    "band": "the residual is up to {value} from {low:.4g} to {high:.4g} of the frequency",
    "deflection": "the deflection reaches {value} of a step",
}
"""What a claim found, by its quantity."""


def claims_in_words(claims: list[Claim], modes: int) -> str:
    """Return what claims found, each with its figure and its limit.

    Parameters
    ----------
    claims
        One or more.
    modes
        How many modes the plant has: of several, each claim says which it is about, from 0.

    Returns
    -------
    str
        Shares in per cent, derivatives as they are; parted by commas.
    """
    return ", ".join(_in_words(claim, modes) for claim in claims)


def _in_words(claim: Claim, modes: int) -> str:
    low, high = claim.band or (1.0, 1.0)
    shares = claim.quantity in {"residual", "band"}
    value = f"{100 * claim.value:.4g} %" if shares else f"{claim.value:.3g}"
    found = IN_WORDS[claim.quantity].format(value=value, low=low, high=high)
    if modes > 1:
        found += f" in mode {claim.mode}"
    return found + ("" if claim.is_zero else f", above {100 * claim.limit:.4g} %")


def shortfall_of(certificate: Certificate | None) -> str:
    """Return what does not hold, in words."""
    claims = () if certificate is None else certificate.claims
    return ", ".join(
        f"the {claim.quantity} is {claim.value:.3g}, allowed {claim.limit:g}"
        for claim in claims
        if not claim.holds
    )


def unverified_error(name: str, certificate: Certificate | None) -> SolverFailedError:
    """Return the error of a kind of shaper that has no verified solution.

    Parameters
    ----------
    name, certificate
        Name of the kind, and the certificate of its last solution; None where it has no solution.

    Returns
    -------
    SolverFailedError
        To be raised.
    """
    if certificate is None:
        return SolverFailedError(
            f"no solution of {name} was found; that there is none is not proven",
            code="none_found_nor_excluded",
        )
    return SolverFailedError(
        f"no solution of {name} was verified; of the last one {shortfall_of(certificate)}",
        code="none_verified",
    )


def raise_with_rejected(error: InfeasibleDesignError, rejected: int) -> NoReturn:
    """Raise an error that says how many solutions of a band were rejected.

    Parameters
    ----------
    error, rejected
        What the search ended with, and the number of solutions above the tolerance.

    Raises
    ------
    InfeasibleDesignError
        Always, of the same code.
    """
    raise InfeasibleDesignError(
        f"{error}; solutions rejected, above the tolerance inside the band: {rejected}",
        code=error.code,
    ) from None


def zeros_of(certificate: Certificate) -> tuple[Quantity, ...]:
    """Return what is claimed to be nothing."""
    return tuple(claim.quantity for claim in certificate.claims if claim.is_zero)


def claim_over_band(certificate: Certificate) -> Claim | None:
    """Return what is claimed over a band of frequencies, if anything is."""
    return next((claim for claim in certificate.claims if claim.band is not None), None)
