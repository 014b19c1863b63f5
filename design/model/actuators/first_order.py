"""A first-order lag whose acceleration and deceleration may differ."""

from dataclasses import dataclass
from typing import ClassVar

from design.checks import MAX_VALUE, MIN_VALUE, require_between
from design.errors import InvalidInputError
from design.model.actuators.model import Model
from design.model.lags import Lag


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstOrder:
    """First-order lag with a time constant for either direction (Kim 2011, 3.5-3.13)."""

    kind: ClassVar[str] = "first_order"
    """Its ``kind`` on the wire."""

    PROOF_WORK: ClassVar[float] = 3.5
    """Work of proving an impulse at one frequency [units of `design.solvers.budget`]."""

    # Time constants, >= 0 [s]; 0 is a set that follows at once
    accel_time_constant_s: float
    decel_time_constant_s: float
    model: Model = "superposed"  # How the two sets share the actuator
    # Delay of all that it does, >= 0 [s]; it shifts the response and changes no residual
    dead_time_s: float = 0.0

    def __post_init__(self) -> None:
        for name in ("accel_time_constant_s", "decel_time_constant_s"):
            value = getattr(self, name)
            if not (value == 0 or MIN_VALUE <= value <= MAX_VALUE):
                raise InvalidInputError(
                    name,
                    value,
                    f"0, or between {MIN_VALUE:g} and {MAX_VALUE:g}",
                    code="out_of_range",
                )
        require_between("dead_time_s", self.dead_time_s, 0.0, MAX_VALUE)

    @property
    def in_words(self) -> tuple[str, str]:
        """Name and parameters for a picture, these on one or two lines."""
        return (
            "first order",
            f"accel time constant {self.accel_time_constant_s:.3g} s\n"
            f"decel time constant {self.decel_time_constant_s:.3g} s",
        )

    @property
    def accel_lag(self) -> Lag:
        """Response to a step that increases the magnitude of the command."""
        return Lag(first_s=self.accel_time_constant_s)

    @property
    def decel_lag(self) -> Lag:
        """Response to a step that decreases the magnitude of the command."""
        return Lag(first_s=self.decel_time_constant_s)

    @property
    def corner_frequencies_rad_s(self) -> dict[str, float]:
        """Corner frequency of each set that has one [rad/s]."""
        constants = {"accel": self.accel_time_constant_s, "decel": self.decel_time_constant_s}
        return {name: 1 / value for name, value in constants.items() if value > 0}
