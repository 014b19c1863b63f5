"""A second-order lag whose acceleration and deceleration may differ."""

from dataclasses import dataclass
from typing import ClassVar

from design.checks import MAX_VALUE, require_between, require_scale
from design.model.actuators.model import Model
from design.model.lags import Lag

MIN_DAMPING_RATIO = 0.1

MAX_DAMPING_RATIO = 5.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SecondOrderSet:
    """One direction of a second-order actuator."""

    natural_frequency_rad_s: float  # Undamped natural frequency, > 0 [rad/s]
    damping_ratio: float  # Share of critical damping, 0.1 to 5 [-]

    def __post_init__(self) -> None:
        require_scale("natural_frequency_rad_s", self.natural_frequency_rad_s)
        require_between("damping_ratio", self.damping_ratio, MIN_DAMPING_RATIO, MAX_DAMPING_RATIO)

    @property
    def lag(self) -> Lag:
        """The set as a lag."""
        return Lag(
            first_s=2 * self.damping_ratio / self.natural_frequency_rad_s,
            second_s2=self.natural_frequency_rad_s**-2,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class SecondOrder:
    """Second-order actuator with a set of parameters for either direction (Kim 2011, 3.14-3.26)."""

    kind: ClassVar[str] = "second_order"
    """Its ``kind`` on the wire."""

    PROOF_WORK: ClassVar[float] = 3.5
    """Work of proving an impulse at one frequency [units of `design.solvers.budget`]."""

    # Parameters for steps that increase and decrease the magnitude of the command
    accel: SecondOrderSet
    decel: SecondOrderSet
    model: Model = "superposed"  # How the two sets share the actuator
    # Delay of all that it does, >= 0 [s]; it shifts the response and changes no residual
    dead_time_s: float = 0.0

    def __post_init__(self) -> None:
        require_between("dead_time_s", self.dead_time_s, 0.0, MAX_VALUE)

    @property
    def in_words(self) -> tuple[str, str]:
        """Name and parameters for a picture, these on one or two lines."""
        accel, decel = (
            f"{part.natural_frequency_rad_s:.3g} rad/s, damping {part.damping_ratio:.3g}"
            for part in (self.accel, self.decel)
        )
        return "second order", f"accel {accel}\ndecel {decel}"

    @property
    def accel_lag(self) -> Lag:
        """Response to a step that increases the magnitude of the command."""
        return self.accel.lag

    @property
    def decel_lag(self) -> Lag:
        """Response to a step that decreases the magnitude of the command."""
        return self.decel.lag

    @property
    def corner_frequencies_rad_s(self) -> dict[str, float]:
        """Corner frequency of each set that has one [rad/s]."""
        return {
            "accel": self.accel.natural_frequency_rad_s,
            "decel": self.decel.natural_frequency_rad_s,
        }
