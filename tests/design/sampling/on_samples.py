"""Shapers and grids of the tests of sampling, and what they leave."""

import math
from dataclasses import replace

import numpy as np

from design.analysis.residual import residual_vibration
from design.claims import Quantity, zeros
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.pipeline import design
from design.sampling.free_amplitudes import free_on_samples
from design.shapers.registry import SHAPERS
from tests.shaper_table import THESIS

PRINTER = Mode(natural_frequency_rad_s=2 * math.pi * 7.3, damping_ratio=0.05)

SAMPLE_S = 0.01
"""The case of the published figures: 7.3 Hz, damping ratio .05, 10 ms."""

EXACT = 1e-12
"""What counts as zero: rounding of a few terms of size one, with a wide margin [-]."""

SWITCHED = replace(THESIS, model="switched")


def shaper(times: list[float], amplitudes: list[float]) -> Impulses:
    return Impulses(times_s=np.array(times), amplitudes=np.array(amplitudes))


RESIDUAL: tuple[Quantity, ...] = ("residual",)
WITH_SLOPE: tuple[Quantity, ...] = ("residual", "slope")


def positive_shaper(mode: Mode, steps: int) -> Impulses:
    """ZV (2 steps), ZVD (3), ZVDD (4), from the damped half period and its decay."""
    root = math.sqrt(1 - mode.damping_ratio**2)
    half_s = math.pi / (mode.natural_frequency_rad_s * root)
    decay = math.exp(-math.pi * mode.damping_ratio / root)
    heights = [math.comb(steps - 1, index) * decay**index for index in range(steps)]
    total = sum(heights)
    return shaper([half_s * index for index in range(steps)], [a / total for a in heights])


def exact(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    claims: tuple[Quantity, ...] = RESIDUAL,
) -> Impulses:
    """Return amplitudes on samples that make all that is claimed zero."""
    return free_on_samples(impulses, zeros(claims), (mode,), actuator, sample_time_s).impulses


def designed(kind: str, plant: Plant, actuator: Actuator) -> Impulses:
    return design(plant, actuator, SHAPERS[kind]).impulses


def percent(impulses: Impulses, mode: Mode = PRINTER, actuator: Actuator | None = None) -> float:
    return 100 * residual_vibration(impulses, mode, actuator or Ideal())


def assert_on_grid(impulses: Impulses, sample_time_s: float) -> None:
    samples = np.rint(impulses.times_s / sample_time_s)
    assert impulses.times_s.tolist() == (samples * sample_time_s).tolist()
    assert np.all(np.diff(samples) >= 1)
