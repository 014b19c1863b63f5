"""Limits to the rate of a command, and what follows the limited command."""

import math
from dataclasses import dataclass, field
from typing import ClassVar, TypeGuard

from design.checks import MAX_VALUE, require_between, require_scale
from design.errors import InvalidInputError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.second_order import SecondOrder
from design.model.lags import Lag

Unlimited = Ideal | FirstOrder | SecondOrder


@dataclass(frozen=True, slots=True, kw_only=True)
class RateLimited:
    """A limit to acceleration and one to deceleration, and what follows the limited command.

    The command's steps become ramps, steep as the limits allow: the first while the reference's
    magnitude grows, the second while it falls. A command that changes before its ramp is over
    turns the ramp; one that reverses passes zero.

    With a limit to the jerk too, the reference goes from where it is, and from the slope that it
    has, to the command's level in least time, and comes to rest there: also where the command
    changes midway, and at zero where it reverses. Under commands of 0 and 1 it stays within them.
    """

    kind: ClassVar[str] = "rate_limited"
    """Its ``kind`` on the wire."""

    PROOF_WORK: ClassVar[float] = 8.0
    """Work of proving an impulse at one frequency [units of `design.solvers.budget`]."""

    # Largest rates of the reference, > 0 [m/s^2]
    accel_limit_m_s2: float
    decel_limit_m_s2: float
    speed_m_s: float  # Full speed: what a command of 1 stands for, > 0 [m/s]
    # What follows the ramps; its sets are those of the reference's latest change
    then: Unlimited = field(default_factory=Ideal)
    # Largest rate of the reference's acceleration, > 0 [m/s^3]; None is no limit
    jerk_limit_m_s3: float | None = None
    # Delay of all that it does, >= 0 [s]; it shifts the response and changes no residual
    dead_time_s: float = 0.0

    def __post_init__(self) -> None:
        for name in ("accel_limit_m_s2", "decel_limit_m_s2", "speed_m_s"):
            require_scale(name, getattr(self, name))
        if self.jerk_limit_m_s3 is not None:
            require_scale("jerk_limit_m_s3", self.jerk_limit_m_s3)
        require_between("dead_time_s", self.dead_time_s, 0.0, MAX_VALUE)
        if self.then.dead_time_s != 0:
            raise InvalidInputError(
                "then.dead_time_s",
                self.then.dead_time_s,
                "0: dead_time_s beside it is the delay",
                code="delay_said_twice",
            )

    @property
    def model(self) -> Model:
        """How the two sets of what follows share the actuator."""
        return self.then.model

    @property
    def in_words(self) -> tuple[str, str]:
        """Name and parameters for a picture, these on one or two lines."""
        limits = f"{self.accel_limit_m_s2:.3g} and {self.decel_limit_m_s2:.3g} m/s²"
        if self.jerk_limit_m_s3 is not None:
            limits += f"\njerk {self.jerk_limit_m_s3:.3g} m/s³"
        return f"ramps, {self.then.kind.replace('_', ' ')}", f"limits {limits}"

    @property
    def accel_lag(self) -> Lag:
        """Response to a reference whose magnitude grows."""
        return self.then.accel_lag

    @property
    def decel_lag(self) -> Lag:
        """Response to a reference whose magnitude falls."""
        return self.then.decel_lag

    @property
    def unit_ramps_s(self) -> tuple[float, float]:
        """Time from rest to full speed, and from it to rest [s]."""
        return self._ramp_s(self.accel_limit_m_s2), self._ramp_s(self.decel_limit_m_s2)

    @property
    def straight_ramps_s(self) -> tuple[float, float]:
        """The same of ramps of constant slope.

        Raises
        ------
        InvalidInputError
            If the jerk is limited.
        """
        self.require_straight_ramps()
        return self.unit_ramps_s

    def require_straight_ramps(self) -> None:
        """Check that the jerk is not limited.

        For what knows constant slopes alone.

        Raises
        ------
        InvalidInputError
            If it is limited.
        """
        if self.jerk_limit_m_s3 is not None:
            raise InvalidInputError(
                "actuator.jerk_limit_m_s3",
                self.jerk_limit_m_s3,
                "left out here: behind it umzv, umzvd, numzv, numzvd, multi_umzv, num_multi, "
                "num_si, num_ei, num_2ei and moves are designed, where one lag follows, nothing "
                "has to settle and no number of impulses is asked for; they are not fitted or "
                "interpolated",
                code="jerk_not_served",
            )

    def _ramp_s(self, limit_m_s2: float) -> float:
        if self.jerk_limit_m_s3 is None:
            return self.speed_m_s / limit_m_s2
        to_limit_s = limit_m_s2 / self.jerk_limit_m_s3
        if to_limit_s * limit_m_s2 < self.speed_m_s:
            return self.speed_m_s / limit_m_s2 + to_limit_s
        return 2 * math.sqrt(self.speed_m_s / self.jerk_limit_m_s3)

    @property
    def corner_frequencies_rad_s(self) -> dict[str, float]:
        """Corner frequency of each set that has one [rad/s]."""
        return self.then.corner_frequencies_rad_s


def follows_one_lag(actuator: Unlimited | RateLimited) -> TypeGuard[RateLimited]:
    """Return whether an actuator has limits, and one lag for both directions."""
    return isinstance(actuator, RateLimited) and actuator.accel_lag == actuator.decel_lag
