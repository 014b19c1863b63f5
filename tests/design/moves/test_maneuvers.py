"""Whole moves: exact distance, nothing left, never out of range."""

import math
from dataclasses import replace

import numpy as np
import pytest

from design.analysis.certificate import certify
from design.analysis.residual import residual_vibration
from design.claims import zeros
from design.errors import InfeasibleDesignError, InvalidInputError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder
from design.model.actuators.swapped import swap_directions
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.settling import settling_time_s
from design.moves.maneuvers import maneuver
from design.moves.parts import mirrored_stop
from design.moves.rest_to_rest import WholeCommand
from design.pipeline import design
from design.shapers.kind import ShaperKind
from design.shapers.peak_options import PeakOptions
from design.shapers.settle_options import SettleOptions
from tests import expm_route
from tests.design.moves.cranes import (
    MODELS,
    NUMZV,
    NUMZVD,
    SPEED_M_S,
    UMZVC,
    UMZVD,
    any_actuator,
    levels,
    travel_by_integration,
)
from tests.integration_route import residual_by_integration
from tests.refusals import refused
from tests.shaper_table import CRANE, DAMPED, FIRST_ORDER, THESIS

SWITCHED = replace(THESIS, model="switched")

CRANES = [
    pytest.param(kind, replace(actuator, model=model), id=f"{kind.name}-{model}")
    for kind, actuator in ((UMZVC, FIRST_ORDER), (NUMZV, THESIS), (NUMZVD, THESIS))
    for model in MODELS
]


@pytest.mark.parametrize(("kind", "actuator"), CRANES)
@pytest.mark.parametrize("distance_m", [0.42, -0.42])
def test_the_cranes_move_is_exact_and_leaves_nothing(
    kind: ShaperKind, actuator: Actuator, distance_m: float
) -> None:
    move = maneuver(CRANE, actuator, kind, speed_m_s=SPEED_M_S, distance_m=distance_m)
    assert abs(move.distance_m - distance_m) <= 1e-12 * abs(distance_m)
    assert move.residual <= 1e-9
    assert move.certificate.verified
    assert tuple(claim.quantity for claim in move.certificate.claims) == kind.claims
    assert not move.joint
    assert move.direction == math.copysign(1, distance_m)
    assert min(levels(move)) == 0
    assert max(levels(move)) == 1


@pytest.mark.parametrize(("kind", "actuator"), CRANES)
@pytest.mark.parametrize("distance_m", [0.42, 0.06])
def test_an_integrator_finds_the_distance_and_no_swing(
    kind: ShaperKind, actuator: Actuator, distance_m: float
) -> None:
    move = maneuver(CRANE, actuator, kind, speed_m_s=SPEED_M_S, distance_m=distance_m)
    assert move.joint == (distance_m < 0.1)
    assert SPEED_M_S * travel_by_integration(move.command, actuator) == pytest.approx(
        distance_m, abs=1e-9
    )
    # Its tolerance is 1e-11 a step; the free swing is divided by that of one unshaped step.
    assert residual_by_integration(move.command, CRANE.mode, actuator) < 1e-8


@pytest.mark.parametrize("model", MODELS)
def test_a_move_in_minus_x_is_the_mirror_image(model: Model) -> None:
    actuator = replace(THESIS, model=model)
    there, back = (
        maneuver(CRANE, actuator, NUMZVD, speed_m_s=SPEED_M_S, distance_m=distance)
        for distance in (0.42, -0.42)
    )
    assert there.command.times_s.tolist() == back.command.times_s.tolist()
    assert there.distance_m == -back.distance_m
    mirrored = replace(back.command, amplitudes=-back.command.amplitudes)
    # The sets go by |command|: mirrored, the command drives them in the same order.
    assert mirrored.accelerates.tolist() == there.command.accelerates.tolist()
    assert residual_vibration(mirrored, CRANE.mode, actuator) < 1e-9
    wrong = residual_vibration(there.command, CRANE.mode, swap_directions(actuator))
    assert wrong > 0.01


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("pulse_s", [1.8, 0.9])
def test_pulse_and_distance_are_two_ways_to_ask_for_one_move(model: Model, pulse_s: float) -> None:
    actuator = replace(THESIS, model=model)
    asked = maneuver(CRANE, actuator, NUMZVD, speed_m_s=SPEED_M_S, pulse_s=pulse_s)
    again = maneuver(CRANE, actuator, NUMZVD, speed_m_s=SPEED_M_S, distance_m=asked.distance_m)
    # Equations are solved to 1e-13; the slopes that turn them into times are of order 1 to 100.
    np.testing.assert_allclose(again.command.times_s, asked.command.times_s, atol=1e-9)


@pytest.mark.parametrize("model", MODELS)
def test_the_mirrored_stop_of_the_thesis_leaves_clearly_more(model: Model) -> None:
    actuator = replace(THESIS, model=model)
    move = maneuver(CRANE, actuator, NUMZVD, speed_m_s=SPEED_M_S, distance_m=0.42)
    mirrored = mirrored_stop(move.start)
    whole = Impulses(
        times_s=np.concatenate((move.start.times_s, move.pulse_s + mirrored.times_s)),
        amplitudes=np.concatenate((move.start.amplitudes, mirrored.amplitudes)),
    )
    left = residual_vibration(whole, CRANE.mode, actuator)
    assert move.residual < 1e-9
    assert left > 1e-3  # 0.56 % superposed, 0.15 % switched: a million times as much


def test_the_mirrored_stop_has_the_gaps_in_reverse_order() -> None:
    start = Impulses(times_s=np.array([0.0, 1.0, 3.0]), amplitudes=np.array([1.0, -1.0, 1.0]))
    stop = mirrored_stop(start)
    assert stop.times_s.tolist() == [0, 2, 3]  # t5 = t4 + t3 - t2, t6 = t5 + t2 - t1
    assert stop.amplitudes.tolist() == [-1, 1, -1]


@pytest.mark.parametrize("kind", [NUMZV, NUMZVD], ids=lambda kind: kind.name)
def test_behind_a_symmetric_actuator_a_stop_mirrors_the_start(kind: ShaperKind) -> None:
    actuator = SecondOrder(accel=THESIS.accel, decel=THESIS.accel)
    move = maneuver(CRANE, actuator, kind, speed_m_s=SPEED_M_S, distance_m=0.42)
    gaps = np.diff(move.start.times_s)
    # Without damping a shaper's own gaps are symmetric too, so forward and reverse agree.
    np.testing.assert_allclose(np.diff(move.stop.times_s), gaps[::-1], atol=1e-9)
    np.testing.assert_allclose(
        np.diff(move.stop.times_s), np.diff(mirrored_stop(move.start).times_s), atol=1e-9
    )


def test_a_switched_stop_is_solved_for_the_state_it_finds() -> None:
    pulse_s = 1.4
    move = maneuver(CRANE, SWITCHED, NUMZVD, speed_m_s=SPEED_M_S, pulse_s=pulse_s)
    from_rest = design(CRANE, swap_directions(SWITCHED), NUMZVD).impulses
    apart = Impulses(
        times_s=np.concatenate((move.start.times_s, pulse_s + from_rest.times_s)),
        amplitudes=np.concatenate((move.start.amplitudes, -from_rest.amplitudes)),
    )
    assert not move.joint
    assert not certify(apart, CRANE.mode, SWITCHED, zeros(NUMZVD.claims)).verified
    assert move.certificate.verified
    assert move.residual < 1e-9


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("kind", [NUMZV, NUMZVD], ids=lambda kind: kind.name)
def test_twenty_pulses_down_to_a_twentieth_of_a_second_are_certified(
    kind: ShaperKind, model: Model
) -> None:
    actuator = replace(THESIS, model=model)
    start_s = design(CRANE, actuator, kind).impulses.duration_s
    durations = []
    for pulse_s in np.linspace(2.0, 0.05, 20).tolist():
        move = maneuver(CRANE, actuator, kind, speed_m_s=SPEED_M_S, pulse_s=pulse_s)
        assert move.certificate.verified
        assert move.residual <= 1e-9
        assert set(levels(move)) <= {0.0, 1.0}
        assert levels(move)[-1] == 0
        assert move.joint == (pulse_s < start_s)
        assert np.diff(move.command.times_s).min() > 1e-3  # no step that no drive can follow
        durations.append(move.duration_s)
    assert durations == sorted(durations, reverse=True)  # a shorter move takes less time


@pytest.mark.parametrize("model", MODELS)
def test_a_short_pulse_goes_as_far_as_its_start_and_stop_would(model: Model) -> None:
    actuator = replace(THESIS, model=model)
    long, short = (
        maneuver(CRANE, actuator, NUMZVD, speed_m_s=SPEED_M_S, pulse_s=pulse_s)
        for pulse_s in (4.0, 0.5)
    )
    assert short.joint
    # At a pulse of 4 s the actuator is at rest between start and stop to e^-50.
    assert long.distance_m - short.distance_m == pytest.approx(SPEED_M_S * 3.5, abs=1e-12)


@pytest.mark.parametrize("actuator", [THESIS, SWITCHED], ids=MODELS)
@pytest.mark.parametrize("distance_m", [0.42, 0.1])
def test_a_shaper_that_knows_no_actuator_is_proven_for_the_ideal_one(
    actuator: Actuator, distance_m: float
) -> None:
    move = maneuver(CRANE, actuator, UMZVD, speed_m_s=SPEED_M_S, distance_m=distance_m)
    assert certify(move.command, CRANE.mode, Ideal(), zeros(UMZVD.claims)).verified
    assert move.certificate.verified
    assert move.residual == residual_vibration(move.command, CRANE.mode, actuator)
    assert move.residual > 0.01
    assert move.distance_m == pytest.approx(distance_m, rel=1e-12)  # behind the actuator given


def test_settling_on_request_holds_for_the_whole_move() -> None:
    options = SettleOptions(settle=True)
    shortest = min(settling_time_s(lag) for lag in (THESIS.accel_lag, THESIS.decel_lag))
    for pulse_s in (2.0, 1.0):
        move = maneuver(
            CRANE, THESIS, NUMZVD, speed_m_s=SPEED_M_S, pulse_s=pulse_s, options=options
        )
        assert move.warnings == ()
        assert np.diff(move.command.times_s).min() > 0.999 * shortest


def test_a_move_that_is_not_found_is_refused_with_the_number_of_starts() -> None:
    # Every pulse must last until the actuator has settled: there is no time for that.
    options = PeakOptions(settle=True, max_velocity_ratio=0.9)
    with refused("no_move_found", says=r"times its speed within .* in \d+ starts$"):
        maneuver(CRANE, THESIS, NUMZV, speed_m_s=SPEED_M_S, pulse_s=0.05, options=options)


def test_a_stop_that_does_not_exist_is_no_obstacle_to_a_move_solved_as_one() -> None:
    # alpha = 1/3 for the start, 3 for the stop, whose three vectors cannot close.
    mode = Mode(natural_frequency_rad_s=1.0)
    actuator = FirstOrder(accel_time_constant_s=0.0, decel_time_constant_s=math.sqrt(8))
    with refused("alpha_above_two"):
        design(mode, swap_directions(actuator), NUMZV)
    move = maneuver(mode, actuator, NUMZV, speed_m_s=1.0, distance_m=20.0)
    assert move.joint
    assert move.certificate.verified
    assert travel_by_integration(move.command, actuator) == pytest.approx(20.0, abs=1e-8)
    # By matrix exponentials to the end: an integrator would have to wait for so slow a lag.
    assert expm_route.outcome(move.command, mode, actuator, (0.0, 0.0)).residual < 1e-9


@pytest.mark.parametrize("seed", range(24))
def test_any_move_is_certified_and_in_range_or_refused_with_its_reason(seed: int) -> None:
    rng = np.random.default_rng(seed)
    w = float(rng.uniform(0.5, 6.0))
    mode = Mode(natural_frequency_rad_s=w, damping_ratio=float(rng.choice([0.0, 0.05, 0.15])))
    actuator = any_actuator(rng, w, MODELS[seed % 2])
    kind = (NUMZV, NUMZVD)[seed // 2 % 2]
    distance_m = float(SPEED_M_S * mode.period_s * rng.uniform(0.05, 2.0))
    try:
        move = maneuver(mode, actuator, kind, speed_m_s=SPEED_M_S, distance_m=distance_m)
    except InfeasibleDesignError as error:
        reason = str(error)
        if "starts" not in reason and "alpha" not in reason:
            raise
        return
    assert move.certificate.verified
    assert move.residual <= 1e-9
    assert move.distance_m == pytest.approx(distance_m, rel=1e-12)
    assert set(levels(move)) <= {0.0, 1.0}
    assert SPEED_M_S * travel_by_integration(move.command, actuator) == pytest.approx(
        distance_m, abs=1e-9
    )


def test_a_move_scales_with_time() -> None:
    slow = FirstOrder(accel_time_constant_s=0.06, decel_time_constant_s=0.024)
    twice = Mode(natural_frequency_rad_s=DAMPED.natural_frequency_rad_s / 2, damping_ratio=0.08)
    for pulse_s in (2.0, 0.5):
        one = maneuver(DAMPED, FIRST_ORDER, NUMZVD, speed_m_s=1.0, pulse_s=pulse_s)
        other = maneuver(twice, slow, NUMZVD, speed_m_s=1.0, pulse_s=2 * pulse_s)
        np.testing.assert_allclose(other.command.times_s, 2 * one.command.times_s, atol=1e-9)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"pulse_s": 0.0}, "pulse_s"),
        ({"pulse_s": -1.0}, "pulse_s"),
        ({"pulse_s": math.nan}, "pulse_s"),
        ({"pulse_s": 1e6}, "pulse_s"),
        ({"distance_m": 0.0}, "distance_m"),
        ({"distance_m": math.inf}, "distance_m"),
        ({"distance_m": 1e6}, "distance_m"),
        ({}, "pulse_s"),
        ({"pulse_s": 1.0, "distance_m": 0.2}, "pulse_s"),
        ({"distance_m": 0.42, "speed_m_s": 0.0}, "speed_m_s"),
        ({"distance_m": 0.42, "speed_m_s": -0.2}, "speed_m_s"),
        ({"pulse_s": 2.0, "speed_m_s": 0.0}, "speed_m_s"),
        ({"pulse_s": 2.0, "speed_m_s": math.nan}, "speed_m_s"),
    ],
)
def test_bad_numbers_are_refused_by_name(arguments: dict[str, float], name: str) -> None:
    with pytest.raises(InvalidInputError) as caught:
        maneuver(CRANE, THESIS, NUMZVD, **{"speed_m_s": SPEED_M_S, **arguments})  # type: ignore[arg-type]
    assert caught.value.name == name


def test_a_whole_move_that_does_not_keep_its_claims_is_a_failure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pulse = Impulses(times_s=np.array([0.0, 2.0]), amplitudes=np.array([1.0, -1.0]))
    whole = WholeCommand(command=pulse, joint=True)
    monkeypatch.setattr("design.moves.maneuvers.over_pulse", lambda *_: whole)
    left = residual_vibration(pulse, CRANE.mode, THESIS)
    with refused("move_not_verified", says=rf"of numzv .*: the residual is {left:.3g}, allowed"):
        maneuver(CRANE, THESIS, NUMZV, speed_m_s=SPEED_M_S, pulse_s=2.0)


def test_a_stop_that_no_solution_verifies_is_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    options = PeakOptions(max_velocity_ratio=1.25)
    monkeypatch.setattr("design.moves.designed_parts.solve", lambda *_: iter(()))
    with refused("stop_not_verified", says="^the stop of numzv was not verified$"):
        maneuver(CRANE, THESIS, NUMZV, speed_m_s=SPEED_M_S, distance_m=0.8, options=options)
