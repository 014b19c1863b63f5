"""Parameters of shapers whose steps may have to settle, and whose first pulse may be higher."""

from dataclasses import dataclass, field

from design.checks import require_between
from design.shapers.options import ShaperOptions

MIN_HORIZON_PERIODS = 0.1
MAX_HORIZON_PERIODS = 100.0
"""Bounds of how long a shaper is searched, in undamped periods [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SettleOptions(ShaperOptions):
    """Parameters of the shapers whose steps may have to settle."""

    # Whether the actuator must reach 80 % of each step before the next
    settle: bool = field(
        default=False,
        metadata={
            "description": "Let the actuator reach 80 % of each step before the next switch."
        },
    )
    # Longest shaper searched, in undamped periods of the plant [-]
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
