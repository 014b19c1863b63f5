"""Numbers of the literature for shapers with given negative amplitudes."""

import math
from itertools import product

import numpy as np
import pytest

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.moves.maneuvers import maneuver
from design.pipeline import design
from design.shapers.negative import NegativeOptions
from design.shapers.registry import SHAPERS
from tests.integration_route import residual_by_integration
from tests.reference.firmware_shapers import shaper
from tests.refusals import refused
from tests.shaper_table import CRANE, IDEAL


@pytest.mark.parametrize("b", [0.0, 1.1, -0.5, math.nan])
def test_a_negative_amplitude_has_bounds(b: float) -> None:
    with refused("out_of_range", "negative_amplitude"):
        NegativeOptions(negative_amplitude=b)


@pytest.mark.parametrize("z", [0.0, 0.1, 0.3])
def test_given_negative_amplitudes_lead_from_zv_to_unity_magnitude(z: float) -> None:
    durations = []
    for b in (1e-6, 0.2, 0.4, 0.6, 0.8, 1.0):
        made = shaper("sna_zv", z, NegativeOptions(negative_amplitude=b))
        assert made.amplitudes[1] == -b
        assert made.amplitudes.max() <= 1
        durations.append(made.duration_s)
    assert durations == sorted(durations, reverse=True)
    assert durations[0] == pytest.approx(shaper("zv", z).duration_s, rel=1e-6)
    # Roots are found to 1e-12.
    assert durations[-1] == pytest.approx(shaper("umzv", z).duration_s, rel=1e-9)


@pytest.mark.parametrize("z", [0.0, 0.1])
@pytest.mark.parametrize("b", [0.3, 0.8])
def test_no_other_split_of_the_positive_impulses_is_faster_by_much(z: float, b: float) -> None:
    made = shaper("sna_zv", z, NegativeOptions(negative_amplitude=b))
    k = z / math.sqrt(1 - z * z)
    end = 2 * math.pi * math.sqrt(1 - z * z) * made.duration_s
    # The sum of the outer vectors is longer than the inner one in its direction for every shorter
    # duration, and just as long for this one.
    # Damped, the inner one grows on the way: half a thousandth is left at z = 0.1.
    last = np.linspace(0.0, (0.9999 if z == 0 else 0.9995) * end, 2000)[:, None]
    first = np.linspace(b, 1.0, 501)
    outer = first + (1 + b - first) * np.exp((k - 1j) * last)
    assert (np.abs(outer) > b * np.exp(-k * np.angle(outer))).all()
    own = made.amplitudes[0] + made.amplitudes[2] * np.exp((k - 1j) * end)
    assert abs(own) == pytest.approx(b * math.exp(-k * float(np.angle(own))), rel=1e-12)


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize("z", [0.0, 0.1])
def test_given_negative_amplitudes_are_exact_behind_an_asymmetric_actuator(
    model: str, z: float
) -> None:
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=z)
    drives: list[Actuator] = [
        FirstOrder(
            accel_time_constant_s=0.03,
            decel_time_constant_s=0.012,
            model="switched" if model == "switched" else "superposed",
        ),
        SecondOrder(
            accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8),
            decel=SecondOrderSet(natural_frequency_rad_s=50.0, damping_ratio=1.5),
            model="switched" if model == "switched" else "superposed",
        ),
    ]
    for actuator, b in product(drives, (0.2, 0.7, 1.0)):
        options = NegativeOptions(negative_amplitude=b)
        made = design(mode, actuator, SHAPERS["sna_zv"], options)
        assert made.impulses.amplitudes[1] == -b
        assert residual_by_integration(made.impulses, mode, actuator) < 1e-7


def test_an_undamped_shaper_of_partial_sums_is_a_triangle_of_sides_1_2_2() -> None:
    made = shaper("ps_zv")
    assert made.amplitudes.tolist() == [1, -2, 2]
    # 1 + 2 exp(-j t3) = 2 exp(-j t2): the law of cosines at either end of the side of 1.
    second, third = math.acos(1 / 4), math.acos(-1 / 4)
    assert made.times_s[1] == pytest.approx(second / (2 * math.pi), rel=1e-14)
    assert made.times_s[2] == pytest.approx(third / (2 * math.pi), rel=1e-14)
    assert made.duration_s < shaper("umzv").duration_s


@pytest.mark.parametrize("name", ["zvd", "um_ei", "ps_zv", "ps_zvd", "sna_zv", "sna_zvd"])
def test_a_move_needs_unity_magnitude_that_leaves_nothing(name: str) -> None:
    with refused("move_not_served", "shaper.kind"):
        maneuver(CRANE, IDEAL, SHAPERS[name], speed_m_s=0.2, distance_m=1.0)
