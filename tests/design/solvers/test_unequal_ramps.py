"""Courses behind two lags: what is left, its derivatives, programs, and the search."""

import math

import numpy as np
import pytest

from design.formulations.ramped import ramped_problem
from design.formulations.ramped_move import ramped_move
from design.formulations.unequal_ramps import UnequalRampsProblem, unequal_ramps
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited, Unlimited
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.solvers.budget import Budget
from design.solvers.ramps.search import candidates
from design.solvers.ramps.unequal_course import TwoLags
from design.solvers.ramps.unequal_program import solve_near, solve_program
from design.solvers.ramps.unequal_search import fastest_from
from design.types import FloatArray
from tests import expm_route

MODE = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.06)

COMMANDS = {
    "each ramp is over": [0.0, 3.0, 6.0, 9.0, 12.0],
    "turned midway": [0.0, 0.8, 1.5, 5.0, 5.5],
    "turned three times": [0.0, 0.9, 1.4, 2.2, 2.8],
}


def lags(order: int, model: Model) -> Unlimited:
    if order == 1:
        return FirstOrder(accel_time_constant_s=0.12, decel_time_constant_s=0.03, model=model)
    return SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.6),
        decel=SecondOrderSet(natural_frequency_rad_s=40.0, damping_ratio=1.5),
        model=model,
    )


def drive(order: int, model: Model) -> RateLimited:
    return RateLimited(
        accel_limit_m_s2=1.6, decel_limit_m_s2=2.5, speed_m_s=0.8, then=lags(order, model)
    )


def command(phases: FloatArray) -> Impulses:
    steps = np.where(np.arange(phases.size) % 2 == 0, 1.0, -1.0)
    return Impulses(times_s=phases / MODE.natural_frequency_rad_s, amplitudes=steps)


def shaper(limited: RateLimited, derivatives: int = 1) -> UnequalRampsProblem:
    alike = ramped_problem((MODE,), limited, derivatives=derivatives, max_duration_periods=3.0)
    return unequal_ramps(alike, limited)


DRIVES = [
    pytest.param(drive(order, model), id=f"{model}, order {order}")
    for order in (1, 2)
    for model in ("superposed", "switched")
]


@pytest.mark.parametrize("limited", DRIVES)
@pytest.mark.parametrize("far", [1e4, 1e8, 1e200])
def test_a_step_of_a_search_that_goes_too_far_is_no_number_and_no_warning(
    limited: RateLimited, far: float
) -> None:
    course = TwoLags(shaper(limited)).of(np.array([0.0, far, 1.5 * far, 2 * far, 3 * far]))
    assert not np.isfinite(course.values).any()


@pytest.mark.parametrize("limited", DRIVES)
@pytest.mark.parametrize("phases", COMMANDS.values(), ids=COMMANDS)
def test_what_is_left_is_that_of_matrix_exponentials(
    limited: RateLimited, phases: list[float]
) -> None:
    at = np.array(phases)
    course = TwoLags(shaper(limited)).of(at)
    played = expm_route.outcome(command(at), MODE, limited)
    # Both are seen at the first step; the steps' own phase is that of the unit.
    assert course.values[0] == pytest.approx(played.vector / played.unit, abs=1e-12)
    assert course.end / 3.5 == pytest.approx(expm_route.end_s(command(at), limited), abs=1e-12)


@pytest.mark.parametrize("limited", DRIVES)
@pytest.mark.parametrize("phases", COMMANDS.values(), ids=COMMANDS)
def test_derivatives_are_those_of_small_differences(
    limited: RateLimited, phases: list[float]
) -> None:
    at, small = np.array([*phases, phases[-1] + 4.0]), 1e-6
    move = unequal_ramps(
        ramped_move(MODE, limited, derivatives=1, travel_s=3.0, swing=None), limited
    )
    behind = TwoLags(move)
    course = behind.of(at)
    for number in range(1, at.size):
        step = small * (np.arange(at.size) == number)
        after, before = behind.of(at + step), behind.of(at - step)
        for name, changes in (
            ("values", course.changes),
            ("levels", course.level_changes),
            ("ends", course.end_changes),
        ):
            slope = (getattr(after, name) - getattr(before, name)) / (2 * small)
            np.testing.assert_allclose(changes[:, number], slope, atol=1e-6)


@pytest.mark.parametrize("limited", DRIVES)
def test_the_slope_is_that_of_frequencies_beside(limited: RateLimited) -> None:
    at, small = np.array(COMMANDS["turned midway"]), 1e-5
    course = TwoLags(shaper(limited)).of(at)
    vectors = []
    for ratio in (1 - small, 1 + small):
        w = ratio * MODE.natural_frequency_rad_s
        beside = Mode(natural_frequency_rad_s=w, damping_ratio=MODE.damping_ratio)
        played = expm_route.outcome(command(at), beside, limited)
        vectors.append(played.vector / played.unit)
    s = MODE.pole_rad_s / MODE.natural_frequency_rad_s
    # Over the gain of the accelerating set at each frequency, so that s alone is varied.
    assert s * course.values[1] == pytest.approx((vectors[1] - vectors[0]) / (2 * small), abs=1e-7)


@pytest.mark.parametrize("limited", DRIVES)
def test_the_way_is_that_of_matrix_exponentials(limited: RateLimited) -> None:
    at = np.array([0.0, 3.4, 4.1, 9.0])
    alike = ramped_move(MODE, limited, derivatives=0, travel_s=3.0, swing=None)
    course = TwoLags(unequal_ramps(alike, limited)).of(at)
    way = expm_route.outcome(command(at), MODE, limited).travel
    assert course.values[-1].real == pytest.approx(3.5 * way, abs=1e-12)


def test_two_equal_lags_end_as_one_does() -> None:
    equal = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.1, model="switched")
    limited = RateLimited(accel_limit_m_s2=1.6, decel_limit_m_s2=2.5, speed_m_s=0.4, then=equal)
    problem = shaper(limited)
    one = next(candidates(problem.alike, Budget())).course
    found = fastest_from(problem, one.switches, Budget())
    assert found is not None
    np.testing.assert_allclose(found.course.switches, one.switches, atol=1e-8)


@pytest.mark.parametrize("limited", DRIVES)
def test_a_command_is_found_again_from_near_it(limited: RateLimited) -> None:
    problem = shaper(limited)
    one = next(candidates(problem.alike, Budget())).course
    found = fastest_from(problem, one.switches, Budget())
    assert found is not None
    assert found.programs <= 3
    beside = np.array([0, 1e-3, -1e-3, 1e-3, 1e-3])
    assert np.abs(found.course.values).max() < 1e-11
    again = solve_near(TwoLags(problem), found.course.switches + beside)
    assert again is not None
    np.testing.assert_allclose(again.switches, found.course.switches, atol=1e-9)


def test_a_ramp_that_arrives_as_the_next_switch_comes_shows_other_structures() -> None:
    limited = drive(2, "superposed")
    problem = shaper(limited, derivatives=0)
    behind = TwoLags(problem)
    one = next(candidates(problem.alike, Budget())).course
    right = fastest_from(problem, one.switches, Budget())
    assert right is not None
    wrong = ~right.course.arrived
    wrong[-1] = True
    end = solve_program(behind, right.course.switches, wrong)
    assert not end.is_solved
    assert end.at_kinks.any()


def test_a_search_without_work_finds_nothing() -> None:
    problem = shaper(drive(1, "switched"))
    assert fastest_from(problem, np.array([0.0, 1.0, 3.0, 5.0, 6.0]), Budget(most=0)) is None


def test_without_lag_both_sets_have_the_gain_of_one() -> None:
    lag = FirstOrder(accel_time_constant_s=0.0, decel_time_constant_s=0.2)
    limited = RateLimited(accel_limit_m_s2=1.0, decel_limit_m_s2=1.0, speed_m_s=1.0, then=lag)
    gains = shaper(limited).gains
    s = complex(-0.06, math.sqrt(1 - 0.06**2))
    gain = 1 / (1 + 0.7 * s)
    np.testing.assert_allclose(gains[0], np.array([[1, 1], [gain, gain]]), atol=1e-15)
    rate = -0.7 * gain**2
    np.testing.assert_allclose(gains[1], np.array([[0, 0], [rate, rate]]), atol=1e-15)
