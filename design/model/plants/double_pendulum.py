"""A load slung below the hook of a crane: two swings."""

import math
from dataclasses import dataclass

from design.checks import require_between, require_scale
from design.errors import InvalidInputError
from design.model.plants.mode import MAX_DAMPING_RATIO, Mode
from design.model.plants.modes import MAX_FREQUENCY_SPREAD, MIN_POLE_DISTANCE, Modes
from design.model.plants.pendulum import STANDARD_GRAVITY_M_S2


@dataclass(frozen=True, slots=True, kw_only=True)
class DoublePendulum:
    """A load slung below a hook of some mass, both under a trolley, at small angles."""

    hook_mass_kg: float  # Of the hook, > 0 [kg]
    load_mass_kg: float  # Of the load, > 0 [kg]
    cable_length_m: float  # From the suspension to the hook, > 0 [m]
    load_length_m: float  # From the hook to the centre of the load, > 0 [m]
    damping_ratio: float = 0.0  # Share of critical damping of either swing, 0 to 0.99 [-]
    gravity_m_s2: float = STANDARD_GRAVITY_M_S2  # Acceleration of free fall, > 0 [m/s^2]

    def __post_init__(self) -> None:
        for name in ("hook_mass_kg", "load_mass_kg", "cable_length_m", "load_length_m"):
            require_scale(name, getattr(self, name))
        require_between("damping_ratio", self.damping_ratio, 0.0, MAX_DAMPING_RATIO)
        require_scale("gravity_m_s2", self.gravity_m_s2)
        slow, fast = self.natural_frequencies_rad_s
        try:
            Modes(modes=self.modes)
        except InvalidInputError as error:
            raise InvalidInputError(
                "load_mass_kg",
                self.load_mass_kg,
                f"such that the faster swing has {1 + MIN_POLE_DISTANCE:g} to "
                f"{MAX_FREQUENCY_SPREAD:g} times the frequency of the slower; with the other "
                f"fields they have {fast:.6g} and {slow:.6g} rad/s",
                code=error.code,
            ) from None

    @property
    def natural_frequencies_rad_s(self) -> tuple[float, float]:
        """Undamped natural frequencies, the slower swing first [rad/s].

        With ``R = m_load / m_hook``, ``a = 1 / L_cable``, ``b = 1 / L_load`` the linearised
        equations have ``w^2 = g/2 ((1 + R) (a + b) +- sqrt((1 + R)^2 (a + b)^2 - 4 (1 + R) a b))``
        (Singhose, Kim, Kenison, "Input shaping control of double-pendulum bridge crane
        oscillations", J. Dyn. Sys., Meas., Control 130 (2008)). The root is written without
        a difference that cancels, and the slower follows from the product ``g^2 (1 + R) a b``.
        """
        ratio = self.load_mass_kg / self.hook_mass_kg
        whole = 1 + ratio
        a, b = 1 / self.cable_length_m, 1 / self.load_length_m
        root = math.sqrt(whole * ((a - b) ** 2 + ratio * (a + b) ** 2))
        fast = math.sqrt(self.gravity_m_s2 / 2 * (whole * (a + b) + root))
        slow = self.gravity_m_s2 * math.sqrt(whole * a * b) / fast
        return slow, fast

    @property
    def mode(self) -> Mode:
        """Raise InvalidInputError: there are two."""
        raise InvalidInputError(
            "plant.kind", "double_pendulum", "of one mode here", code="single_mode_only"
        )

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Both modes to be shaped, the slower first."""
        return tuple(
            Mode(natural_frequency_rad_s=one, damping_ratio=self.damping_ratio)
            for one in self.natural_frequencies_rad_s
        )
