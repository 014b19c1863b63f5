"""What moves: lightly damped modes, given directly, as a pendulum or as a mass on a spring."""

import cmath
import math
from dataclasses import dataclass

from design.errors import InvalidInputError
from design.types import require_between, require_scale

STANDARD_GRAVITY_M_S2 = 9.80665
"""Standard acceleration of free fall [m/s^2] (3rd CGPM, 1901)."""

LARGEST_DAMPING_RATIO = 0.99
"""A swing has decayed to 3e-10 there by the time at which `zv` answers it; from 0.9936 on, to less
than the rounding of a command. Kinds that end below it have bounds of their own [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """One vibration mode, driven by the acceleration of its support.

    Attributes
    ----------
    natural_frequency_rad_s
        Undamped natural frequency, > 0 [rad/s].
    damping_ratio
        Share of critical damping, 0 to 0.99 [-].
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
    def modes(self) -> tuple["Mode", ...]:
        """Every mode to be shaped, here one."""
        return (self,)

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
        Share of critical damping, 0 to 0.99 [-].
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

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Every mode to be shaped, here one."""
        return (self.mode,)


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringMass:
    """A load held by a spring, of which the mass may be known better than the frequency.

    Attributes
    ----------
    mass_kg
        Of the load, > 0 [kg].
    stiffness_n_m
        Of what holds it, > 0 [N/m].
    damping_ratio
        Share of critical damping, 0 to 0.99 [-].
    """

    mass_kg: float
    stiffness_n_m: float
    damping_ratio: float = 0.0

    def __post_init__(self) -> None:
        require_scale("mass_kg", self.mass_kg)
        require_scale("stiffness_n_m", self.stiffness_n_m)
        require_between("damping_ratio", self.damping_ratio, 0.0, LARGEST_DAMPING_RATIO)

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Scheduled:
    """A plant of one mode whose frequency is anywhere in a range: of a length, a mass, a stiffness.

    Attributes
    ----------
    first, last
        The plant at either end of the range, of equal damping ratio.
    """

    first: Mode | Pendulum | SpringMass
    last: Mode | Pendulum | SpringMass

    def __post_init__(self) -> None:
        ends = self.first.mode, self.last.mode
        if ends[0].damping_ratio != ends[1].damping_ratio:
            raise InvalidInputError(
                "over",
                "damping_ratio",
                "a field that changes the frequency: sensitivity.damping tells of damping",
            )
        if not WIDEST_RANGE >= self.band[1] / self.band[0] > 1:
            raise InvalidInputError(
                "to",
                f"frequencies 1 to {self.band[1] / self.band[0]:.4g}",
                "such that the highest frequency is more than the lowest, and at most "
                f"{WIDEST_RANGE:g} times as high",
            )

    @property
    def mode(self) -> Mode:
        """The mode itself, which there is not: whoever asks serves plants of one frequency."""
        raise InvalidInputError("plant.kind", "scheduled", "a plant of one frequency here")

    @property
    def middle(self) -> Mode:
        """The mode in the middle of the range of frequencies, for which shapers are designed."""
        ends = [end.mode.natural_frequency_rad_s for end in (self.first, self.last)]
        return Mode(
            natural_frequency_rad_s=sum(ends) / 2, damping_ratio=self.first.mode.damping_ratio
        )

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Every mode to be shaped, here the middle one."""
        return (self.middle,)

    @property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency over that of `middle` [-]."""
        ends = [end.mode.natural_frequency_rad_s for end in (self.first, self.last)]
        middle = sum(ends) / 2
        return min(ends) / middle, max(ends) / middle


WIDEST_RANGE = 10.0
"""Highest over lowest frequency of a range: no shaper of a few impulses spans more [-]."""

MOST_MODES = 6
"""Modes of one plant, at most: what the search for joint shapers is tried with."""

NEAREST_POLES = 1e-3
"""Distance of two poles, over the slower, below which shaping both asks for a slope [-]."""

WIDEST_SPREAD = 1000.0
"""Highest over lowest natural frequency of one plant [-].

A shaper turns the fastest mode by thousands of periods then: its residual has eleven digits left.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Modes:
    """Several vibration modes of one plant, all driven by the acceleration of its support.

    Attributes
    ----------
    modes
        Two to six, no two alike, in any order.
    """

    modes: tuple[Mode, ...]

    def __post_init__(self) -> None:
        if not 1 < len(self.modes) <= MOST_MODES:
            raise InvalidInputError(
                "modes", f"{len(self.modes)} modes", f"a list of 2 to {MOST_MODES} here"
            )
        for number, one in enumerate(self.modes):
            for earlier, other in enumerate(self.modes[:number]):
                poles = one.pole_rad_s, other.pole_rad_s
                if abs(poles[0] - poles[1]) < NEAREST_POLES * min(map(abs, poles)):
                    raise InvalidInputError(
                        f"modes.{number}",
                        (one.natural_frequency_rad_s, one.damping_ratio),
                        f"another mode than modes.{earlier}, its pole apart by {NEAREST_POLES:g} "
                        "of itself at least: modes so near are one, for which zvd or umzvd add "
                        "robustness",
                    )
                ratio = one.natural_frequency_rad_s / other.natural_frequency_rad_s
                if max(ratio, 1 / ratio) > WIDEST_SPREAD:
                    raise InvalidInputError(
                        f"modes.{number}.natural_frequency_rad_s",
                        one.natural_frequency_rad_s,
                        f"within {WIDEST_SPREAD:g} times of modes.{earlier}, "
                        f"{other.natural_frequency_rad_s!r}",
                    )

    @property
    def mode(self) -> Mode:
        """The mode itself, which there is not: whoever asks serves plants of one mode."""
        raise InvalidInputError("plant.modes", f"{len(self.modes)} modes", "a list of one here")


Plant = Mode | Pendulum | SpringMass | Modes | Scheduled
