"""Every kind of shaper: closed forms, limits, and its claims by another route."""

import dataclasses
import math
import pickle
from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from design.claims import ZERO_LIMITS
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.pipeline import design
from design.shapers.peak_options import PeakOptions
from design.shapers.registry import SHAPERS
from design.shapers.settle_options import SettleOptions
from design.types import FloatArray
from tests.integration_route import residual_by_integration
from tests.second_route import (
    claims_by_formula,
    ideal_derivative_by_formula,
    largest_in_band_by_formula,
)
from tests.shaper_table import CRANE, DAMPED, FIRST_ORDER, IDEAL, PLANTS, SHAPER_TABLE, THESIS

CASES = [
    pytest.param(name, *case, id=f"{name}-{number}")
    for name, row in SHAPER_TABLE.items()
    for number, case in enumerate(product(row.plants, row.actuators, row.options))
]

TIME_CONSTANTS = st.one_of(st.just(0.0), st.floats(1e-9, 0.3))


def times(name: str, plant: Plant, actuator: Actuator, options: Any = None) -> FloatArray:
    return design(plant, actuator, SHAPERS[name], options).impulses.times_s


def test_every_kind_of_shaper_has_its_row_in_the_table() -> None:
    linear = [name for name, kind in SHAPERS.items() if not kind.large_swings]
    assert sorted(SHAPER_TABLE) == sorted(linear)  # tests/design/shapers/test_num_large.py


def test_every_row_tries_each_actuator_that_its_shaper_serves() -> None:
    for name, row in SHAPER_TABLE.items():
        assert {one.kind for one in row.actuators} == set(SHAPERS[name].actuators), name


@pytest.mark.parametrize(("name", "plant", "actuator", "options"), CASES)
def test_a_shaper_holds_its_claims_by_the_textbook_formula(
    name: str,
    plant: Plant,
    actuator: Actuator,
    options: Any,
) -> None:
    kind = SHAPERS[name]
    made = design(plant, actuator, kind, options)
    shaper = made.impulses
    row = SHAPER_TABLE[name]
    assert shaper.amplitudes.size == row.impulses
    assert shaper.amplitudes.sum() == pytest.approx(1.0, abs=1e-15)
    if row.unity:
        wanted = [(-1.0) ** i for i in range(row.impulses)]
        if isinstance(options, PeakOptions):
            wanted[:2] = [options.max_velocity_ratio, -options.max_velocity_ratio]
        assert shaper.amplitudes.tolist() == wanted
    assert shaper.times_s[0] == 0
    assert (np.diff(shaper.times_s) > 0).all()
    designed_for = Ideal() if actuator.kind in row.for_ideal else actuator
    found = claims_by_formula(shaper, plant.mode, designed_for)
    orders = {"second_derivative": 2, "third_derivative": 3}
    for claim in made.certificate.claims:
        if claim.quantity in orders:
            # V is zero to rounding, and so is what G adds to its derivatives; s t is up to 13.
            value = ideal_derivative_by_formula(shaper, plant.mode, orders[claim.quantity])
            assert value <= 1e-11, claim.quantity
        elif claim.band is not None:
            value = largest_in_band_by_formula(shaper, plant.mode, designed_for, claim.band, 400)
            # A peak may lie between two of 400 points: a curvature of 100 over (1/800)^2.
            assert (1 - 1e-3) * claim.limit <= value <= (1 + 1e-9) * claim.limit
        elif claim.limit > 1e-7:
            assert found[claim.quantity] == pytest.approx(claim.limit, rel=1e-9)
        else:
            # Newton ends at 1e-13; the slope has phases up to 20 rad in front.
            assert found[claim.quantity] <= 1e-11, claim.quantity
    if name in {"ps_zv", "ps_zvd"} and actuator.kind == "rate_limited":
        # Its ramps pass zero, each at two rates, of which the formula knows one.
        told = residual_by_integration(shaper, plant.mode, actuator)
        assert made.residual == pytest.approx(told, rel=1e-6)
        return
    told = claims_by_formula(shaper, plant.mode, actuator)["residual"]
    assert made.residual == pytest.approx(told, abs=1e-12)


@pytest.mark.parametrize(("name", "plant", "actuator", "options"), CASES)
def test_a_shaper_settles_where_asked_and_stays_within_its_horizon(
    name: str,
    plant: Plant,
    actuator: Actuator,
    options: Any,
) -> None:
    made = times(name, plant, actuator, options)
    horizon = options.max_duration_periods if isinstance(options, SettleOptions) else 3.0
    assert made[-1] <= horizon * plant.mode.period_s
    if isinstance(options, SettleOptions) and options.settle:
        for gap, lag in zip(
            np.diff(made).tolist(),
            [actuator.accel_lag, actuator.decel_lag] * 2,
            strict=False,
        ):
            assert abs(lag.step_error(gap)) <= 0.2 + 1e-9  # bounds of gaps are kept to 1e-8


def test_an_undamped_umzv_switches_at_a_sixth_and_a_third_of_the_period() -> None:
    made = times("umzv", CRANE, IDEAL)
    assert made == pytest.approx(CRANE.mode.period_s * np.array([0, 1 / 6, 1 / 3]), rel=1e-15)


@given(accel=TIME_CONSTANTS, decel=TIME_CONSTANTS)
def test_an_undamped_umzvc_is_the_published_closed_form(accel: float, decel: float) -> None:
    w = 3.5
    actuator = FirstOrder(accel_time_constant_s=accel, decel_time_constant_s=decel)
    r = math.sqrt(((accel * w) ** 2 + 1) / ((decel * w) ** 2 + 1))
    # atan(1/x) is pi/2 - atan(x), which serves x = 0 too.
    t2 = (math.atan(accel * w) - math.atan(decel * w) + math.acos(r / 2)) / w
    t3 = math.acos(r * r / 2 - 1) / w
    made = times("umzvc", Mode(natural_frequency_rad_s=w), actuator)
    if 1e-5 < t2 < t3 - 1e-5:
        # acos(r^2/2 - 1) loses half its digits nowhere here: r < 1.5.
        assert made == pytest.approx([0, t2, t3], abs=1e-13)
    else:
        assert made[-1] > t3


def test_with_an_instant_stop_the_published_umzvc_is_out_of_order_above_root_two() -> None:
    w = 2.0
    for accel, ordered in ((0.99 / w, True), (1.01 / w, False)):  # alpha = sqrt(1 + (tau w)^2)
        actuator = FirstOrder(accel_time_constant_s=accel, decel_time_constant_s=0.0)
        made = times("umzvc", Mode(natural_frequency_rad_s=w), actuator)
        assert (made[-1] < math.pi / w) == ordered


@settings(max_examples=50)
@given(w1=st.floats(8, 60), w2=st.floats(8, 60), z1=st.floats(0.5, 1.5), z2=st.floats(0.5, 1.5))
def test_an_undamped_numzv_is_the_published_closed_form(
    w1: float, w2: float, z1: float, z2: float
) -> None:
    w = 3.5
    actuator = SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=w1, damping_ratio=z1),
        decel=SecondOrderSet(natural_frequency_rad_s=w2, damping_ratio=z2),
    )
    gains = [a * a / (a * a - w * w + 2j * z * a * w) for a, z in ((w1, z1), (w2, z2))]
    alpha, beta = abs(gains[1] / gains[0]), -np.angle(gains[1] / gains[0])
    t2, t3 = (math.acos(alpha / 2) - beta) / w, 2 * math.acos(alpha / 2) / w
    made = times("numzv", Mode(natural_frequency_rad_s=w), actuator)
    if 1e-5 < t2 < t3 - 1e-5:
        assert made == pytest.approx([0, t2, t3], abs=1e-13)
    else:
        assert made[-1] > t3


@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize(("plain", "aware"), [("umzv", "numzv"), ("umzvd", "numzvd")])
def test_equal_sets_need_no_compensation(plant: Plant, plain: str, aware: str) -> None:
    # V = G(s) times the ideal actuator's: both have the same zeros, of value and of slope.
    w = plant.mode.natural_frequency_rad_s
    one = SecondOrderSet(natural_frequency_rad_s=5 * w, damping_ratio=0.7)
    made = times(aware, plant, SecondOrder(accel=one, decel=one))
    # Roots are found to 1e-13 of a radian or so, with derivatives of order one.
    assert w * made == pytest.approx(w * times(plain, plant, IDEAL), abs=1e-10)


@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize(("plain", "aware"), [("umzv", "numzv"), ("umzvd", "numzvd")])
def test_a_fast_actuator_tends_to_an_ideal_one(plant: Plant, plain: str, aware: str) -> None:
    w = plant.mode.natural_frequency_rad_s
    ideal = times(plain, plant, IDEAL)
    gaps = []
    for tau in (1e-3, 1e-4):
        actuator = FirstOrder(accel_time_constant_s=tau / w, decel_time_constant_s=0.3 * tau / w)
        gaps.append(w * np.abs(times(aware, plant, actuator) - ideal).max())
    assert gaps[0] <= 5e-3  # the lags themselves, and a factor of a few for five impulses
    assert gaps[1] == pytest.approx(gaps[0] / 10, rel=0.02)  # first order in the lag


@pytest.mark.parametrize("actuator", [IDEAL, FIRST_ORDER, THESIS])
def test_the_damped_solution_tends_to_the_undamped_closed_form(actuator: Actuator) -> None:
    closed = times("numzv", Mode(natural_frequency_rad_s=3.5), actuator)
    for z in (1e-4, 1e-6):
        solved = times("numzv", Mode(natural_frequency_rad_s=3.5, damping_ratio=z), actuator)
        # The slope of UMZV's times in z is 0.3 periods at most (its polynomials).
        assert np.abs(solved - closed).max() <= 0.5 * z * 1.8


@pytest.mark.parametrize("name", SHAPER_TABLE)
@pytest.mark.parametrize("scale", [0.01, 7.0, 1000.0])
def test_times_scale_with_plant_and_actuator(name: str, scale: float) -> None:
    slow_mode = Mode(natural_frequency_rad_s=4.0 / scale, damping_ratio=0.08)
    if name == "umzvc":
        fast: Actuator = FIRST_ORDER
        slow: Actuator = FirstOrder(
            accel_time_constant_s=0.03 * scale, decel_time_constant_s=0.012 * scale
        )
    else:
        fast = THESIS
        slow = SecondOrder(
            accel=SecondOrderSet(natural_frequency_rad_s=20 / scale, damping_ratio=0.8),
            decel=SecondOrderSet(natural_frequency_rad_s=50 / scale, damping_ratio=1.5),
        )
    # Roots are found to 1e-12 in the equations.
    assert times(name, slow_mode, slow) / scale == pytest.approx(
        times(name, DAMPED, fast), abs=1e-11
    )


def test_no_three_steps_of_unit_magnitude_are_faster_than_umzv() -> None:
    # t3 < T/3: the two outer vectors are less than 120 degrees apart and sum to more than one.
    phases = np.linspace(0.01, 2 * math.pi / 3 - 0.01, 60)
    mode = Mode(natural_frequency_rad_s=1.0)
    for last in phases.tolist():
        for middle in np.linspace(0, last, 20).tolist():
            command = Impulses(
                times_s=np.array([0.0, middle, last]), amplitudes=np.array([1.0, -1.0, 1.0])
            )
            assert claims_by_formula(command, mode, Ideal())["residual"] > 1e-3


def test_every_entry_is_listed_under_its_own_name_with_words_for_the_catalogue() -> None:
    for name, kind in SHAPERS.items():
        assert kind.name == name
        assert kind.summary.endswith(".")
        assert kind.source
        assert set(kind.claims) <= {*ZERO_LIMITS, "band"}
        assert {"residual", "band"} & set(kind.claims)


def test_every_option_has_a_description_and_a_default() -> None:
    for kind in SHAPERS.values():
        for field in dataclasses.fields(kind.options):
            assert field.metadata["description"].endswith("."), field.name
            assert kind.options() == kind.options()


@pytest.mark.parametrize("name", SHAPERS)
def test_a_kind_can_be_sent_to_a_worker_process(name: str) -> None:
    kind = SHAPERS[name]
    sent = pickle.loads(pickle.dumps(kind))
    assert (sent.name, sent.claims, sent.options) == (kind.name, kind.claims, kind.options)
    assert sent.actuators == kind.actuators
