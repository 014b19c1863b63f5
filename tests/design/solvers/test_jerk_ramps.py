"""The fastest courses of limited jerk: derivatives, structures, rules, search."""

import numpy as np
import pytest

from design.formulations.ramped import RampedProblem, ramped_problem
from design.model.actuators.rate_limited import RateLimited
from design.model.jerk_ramps import jerk_limited_pieces
from design.model.plants.mode import Mode
from design.solvers.budget import Budget
from design.solvers.jerk_ramps.events import EventCourse, Group, Limits
from design.solvers.jerk_ramps.exchange import next_structures
from design.solvers.jerk_ramps.following import course_following
from design.solvers.jerk_ramps.grid import nearest_course, switches_of
from design.solvers.jerk_ramps.optimality import solve_structure
from design.solvers.jerk_ramps.search import candidates
from design.solvers.ramps.functionals import Functionals

LIMITS = Limits(up=0.8, down=1.7, jerk=3.0)
DRIVE = RateLimited(accel_limit_m_s2=0.8, decel_limit_m_s2=1.7, speed_m_s=1.0, jerk_limit_m_s3=3.0)
FUNCTIONALS = Functionals(
    np.array([-0.05 + 1j, -0.05 + 1j, -0.02 + 3.1j, 0.0]), np.array([0.0, 1.0, 0.0, 1.0])
)
COMMANDS = {
    "each ramp is over": [0.0, 4.0, 8.0],
    "turned down midway": [0.0, 0.4, 0.5],
    "turned twice, then over": [0.0, 0.4, 0.5, 3.0, 3.3],
    "from rest at 0": [0.0, 0.5, 1.5, 1.9, 2.0],
    "a touch of 1": [0.0, 1.3, 2.0],
    "a move": [0.0, 0.6],
}
MODE = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.01)


def problem_of(jerk_m_s3: float, derivatives: int) -> tuple[RampedProblem, Limits]:
    limited = RateLimited(
        accel_limit_m_s2=1.6, decel_limit_m_s2=2.5, speed_m_s=0.4, jerk_limit_m_s3=jerk_m_s3
    )
    problem = ramped_problem((MODE,), limited, derivatives=derivatives, max_duration_periods=3.0)
    assert problem.jerk is not None
    rise, fall = problem.ramps_rad
    return problem, Limits(up=1 / rise, down=1 / fall, jerk=problem.jerk)


@pytest.mark.parametrize("switches", COMMANDS.values(), ids=COMMANDS)
def test_functionals_are_integrals_over_the_drives_course(switches: list[float]) -> None:
    nodes, weights = np.polynomial.legendre.leggauss(40)
    levels = [float(number % 2 == 0) for number in range(len(switches))]
    total = np.zeros(4, dtype=np.complex128)
    for start, duration, change, _, bend in jerk_limited_pieces(switches, levels, DRIVE, 3.0):
        at = (nodes + 1) / 2
        along = weights / 2 * change * (1 + bend * (2 * at - 1))
        total += FUNCTIONALS.kernels(start + duration * at) @ along
    course = course_following(np.array(switches), LIMITS)
    np.testing.assert_allclose(course.values(FUNCTIONALS), total, atol=1e-13)
    assert np.abs(course.conditions).max() < 1e-14
    again = course_following(course.switches, LIMITS)
    assert again.groups == course.groups
    np.testing.assert_allclose(again.times, course.times, atol=1e-12)


@pytest.mark.parametrize("switches", COMMANDS.values(), ids=COMMANDS)
def test_derivatives_are_those_of_small_differences(switches: list[float]) -> None:
    rng = np.random.default_rng(len(switches))
    course = course_following(np.array(switches), LIMITS)
    # Beside the structure's conditions too, as within Newton's method.
    away = 0.01 * rng.normal(size=course.times.size) * (np.arange(course.times.size) > 0)
    course = course.moved(away)
    multipliers = rng.normal(size=4) + 1j * rng.normal(size=4)
    prices = rng.normal(size=course.conditions.size)
    bends = course.bends(FUNCTIONALS, multipliers) + course.condition_bends(prices)
    small = 1e-6

    def moved(event: int, by: float) -> EventCourse:
        return course.moved(by * (np.arange(course.times.size) == event))

    def stationary(one: EventCourse) -> np.ndarray:
        pulls: np.ndarray = (multipliers.conj() @ one.changes(FUNCTIONALS)).real
        return pulls + prices @ one.condition_changes

    for event in range(1, course.times.size):
        after, before = moved(event, small), moved(event, -small)
        values = (after.values(FUNCTIONALS) - before.values(FUNCTIONALS)) / (2 * small)
        np.testing.assert_allclose(course.changes(FUNCTIONALS)[:, event], values, atol=1e-6)
        conditions = (after.conditions - before.conditions) / (2 * small)
        np.testing.assert_allclose(course.condition_changes[:, event], conditions, atol=1e-7)
        curved = (stationary(after) - stationary(before)) / (2 * small)
        np.testing.assert_allclose(bends[event], curved, atol=1e-6)


def test_a_grid_shows_how_the_optimum_switches() -> None:
    problem, limits = problem_of(100.0, 0)
    functionals = Functionals(problem.unit_poles, problem.orders)
    course = nearest_course(functionals, problem.targets, limits, 1.0, 0.85 * 3.5, 1.0)
    assert course is not None
    assert not course.is_possible
    assert np.abs(np.diff(course.slopes)).max() <= limits.jerk * course.cell * (1 + 1e-9)
    switches = switches_of(course, limits) / 3.5
    np.testing.assert_allclose(switches, [0, 0.334, 0.582], atol=0.03)
    later = nearest_course(functionals, problem.targets, limits, 1.0, 0.9 * 3.5, 1.0)
    assert later is not None
    assert later.is_possible


def test_rules_that_a_course_breaks_lead_to_the_optimum() -> None:
    # From a turn below 1 and above 0, where the optimum rests at either.
    problem, limits = problem_of(20.0, 0)
    functionals = Functionals(problem.unit_poles, problem.orders)
    start = EventCourse(
        groups=(Group(signs=(1, 0, -1, 1, 0, -1), goal=1.0, rests=False),),
        limits=limits,
        widths=3.5 * np.diff([0.0, 0.2, 0.25, 0.45, 0.65, 0.72, 0.92]),
    )
    first = solve_structure(start, functionals, problem.targets)
    assert first is not None
    assert first.course.slopes_of(0).min() < -limits.down
    (following,) = next_structures(first, functionals)
    assert following.groups[0].signs == (1, 0, -1, 0, 1, 0, -1)
    second = solve_structure(following, functionals, problem.targets)
    assert second is not None
    assert second.course.end > first.course.end
    assert not [*next_structures(second, functionals)]


@pytest.mark.parametrize("derivatives", [0, 1])
@pytest.mark.parametrize("jerk", [3.0, 20.0, 100.0, 1e4])
def test_the_first_candidate_meets_every_condition(jerk: float, derivatives: int) -> None:
    problem, limits = problem_of(jerk, derivatives)
    functionals = Functionals(problem.unit_poles, problem.orders)
    optimum = next(candidates(problem, limits, Budget()))
    course = optimum.found.course
    assert np.abs(course.values(functionals)).max() < 1e-10
    assert np.abs(course.conditions).max() < 1e-10
    assert course.widths.min() > 0
    # The drive itself, under the command, goes this way.
    again = course_following(course.switches, limits)
    assert again.end == pytest.approx(course.end, abs=1e-9)
    assert np.abs(again.values(functionals)).max() < 1e-9


def test_a_search_ends_with_its_budget() -> None:
    problem, limits = problem_of(100.0, 1)
    assert not list(candidates(problem, limits, Budget(most=0)))


@pytest.mark.parametrize(
    ("plant", "limits", "derivatives", "end_periods"),
    [
        # At 1 it neither turns below nor can turn there: it rests.
        ((4.24226945, 0.28542058), (1.8876383, 272.85237, 43685.068), 0, 0.786273),
        # The first grids say that what is possible is too short.
        ((6.65211895, 0.09176949), (288.1032, 1.1327607, 52602.262), 1, 0.877364),
    ],
)
def test_courses_that_nearly_turn_at_full_speed_are_found(
    plant: tuple[float, float],
    limits: tuple[float, float, float],
    derivatives: int,
    end_periods: float,
) -> None:
    mode = Mode(natural_frequency_rad_s=plant[0], damping_ratio=plant[1])
    up, down, jerk = limits  # by the period
    drive = RateLimited(
        accel_limit_m_s2=up / mode.period_s,
        decel_limit_m_s2=down / mode.period_s,
        speed_m_s=1.0,
        jerk_limit_m_s3=jerk / mode.period_s**2,
    )
    problem = ramped_problem((mode,), drive, derivatives=derivatives, max_duration_periods=3.0)
    assert problem.jerk is not None
    rise, fall = problem.ramps_rad
    bounds = Limits(up=1 / rise, down=1 / fall, jerk=problem.jerk)
    found = next(candidates(problem, bounds, Budget()))
    assert found.end / (2 * np.pi) == pytest.approx(end_periods, abs=1e-6)
