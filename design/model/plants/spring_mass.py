"""A load held by a spring."""

import math
from dataclasses import dataclass

from design.checks import require_between, require_scale
from design.model.plants.mode import MAX_DAMPING_RATIO, Mode


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringMass:
    """A load held by a spring, of which the mass may be known better than the frequency."""

    mass_kg: float  # Of the load, > 0 [kg]
    stiffness_n_m: float  # Of what holds it, > 0 [N/m]
    damping_ratio: float = 0.0  # Share of critical damping, 0 to 0.99 [-]

    def __post_init__(self) -> None:
        require_scale("mass_kg", self.mass_kg)
        require_scale("stiffness_n_m", self.stiffness_n_m)
        require_between("damping_ratio", self.damping_ratio, 0.0, MAX_DAMPING_RATIO)

    @property
    def mode(self) -> Mode:
        """The vibration, of natural frequency ``sqrt(k / m)``."""
        return Mode(
            natural_frequency_rad_s=math.sqrt(self.stiffness_n_m / self.mass_kg),
            damping_ratio=self.damping_ratio,
        )

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Every mode to be shaped, here one."""
        return (self.mode,)
