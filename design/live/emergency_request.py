"""What an emergency stop is asked for: apart, so that the wire knows it without any solver."""

import math
from dataclasses import dataclass

from design.checks import require_between

MIN_PERIODS, MAX_PERIODS = 0.05, 8.0
"""Periods of the slowest mode within which a stop may be asked for: beyond, little is gained."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EmergencyRequest:
    """What an emergency stop may leave, and until when.

    Attributes
    ----------
    swing_left
        Largest swing that may be left in any mode, over that of an unshaped step, 0 to less than 1
        [-].
    within_periods
        Periods of the slowest mode after which no more than that swings, and the command is 0 [-].
    """

    swing_left: float = 0.0
    within_periods: float = 1.0

    def __post_init__(self) -> None:
        require_between("within_periods", self.within_periods, MIN_PERIODS, MAX_PERIODS)
        require_between("swing_left", self.swing_left, 0.0, math.nextafter(1.0, 0.0))
