"""Parameters of shapers that several kinds share, and their bounds."""

from dataclasses import dataclass, field
from typing import ClassVar, Self

from design.types import require_between

MIN_HORIZON_PERIODS = 0.1
MAX_HORIZON_PERIODS = 100.0
"""Bounds of how long a shaper is searched, in undamped periods [-]."""

MIN_PEAK = 0.01
MAX_PEAK = 100.0
"""Bounds of the peak command over the cruise speed: beyond them one of the two is nothing [-]."""


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
class SettleOptions(ShaperOptions):
    """Parameters of the shapers whose steps may have to settle.

    Attributes
    ----------
    settle
        Whether the actuator must reach 80 % of each step before the next.
    max_duration_periods
        Longest shaper searched, in undamped periods of the plant [-].
    """

    settle: bool = field(
        default=False,
        metadata={
            "description": "Let the actuator reach 80 % of each step before the next switch."
        },
    )
    max_duration_periods: float = field(
        default=3.0,
        metadata={
            "description": "Longest shaper searched, in undamped periods of the plant.",
            "ge": MIN_HORIZON_PERIODS,
            "le": MAX_HORIZON_PERIODS,
        },
    )

    def __post_init__(self) -> None:
        require_between(
            "max_duration_periods",
            self.max_duration_periods,
            MIN_HORIZON_PERIODS,
            MAX_HORIZON_PERIODS,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class PeakOptions(SettleOptions):
    """Parameters of the shapers whose first pulse may be higher than the cruise speed.

    Attributes
    ----------
    max_velocity_ratio
        Height of that pulse over the cruise speed [-].
    """

    max_velocity_ratio: float = field(
        default=1.0,
        metadata={
            "description": "Peak of the command, over its cruise speed.",
            "ge": MIN_PEAK,
            "le": MAX_PEAK,
        },
    )

    def __post_init__(self) -> None:
        SettleOptions.__post_init__(self)
        require_between("max_velocity_ratio", self.max_velocity_ratio, MIN_PEAK, MAX_PEAK)


@dataclass(frozen=True, slots=True, kw_only=True)
class NoOptions(ShaperOptions):
    """A shaper without parameters."""
