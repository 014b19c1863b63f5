"""An absolute encoder on the motor of an axis."""

import math
from dataclasses import dataclass

import numpy as np

from design.checks import require_scale
from design.errors import InvalidInputError
from design.types import FloatArray, IntArray

PULSES_PER_REVOLUTION = 512
"""Of the mini-crane's encoders (Kim 2011, table 2-1)."""

TRAVEL_PER_REVOLUTION_M = 0.1
"""Travel of an axis in a turn of its motor; an assumption, the thesis does not say [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Encoder:
    """An absolute encoder: it counts whole pulses from the end of the stroke."""

    pulses_per_revolution: int = PULSES_PER_REVOLUTION  # > 0
    travel_per_revolution_m: float = TRAVEL_PER_REVOLUTION_M  # > 0 [m]

    def __post_init__(self) -> None:
        if self.pulses_per_revolution < 1:
            raise InvalidInputError(
                "pulses_per_revolution", self.pulses_per_revolution, "at least 1", code="no_pulses"
            )
        require_scale("travel_per_revolution_m", self.travel_per_revolution_m)

    @property
    def pulse_m(self) -> float:
        """Travel of one pulse [m]."""
        return self.travel_per_revolution_m / self.pulses_per_revolution

    def pulses(self, position_m: FloatArray) -> IntArray:
        """Return what the encoder counts at positions, shape (n,)."""
        counted: IntArray = np.floor(position_m / self.pulse_m).astype(np.intp)
        return counted

    def position_m(self, position_m: float) -> float:
        """Return the position that it reports: the middle of the pulse [m].

        It is off by half a pulse at most.
        """
        pulse_m = self.pulse_m
        return (math.floor(position_m / pulse_m) + 0.5) * pulse_m
