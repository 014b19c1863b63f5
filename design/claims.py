"""What can be promised of a shaper, and what of it counts as zero."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

Quantity = Literal[
    "residual", "slope", "second_derivative", "third_derivative", "band", "deflection"
]
"""What a shaper may claim to keep small.

Its residual vibration; derivatives of its vector V, ``|d^k V / d(ln w)^k|`` with z fixed, over the
unshaped step; the largest residual over a band of frequencies; the largest deflection on the way.
"""


ZERO_LIMITS: dict[Quantity, float] = {
    "residual": 1e-9,
    "slope": 1e-7,
    "second_derivative": 1e-6,
    "third_derivative": 1e-5,
}
"""Largest value that counts as zero: far below anything measurable, above rounding [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Promise:
    """One thing that the impulses of a shaper keep."""

    quantity: Quantity  # What is kept small
    limit: float  # It holds if the value is at most this: nearly zero, or a tolerance [-]
    mode: int = 0  # Number of the plant's mode that it is about, from 0
    # Ends of the band as ratios of the mode's frequency, lower first [-]; for ``band`` only, where
    # None asks for the widest band around 1 that the impulses themselves keep
    band: tuple[float, float] | None = None


def within(tolerance: float, band: tuple[float, float] | None) -> Promise:
    """Return the promise of a tolerance over a band.

    Parameters
    ----------
    tolerance, band
        Largest residual over the band, and its ends, as of `Promise` [-].

    Returns
    -------
    Promise
        Of the plant's first mode.
    """
    return Promise(quantity="band", limit=tolerance, band=band)


def zeros(quantities: Iterable[Quantity]) -> tuple[Promise, ...]:
    """Return the promises that each of the quantities is zero."""
    return tuple(Promise(quantity=name, limit=ZERO_LIMITS[name]) for name in quantities)
