"""Parameters of shapers that several kinds share, and their bounds."""

from dataclasses import dataclass, field
from typing import ClassVar, Self

MIN_TOLERANCE, MAX_TOLERANCE = 1e-3, 0.5
"""Bounds of a tolerance: below, zeros do as well; above, hardly any shaper is needed [-]."""

USUAL_TOLERANCE = 0.05
"""Tolerance of the literature [-]."""


def tolerance_field(description: str) -> float:
    """Return the field of a tolerance, with default and bounds.

    The bounds are `MIN_TOLERANCE` and `MAX_TOLERANCE`.
    """
    return field(
        default=USUAL_TOLERANCE,
        metadata={
            "description": description,
            "ge": MIN_TOLERANCE,
            "le": MAX_TOLERANCE,
        },
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ShaperOptions:
    """Parameters of a kind of shaper: each kind has a separate record.

    Attributes
    ----------
    BAND_FIELDS
        Names of the fields that say over which band of frequencies a tolerance holds; none of
        kinds without a band.
    """

    BAND_FIELDS: ClassVar[tuple[str, ...]] = ()

    def with_band(self, half_width: float) -> Self:  # noqa: ARG002
        """Return these parameters with a band of a half width around 1.

        A kind without a band returns them as they are.

        Returns
        -------
        Self
            Parameters of the same kind.

        Raises
        ------
        InvalidInputError
            If the kind serves no band so narrow, or so wide.
        """
        return self


@dataclass(frozen=True, slots=True, kw_only=True)
class NoOptions(ShaperOptions):
    """A shaper without parameters."""
