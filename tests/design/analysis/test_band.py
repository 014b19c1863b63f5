"""The largest residual over frequency and damping."""

import math
from dataclasses import replace

import numpy as np
import pytest

from design.analysis.band import largest_in_band
from design.analysis.high_modes import high_mode_gain
from design.model.actuators.model import Model
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS
from tests.second_route import claims_by_formula
from tests.shaper_table import FIRST_ORDER, IDEAL, LIMITED, THESIS

MODE = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.1)
BAND, DAMPING = (0.8, 1.2), (0.03, 0.2)


def worst_of_grid(
    impulses: Impulses, actuator: Actuator, band: tuple[float, float], damping: tuple[float, float]
) -> float:
    modes = [replace(MODE, damping_ratio=z) for z in np.linspace(*damping, 15).tolist()]
    return max(
        claims_by_formula(impulses, mode, actuator, ratio)["residual"]
        for mode in modes
        for ratio in np.linspace(*band, 41).tolist()
    )


@pytest.mark.parametrize(
    "actuator",
    [IDEAL, FIRST_ORDER, THESIS, replace(THESIS, model="switched"), LIMITED],
    ids=["ideal", "first_order", "superposed", "switched", "limited"],
)
@pytest.mark.parametrize("kind", ["zv", "ei", "two_hump_ei", "umzvd"])
def test_the_rim_holds_the_largest_residual_of_the_whole_region(
    kind: str, actuator: Actuator
) -> None:
    impulses = design(MODE, actuator, SHAPERS[kind]).impulses
    if actuator.model == "switched":
        # The formula of the second route superposes: here against the rim of one band alone.
        whole = largest_in_band(impulses, MODE, actuator, BAND, DAMPING)
        inner = [
            largest_in_band(impulses, replace(MODE, damping_ratio=z), actuator, BAND)
            for z in np.linspace(*DAMPING, 7).tolist()
        ]
        assert whole >= max(inner) * (1 - 1e-12)
        return
    found = largest_in_band(impulses, MODE, actuator, BAND, DAMPING)
    grid = worst_of_grid(impulses, actuator, BAND, DAMPING)
    # A grid never finds more, and at a hundredth of the band little less.
    assert grid * (1 - 1e-9) <= found <= grid * 1.002


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize("damping", [0.1, 0.2, 0.3, 0.45])
@pytest.mark.parametrize("amplitudes", [(0.25, 0.3, 0.45), (1.0, -1.0, 1.0)])
def test_a_band_that_ends_at_a_pole_of_both_sets_is_that_of_an_ideal_drive(
    model: Model, damping: float, amplitudes: tuple[float, ...]
) -> None:
    # Equal sets are a common factor of the command and of the step, at their pole too. A band of
    # 1.5 to 2 has its end there to the bit for some dampings, and then the system is singular.
    one = SecondOrderSet(natural_frequency_rad_s=2.0, damping_ratio=damping)
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=damping)
    command = Impulses(times_s=np.array([0.0, 1.0, 3.2]), amplitudes=np.array(amplitudes))
    for band in ((1.5, 2.0), (2.0, 2.5)):
        found = largest_in_band(command, mode, SecondOrder(accel=one, decel=one, model=model), band)
        # Beside the pole both are some 1e12 times larger; their quotient keeps most digits.
        assert found == pytest.approx(largest_in_band(command, mode, IDEAL, band), rel=1e-9)


def test_a_range_of_one_damping_ratio_is_the_band() -> None:
    impulses = design(MODE, THESIS, SHAPERS["umzvd"]).impulses
    alone = largest_in_band(impulses, MODE, THESIS, BAND)
    both = largest_in_band(impulses, MODE, THESIS, BAND, (0.1, 0.1))
    assert both == pytest.approx(alone, rel=1e-12)


def test_a_set_that_rings_within_the_ranges_leaves_no_bound() -> None:
    near = SecondOrderSet(natural_frequency_rad_s=3.6, damping_ratio=0.15)
    actuator = SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8), decel=near
    )
    umzv = design(MODE, actuator, SHAPERS["umzv"]).impulses
    assert largest_in_band(umzv, MODE, actuator, BAND, DAMPING) == math.inf
    assert largest_in_band(umzv, MODE, actuator, (0.8, 1.0), DAMPING) < math.inf
    zv = design(MODE, actuator, SHAPERS["zv"]).impulses
    ideal = largest_in_band(zv, MODE, IDEAL, BAND, DAMPING)
    assert largest_in_band(zv, MODE, actuator, BAND, DAMPING) == pytest.approx(ideal, rel=1e-9)


UNDAMPED = Mode(natural_frequency_rad_s=3.5)


@pytest.mark.parametrize("kind", ["zv", "zvd", "mzv", "ei", "three_hump_ei"])
@pytest.mark.parametrize("mode", [UNDAMPED, MODE], ids=["undamped", "damped"])
def test_positive_shapers_amplify_no_high_mode(kind: str, mode: Mode) -> None:
    impulses = design(mode, IDEAL, SHAPERS[kind]).impulses
    assert high_mode_gain(impulses, mode, IDEAL) <= 1 + 1e-12
    # Odd multiples are suppressed by zv, even ones not at all: two periods in step.
    if kind == "zv" and mode is UNDAMPED:
        assert high_mode_gain(impulses, mode, IDEAL) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("actuator", [IDEAL, THESIS, LIMITED], ids=["ideal", "thesis", "limited"])
@pytest.mark.parametrize("kind", ["umzv", "umzvd", "um_2ei"])
def test_the_high_mode_gain_is_the_peak_of_the_curve(kind: str, actuator: Actuator) -> None:
    impulses = design(UNDAMPED, actuator, SHAPERS[kind]).impulses
    found = high_mode_gain(impulses, UNDAMPED, actuator)
    ratios = np.linspace(1.5, 10.0, 4001).tolist()
    grid = max(claims_by_formula(impulses, UNDAMPED, actuator, r)["residual"] for r in ratios)
    # A grid of 0.002 misses a peak by its curvature, |V| (w t_n 0.001)^2 / 2 at most.
    assert grid * (1 - 1e-12) <= found <= grid * (1 + 2e-4)
    if actuator is IDEAL:
        assert found <= np.abs(impulses.amplitudes).sum()


def test_the_unity_magnitude_zero_vibration_shaper_triples_its_third_harmonic_and_more() -> None:
    # 0, T/6, T/3: at three times the frequency the turns are 180 and 360 degrees, 1 + 1 + 1.
    impulses = design(UNDAMPED, IDEAL, SHAPERS["umzv"]).impulses
    assert high_mode_gain(impulses, UNDAMPED, IDEAL) == pytest.approx(3.0, abs=1e-9)


def test_scaling_time_changes_neither() -> None:
    slow = design(MODE, THESIS, SHAPERS["numzvd"]).impulses
    fast_drive = SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=200.0, damping_ratio=0.8),
        decel=SecondOrderSet(natural_frequency_rad_s=500.0, damping_ratio=1.5),
    )
    quick = Impulses(times_s=slow.times_s / 10, amplitudes=slow.amplitudes)
    faster = replace(MODE, natural_frequency_rad_s=35.0)
    for scaled, plain in (
        (
            largest_in_band(quick, faster, fast_drive, BAND, DAMPING),
            largest_in_band(slow, MODE, THESIS, BAND, DAMPING),
        ),
        (high_mode_gain(quick, faster, fast_drive), high_mode_gain(slow, MODE, THESIS)),
    ):
        assert scaled == pytest.approx(plain, rel=1e-9)
