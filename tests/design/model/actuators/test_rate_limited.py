"""Limits to acceleration: ramps for steps, alone and before a lag."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from design.analysis.certificate import certify
from design.analysis.residual import residual_vectors, residual_vibration
from design.analysis.residuals_of_many import vectors_of_many
from design.analysis.sensitivity import SensitivityRange, sensitivity
from design.analysis.unshaped import unshaped_ramp_residual
from design.claims import zeros
from design.errors import InfeasibleDesignError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited, Unlimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.commands import pulse, step
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.reference_ramps import reference
from design.moves.maneuvers import maneuver
from design.pipeline import design
from design.response.closed_form import history, travel
from design.response.simulated_history import simulated_history
from design.response.simulation import ringing_after
from design.shapers.registry import SHAPERS
from tests.integration_route import integrate
from tests.refusals import refused
from tests.shaper_table import CRANE, LIMITED, THESIS

ALONE = RateLimited(accel_limit_m_s2=1.0, decel_limit_m_s2=2.5, speed_m_s=0.2)
MODELS: list[Model] = ["superposed", "switched"]


def actuator_that_follows(seed: int, w: float) -> Unlimited:
    rng = np.random.default_rng(seed)
    model = MODELS[seed % 2]
    corners = (w * rng.uniform(1.5, 20.0, 2)).tolist()
    if seed % 5 == 0:
        return Ideal()
    if seed % 5 == 1:
        constants = [float(rng.choice([0.0, 1 / corner])) for corner in corners]
        return FirstOrder(
            accel_time_constant_s=constants[0], decel_time_constant_s=constants[1], model=model
        )
    dampings = rng.choice([0.4, 0.8, 1.0, 1 + 1e-7, 1.5, 3.0], 2).tolist()
    accel, decel = (
        SecondOrderSet(natural_frequency_rad_s=corner, damping_ratio=damping)
        for corner, damping in zip(corners, dampings, strict=True)
    )
    return SecondOrder(accel=accel, decel=decel, model=model)


def random_case(seed: int) -> tuple[Impulses, Mode, RateLimited]:
    """Any command, its ramps cut, turned and sent through zero."""
    rng = np.random.default_rng(seed)
    w = float(rng.uniform(0.5, 5.0))
    mode = Mode(natural_frequency_rad_s=w, damping_ratio=float(rng.uniform(0, 0.3)))
    limits = (1 / 10 ** rng.uniform(-3, 0.3, 2)).tolist()
    actuator = RateLimited(
        accel_limit_m_s2=limits[0],
        decel_limit_m_s2=limits[1],
        speed_m_s=1.0,
        then=actuator_that_follows(seed, w),
    )
    size = int(rng.integers(1, 7))
    amplitudes = rng.uniform(-1, 1, size) if seed % 3 else (-1.0) ** np.arange(size)
    return Impulses(times_s=np.sort(rng.uniform(0, 3, size)), amplitudes=amplitudes), mode, actuator


def test_steps_become_ramps_by_the_limit_of_their_direction() -> None:
    ramps = reference(pulse(1.0), ALONE)
    assert ramps.times_s.tolist() == [0.0, 1.0]
    assert ramps.ramps_s == pytest.approx([0.2, 0.08], rel=1e-15)
    assert ramps.changes.tolist() == [1.0, -1.0]
    assert ramps.accelerates.tolist() == [True, False]


def test_a_ramp_that_is_not_over_turns() -> None:
    ramps = reference(pulse(0.05), ALONE)  # a quarter of the way to full speed
    assert ramps.changes == pytest.approx([0.25, -0.25], rel=1e-15)
    assert ramps.ramps_s == pytest.approx([0.05, 0.02], rel=1e-15)


def test_a_reversal_brakes_to_zero_and_then_accelerates() -> None:
    reversal = Impulses(times_s=np.array([0.0, 1.0]), amplitudes=np.array([1.0, -2.0]))
    ramps = reference(reversal, ALONE)
    assert ramps.accelerates.tolist() == [True, False, True]
    assert ramps.times_s == pytest.approx([0.0, 1.0, 1.08], rel=1e-15)
    assert ramps.changes.tolist() == [1.0, -1.0, -1.0]


def test_a_ramp_alone_swings_by_its_textbook_factor() -> None:
    # A ramp of length T leaves |sin(w T / 2) / (w T / 2)| of what a step does; the last ramp here
    # falls, the unit is one that rises.
    mode = Mode(natural_frequency_rad_s=7.0)
    late = Impulses(times_s=np.array([0.0, 50.0]), amplitudes=np.array([1e-9, -1.0]))

    def factor(duration: float) -> float:
        return abs(math.sin(3.5 * duration) / (3.5 * duration))

    # From 1e-9 down to 0 by the fall, then on to -1 by the rise: all but the share of 1e-9.
    assert residual_vibration(late, mode, ALONE) == pytest.approx(factor(0.2), abs=1e-8)
    fall = Impulses(times_s=np.array([0.0, 1e-300]), amplitudes=np.array([1.0, 1e-300]))
    assert residual_vibration(fall, mode, ALONE) == pytest.approx(factor(0.2), abs=1e-12)
    both = residual_vibration(pulse(2 * math.pi / 7.0), mode, ALONE)
    turn = abs(factor(0.2) - factor(0.08) * np.exp(-3.5j * (0.08 - 0.2)))
    assert both == pytest.approx(turn, abs=1e-14)


@pytest.mark.parametrize("seed", range(200))
def test_the_formula_agrees_with_the_simulation(seed: int) -> None:
    impulses, mode, actuator = random_case(seed)
    ringing, unit, _ = ringing_after(
        impulses, actuator, np.array([mode.natural_frequency_rad_s]), mode.damping_ratio
    )
    vectors = residual_vectors(impulses, np.array([mode.pole_rad_s]), actuator)
    assert abs(ringing[0] / unit[0] - vectors[0]) < 1e-10 * max(1.0, abs(vectors[0]))


@pytest.mark.parametrize("seed", range(40))
def test_many_commands_at_once_leave_what_each_does(seed: int) -> None:
    impulses, mode, actuator = random_case(seed)
    rng = np.random.default_rng(seed)
    size = impulses.times_s.size
    times = np.cumsum(rng.uniform(0, 2, (9, size)) * 10.0 ** rng.uniform(-2, 0, (9, 1)), axis=1)
    poles = mode.pole_rad_s * rng.uniform(0.8, 1.2, 9)
    together = vectors_of_many(times, impulses.amplitudes, poles, actuator)
    for row, pole, vector in zip(times, poles, together, strict=True):
        command = replace(impulses, times_s=row)
        alone = residual_vectors(command, np.array([pole]), actuator)[0]
        assert abs(vector - alone) < 1e-12 * max(1.0, abs(alone))


@pytest.mark.parametrize("seed", range(100))
def test_the_histories_agree_with_an_integrator(seed: int) -> None:
    impulses, mode, actuator = random_case(seed)
    end = float(impulses.times_s[-1]) + (0.05, 0.7)[seed % 2]
    deflection, _, velocity = integrate(impulses, mode, actuator, end)
    for route in (history, simulated_history):
        told = route(impulses, mode, actuator, np.array([end]))
        assert told.velocity[0] == pytest.approx(velocity, abs=1e-8)
        assert told.deflection[0] == pytest.approx(
            deflection * mode.natural_frequency_rad_s, abs=1e-8
        )


@pytest.mark.parametrize("seed", range(30))
def test_both_histories_agree_at_all_times(seed: int) -> None:
    impulses, mode, actuator = random_case(seed)
    times = np.linspace(-0.1, 5.0, 200)
    closed, simulated = (
        route(impulses, mode, actuator, times) for route in (history, simulated_history)
    )
    for name in ("command", "velocity", "deflection"):
        assert getattr(closed, name) == pytest.approx(getattr(simulated, name), abs=1e-10)


def test_limits_beyond_reach_are_none() -> None:
    # A ramp of 2e-10 s: its residual differs from a step's by (w T)^2.
    fast = replace(LIMITED, accel_limit_m_s2=1e9, decel_limit_m_s2=1e9)
    for actuator, limited in ((THESIS, fast), (Ideal(), replace(fast, then=Ideal()))):
        shaper = design(CRANE, actuator, SHAPERS["umzvd"]).impulses
        assert residual_vibration(shaper, CRANE.mode, limited) == pytest.approx(
            residual_vibration(shaper, CRANE.mode, actuator), abs=1e-8
        )


@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("accel_limit", [30.0, 5.0])
def test_designs_are_verified_behind_limits(kind: str, model: Model, accel_limit: float) -> None:
    limited = replace(LIMITED, accel_limit_m_s2=accel_limit, then=replace(THESIS, model=model))
    found = design(CRANE, limited, SHAPERS[kind])
    assert found.certificate.verified
    assert found.residual <= 1e-9
    # What ignores the limits leaves more, and is told so.
    unaware = design(CRANE, limited.then, SHAPERS[kind]).impulses
    assert residual_vibration(unaware, CRANE.mode, limited) > 1e-5
    curve = sensitivity(found.impulses, CRANE.mode, limited, SensitivityRange())
    assert curve.insensitivity is not None
    assert certify(found.impulses, CRANE.mode, limited, zeros(SHAPERS[kind].claims)).verified


def test_random_designs_behind_limits_are_verified_or_refused() -> None:
    rng = np.random.default_rng(5)
    verified = 0
    for _ in range(60):
        w = float(rng.uniform(0.5, 60))
        mode = Mode(natural_frequency_rad_s=w, damping_ratio=float(rng.uniform(0, 0.2)))
        accel, decel = (
            SecondOrderSet(
                natural_frequency_rad_s=w * float(rng.uniform(4, 20)),
                damping_ratio=float(rng.uniform(0.4, 1.6)),
            )
            for _ in range(2)
        )
        model = MODELS[int(rng.integers(2))]
        ramps = rng.uniform(0.001, 0.4, 2) / w
        drive = RateLimited(
            accel_limit_m_s2=0.2 / float(ramps[0]),
            decel_limit_m_s2=0.2 / float(ramps[1]),
            speed_m_s=0.2,
            then=SecondOrder(accel=accel, decel=decel, model=model),
        )
        try:
            found = design(mode, drive, SHAPERS["numzvd"])
        except InfeasibleDesignError:
            continue
        assert found.certificate.verified
        verified += 1
    assert verified >= 55


@pytest.mark.parametrize(
    ("drive", "distance_m"),
    [(LIMITED, 0.42), (LIMITED, -0.42), (LIMITED, 0.05), (ALONE, 0.42), (ALONE, -0.42)],
)
@pytest.mark.parametrize("model", MODELS)
def test_moves_meet_their_distance_behind_limits(
    drive: RateLimited, model: Model, distance_m: float
) -> None:
    if drive.then.kind != "ideal":
        drive = replace(drive, then=replace(drive.then, model=model))
    move = maneuver(CRANE, drive, SHAPERS["numzvd"], speed_m_s=0.2, distance_m=distance_m)
    assert move.certificate.verified
    assert move.residual <= 1e-9
    assert move.distance_m == pytest.approx(distance_m, abs=1e-12)
    assert 0.2 * travel_by_quadrature(move.command, drive) == pytest.approx(
        abs(distance_m), abs=1e-9
    )


def travel_by_quadrature(command: Impulses, actuator: Actuator) -> float:
    """Integrate the velocity by Gauss nodes between its kinks, 20 ms at a time."""
    changes = reference(command, actuator)
    end = command.times_s[-1] + 8.0
    knots = np.concatenate((
        command.times_s, changes.times_s, changes.times_s + changes.ramps_s, np.arange(0, end, 0.02)
    ))  # fmt: skip
    knots = np.unique(knots)
    nodes, weights = np.polynomial.legendre.leggauss(12)
    widths = np.diff(knots)
    at = knots[:-1, None] + np.multiply.outer(widths, (nodes + 1) / 2)
    motion = simulated_history(command, CRANE.mode, actuator, at.ravel())
    return float(widths @ motion.velocity.reshape(at.shape) @ weights) / 2


def test_a_move_in_which_no_ramp_finishes_turns_them() -> None:
    # 0.25 s at full speed, in pulses of 0.2 s of ramp each: three of them are too many.
    move = maneuver(CRANE, ALONE, SHAPERS["numzvd"], speed_m_s=0.2, distance_m=0.05)
    assert move.certificate.verified
    assert np.diff(move.command.times_s)[::2].max() < 0.2


def test_travel_of_a_ramped_pulse_is_its_area() -> None:
    assert travel(pulse(1.0), ALONE) == pytest.approx(1.0 - 0.1 + 0.04, rel=1e-15)
    # A triangle: a quarter of full speed, 0.07 s wide.
    assert travel(pulse(0.05), ALONE) == pytest.approx(0.25 * 0.07 / 2, rel=1e-14)


def test_the_unit_is_a_step_without_limits() -> None:
    assert residual_vibration(step(), CRANE.mode, LIMITED.then) == pytest.approx(1.0, abs=1e-14)
    ramped = residual_vibration(step(), CRANE.mode, LIMITED)
    assert ramped == pytest.approx(unshaped_ramp_residual(CRANE.mode, LIMITED), rel=1e-13)
    assert 0 < ramped < 1


@pytest.mark.parametrize(
    ("changes", "code", "field"),
    [
        ({"accel_limit_m_s2": 0.0}, "not_positive", "accel_limit_m_s2"),
        ({"speed_m_s": -0.2}, "not_positive", "speed_m_s"),
        ({"then": replace(THESIS, dead_time_s=0.1)}, "delay_said_twice", "then.dead_time_s"),
    ],
)
def test_bad_limits_are_named(changes: dict[str, Any], code: str, field: str) -> None:
    with refused(code, field):
        replace(LIMITED, **changes)


def test_limits_out_of_proportion_are_refused() -> None:
    slow = replace(ALONE, accel_limit_m_s2=1e-3)
    with refused("ramp_too_long", "actuator.accel_limit_m_s2"):
        design(CRANE, slow, SHAPERS["numzvd"])


def test_a_ramp_of_one_period_is_no_obstacle_and_needs_a_shaper_for_its_slope_alone() -> None:
    period = replace(ALONE, accel_limit_m_s2=ALONE.speed_m_s / CRANE.mode.period_s)
    assert design(CRANE, period, SHAPERS["numzv"]).impulses.times_s.size == 1
    robust = design(CRANE, period, SHAPERS["numzvd"])
    assert robust.impulses.times_s.size > 1
    assert robust.certificate.verified


def test_a_move_at_another_speed_is_refused() -> None:
    with refused("speed_not_actuators", "speed_m_s"):
        maneuver(CRANE, LIMITED, SHAPERS["numzvd"], speed_m_s=0.3, distance_m=0.42)
