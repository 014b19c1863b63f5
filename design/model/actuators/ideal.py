"""An actuator that follows its command at once."""

from dataclasses import dataclass, field
from typing import ClassVar

from design.model.actuators.model import Model
from design.model.lags import Lag

IDEAL_LAG = Lag()


@dataclass(frozen=True, slots=True, kw_only=True)
class Ideal:
    """An actuator that follows its command at once."""

    kind: ClassVar[str] = "ideal"
    """Its ``kind`` on the wire."""

    PROOF_WORK: ClassVar[float] = 1.0
    """Work of proving an impulse at one frequency [units of `design.solvers.budget`]."""

    model: Model = field(default="superposed", init=False)
    dead_time_s: float = field(default=0.0, init=False)

    @property
    def in_words(self) -> tuple[str, str]:
        """Name and parameters for a picture, these on one or two lines."""
        return "ideal", "follows its command at once"

    @property
    def accel_lag(self) -> Lag:
        """Response to a step that increases the magnitude of the command."""
        return IDEAL_LAG

    @property
    def decel_lag(self) -> Lag:
        """Response to a step that decreases the magnitude of the command."""
        return IDEAL_LAG

    @property
    def corner_frequencies_rad_s(self) -> dict[str, float]:
        """Corner frequency of each set that has one [rad/s]."""
        return {}
