"""Plants of several modes, designed and judged by a formula."""

import math

import numpy as np

from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.pipeline import Design, design
from design.shapers.registry import SHAPERS
from tests.second_route import claims_by_formula
from tests.shaper_table import IDEAL

HERTZ = 2 * math.pi


def plant(*modes: tuple[float, float]) -> Modes:
    """Return the plant of modes of these frequencies [Hz] and damping ratios."""
    return Modes(
        modes=tuple(
            Mode(natural_frequency_rad_s=HERTZ * frequency, damping_ratio=damping)
            for frequency, damping in modes
        )
    )


def random_plants(count: int, modes: int, seed: int) -> list[Modes]:
    rng = np.random.default_rng(seed)
    plants: list[Modes] = []
    while len(plants) < count:
        frequencies = [1.0, *rng.uniform(1.1, 6, modes - 1).tolist()]
        plants.append(plant(*zip(frequencies, rng.uniform(0, 0.1, modes).tolist(), strict=True)))
    return plants


PAIR = plant((1.0, 0.0), (2.7, 0.0))
PAIRS = [PAIR, *random_plants(40, 2, seed=1)]
LARGER = [one for modes in (3, 4, 5, 6) for one in random_plants(3, modes, seed=modes)]


def made(subject: Modes, name: str, options: object = None, actuator: Actuator = IDEAL) -> Design:
    return design(subject, actuator, SHAPERS[name], options)


def left_by_formula(found: Design, subject: Modes, actuator: Actuator = IDEAL) -> float:
    return max(
        claims_by_formula(found.impulses, mode, actuator)["residual"] for mode in subject.modes
    )
