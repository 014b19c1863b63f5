"""What moves: a lightly damped mode, given directly or as a pendulum."""

import cmath
import math
from dataclasses import dataclass

from design.types import require_between, require_scale

STANDARD_GRAVITY_M_S2 = 9.80665
"""Standard acceleration of free fall [m/s^2] (3rd CGPM, 1901)."""

LARGEST_DAMPING_RATIO = 0.5
"""Beyond it the seeds of the literature leave their range and shaping has little to cancel [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """One vibration mode, driven by the acceleration of its support.

    Attributes
    ----------
    natural_frequency_rad_s
        Undamped natural frequency, > 0 [rad/s].
    damping_ratio
        Share of critical damping, 0 to 0.5 [-].
    """

    natural_frequency_rad_s: float
    damping_ratio: float = 0.0

    def __post_init__(self) -> None:
        require_scale("natural_frequency_rad_s", self.natural_frequency_rad_s)
        require_between("damping_ratio", self.damping_ratio, 0.0, LARGEST_DAMPING_RATIO)

    @property
    def mode(self) -> "Mode":
        """The mode itself: every plant answers with the mode to be shaped."""
        return self

    @property
    def unit_pole(self) -> complex:
        """Upper pole of the mode over its natural frequency, ``-z + j sqrt(1 - z^2)`` [-]."""
        return complex(-self.damping_ratio, math.sqrt(1 - self.damping_ratio**2))

    @property
    def pole_rad_s(self) -> complex:
        """Upper pole of the mode [rad/s]."""
        return self.natural_frequency_rad_s * self.unit_pole

    @property
    def period_s(self) -> float:
        """Undamped period, ``2 pi / w`` [s]."""
        return 2 * cmath.pi / self.natural_frequency_rad_s


@dataclass(frozen=True, slots=True, kw_only=True)
class Pendulum:
    """A load on a cable under a trolley, at small angles.

    Attributes
    ----------
    cable_length_m
        From the suspension to the centre of the load, > 0 [m].
    damping_ratio
        Share of critical damping, 0 to 0.5 [-].
    gravity_m_s2
        Acceleration of free fall, > 0 [m/s^2].
    """

    cable_length_m: float
    damping_ratio: float = 0.0
    gravity_m_s2: float = STANDARD_GRAVITY_M_S2

    def __post_init__(self) -> None:
        require_scale("cable_length_m", self.cable_length_m)
        require_between("damping_ratio", self.damping_ratio, 0.0, LARGEST_DAMPING_RATIO)
        require_scale("gravity_m_s2", self.gravity_m_s2)

    @property
    def mode(self) -> Mode:
        """The swing, of natural frequency ``sqrt(g / L)``."""
        return Mode(
            natural_frequency_rad_s=math.sqrt(self.gravity_m_s2 / self.cable_length_m),
            damping_ratio=self.damping_ratio,
        )


Plant = Mode | Pendulum
