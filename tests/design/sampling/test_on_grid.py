"""Designs brought to the samples of a controller: the joint command between 0 and 1."""

import math

import numpy as np
import pytest
from scipy.optimize import linprog

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.pipeline import design
from design.sampling.on_grid import SampleGrid, brought_to_grid, design_on_grid, require_served
from design.shapers.registry import SHAPERS
from tests.design.sampling.on_samples import EXACT, assert_on_grid
from tests.integration_route import residual_by_integration
from tests.refusals import refused

KIND = SHAPERS["multi_umzv"]

LAG = FirstOrder(accel_time_constant_s=0.03, decel_time_constant_s=0.05)


def modes_of(*modes: tuple[float, float]) -> Modes:
    return Modes(
        modes=tuple(
            Mode(natural_frequency_rad_s=2 * math.pi * hertz, damping_ratio=ratio)
            for hertz, ratio in modes
        )
    )


CASES = [
    (modes_of((1.0, 0.0), (2.7, 0.0)), 0.02),
    (modes_of((1.0, 0.03), (2.7, 0.02)), 0.05),
    (modes_of((0.7, 0.01), (1.1, 0.05), (2.9, 0.0)), 0.04),
    (modes_of((0.31, 0.08), (0.97, 0.02)), 0.1),
]


def leaves_nothing_by_program(plant: Modes, sample_time_s: float, last: int) -> bool:
    """Whether some levels between 0 and 1 on samples 0 to last leave nothing, by a dense program.

    The level of each sample is unknown, and 1 from the last on: V = sum (u_k - u_(k-1)) exp(...).
    """
    rows, right = [], []
    for mode in plant.modes:
        w, z = mode.natural_frequency_rad_s, mode.damping_ratio
        pole = w * complex(-z, math.sqrt(1 - z * z))
        swings = np.exp(pole * sample_time_s * (last - np.arange(last + 1)))
        vector = swings[:-1] - swings[1:]  # of a level that begins at a sample and ends at the next
        for part in (np.real, np.imag):
            rows.append(part(vector))
            right.append(-part(swings[-1]))
    found = linprog(np.zeros(last), A_eq=np.array(rows), b_eq=right, bounds=(0, 1), method="highs")
    return bool(found.status == 0)


@pytest.mark.parametrize(("plant", "sample_time_s"), CASES)
def test_the_joint_command_leaves_nothing_on_the_fewest_samples(
    plant: Modes, sample_time_s: float
) -> None:
    continuous = design(plant, Ideal(), KIND)
    grid = SampleGrid(sample_time_s=sample_time_s)
    found, sampled = brought_to_grid(continuous, plant, Ideal(), KIND, None, grid)
    assert_on_grid(found.impulses, sample_time_s)
    levels = np.cumsum(found.impulses.amplitudes)
    assert levels.min() > -EXACT
    assert levels.max() < 1 + EXACT
    assert levels[-1] == pytest.approx(1, abs=EXACT)
    assert found.certificate.verified
    for mode in plant.modes:
        assert residual_by_integration(found.impulses, mode, Ideal()) < 1e-7
    last = sampled.samples[-1]
    assert leaves_nothing_by_program(plant, sample_time_s, last)
    assert not leaves_nothing_by_program(plant, sample_time_s, last - 1)
    assert sampled.shorter_bound is not None
    assert sampled.shorter_bound > 0
    assert found.impulses.duration_s >= continuous.impulses.duration_s * (1 - 1e-9)


def test_behind_a_lag_the_claim_is_for_an_ideal_actuator() -> None:
    plant, sample_time_s = CASES[0]
    found = design_on_grid(plant, LAG, KIND, None, SampleGrid(sample_time_s=sample_time_s))
    assert found.for_ideal
    assert found.warnings[0].code == "actuator_ignored"
    left = max(residual_by_integration(found.impulses, mode, LAG) for mode in plant.modes)
    assert found.residual == pytest.approx(left, abs=1e-7)


def test_one_mode_keeps_unity_magnitude() -> None:
    plant = Mode(natural_frequency_rad_s=6.0, damping_ratio=0.03)
    found = design_on_grid(plant, Ideal(), KIND, None, SampleGrid(sample_time_s=0.03))
    assert np.abs(found.impulses.amplitudes).tolist() == [1.0] * found.impulses.times_s.size


def test_behind_limits_it_is_refused() -> None:
    limits: Actuator = RateLimited(accel_limit_m_s2=20, decel_limit_m_s2=20, speed_m_s=0.2)
    plant, sample_time_s = CASES[0]
    with refused("samples_of_one_mode", "sample_time_s", says="multi_umzv without limits has"):
        design_on_grid(plant, limits, KIND, None, SampleGrid(sample_time_s=sample_time_s))


def test_convolved_unity_is_refused_with_the_way_out() -> None:
    plant, sample_time_s = CASES[0]
    kind = SHAPERS["convolved"]
    options = kind.options(base="umzv")
    with refused("samples_of_one_mode", "sample_time_s", says="multi_umzv without limits has"):
        require_served(plant.modes, kind, options, sample_time_s)
    require_served(plant.modes, kind, kind.options(), sample_time_s)


@pytest.mark.parametrize(
    ("values", "code"),
    [
        ({"sample_time_s": 0.0}, "not_positive"),
        ({"sample_time_s": 0.01, "sample_tolerance": 1.5}, "out_of_range"),
    ],
)
def test_a_grid_holds_its_rules(values: dict[str, float], code: str) -> None:
    with refused(code):
        SampleGrid(**values)


def test_without_samples_it_is_the_design_itself() -> None:
    plant = CASES[0][0]
    found = design_on_grid(plant, Ideal(), KIND, None, None)
    assert found.impulses.times_s.tolist() == design(plant, Ideal(), KIND).impulses.times_s.tolist()
