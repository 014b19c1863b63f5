"""One vibration mode, lightly damped: what every shaper is designed for."""

import cmath
import math
from dataclasses import dataclass

from design.checks import require_between, require_scale

MAX_DAMPING_RATIO = 0.99
"""A swing has decayed to 3e-10 there by the time at which `zv` answers it; from 0.9936 on, to less
than the rounding of a command. Kinds that end below it have bounds of their own [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """One vibration mode, driven by the acceleration of its support."""

    natural_frequency_rad_s: float  # Undamped natural frequency, > 0 [rad/s]
    damping_ratio: float = 0.0  # Share of critical damping, 0 to 0.99 [-]

    def __post_init__(self) -> None:
        require_scale("natural_frequency_rad_s", self.natural_frequency_rad_s)
        require_between("damping_ratio", self.damping_ratio, 0.0, MAX_DAMPING_RATIO)

    @property
    def mode(self) -> "Mode":
        """The mode itself: every plant answers with the mode to be shaped."""
        return self

    @property
    def modes(self) -> tuple["Mode", ...]:
        """Every mode to be shaped, here one."""
        return (self,)

    @property
    def unit_pole(self) -> complex:
        """Upper pole over the natural frequency, ``-z + j sqrt(1 - z^2)`` [-]."""
        return complex(-self.damping_ratio, math.sqrt(1 - self.damping_ratio**2))

    @property
    def pole_rad_s(self) -> complex:
        """Upper pole of the mode [rad/s]."""
        return self.natural_frequency_rad_s * self.unit_pole

    @property
    def period_s(self) -> float:
        """Undamped period, ``2 pi / w`` [s]."""
        return 2 * cmath.pi / self.natural_frequency_rad_s
