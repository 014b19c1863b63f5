"""Random plants of several modes behind the thesis's drive: how many are solved, and how fast.

`python -m tests.acceptance.random_modes 200 50 20` solves 200 pairs and 50 triples behind either
model, and holds 20 of the pairs against least squares from 400 starts each, which share no code.
The suite runs fewer.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from design.errors import InfeasibleDesignError
from design.model.actuators.model import Model
from design.model.actuators.second_order import SecondOrder
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.types import FloatArray
from tests.multistart_route import Plant
from tests.shaper_table import THESIS

MODELS: tuple[Model, ...] = ("superposed", "switched")

STARTS = 400

SLOWER = 1e-6
"""How much slower than the best of the starts a design may be, over itself [-]."""

TOLD = 1e-9
"""Residual that the certificate allows; the own formula adds a thousandth of it [-]."""


@dataclass(frozen=True)
class Case:
    """A plant behind a drive, and what is left by the design of it.

    Attributes
    ----------
    plant
        By formulas of its own.
    times_s
        Steps after the first; empty where there is none [s].
    """

    plant: Plant
    times_s: FloatArray

    @property
    def shortest_s(self) -> float:
        """Least pulse of superposed steps; what keeps the order of switched ones [s]."""
        if self.plant.switched:
            return 1e-6 / min(self.plant.frequencies)
        return 0.01 * 2 * np.pi / max(self.plant.frequencies)


def random_modes(count: int, modes: int, seed: int) -> list[tuple[FloatArray, FloatArray]]:
    """Return frequencies [rad/s] and damping ratios of random plants, half of them undamped."""
    rng = np.random.default_rng(seed)
    plants: list[tuple[FloatArray, FloatArray]] = []
    for number in range(count):
        ratios = np.cumprod(
            np.append(1.0, rng.uniform(1.15, 3.5 if modes == 2 else 2.2, modes - 1))
        )
        damping = rng.uniform(0, 0.1, modes) * (number % 2)
        plants.append((rng.uniform(1.0, 5.0) * ratios, damping))
    return plants


def solved(count: int, modes: int, model: Model, seed: int = 1) -> Iterator[Case]:
    """Yield designs of `num_multi`, with the times that they have."""
    drive = SecondOrder(accel=THESIS.accel, decel=THESIS.decel, model=model)
    for frequencies, damping in random_modes(count, modes, seed):
        each = zip(frequencies.tolist(), damping.tolist(), strict=True)
        plant = Modes(
            modes=tuple(Mode(natural_frequency_rad_s=w, damping_ratio=z) for w, z in each)
        )
        try:
            times = design(plant, drive, SHAPERS["num_multi"]).impulses.times_s[1:]
        except InfeasibleDesignError:
            times = np.zeros(0)
        subject = Plant(tuple(frequencies), tuple(damping), switched=model == "switched")
        yield Case(plant=subject, times_s=times)


def wrong(case: Case) -> bool:
    """Whether a design leaves something, or has a pulse below the shortest."""
    gaps = np.diff(case.times_s, prepend=0.0)
    return bool(np.abs(case.plant.left(gaps)).max() > 1.001 * TOLD or gaps.min() < case.shortest_s)


def too_slow(case: Case, starts: int = STARTS) -> bool:
    """Whether some start leads to steps that are faster."""
    best = case.plant.fastest(starts, case.shortest_s, seed=1)
    if best is None:
        return False
    return case.times_s.size == 0 or bool(case.times_s[-1] > best[-1] * (1 + SLOWER))


def main(pairs: int, triples: int, compared: int) -> None:
    """Print what becomes of so many plants."""
    for model in MODELS:
        for count, modes in ((pairs, 2), (triples, 3)):
            cases = list(solved(count, modes, model))
            found = [case for case in cases if case.times_s.size]
            bad = sum(map(wrong, found))
            print(f"{model}, {modes} modes: {len(found)} of {count} solved, {bad} wrong")
        cases = list(solved(compared // 2, 2, model, seed=2))
        slow = [case for case in cases if too_slow(case)]
        print(f"{model}: {len(slow)} of {len(cases)} slower than the best of {STARTS} starts", slow)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:4]))
