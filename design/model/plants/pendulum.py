"""A load on a cable."""

import math
from dataclasses import dataclass

from design.checks import require_between, require_scale
from design.model.plants.mode import MAX_DAMPING_RATIO, Mode

STANDARD_GRAVITY_M_S2 = 9.80665
"""Standard acceleration of free fall [m/s^2] (3rd CGPM, 1901)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pendulum:
    """A load on a cable under a trolley, at small angles."""

    cable_length_m: float  # From the suspension to the centre of the load, > 0 [m]
    damping_ratio: float = 0.0  # Share of critical damping, 0 to 0.99 [-]
    gravity_m_s2: float = STANDARD_GRAVITY_M_S2  # Acceleration of free fall, > 0 [m/s^2]

    def __post_init__(self) -> None:
        require_scale("cable_length_m", self.cable_length_m)
        require_between("damping_ratio", self.damping_ratio, 0.0, MAX_DAMPING_RATIO)
        require_scale("gravity_m_s2", self.gravity_m_s2)

    @property
    def mode(self) -> Mode:
        """The swing, of natural frequency ``sqrt(g / L)``."""
        return Mode(
            natural_frequency_rad_s=math.sqrt(self.gravity_m_s2 / self.cable_length_m),
            damping_ratio=self.damping_ratio,
        )

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Every mode to be shaped, here one."""
        return (self.mode,)
