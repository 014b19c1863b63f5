"""What claims found, in words."""

from design.analysis.certificate import Certificate, Claim

IN_WORDS = {
    "residual": "the residual is {value}",
    "slope": "its slope over the frequency is {value} of a step",
    "second_derivative": "its second derivative is {value} of a step",
    "third_derivative": "its third derivative is {value} of a step",
    "band": "the residual is up to {value} from {low:.4g} to {high:.4g} of the frequency",
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
