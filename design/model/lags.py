"""How one set of an actuator answers: a lag of unit gain, of order two or less."""

import math
from dataclasses import dataclass
from typing import TypeVar

from design.types import ComplexArray

Pole = TypeVar("Pole", complex, ComplexArray)

CRITICAL_PHASE = 1e-6
"""Below it, sin(x)/x and cos(x) are 1 to 1e-12: the lag counts as critically damped [rad]."""

SETTLED_SHARE = 0.8
"""Share of a step after which a step counts as settled (Kim 2011, eq. 3.40) [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Lag:
    """Unit-gain lag of order two or less, ``G(p) = 1 / (1 + first p + second p^2)``."""

    first_s: float = 0.0  # Coefficient of p, >= 0 [s]
    second_s2: float = 0.0  # Coefficient of p^2, >= 0 [s^2]; 0 makes it first order, both 0 ideal

    def denominator(self, pole_rad_s: Pole) -> Pole:
        """Return ``1 / G`` at one pole or at many [-]."""
        return 1 + pole_rad_s * (self.first_s + pole_rad_s * self.second_s2)

    def step_error(self, time_s: float) -> float:
        """Return ``1 - v(t)`` of the response to a unit step [-].

        Time counts from the step on, >= 0 [s]. Negative where the response overshoots; 0 for an
        ideal lag.
        """
        if self.second_s2 == 0.0:
            return math.exp(-time_s / self.first_s) if self.first_s > 0 else 0.0
        frequency = 1 / math.sqrt(self.second_s2)
        damping = self.first_s * frequency / 2
        phase = frequency * time_s
        root = math.sqrt(abs(damping**2 - 1))
        if root * phase < CRITICAL_PHASE:
            return math.exp(-damping * phase) * (1 + damping * phase)
        if damping < 1:
            wave = math.cos(root * phase) + damping / root * math.sin(root * phase)
            return math.exp(-damping * phase) * wave
        slow, fast = 1 / (damping + root), damping + root
        return (fast * math.exp(-slow * phase) - slow * math.exp(-fast * phase)) / (fast - slow)

    @property
    def corner_rad_s(self) -> float:
        """Undamped frequency of a second-order lag; 0 for others [rad/s]."""
        return self.second_s2**-0.5 if self.second_s2 > 0 else 0.0
