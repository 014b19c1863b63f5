"""Unity magnitude over a band where samples are longer than gaps, against all commands."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from design.errors import InfeasibleDesignError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.sampling.sampled_design import sampled_design
from design.sampling.unity_band import unity_over_band
from design.shapers.ei import ToleranceOptions
from design.shapers.registry import SHAPERS
from tests.expm_route import outcome
from tests.refusals import refused
from tests.second_route import curve_by_formula, largest_in_band_by_formula

MODE = Mode(natural_frequency_rad_s=2 * math.pi, damping_ratio=0.02)
LAG = FirstOrder(accel_time_constant_s=0.03, decel_time_constant_s=0.01)
LIMITED = RateLimited(accel_limit_m_s2=10.0, decel_limit_m_s2=8.0, speed_m_s=1.0)
BAND = (0.95, 1.05)


def every_command(samples: int, sample_s: float) -> list[Impulses]:
    """Return all commands of level 0 or 1 of up to so many samples."""
    found = []
    for last in range(2, samples + 1):
        for inner in itertools.product((0, 1), repeat=last - 2):
            steps = np.diff([0, 1, *inner, 0, 1])
            used = np.flatnonzero(steps)
            found.append(Impulses(times_s=used * sample_s, amplitudes=1.0 * steps[used]))
    return found


@pytest.mark.parametrize("actuator", [Ideal(), LAG])
@pytest.mark.parametrize("sample_s", [0.11, 0.17, 0.3])
def test_of_few_samples_no_command_has_less_over_the_band(
    actuator: Actuator, sample_s: float
) -> None:
    between = design(MODE, actuator, SHAPERS["um_2ei"], ToleranceOptions(tolerance=0.05))
    found, proven = unity_over_band(
        between.impulses, MODE, actuator, sample_s, BAND, tolerance=0.0, longest=9
    )
    ratios = np.linspace(*BAND, 17)
    least = min(
        float(curve_by_formula(one, MODE, actuator, ratios).max())
        for one in every_command(9, sample_s)
    )
    assert proven.complete
    assert proven.bound == pytest.approx(least, abs=1e-12)
    assert curve_by_formula(found, MODE, actuator, ratios).max() == pytest.approx(least, abs=1e-9)


def test_the_shortest_within_the_tolerance_is_taken() -> None:
    between = design(MODE, Ideal(), SHAPERS["um_2ei"], ToleranceOptions(tolerance=0.05))
    commands = [every_command(n, 0.1) for n in range(2, 11)]
    least = [
        min(largest_in_band_by_formula(one, MODE, Ideal(), BAND, 17) for one in each)
        for each in commands
    ]
    tolerance = 1.001 * least[6]
    shortest = next(n for n, left in enumerate(least, start=2) if left <= tolerance)
    found, proven = unity_over_band(
        between.impulses, MODE, Ideal(), 0.1, BAND, tolerance=tolerance, longest=30
    )
    assert proven.complete
    assert round(found.duration_s / 0.1) == shortest


@pytest.mark.parametrize("actuator", [Ideal(), LAG, LIMITED])
@pytest.mark.parametrize("kind", ["um_ei", "um_2ei", "num_ei"])
@pytest.mark.parametrize("per_period", [4.0, 9.0, 16.0])
def test_a_shaper_whose_gaps_are_shorter_than_a_sample_is_served(
    kind: str, actuator: Actuator, per_period: float
) -> None:
    sample_s = MODE.period_s / per_period
    between = design(MODE, actuator, SHAPERS[kind])
    if np.diff(between.impulses.times_s).min() >= sample_s:
        pytest.skip("each impulse has a sample")
    try:
        found, sampled = sampled_design(between, MODE, actuator, sample_s, tolerance=0.01)
    except InfeasibleDesignError:
        assert per_period == 4  # samples as coarse as these do not serve so wide a band
        return
    command = found.impulses
    assert command.amplitudes.tolist() == [(-1.0) ** k for k in range(command.times_s.size)]
    (claim,) = (one for one in found.certificate.claims if one.band is not None)
    (promised,) = (one for one in between.certificate.claims if one.band is not None)
    assert sampled.searched is not None
    assert claim.band is not None
    # Commands are compared behind the drive given, whatever the claims are for.
    ratios = np.linspace(*claim.band, 17).tolist()
    w = MODE.natural_frequency_rad_s
    worst = max(
        outcome(command, replace(MODE, natural_frequency_rad_s=w * at), actuator).residual
        for at in ratios
    )
    assert sampled.searched.bound <= worst * (1 + 1e-9) or not sampled.searched.complete
    told = [one.detail for one in found.warnings if one.code == "tolerance_not_kept"]
    assert bool(told) == (claim.value > promised.limit * (1 + 1e-3))
    played = outcome(command, MODE, actuator).residual
    assert found.residual == pytest.approx(played, abs=1e-9)


def test_a_band_for_which_no_command_helps_is_refused_with_the_least() -> None:
    between = design(MODE, Ideal(), SHAPERS["um_2ei"])
    least = min(
        largest_in_band_by_formula(one, MODE, Ideal(), (0.5, 1.5), 17)
        for one in every_command(5, 0.49)
    )
    assert least > 1
    with refused("band_not_on_samples", says=f"{100 * least:.4g} %"):
        unity_over_band(
            between.impulses, MODE, Ideal(), 0.49, (0.5, 1.5), tolerance=0.05, longest=5
        )
