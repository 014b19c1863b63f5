"""Modes and pendulums."""

import cmath
import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from tests.refusals import refused

FREQUENCIES = st.floats(1e-2, 1e3)
DAMPING_RATIOS = st.floats(0.0, 0.99)


@given(w=FREQUENCIES, z=DAMPING_RATIOS)
def test_the_pole_is_the_upper_root_of_the_characteristic_polynomial(w: float, z: float) -> None:
    pole = Mode(natural_frequency_rad_s=w, damping_ratio=z).pole_rad_s
    roots = np.roots([1.0, 2 * z * w, w * w])
    expected = roots[np.argmax(roots.imag)]
    # The companion matrix's eigenvalues are good to a few roundings of w.
    assert abs(pole - expected) <= 1e-13 * w


@given(w=FREQUENCIES, z=DAMPING_RATIOS, scale=st.floats(0.1, 10.0))
def test_frequency_scales_pole_and_period_inversely(w: float, z: float, scale: float) -> None:
    one = Mode(natural_frequency_rad_s=w, damping_ratio=z)
    other = Mode(natural_frequency_rad_s=w * scale, damping_ratio=z)
    # One multiplication, one rounding.
    assert cmath.isclose(other.pole_rad_s, scale * one.pole_rad_s, rel_tol=1e-15)
    assert math.isclose(other.period_s * scale, one.period_s, rel_tol=1e-15)


def test_the_unit_pole_lies_on_the_unit_circle() -> None:
    for z in (0.0, 0.1, 0.5):
        pole = Mode(natural_frequency_rad_s=7.0, damping_ratio=z).unit_pole
        assert abs(pole) == pytest.approx(1.0, abs=1e-15)  # one rounding
        assert pole.real == -z


def test_an_undamped_mode_swings_once_in_its_period() -> None:
    mode = Mode(natural_frequency_rad_s=3.7)
    # One rounding of pi, one of the quotient.
    assert cmath.isclose(cmath.exp(mode.pole_rad_s * mode.period_s), 1.0, rel_tol=1e-15)


def test_a_mode_is_its_own_mode() -> None:
    mode = Mode(natural_frequency_rad_s=2.0, damping_ratio=0.1)
    assert mode.mode is mode


def test_a_pendulum_swings_at_the_root_of_gravity_over_length() -> None:
    crane = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81, damping_ratio=0.02)
    assert crane.mode == Mode(natural_frequency_rad_s=math.sqrt(9.81 / 0.8), damping_ratio=0.02)


def test_a_seconds_pendulum_is_just_under_a_metre() -> None:
    # Half a period of one second: L = g / pi^2 = 0.99362 m at standard gravity.
    crane = Pendulum(cable_length_m=9.80665 / math.pi**2)
    assert crane.mode.period_s == pytest.approx(2.0, rel=1e-15)  # two roundings at most


def test_four_times_the_cable_takes_twice_the_time() -> None:
    short, long = Pendulum(cable_length_m=0.3), Pendulum(cable_length_m=1.2)
    assert long.mode.period_s == pytest.approx(2 * short.mode.period_s, rel=1e-15)


@pytest.mark.parametrize("record", [Mode(natural_frequency_rad_s=1.0), Pendulum(cable_length_m=1)])
def test_a_plant_cannot_be_changed_after_its_check(record: Mode | Pendulum) -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        record.damping_ratio = 2.0  # type: ignore[misc]


@pytest.mark.parametrize("value", [0.0, -3.0, math.nan, math.inf])
def test_a_frequency_must_be_positive(value: float) -> None:
    with refused("not_positive", "natural_frequency_rad_s"):
        Mode(natural_frequency_rad_s=value)


@pytest.mark.parametrize("value", [-0.01, 0.991, 1.0, math.nan])
def test_a_plant_must_swing(value: float) -> None:
    rule = r"^damping_ratio must be between 0 and 0\.99, got "
    with refused("out_of_range", "damping_ratio", says=rule):
        Mode(natural_frequency_rad_s=1.0, damping_ratio=value)
    with refused("out_of_range", "damping_ratio", says=rule):
        Pendulum(cable_length_m=1.0, damping_ratio=value)


def test_the_heaviest_damping_is_accepted() -> None:
    assert Mode(natural_frequency_rad_s=1.0, damping_ratio=0.99).pole_rad_s.real == -0.99


def test_a_cable_must_have_a_length() -> None:
    with refused("not_positive", "cable_length_m", says="finite and > 0, got 0"):
        Pendulum(cable_length_m=0.0)


def test_gravity_must_pull_down() -> None:
    with refused("not_positive", "gravity_m_s2", says="finite and > 0, got -9.8"):
        Pendulum(cable_length_m=1.0, gravity_m_s2=-9.8)


@pytest.mark.parametrize("value", [1e-300, 1e300])
def test_sizes_that_overflow_when_squared_are_refused(value: float) -> None:
    with refused("out_of_range", "cable_length_m", says=r"between 1e-12 and 1e\+12"):
        Pendulum(cable_length_m=value)
    with refused("out_of_range", "gravity_m_s2", says=r"between 1e-12 and 1e\+12"):
        Pendulum(cable_length_m=1.0, gravity_m_s2=value)
    with refused("out_of_range", "natural_frequency_rad_s", says="between 1e-12"):
        Mode(natural_frequency_rad_s=value)
