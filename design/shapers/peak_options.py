"""Parameters of shapers whose first pulse may be higher than the cruise speed."""

from dataclasses import dataclass, field

from design.checks import require_between
from design.shapers.settle_options import SettleOptions

MIN_PEAK = 0.01
MAX_PEAK = 100.0
"""Bounds of the peak command over the cruise speed: beyond them one of the two is nothing [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PeakOptions(SettleOptions):
    """Parameters of the shapers whose first pulse may be higher than the cruise speed."""

    # Height of that pulse over the cruise speed [-]
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
