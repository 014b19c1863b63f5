"""A plant of several vibration modes."""

from dataclasses import dataclass

from design.errors import InvalidInputError
from design.model.plants.mode import Mode

MAX_MODES = 6
"""Modes of one plant, at most: what the search for joint shapers is tried with."""

MIN_POLE_DISTANCE = 1e-3
"""Distance of two poles, over the slower, below which shaping both asks for a slope [-]."""

MAX_FREQUENCY_SPREAD = 1000.0
"""Highest over lowest natural frequency of one plant [-].

A shaper turns the fastest mode by thousands of periods then: its residual has eleven digits left.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Modes:
    """Several vibration modes of one plant, all driven by the acceleration of its support."""

    modes: tuple[Mode, ...]  # Two to six, no two alike, in any order

    def __post_init__(self) -> None:
        if not 1 < len(self.modes) <= MAX_MODES:
            raise InvalidInputError(
                "modes",
                f"{len(self.modes)} modes",
                f"a list of 2 to {MAX_MODES} here",
                code="wrong_count_of_modes",
            )
        for number, one in enumerate(self.modes):
            for earlier, other in enumerate(self.modes[:number]):
                poles = one.pole_rad_s, other.pole_rad_s
                if abs(poles[0] - poles[1]) < MIN_POLE_DISTANCE * min(map(abs, poles)):
                    raise InvalidInputError(
                        f"modes.{number}",
                        (one.natural_frequency_rad_s, one.damping_ratio),
                        f"another mode than modes.{earlier}, its pole apart by "
                        f"{MIN_POLE_DISTANCE:g} of itself at least: modes so near "
                        "are one, for which zvd or umzvd add robustness",
                        code="modes_too_near",
                    )
                ratio = one.natural_frequency_rad_s / other.natural_frequency_rad_s
                if max(ratio, 1 / ratio) > MAX_FREQUENCY_SPREAD:
                    raise InvalidInputError(
                        f"modes.{number}.natural_frequency_rad_s",
                        one.natural_frequency_rad_s,
                        f"within {MAX_FREQUENCY_SPREAD:g} times of modes.{earlier}, "
                        f"{other.natural_frequency_rad_s!r}",
                        code="modes_too_far",
                    )

    @property
    def mode(self) -> Mode:
        """Raise InvalidInputError: there is more than one."""
        raise InvalidInputError(
            "plant.modes", f"{len(self.modes)} modes", "of one mode here", code="single_mode_only"
        )
