"""Lags and actuators: transfer functions, step responses, settling."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.second_order import SecondOrderSet
from design.model.lags import Lag
from design.model.settling import settling_time_s
from tests.refusals import refused
from tests.shaper_table import FIRST_ORDER, THESIS

SETS = st.builds(
    SecondOrderSet,
    natural_frequency_rad_s=st.floats(0.5, 100.0),
    damping_ratio=st.one_of(st.floats(0.1, 0.99), st.floats(1.01, 5.0), st.just(1.0)),
)
POLES = st.builds(complex, st.floats(-5.0, 0.0), st.floats(0.1, 20.0))


@given(one=SETS, pole=POLES)
def test_a_second_order_denominator_is_the_published_polynomial(
    one: SecondOrderSet, pole: complex
) -> None:
    w, z = one.natural_frequency_rad_s, one.damping_ratio
    terms = [pole * pole, 2 * z * w * pole, w * w]
    # Cancellation between the terms costs roundings of the largest.
    tolerance = 1e-14 * max(abs(term) for term in terms) / (w * w)
    assert abs(one.lag.denominator(pole) - sum(terms) / (w * w)) <= tolerance


def test_a_first_order_denominator_is_one_plus_tau_p() -> None:
    pole = complex(-0.3, 3.5)
    assert FIRST_ORDER.accel_lag.denominator(pole) == 1 + 0.03 * pole
    assert FIRST_ORDER.decel_lag.denominator(pole) == 1 + 0.012 * pole


def test_an_ideal_actuator_changes_nothing() -> None:
    assert Ideal().accel_lag.denominator(3.5j) == 1
    assert Ideal().decel_lag.denominator(3.5j) == 1
    assert settling_time_s(Ideal().accel_lag) == 0


def test_denominators_of_many_poles_are_those_of_each() -> None:
    poles = np.array([1j, complex(-0.2, 3.0), complex(-1.0, 20.0)])
    lag = THESIS.accel_lag
    assert lag.denominator(poles).tolist() == [lag.denominator(complex(p)) for p in poles]


DAMPINGS = [0.1, 0.8, 1 - 1e-4, 1 - 1e-9, 1.0, 1 + 1e-9, 1 + 1e-6, 1 + 1e-4, 1.5, 5.0]


@pytest.mark.parametrize("damping", DAMPINGS)
def test_the_step_error_is_the_free_response_of_the_lag(damping: float) -> None:
    from scipy.linalg import expm

    w = 7.0
    lag = SecondOrderSet(natural_frequency_rad_s=w, damping_ratio=damping).lag
    matrix = np.array([[0.0, w], [-w, -2 * damping * w]])
    for time in (0.0, 1e-9, 1e-3, 0.05, 0.3, 1.0, 4.0):
        expected = expm(matrix * time)[0] @ np.array([1.0, 0.0])
        # Near critical damping the two exponentials cancel: eps / root, root >= 1e-6 / phase.
        assert lag.step_error(time) == pytest.approx(expected, abs=1e-10)


def test_the_step_error_of_a_first_order_lag_is_an_exponential() -> None:
    assert Lag(first_s=0.2).step_error(0.3) == pytest.approx(math.exp(-1.5), rel=1e-15)


def test_a_lag_of_order_zero_has_no_step_error() -> None:
    assert Lag().step_error(0.0) == 0


def test_a_first_order_lag_settles_to_80_percent_in_log_5_time_constants() -> None:
    # 1 - 0.8 is not 0.2 to the last bit.
    assert settling_time_s(Lag(first_s=0.3)) == pytest.approx(0.3 * math.log(5), rel=1e-15)


def test_a_critical_lag_settles_where_its_closed_form_says() -> None:
    from scipy.optimize import brentq

    phase = brentq(lambda x: (1 + x) * math.exp(-x) - 0.2, 1, 10, xtol=1e-14)
    lag = SecondOrderSet(natural_frequency_rad_s=4.0, damping_ratio=1.0).lag
    assert 4.0 * settling_time_s(lag) == pytest.approx(phase, rel=1e-11)  # bisected to 1e-12


@settings(max_examples=80)
@given(one=SETS, share=st.sampled_from([0.5, 0.8, 0.9, 0.98]))
def test_settling_is_the_last_exit_from_the_band_of_a_dense_sampling(
    one: SecondOrderSet, share: float
) -> None:
    settled = settling_time_s(one.lag, share)
    times = np.linspace(0, 2 * settled + 3 / one.natural_frequency_rad_s, 3001)
    errors = np.abs([one.lag.step_error(time) for time in times.tolist()])
    last_outside = times[np.flatnonzero(errors > 1 - share)[-1]]
    # A lobe can leave the band for less than a sample: only there may the sampling be early.
    assert settled >= last_outside
    assert abs(one.lag.step_error(settled)) == pytest.approx(1 - share, rel=1e-9)
    assert (errors[times > settled * (1 + 1e-9)] <= 1 - share).all()


@given(one=SETS, scale=st.floats(0.1, 10.0))
def test_settling_scales_with_time(one: SecondOrderSet, scale: float) -> None:
    slower = Lag(first_s=one.lag.first_s * scale, second_s2=one.lag.second_s2 * scale**2)
    # Bisected to 1e-12 on either side.
    assert settling_time_s(slower) == pytest.approx(scale * settling_time_s(one.lag), rel=1e-11)


def test_the_second_overshoot_counts_when_it_leaves_the_band() -> None:
    # Damping 0.1: extrema exp(-0.3157 k) high; the fifth, 0.206, is outside 20 %, the sixth not.
    lag = SecondOrderSet(natural_frequency_rad_s=1.0, damping_ratio=0.1).lag
    half = math.pi / math.sqrt(1 - 0.1**2)
    assert 5 * half < settling_time_s(lag) < 6 * half


def test_corner_frequencies_are_told_of_each_set_that_lags() -> None:
    assert THESIS.corner_frequencies_rad_s == {"accel": 20.0, "decel": 50.0}
    assert FirstOrder(
        accel_time_constant_s=0.25, decel_time_constant_s=0.0
    ).corner_frequencies_rad_s == {"accel": 4.0}
    assert Ideal().corner_frequencies_rad_s == {}


def test_a_time_constant_of_zero_is_an_ideal_set() -> None:
    actuator = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.0)
    assert actuator.decel_lag == Ideal().decel_lag
    assert actuator.accel_lag == Lag(first_s=0.1)


@pytest.mark.parametrize("value", [-0.1, 1e-310, 1e300, math.nan, math.inf])
@pytest.mark.parametrize("name", ["accel_time_constant_s", "decel_time_constant_s"])
def test_a_time_constant_must_be_zero_or_of_a_size_to_compute_with(name: str, value: float) -> None:
    values: dict[str, Any] = {
        "accel_time_constant_s": 0.1,
        "decel_time_constant_s": 0.1,
        name: value,
    }
    with refused("out_of_range", says=rf"^{name} must be 0, or between 1e-12 and 1e"):
        FirstOrder(**values)


@pytest.mark.parametrize("value", [0.0, -20.0, math.nan, math.inf])
def test_a_set_needs_a_frequency(value: float) -> None:
    with refused("not_positive", "natural_frequency_rad_s"):
        SecondOrderSet(natural_frequency_rad_s=value, damping_ratio=0.8)


@pytest.mark.parametrize("value", [0.0, 0.099, 5.001, math.nan])
def test_a_set_damping_must_be_that_of_a_drive(value: float) -> None:
    with refused("out_of_range", "damping_ratio", says=r"between 0\.1 and 5, got "):
        SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=value)
