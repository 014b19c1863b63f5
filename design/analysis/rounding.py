"""What rounding can make of a claim of zero: whether doubles hold it at all."""

import math

import numpy as np

from design.analysis.certificate import ORDERS, Certificate, Claim
from design.errors import InfeasibleDesignError
from design.model.impulses import Impulses
from design.model.plants.mode import Mode

ROUNDINGS = 4
"""Rounding of a claim in units of that of its last phase: twice; up to 1.02 was seen in
1,500 random pairs of modes [-]."""


def rounding_of(claim: Claim, impulses: Impulses, mode: Mode) -> float:
    """Return what rounding can make of a claim of zero [-].

    A phase is off by up to ``eps`` of it, as a time and once more in each step of the simulation:
    the derivative of order n of a vector then by some ``eps phase^(n + 1)``.

    Parameters
    ----------
    claim
        Of a residual or one of its derivatives.
    impulses, mode
        The shaper, and the mode that it is about.

    Returns
    -------
    float
        In the unit of the claim's value [-].
    """
    phase = mode.natural_frequency_rad_s * impulses.duration_s
    powers = phase ** (ORDERS[claim.quantity] + 1) * np.abs(impulses.amplitudes).sum()
    return float(ROUNDINGS * np.finfo(float).eps * powers)


def require_doubles_to_hold(
    impulses: Impulses, modes: tuple[Mode, ...], certificate: Certificate
) -> None:
    """Refuse a command of which all that does not hold can be rounding.

    Parameters
    ----------
    impulses
        The command.
    modes
        The modes of the plant, by the numbers that claims have.
    certificate
        Its claims, of which one or more do not hold.

    Raises
    ------
    InfeasibleDesignError
        If rounding alone may be what does not hold.
    """
    failing = [claim for claim in certificate.claims if not claim.holds]
    for claim in failing:
        if not claim.is_zero or claim.value > rounding_of(claim, impulses, modes[claim.mode]):
            return
    claim = failing[0]
    phase = modes[claim.mode].natural_frequency_rad_s * impulses.duration_s
    raise InfeasibleDesignError(
        f"the {claim.quantity.replace('_', ' ')} of mode {claim.mode} cannot be proven zero: the "
        f"command lasts {phase / math.tau:.4g} of that mode's periods, and the rounding of "
        f"double precision makes {claim.value:.3g} of it (limit {claim.limit:g}). Modes nearer "
        "to each other, or a kind that claims fewer derivatives, can be proven",
        code="rounding_above_claim",
    )
