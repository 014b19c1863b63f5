"""Cases that `tests.acceptance.random_samples` found to be wrong, each held by another route."""

import math

import numpy as np
import pytest

from design.claims import zeros
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.pipeline import design
from design.sampling.free_amplitudes import free_on_samples
from design.sampling.sampled_design import promise_of, sampled_design
from design.shapers.peak_options import PeakOptions
from design.shapers.registry import SHAPERS
from design.shapers.settle_options import SettleOptions
from design.shapers.several_modes import ConvolvedOptions
from design.solvers.budget import Budget
from tests.expm_route import outcome
from tests.second_route import claims_by_formula

PEAK = 1.25


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize("kind", ["umzvc", "numzv"])
@pytest.mark.parametrize("sample_s", [0.05, 0.2, 0.5])
def test_a_higher_first_pulse_is_exact_behind_sets_that_differ(
    kind: str, model: Model, sample_s: float
) -> None:
    mode = Mode(natural_frequency_rad_s=1.4, damping_ratio=0.05)
    drive = FirstOrder(accel_time_constant_s=0.125, decel_time_constant_s=0.058, model=model)
    between = design(mode, drive, SHAPERS[kind], PeakOptions(max_velocity_ratio=PEAK))
    found = sampled_design(between, mode, drive, sample_s, between_levels=False)[0].impulses
    assert outcome(found, mode, drive).residual < 1e-12
    levels = np.cumsum(found.amplitudes)
    assert levels.min() >= -1e-12
    assert levels.max() <= PEAK + 1e-12


def test_equal_steps_whose_ramps_were_alike_are_claimed_for_an_ideal_drive_when_shared() -> None:
    mode = Mode(natural_frequency_rad_s=2.683)
    drive = RateLimited(accel_limit_m_s2=1.6, decel_limit_m_s2=6.0, speed_m_s=0.24)
    between = design(mode, drive, SHAPERS["zv"])
    assert not between.for_ideal
    found, _ = sampled_design(between, mode, drive, 0.32)
    assert found.for_ideal
    assert outcome(found.impulses, mode, Ideal()).residual < 1e-12
    played = outcome(found.impulses, mode, drive).residual
    (warning,) = (one for one in found.warnings if one.code == "actuator_ignored")
    assert f"{100 * played:.4g} %" in warning.detail


@pytest.mark.parametrize("shift", [0.0, 3e-11, 1e-10, 3e-10, 1e-9, 1e-8])
def test_tiny_shares_are_none_and_the_others_make_up_for_them(shift: float) -> None:
    # Half a period is 20 samples and a little: the shares beside them are as little.
    mode = Mode(natural_frequency_rad_s=math.pi / (20 + shift))
    between = design(mode, Ideal(), SHAPERS["zvdd"])
    promises = zeros(SHAPERS["zvdd"].claims)
    found = free_on_samples(between.impulses, promises, (mode,), Ideal(), 1.0).impulses
    assert found.amplitudes.sum() == pytest.approx(1.0, abs=1e-12)
    assert claims_by_formula(found, mode, Ideal())["residual"] < 1e-12


def test_a_long_shaper_with_bands_in_several_modes_takes_little_work() -> None:
    frequencies = ((11.476, 0.163), (56.426, 0.099), (13.714, 0.03), (17.305, 0.126))
    plant = Modes(
        modes=tuple(Mode(natural_frequency_rad_s=w, damping_ratio=z) for w, z in frequencies)
    )
    options = ConvolvedOptions(base="ei", tolerance=0.09)
    between = design(plant, Ideal(), SHAPERS["convolved"], options)
    budget = Budget()
    promises = [promise_of(claim) for claim in between.certificate.claims]
    found = free_on_samples(
        between.impulses, promises, plant.modes, Ideal(), 0.001245, budget
    ).impulses
    assert budget.done < 2e6
    for mode in plant.modes:
        assert outcome(found, mode, Ideal()).residual <= 0.09


def test_a_tolerance_on_samples_counts_where_no_impulses_are_added() -> None:
    mode = Mode(natural_frequency_rad_s=1.621, damping_ratio=0.155)
    between = design(mode, Ideal(), SHAPERS["numzvd"], SettleOptions(settle=True))
    for claimed, warned in ((0.0242, False), (None, True)):
        found, _ = sampled_design(between, mode, Ideal(), 0.1459, claimed=claimed)
        assert 0.01 < found.residual < 0.0242
        assert ("tolerance_not_kept" in [one.code for one in found.warnings]) == warned
