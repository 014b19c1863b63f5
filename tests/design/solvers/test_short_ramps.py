"""Very short ramps: beside long ones, and both at once, in designs and in moves."""

import math

import numpy as np
import pytest

from design.formulations.ramped import ramped_problem
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.moves.maneuvers import maneuver
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.solvers.budget import Budget
from design.solvers.ramps.course import Slopes, course_of
from design.solvers.ramps.search import candidates
from design.solvers.ramps.short_ramps import lengthened, shortened
from tests.expm_route import outcome
from tests.refusals import refused


def limits(rise: float, fall: float) -> RateLimited:
    return RateLimited(accel_limit_m_s2=1 / rise, decel_limit_m_s2=1 / fall, speed_m_s=1.0)


@pytest.mark.parametrize("seed", range(24))
def test_a_short_ramp_beside_a_long_one_is_turned_in_time(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=float(rng.choice([0, 0.02, 0.2])))
    ramps = [float(10 ** rng.uniform(-5, -2)), float(rng.uniform(0.3, 12))]
    rng.shuffle(ramps)
    drive, kind = limits(*ramps), SHAPERS[str(rng.choice(["numzv", "numzvd"]))]
    found = design(mode, drive, kind)
    assert found.certificate.verified
    assert found.solver.gap is not None
    assert found.solver.gap < 1e-3
    # The switch of a ramp of 1e-5 s is off by 1e-15 s, and the level by 1e-10.
    assert outcome(found.impulses, mode, drive).residual < 1e-8


@pytest.mark.parametrize("ramp_s", [1e-12, 1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize(("kind", "without"), [("numzv", "umzv"), ("numzvd", "umzvd")])
@pytest.mark.parametrize("damping", [0.0, 0.1])
def test_where_both_ramps_are_short_the_shaper_tends_to_that_without_limits(
    ramp_s: float, kind: str, without: str, damping: float
) -> None:
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=damping)
    found = design(mode, limits(ramp_s, ramp_s), SHAPERS[kind]).impulses
    ideal = design(mode, Ideal(), SHAPERS[without]).impulses
    # Ramps of one length are a delay of half of it, and what is left grows with its square.
    np.testing.assert_allclose(found.times_s, ideal.times_s, atol=ramp_s**2 + 1e-7)


@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
@pytest.mark.parametrize(("rise", "fall"), [(1e-4, 2.6), (3.5, 1e-4), (1e-5, 2.6)])
@pytest.mark.parametrize("distance_m", [1e-2, 1.0, 12.0])
def test_moves_behind_one_short_ramp_are_served(
    kind: str, rise: float, fall: float, distance_m: float
) -> None:
    mode = Mode(natural_frequency_rad_s=1.0)
    move = maneuver(mode, limits(rise, fall), SHAPERS[kind], speed_m_s=1.0, distance_m=distance_m)
    assert move.certificate.verified
    assert move.distance_m == pytest.approx(distance_m, abs=1e-9)


@pytest.mark.parametrize("distance_m", [1e-9, 1e-7, 1e-6])
@pytest.mark.parametrize("kind", ["umzv", "numzvd"])
def test_a_tiny_move_is_as_exact_as_any(kind: str, distance_m: float) -> None:
    mode = Mode(natural_frequency_rad_s=1.0)
    move = maneuver(mode, limits(3.5, 2.6), SHAPERS[kind], speed_m_s=1.0, distance_m=distance_m)
    assert move.certificate.verified
    assert move.distance_m == pytest.approx(distance_m, rel=1e-9)


def test_sets_that_are_alike_are_one_lag_in_a_long_move_too() -> None:
    mode = Mode(natural_frequency_rad_s=1.0)
    one = SecondOrderSet(natural_frequency_rad_s=5, damping_ratio=0.7)
    ends = []
    models: tuple[Model, ...] = ("superposed", "switched")
    for model in models:
        then = SecondOrder(accel=one, decel=one, model=model)
        drive = RateLimited(accel_limit_m_s2=0.3, decel_limit_m_s2=0.4, speed_m_s=1.0, then=then)
        move = maneuver(mode, drive, SHAPERS["numzv"], speed_m_s=1.0, distance_m=1000.0)
        assert move.ramps is not None
        ends.append(move.ramps.end_s)
    assert ends[0] == pytest.approx(ends[1], rel=1e-12)


def test_a_shortened_course_keeps_its_levels() -> None:
    mode = Mode(natural_frequency_rad_s=1.0)
    problem = ramped_problem((mode,), limits(1e-4, 2.0), derivatives=1, max_duration_periods=3.0)
    longer = lengthened(problem)
    assert longer is not None
    assert lengthened(longer) is None
    found = next(candidates(longer, Budget())).course
    slopes = Slopes(up=1e4, down=0.5)
    course = course_of(shortened(found, slopes), slopes)
    np.testing.assert_allclose(course.rises, found.rises, rtol=0, atol=1e-9)


def test_ramps_alike_are_not_lengthened() -> None:
    for rise, fall in ((1e-4, 1e-5), (0.5, 2.0)):
        problem = ramped_problem(
            (Mode(natural_frequency_rad_s=1.0),),
            limits(rise, fall),
            derivatives=0,
            max_duration_periods=3.0,
        )
        assert lengthened(problem) is None


def test_a_ramp_too_short_to_be_turned_is_refused_by_its_limit() -> None:
    drive = limits(2.0, 1e-8)
    with refused("ramp_too_short", "actuator.decel_limit_m_s2", says=r"at most 1e\+05 m/s\^2"):
        design(Mode(natural_frequency_rad_s=1.0), drive, SHAPERS["numzv"])


def test_a_short_ramp_rises_by_all_of_its_level() -> None:
    course = course_of(np.array([0.0, 1.0, 2.0]), Slopes(up=1e12, down=1e12))
    assert course.rises.tolist() == [1.0, -1.0, 1.0]
    assert math.isclose(course.end, 2.0)
