"""The fastest courses of a limited reference: derivatives, conditions, structure, search."""

import math

import numpy as np
import pytest

from design.formulations.ramped import ramped_problem
from design.formulations.ramped_move import ramped_move
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.rate_limited import RateLimited, follows_one_lag
from design.model.plants.mode import Mode
from design.solvers.budget import Budget
from design.solvers.ramps.course import Course, Slopes, course_of
from design.solvers.ramps.exchange import lacking_switches
from design.solvers.ramps.functionals import Functionals
from design.solvers.ramps.optimality import solve_conditions
from design.solvers.ramps.search import candidates
from design.types import FloatArray

SLOPES = Slopes(up=0.8, down=1.7)
FUNCTIONALS = Functionals(
    np.array([-0.05 + 1j, -0.05 + 1j, -0.02 + 3.1j, 0.0]), np.array([0.0, 1.0, 0.0, 1.0])
)
COMMANDS = {
    "each ramp is over": [0.0, 2.0, 4.0],
    "turned down midway": [0.0, 0.4, 0.5],
    "turned twice, then over": [0.0, 0.4, 0.5, 3.0, 3.3],
    "from rest at 0": [0.0, 0.5, 1.5, 1.9, 2.0],
    "a move": [0.0, 0.6],
}


def levels_at(switches: list[float], times: FloatArray) -> FloatArray:
    """Return the reference, step by step along the times: a route of its own."""
    levels = np.zeros(times.size)
    step = float(times[1] - times[0])
    for number in range(1, times.size):
        passed = sum(times[number - 1] + step / 2 >= at for at in switches)
        slope = SLOPES.up if passed % 2 else -SLOPES.down
        levels[number] = min(1.0, max(0.0, levels[number - 1] + slope * step))
    return levels


@pytest.mark.parametrize("switches", COMMANDS.values(), ids=COMMANDS)
def test_functionals_are_integrals_over_the_course(switches: list[float]) -> None:
    course = course_of(np.array(switches), SLOPES)
    times = np.linspace(0, course.end + 0.5, 20_001)
    levels = levels_at(switches, times)
    middle = (times[1:] + times[:-1]) / 2
    by_sum = FUNCTIONALS.kernels(middle) @ np.diff(levels)
    np.testing.assert_allclose(course.values(FUNCTIONALS), by_sum, atol=2e-3)
    assert levels[-1] == pytest.approx(len(switches) % 2, abs=1e-9)
    arrived = np.abs(levels - levels[-1]) < 1e-9
    assert times[np.flatnonzero(~arrived)[-1]] == pytest.approx(course.end, abs=2e-3)


@pytest.mark.parametrize("switches", COMMANDS.values(), ids=COMMANDS)
def test_derivatives_are_those_of_small_differences(switches: list[float]) -> None:
    at, small = np.array(switches), 1e-6
    multipliers = np.array([1.0 + 0.3j, -0.4j, 0.7, 0.2])

    def moved(number: int, by: float) -> Course:
        return course_of(at + by * (np.arange(at.size) == number), SLOPES)

    course = course_of(at, SLOPES)
    bends = course.bends(FUNCTIONALS, multipliers)
    for number in range(1, at.size):
        after, before = moved(number, small), moved(number, -small)
        changes = (after.values(FUNCTIONALS) - before.values(FUNCTIONALS)) / (2 * small)
        np.testing.assert_allclose(course.changes(FUNCTIONALS)[:, number], changes, atol=1e-8)
        ends = (after.end - before.end) / (2 * small)
        assert course.end_changes()[number] == pytest.approx(ends, abs=1e-8)
        pulls = ((multipliers.conj() @ one.changes(FUNCTIONALS)).real for one in (after, before))
        up, down = pulls
        np.testing.assert_allclose(bends[number], (up - down) / (2 * small), atol=1e-6)


def test_integrals_are_antiderivatives_of_the_kernels() -> None:
    times, small = np.linspace(0.1, 7, 9), 1e-6
    slopes = (FUNCTIONALS.integrals(times + small) - FUNCTIONALS.integrals(times - small)) / (
        2 * small
    )
    np.testing.assert_allclose(slopes, FUNCTIONALS.kernels(times), atol=1e-8)
    rates = (FUNCTIONALS.kernels(times + small) - FUNCTIONALS.kernels(times - small)) / (2 * small)
    np.testing.assert_allclose(FUNCTIONALS.rates(times), rates, atol=1e-7)


LIMITED = RateLimited(accel_limit_m_s2=1.6, decel_limit_m_s2=2.5, speed_m_s=0.4)
MODE = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.01)


def test_the_first_candidate_is_the_published_optimum() -> None:
    problem = ramped_problem((MODE,), LIMITED, derivatives=1, max_duration_periods=3.0)
    found = next(candidates(problem, Budget()))
    wanted = [0, 0.22402307, 0.64740690, 1.19134693, 1.33023728]
    np.testing.assert_allclose(found.course.switches / 3.5, wanted, atol=2e-8)
    assert found.course.end / 3.5 == pytest.approx(1.5472535, abs=1e-7)


def test_a_ramp_of_one_period_needs_no_shaper() -> None:
    period = Mode(natural_frequency_rad_s=2 * np.pi)
    limited = RateLimited(accel_limit_m_s2=1.0, decel_limit_m_s2=3.0, speed_m_s=1.0)
    problem = ramped_problem((period,), limited, derivatives=0, max_duration_periods=3.0)
    ends = [found.course.end for found in candidates(problem, Budget())]
    assert min(ends) == pytest.approx(2 * np.pi, rel=1e-9)


def test_a_dip_too_short_for_the_grid_is_found_by_the_signs_that_it_breaks() -> None:
    crane = Mode(natural_frequency_rad_s=math.sqrt(9.81 / 9))
    limited = RateLimited(accel_limit_m_s2=0.3, decel_limit_m_s2=0.4, speed_m_s=1.0)
    problem = ramped_move(crane, limited, derivatives=1, travel_s=12.0, swing=None)
    functionals = Functionals(problem.unit_poles, problem.orders)
    slopes = Slopes(up=1 / problem.ramps_rad[0], down=1 / problem.ramps_rad[1])
    w = crane.natural_frequency_rad_s
    seed = w * np.array([0, 2.0594, 2.6169, 12.2381, 13.8565, 14.8043])
    without = solve_conditions(seed, functionals, problem.targets, slopes)
    assert without is not None
    assert without.course.end / w == pytest.approx(16.3967163, abs=1e-6)
    more = lacking_switches(without, functionals)
    assert more is not None
    assert more.size == seed.size + 2
    best = solve_conditions(more, functionals, problem.targets, slopes)
    assert best is not None
    assert best.course.end / w == pytest.approx(16.3966926, abs=1e-6)
    assert lacking_switches(best, functionals) is None
    # The search needs no grid that is fine enough for the dip of 0.1 s.
    assert next(candidates(problem, Budget())).programs <= 5


def test_a_search_ends_with_its_budget() -> None:
    problem = ramped_problem((MODE,), LIMITED, derivatives=1, max_duration_periods=3.0)
    assert not list(candidates(problem, Budget(most=0)))


def test_one_lag_is_what_responds_to_all_changes_alike() -> None:
    def behind(decel: float) -> RateLimited:
        lag = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=decel)
        return RateLimited(accel_limit_m_s2=1, decel_limit_m_s2=2, speed_m_s=1, then=lag)

    assert follows_one_lag(behind(0.1))
    assert not follows_one_lag(behind(0.2))
    assert not follows_one_lag(FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.1))
