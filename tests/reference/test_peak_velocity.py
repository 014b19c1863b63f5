"""Kim 2011, appendix B: UMZVc and UMZVc2 with a peak velocity v_max, eqs. 1 to 6."""

import math

import pytest

from design.model.actuators.first_order import FirstOrder
from design.model.plants.mode import Mode
from design.moves.maneuvers import maneuver
from design.pipeline import design
from design.shapers.peak_options import PeakOptions
from design.shapers.registry import SHAPERS
from tests.refusals import refused
from tests.second_route import claims_by_formula

UMZVC = SHAPERS["umzvc"]


def start_times(w: float, tau_a: float, tau_b: float, v: float) -> tuple[float, float]:
    """Eqs. 1-3, with A_3 = 1."""
    beta = 2 * math.sqrt(((tau_a * w) ** 2 + 1) / ((tau_b * w) ** 2 + 1))
    t2 = (
        math.atan(1 / (w * tau_b))
        - math.atan(1 / (w * tau_a))
        + math.acos(1 / beta + beta / 4 - (1 / v) ** 2 / beta)
    ) / w
    t3 = math.acos(v / 2 * (beta**2 / 4 - 1) - 1 / (2 * v)) / w
    return t2, t3


def stop_times(w: float, tau_a: float, tau_b: float, v: float) -> tuple[float, float]:
    """Eqs. 4-6, from the first step of the stop."""
    beta = 2 * math.sqrt(((tau_b * w) ** 2 + 1) / ((tau_a * w) ** 2 + 1))
    t5 = (
        math.atan(1 / (w * tau_a))
        - math.atan(1 / (w * tau_b))
        + math.acos(1 / (beta * v) + beta * v / 4 - v / beta)
    ) / w
    t6 = math.acos(v * beta**2 / 8 - v / 2 - 1 / (2 * v)) / w
    return t5, t6


CASES = [
    (3.5, 0.1, 0.05, 1.0),
    (3.5, 0.1, 0.05, 1.3),
    (3.5, 0.05, 0.1, 1.3),
    (3.5, 0.1, 0.05, 0.8),
    (6.0, 0.08, 0.03, 2.5),
]


@pytest.mark.parametrize(("w", "tau_a", "tau_b", "v"), CASES)
def test_start_and_stop_are_those_of_appendix_b(
    w: float, tau_a: float, tau_b: float, v: float
) -> None:
    mode = Mode(natural_frequency_rad_s=w)
    drive = FirstOrder(accel_time_constant_s=tau_a, decel_time_constant_s=tau_b)
    options = PeakOptions(max_velocity_ratio=v)
    move = maneuver(mode, drive, UMZVC, speed_m_s=1.0, pulse_s=5.0, options=options)
    start, stop = move.start.times_s, move.stop.times_s - move.stop.times_s[0]
    assert start[1:].tolist() == pytest.approx(start_times(w, tau_a, tau_b, v), abs=1e-12)
    assert stop[1:].tolist() == pytest.approx(stop_times(w, tau_a, tau_b, v), abs=1e-12)
    assert claims_by_formula(move.command, mode, drive)["residual"] < 1e-12


def test_where_the_triangle_does_not_close_its_sides_are_told() -> None:
    # alpha = 1.9 and v_max = 3: of 3, 5.7 and 1 the second is longer than the others together.
    drive = FirstOrder(
        accel_time_constant_s=math.sqrt(1.9**2 * 1.01 - 1), decel_time_constant_s=0.1
    )
    with refused("diagram_open", says=r"does not close: of its sides 3, 5\.7 and 1 "):
        design(Mode(natural_frequency_rad_s=1.0), drive, UMZVC, PeakOptions(max_velocity_ratio=3.0))
