"""A reference of limited jerk: its course, and what lags and mode make of it."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from design.analysis.ramp_figures import ramp_figures
from design.analysis.residual import residual_vectors, residual_vibration
from design.analysis.residuals_of_many import vectors_of_many
from design.analysis.terms import terms_of_residual
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.commands import pulse, step
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.ramps import ramp_factors
from design.model.reference_ramps import reference
from design.pipeline import design
from design.response.closed_form import history, travel
from design.response.simulated_history import simulated_history
from design.response.simulation import ringing_after
from design.shapers.registry import SHAPERS
from design.types import FloatArray
from tests.design.model.actuators.test_rate_limited import random_case
from tests.jerk_route import integrate_jerk_limited
from tests.refusals import refused
from tests.shaper_table import CRANE, LIMITED

# To full speed in 0.2 s at the limit and 0.05 s to the limit; from it in 0.08 s and 0.125 s.
ALONE = RateLimited(accel_limit_m_s2=1.0, decel_limit_m_s2=2.5, speed_m_s=0.2, jerk_limit_m_s3=20.0)


def jerky_case(seed: int) -> tuple[Impulses, Mode, RateLimited]:
    """Any command, behind limits to acceleration and jerk that cut its ramps anywhere."""
    impulses, mode, actuator = random_case(seed)
    rng = np.random.default_rng(1000 + seed)
    jerk = float(10 ** rng.uniform(-0.5, 3.5))
    return impulses, mode, replace(actuator, jerk_limit_m_s3=jerk)


def course(command: Impulses, actuator: RateLimited) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Levels after each piece, and slopes at their beginnings and ends, by the pieces alone."""
    made = reference(command, actuator)
    means = made.changes / made.ramps_s
    return np.cumsum(made.changes), means * (1 - made.bends), means * (1 + made.bends)


def test_a_step_becomes_a_ramp_that_begins_and_ends_evenly() -> None:
    made = reference(step(), ALONE)
    np.testing.assert_allclose(made.times_s, [0.0, 0.05, 0.2], atol=1e-15)
    np.testing.assert_allclose(made.ramps_s, [0.05, 0.15, 0.05], atol=1e-15)
    np.testing.assert_allclose(made.changes, [0.125, 0.75, 0.125], atol=1e-15)
    np.testing.assert_allclose(made.bends, [1.0, 0.0, -1.0], atol=1e-12)
    assert made.accelerates.all()
    assert ALONE.unit_ramps_s[0] == pytest.approx(0.25, rel=1e-15)
    # Too gentle a jerk to reach the limit: half of the way up, half of it down.
    gentle = replace(ALONE, jerk_limit_m_s3=0.8)
    assert reference(step(), gentle).ramps_s == pytest.approx([0.5, 0.5], rel=1e-14)
    assert gentle.unit_ramps_s == pytest.approx((1.0, 1.0), rel=1e-15)


def test_a_ramp_that_is_turned_goes_on_until_its_slope_is_gone() -> None:
    made = reference(pulse(0.05), ALONE)  # at full slope it is told to go back
    levels, begins, ends = course(pulse(0.05), ALONE)
    assert made.accelerates.tolist() == [True, True, False, False]
    assert levels[1] == pytest.approx(0.25, rel=1e-14)
    assert ends[:2] == pytest.approx([5.0, 0.0], abs=1e-12)
    assert levels[-1] == pytest.approx(0.0, abs=1e-15)
    assert begins[3] == pytest.approx(ends[2], rel=1e-12)


def test_a_reversal_rests_at_zero() -> None:
    reversal = Impulses(times_s=np.array([0.0, 1.0]), amplitudes=np.array([1.0, -2.0]))
    made = reference(reversal, ALONE)
    levels, begins, ends = course(reversal, ALONE)
    turn = int(np.flatnonzero(np.abs(levels) < 1e-12)[0])
    assert ends[turn] == pytest.approx(0.0, abs=1e-12)
    assert begins[turn + 1] == pytest.approx(0.0, abs=1e-12)
    assert levels[-1] == pytest.approx(-1.0, rel=1e-14)
    end = 1.0 + sum(ALONE.unit_ramps_s)
    assert made.times_s[-1] + made.ramps_s[-1] == pytest.approx(end, rel=1e-14)


@pytest.mark.parametrize("seed", range(200))
def test_the_course_keeps_its_limits(seed: int) -> None:
    impulses, _, actuator = jerky_case(seed)
    made = reference(impulses, actuator)
    levels, begins, ends = course(impulses, actuator)
    rise, fall, jerk = (
        limit / actuator.speed_m_s
        for limit in (
            actuator.accel_limit_m_s2,
            actuator.decel_limit_m_s2,
            actuator.jerk_limit_m_s3 or 0.0,
        )
    )
    limits = np.where(made.accelerates, rise, fall) * (1 + 1e-9)
    assert (np.abs(begins) <= limits).all()
    assert (np.abs(ends) <= limits).all()
    assert (np.abs(ends - begins) <= jerk * made.ramps_s + 1e-9 * limits).all()
    # Without a jump of the slope where one piece follows another.
    held = made.times_s[1:] - made.times_s[:-1] - made.ramps_s[:-1]
    assert (held > -1e-12).all()
    joined = np.abs(held) < 1e-12
    np.testing.assert_allclose(ends[:-1][joined], begins[1:][joined], atol=1e-9 * (rise + fall))
    commanded = np.cumsum(impulses.amplitudes)
    assert levels[-1] == pytest.approx(float(commanded[-1]), abs=1e-12)
    if set(np.round(commanded, 9).tolist()) <= {0.0, 1.0}:
        assert levels.min() >= -1e-12
        assert levels.max() <= 1 + 1e-12


@pytest.mark.parametrize("seed", range(60))
def test_the_histories_agree_with_an_integrator(seed: int) -> None:
    impulses, mode, actuator = jerky_case(seed)
    end = float(impulses.times_s[-1]) + (0.05, 0.7, 3.0)[seed % 3]
    deflection, _, velocity, _ = integrate_jerk_limited(impulses, mode, actuator, end)
    for route in (history, simulated_history):
        told = route(impulses, mode, actuator, np.array([end]))
        assert told.velocity[0] == pytest.approx(velocity, abs=1e-8)
        assert told.deflection[0] == pytest.approx(
            deflection * mode.natural_frequency_rad_s, abs=1e-8
        )


@pytest.mark.parametrize("seed", range(100))
def test_the_formula_agrees_with_the_simulation(seed: int) -> None:
    impulses, mode, actuator = jerky_case(seed)
    ringing, unit, _ = ringing_after(
        impulses, actuator, np.array([mode.natural_frequency_rad_s]), mode.damping_ratio
    )
    vector = residual_vectors(impulses, np.array([mode.pole_rad_s]), actuator)[0]
    assert abs(ringing[0] / unit[0] - vector) < 1e-10 * max(1.0, abs(vector))
    terms = terms_of_residual(impulses, mode.pole_rad_s, actuator)
    assert abs(abs(terms.sum()) - abs(vector)) < 1e-12 * max(1.0, abs(vector))
    alone = vectors_of_many(
        impulses.times_s[None], impulses.amplitudes, np.array([mode.pole_rad_s]), actuator
    )
    assert abs(alone[0] - vector) < 1e-12 * max(1.0, abs(vector))


@pytest.mark.parametrize("seed", range(30))
def test_both_histories_agree_at_all_times(seed: int) -> None:
    impulses, mode, actuator = jerky_case(seed)
    times = np.linspace(-0.1, 5.0, 200)
    closed, simulated = (
        route(impulses, mode, actuator, times) for route in (history, simulated_history)
    )
    for name in ("command", "velocity", "deflection"):
        assert getattr(closed, name) == pytest.approx(getattr(simulated, name), abs=1e-10)


@pytest.mark.parametrize("turn", [1e-9, 0.3, 3.9, 4.1, 30.0])
def test_factors_of_bent_ramps_are_means_of_the_swing(turn: float) -> None:
    pole = np.array([[complex(-0.07, 1.0)]])
    nodes, weights = np.polynomial.legendre.leggauss(200)
    at, bends = (nodes + 1) / 2, np.array([1.0, -0.4])
    means = [
        np.sum(weights / 2 * (1 + bend * (2 * at - 1)) * np.exp(-pole[0, 0] * turn * at))
        for bend in bends.tolist()
    ]
    factors = ramp_factors(pole, np.full(2, turn), bends)[0]
    np.testing.assert_allclose(factors, means, rtol=1e-13)


def test_a_smooth_ramp_alone_swings_by_the_product_of_two() -> None:
    # A trapezoid of slope is a box of 0.2 s over one of 0.05 s: two ramps, one after the other.
    mode = Mode(natural_frequency_rad_s=7.0)
    wanted = math.prod(abs(math.sin(3.5 * length) / (3.5 * length)) for length in (0.2, 0.05))
    assert residual_vibration(step(), mode, ALONE) == pytest.approx(wanted, rel=1e-13)
    figures = ramp_figures(step(), (mode,), ALONE)
    assert figures.unshaped_residual == pytest.approx(wanted, rel=1e-13)
    assert figures.end_s == pytest.approx(0.25, rel=1e-14)


def test_travel_of_a_smooth_pulse_is_its_area() -> None:
    # Ramps are even about their middles: up 0.25 s, down 0.2 / 2.5 + 2.5 / 20 s.
    down = 2 * math.sqrt(0.2 / 20)
    assert travel(pulse(1.0), ALONE) == pytest.approx(1.0 - 0.125 + down / 2, rel=1e-14)


def test_a_jerk_beyond_reach_is_no_limit() -> None:
    straight = replace(ALONE, jerk_limit_m_s3=None)
    fast = replace(ALONE, jerk_limit_m_s3=1e10)
    for command in (step(), pulse(0.05), pulse(0.5)):
        assert residual_vibration(command, CRANE.mode, fast) == pytest.approx(
            residual_vibration(command, CRANE.mode, straight), abs=1e-8
        )


@pytest.mark.parametrize(
    ("jerk", "code"),
    [(0.0, "not_positive"), (-1.0, "not_positive"), (math.inf, "not_positive")],
)
def test_a_bad_limit_is_named(jerk: float, code: str) -> None:
    with refused(code, "jerk_limit_m_s3"):
        replace(LIMITED, jerk_limit_m_s3=jerk)


@pytest.mark.parametrize(
    ("changes", "code", "field"),
    [
        ({"jerk_limit_m_s3": 1e-4}, "jerk_limit_too_small", "actuator.jerk_limit_m_s3"),
        ({"accel_limit_m_s2": 1e-3}, "ramp_too_long", "actuator.accel_limit_m_s2"),
    ],
)
def test_the_limit_that_makes_a_ramp_too_long_is_named(
    changes: dict[str, Any], code: str, field: str
) -> None:
    with refused(code, field):
        design(CRANE, replace(ALONE, **changes), SHAPERS["numzvd"])


@pytest.mark.parametrize("kind", ["numzv", "numzvd", "num_si", "num_ei"])
def test_what_knows_straight_ramps_alone_refuses(kind: str) -> None:
    limited = replace(LIMITED, jerk_limit_m_s3=3000.0)
    with refused("jerk_not_served", "actuator.jerk_limit_m_s3"):
        design(CRANE, limited, SHAPERS[kind])


@pytest.mark.parametrize("kind", ["zvd", "ei", "umzv"])
def test_what_knows_no_actuator_tells_its_residual(kind: str) -> None:
    limited = replace(LIMITED, jerk_limit_m_s3=3000.0)
    made = design(CRANE, limited, SHAPERS[kind])
    assert made.for_ideal
    assert made.certificate.verified
    ideal = design(CRANE, Ideal(), SHAPERS[kind])
    np.testing.assert_allclose(made.impulses.times_s, ideal.impulses.times_s)
    assert made.residual == residual_vibration(made.impulses, CRANE.mode, limited) > 1e-5
