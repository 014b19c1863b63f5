"""Half a period of a whole number of samples, but for what frequencies are rounded by."""

import math

import pytest

from design.model.actuators.ideal import Ideal
from design.model.plants.mode import Mode
from design.pipeline import design
from design.sampling.sampled_design import sampled_design
from design.shapers.registry import SHAPERS
from tests.second_route import ideal_derivative_by_formula

ORDERS = {"residual": 0, "slope": 1, "second_derivative": 2, "third_derivative": 3}

OFF = (0.0, 1e-15, -1e-13, 1e-12, -1e-11, 3e-11, 1e-10, -3e-10, 1e-9, -1e-8, 1e-7, 1e-6)


@pytest.mark.parametrize("kind", ["zv", "zvd", "zvdd", "zvddd", "ei", "mzv", "sna_zv", "ps_zv"])
@pytest.mark.parametrize("samples_a_period", [4, 10, 20])
@pytest.mark.parametrize("damping_ratio", [0.0, 0.01])
@pytest.mark.parametrize("off", OFF)
def test_a_period_of_whole_samples_up_to_rounding_is_served(
    kind: str, samples_a_period: int, damping_ratio: float, off: float
) -> None:
    turn = 2 * math.pi / math.sqrt(1 - damping_ratio**2)
    mode = Mode(natural_frequency_rad_s=turn * (1 + off), damping_ratio=damping_ratio)
    between = design(mode, Ideal(), SHAPERS[kind])
    made, _ = sampled_design(between, mode, Ideal(), 1 / samples_a_period)
    for claim in between.certificate.claims:
        if claim.band is None:
            order = ORDERS[claim.quantity]
            found = ideal_derivative_by_formula(made.impulses, mode, order)
            assert found <= claim.limit * (1 + 1e-9)
    assert made.impulses.amplitudes.sum() == pytest.approx(1.0, abs=1e-13)
