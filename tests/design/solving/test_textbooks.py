"""Shapers of an ideal drive behind limits: when they end, what they leave, and what is faster."""

import math
from dataclasses import replace

import numpy as np
import pytest

from design.analysis.ramp_figures import Textbook, end_of_reference
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import maneuver
from design.pipeline import Design, design
from design.response.closed_form import travel
from design.shapers.registry import SHAPERS
from design.solving.textbooks import (
    figures_beside_textbooks,
    textbook_moves,
    textbook_shapers,
    unshaped_move,
    waiting,
)
from tests.design.solving.test_ramps import random_drives
from tests.expm_route import outcome

CRANE = Pendulum(cable_length_m=9.0, gravity_m_s2=9.81)
DRIVE = RateLimited(accel_limit_m_s2=0.3, decel_limit_m_s2=0.4, speed_m_s=1.0)


def by_name(found: tuple[Textbook, ...]) -> dict[tuple[str, str], Textbook]:
    return {(one.shaper, one.command): one for one in found}


def figures_of(found: Design, modes: tuple[Mode, ...], drive: RateLimited) -> tuple[Textbook, ...]:
    return figures_beside_textbooks(
        found.impulses, modes, drive, found.certificate.claims
    ).textbooks


def left_by_a_shaped_ramp(mode: Mode, ramp_s: float, derivatives: int) -> float:
    """Return what the convolved ramp leaves over a step, by the midpoint rule over its slope."""
    w, z = mode.natural_frequency_rad_s, mode.damping_ratio
    half = math.pi / (w * math.sqrt(1 - z * z))
    k = math.exp(-math.pi * z / math.sqrt(1 - z * z))
    weights = np.array([math.comb(derivatives + 1, n) * k**n for n in range(derivatives + 2)])
    times = (np.arange(20_000) + 0.5) * ramp_s / 20_000
    s = w * complex(-z, math.sqrt(1 - z * z))
    sums = [
        weight / weights.sum() * np.exp(-s * (times + n * half)).mean()
        for n, weight in enumerate(weights)
    ]
    return float(abs(sum(sums)))


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.3])
@pytest.mark.parametrize("derivatives", [0, 1])
def test_a_shaped_ramp_ends_with_the_ramp_and_the_shaper_and_leaves_nothing(
    damping: float, derivatives: int
) -> None:
    mode = Mode(natural_frequency_rad_s=2.0, damping_ratio=damping)
    found = textbook_shapers((mode,), DRIVE, derivatives=derivatives, end_s=1.0)[0]
    half = math.pi / (2.0 * math.sqrt(1 - damping**2))
    assert (found.shaper, found.command) == (("zv", "zvd")[derivatives], "shaped_ramp")
    assert found.ramp_end_s == pytest.approx(1 / 0.3 + (derivatives + 1) * half, rel=1e-14)
    assert found.residual < 1e-14
    assert left_by_a_shaped_ramp(mode, 1 / 0.3, derivatives) < 1e-9
    assert found.earlier == pytest.approx(1 - 1 / found.ramp_end_s, rel=1e-14)


def test_steps_wait_for_the_ramps_before_them() -> None:
    found = by_name(textbook_shapers(CRANE.modes, DRIVE, derivatives=0, end_s=4.0))
    # Half ramps of 1.67 s are over before half a period is, 3.01 s; ramps up, down and up are not.
    half = math.pi * math.sqrt(9 / 9.81)
    assert found["zv", "steps"].ramp_end_s == pytest.approx(half + 0.5 / 0.3, rel=1e-14)
    assert found["zv", "steps"].residual < 1e-14
    assert found["umzv", "steps"].ramp_end_s == pytest.approx(2 / 0.3 + 1 / 0.4, rel=1e-14)
    w = math.sqrt(9.81 / 9)

    def ramp(begin: float, length: float) -> complex:
        times = begin + (np.arange(100_000) + 0.5) * length / 100_000
        return complex(np.exp(-1j * w * times).mean())

    rise, fall = 1 / 0.3, 1 / 0.4
    left = ramp(0, rise) - ramp(rise, fall) + ramp(rise + fall, rise)
    assert found["umzv", "steps"].residual == pytest.approx(abs(left), rel=1e-8)


@pytest.mark.parametrize(("mode", "drive", "kind"), random_drives(11, 24))
def test_no_textbook_without_residual_is_faster(mode: Mode, drive: RateLimited, kind: str) -> None:
    textbooks = figures_of(design(mode, drive, SHAPERS[kind]), (mode,), drive)
    assert len(textbooks) == 3
    for one in textbooks:
        if one.residual < 1e-9 and kind == "numzv":
            assert one.earlier > -1e-9
    assert textbooks[0].residual < 1e-9
    assert textbooks[0].earlier > -1e-9


def test_short_ramps_bring_the_steps_of_unity_magnitude_near_the_fastest() -> None:
    drive = RateLimited(accel_limit_m_s2=1e4, decel_limit_m_s2=1e4, speed_m_s=1.0)
    found = by_name(figures_of(design(CRANE, drive, SHAPERS["numzv"]), CRANE.modes, drive))
    assert abs(found["umzv", "steps"].earlier) < 1e-6
    assert found["umzv", "steps"].residual < 1e-7
    assert found["zv", "steps"].earlier == pytest.approx(1 / 3, abs=1e-4)  # T/3 beside T/2


@pytest.mark.parametrize("damping", [0.0, 0.2, 0.5, 0.9, 0.95, 0.97, 0.98, 0.99])
@pytest.mark.parametrize("derivatives", [0, 1])
def test_any_damping_has_the_textbooks_that_exist_there(damping: float, derivatives: int) -> None:
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=damping)
    kinds = {1: ("zvd", "umzvd"), 0: ("zv", "umzv")}[derivatives]
    exist = {name for name in kinds if damping <= SHAPERS[name].damping.most}
    found = textbook_shapers((mode,), DRIVE, derivatives=derivatives, end_s=1.0)
    assert {one.shaper for one in found} == exist
    moves = textbook_moves(mode, DRIVE, derivatives=derivatives, travel_s=9.0, end_s=1.0)
    assert {one.shaper for one in moves} == exist & {kinds[0]}


@pytest.mark.parametrize("damping", [0.95, 0.97])
@pytest.mark.parametrize("kind", ["zv", "zvd", "numzv"])
@pytest.mark.parametrize("slow", [1.0, 1e-3, 1e-6])
def test_a_design_needs_no_textbook(kind: str, damping: float, slow: float) -> None:
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=damping)
    drive = replace(
        DRIVE,
        accel_limit_m_s2=slow * DRIVE.accel_limit_m_s2,
        decel_limit_m_s2=slow * DRIVE.decel_limit_m_s2,
        speed_m_s=slow * DRIVE.speed_m_s,
    )
    assert design(mode, drive, SHAPERS[kind]).certificate.verified


def test_several_modes_have_a_ramp_shaped_for_each() -> None:
    modes = Modes(
        modes=tuple(Mode(natural_frequency_rad_s=w, damping_ratio=0.02) for w in (1.0, 3.0))
    )
    (found,) = figures_of(design(modes, DRIVE, SHAPERS["multi_umzv"]), modes.modes, DRIVE)
    halves = sum(math.pi / (w * math.sqrt(1 - 0.02**2)) for w in (1.0, 3.0))
    assert found.ramp_end_s == pytest.approx(1 / 0.3 + halves, rel=1e-14)
    assert found.residual < 1e-14
    assert found.earlier > 0


def test_what_claims_no_zero_is_not_compared() -> None:
    found = design(CRANE, DRIVE, SHAPERS["zvd"])
    assert found.for_ideal
    assert figures_beside_textbooks(found.impulses, CRANE.modes, DRIVE, ()).textbooks == ()


@pytest.mark.parametrize("distance_m", [0.3, 2.9, 12.0])
@pytest.mark.parametrize(("kind", "derivatives"), [("numzv", 0), ("numzvd", 1)])
def test_a_shaped_trapezoid_goes_as_far_and_the_move_is_faster(
    distance_m: float, kind: str, derivatives: int
) -> None:
    move = maneuver(CRANE, DRIVE, SHAPERS[kind], speed_m_s=1.0, distance_m=distance_m)
    assert move.ramps is not None
    (found,) = move.ramps.textbooks
    rise, fall = 1 / 0.3, 1 / 0.4
    unshaped = distance_m + (rise + fall) / 2
    if distance_m < (rise + fall) / 2:
        unshaped = math.sqrt(2 * distance_m * (rise + fall))
    shaper = (derivatives + 1) * math.pi * math.sqrt(9 / 9.81)
    assert found.ramp_end_s == pytest.approx(unshaped + shaper, rel=1e-12)
    assert found.residual < 1e-13
    assert found.earlier > 0


def test_moves_behind_two_lags_are_not_compared() -> None:
    sets = [SecondOrderSet(natural_frequency_rad_s=w, damping_ratio=0.8) for w in (20.0, 40.0)]
    drive = RateLimited(
        accel_limit_m_s2=30,
        decel_limit_m_s2=30,
        speed_m_s=0.2,
        then=SecondOrder(accel=sets[0], decel=sets[1]),
    )
    move = maneuver(
        Pendulum(cable_length_m=0.8), drive, SHAPERS["numzv"], speed_m_s=0.2, distance_m=1.0
    )
    assert move.ramps is not None
    assert move.ramps.textbooks == ()


def test_a_triangle_has_the_height_that_its_distance_asks() -> None:
    (found,) = textbook_moves(CRANE.mode, DRIVE, derivatives=0, travel_s=1e-6, end_s=1.0)
    assert found.ramp_end_s == pytest.approx(
        math.sqrt(2e-6 * (1 / 0.3 + 1 / 0.4)) + math.pi * math.sqrt(9 / 9.81), rel=1e-12
    )


def test_the_ideal_umzv_is_what_waits() -> None:
    ideal = design(CRANE, Ideal(), SHAPERS["umzv"]).impulses
    quick = RateLimited(accel_limit_m_s2=1e3, decel_limit_m_s2=1e3, speed_m_s=1.0)
    found = by_name(textbook_shapers(CRANE.modes, quick, derivatives=0, end_s=1.0))
    assert found["umzv", "steps"].ramp_end_s == pytest.approx(ideal.duration_s + 1e-3, rel=1e-13)
    assert found["umzv", "steps"].residual == pytest.approx(
        outcome(ideal, CRANE.mode, quick).residual, abs=1e-12
    )


JERKY = replace(DRIVE, jerk_limit_m_s3=0.5)


@pytest.mark.parametrize("travel_s", [0.01, 0.5, 2.0, 4.0, 20.0])
def test_an_unshaped_move_of_limited_jerk_goes_as_far(travel_s: float) -> None:
    assert travel(unshaped_move(JERKY, travel_s), JERKY) == pytest.approx(travel_s, rel=1e-9)


@pytest.mark.parametrize("kind", ["zv", "zvd", "umzv", "umzvd"])
def test_steps_wait_for_ramps_of_limited_jerk_too(kind: str) -> None:
    shaper = design(CRANE, Ideal(), SHAPERS[kind]).impulses
    waited = waiting(shaper, JERKY)
    for count in range(1, waited.times_s.size):
        begun = Impulses(times_s=waited.times_s[:count], amplitudes=waited.amplitudes[:count])
        assert end_of_reference(begun, JERKY) <= waited.times_s[count] + 1e-12
