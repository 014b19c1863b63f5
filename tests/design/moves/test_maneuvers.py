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
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.initial_state import AngleSwing
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.moves.maneuvers import Maneuver, maneuver, mirrored_stop, swap_directions
from design.pipeline import design
from design.response.closed_form import travel
from design.shapers.kind import ShaperKind
from design.shapers.options import PeakOptions, SettleOptions
from design.shapers.registry import SHAPERS
from tests.refusals import refused
from tests.second_route import integrate, residual_by_integration
from tests.shaper_table import CRANE, DAMPED, FIRST_ORDER, IDEAL, THESIS

NUMZV, NUMZVD, UMZVC, UMZVD = (SHAPERS[name] for name in ("numzv", "numzvd", "umzvc", "umzvd"))
MODELS: tuple[Model, ...] = ("superposed", "switched")
SPEED_M_S = 0.2
SWITCHED = replace(THESIS, model="switched")

CRANES = [
    pytest.param(kind, replace(actuator, model=model), id=f"{kind.name}-{model}")
    for kind, actuator in ((UMZVC, FIRST_ORDER), (NUMZV, THESIS), (NUMZVD, THESIS))
    for model in MODELS
]


def levels(move: Maneuver) -> list[float]:
    return [float(level) for level in np.cumsum(move.command.amplitudes)]


def travel_by_integration(command: Impulses, actuator: Actuator) -> float:
    """How far a command goes: the deflection of a payload without restoring force is -x."""
    floating = Mode(natural_frequency_rad_s=1e-9)
    slowest = max(
        lag.first_s + lag.second_s2**0.5 for lag in (actuator.accel_lag, actuator.decel_lag)
    )
    end = float(command.times_s[-1]) + 40 * slowest  # e^-40 of the transient is left
    return -float(integrate(command, floating, actuator, end)[0])


def any_actuator(rng: np.random.Generator, w: float, model: Model) -> Actuator:
    corners = (w * rng.uniform(4, 20, 2)).tolist()
    if rng.random() < 0.3:
        return FirstOrder(
            accel_time_constant_s=1 / corners[0], decel_time_constant_s=1 / corners[1], model=model
        )
    accel, decel = (
        SecondOrderSet(natural_frequency_rad_s=corner, damping_ratio=float(rng.uniform(0.4, 1.6)))
        for corner in corners
    )
    return SecondOrder(accel=accel, decel=decel, model=model)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("seed", range(12))
def test_travel_agrees_with_an_integrator(seed: int, model: Model) -> None:
    rng = np.random.default_rng(seed)
    actuator = any_actuator(rng, 3.0, model)
    amplitudes = rng.uniform(-1, 1, 5)
    command = Impulses(
        times_s=np.sort(rng.uniform(0, 3, 6)), amplitudes=np.append(amplitudes, -amplitudes.sum())
    )
    # The integrator's tolerance is 1e-11 a step.
    assert travel(command, actuator) == pytest.approx(
        travel_by_integration(command, actuator), abs=1e-9
    )


@pytest.mark.parametrize("model", MODELS)
def test_travel_holds_where_a_set_follows_at_once(model: Model) -> None:
    actuator = FirstOrder(accel_time_constant_s=0.2, decel_time_constant_s=0.0, model=model)
    command = Impulses(
        times_s=np.array([0.0, 0.1, 0.4, 1.0]), amplitudes=np.array([1.0, -1.0, 1.0, -1.0])
    )
    assert travel(command, actuator) == pytest.approx(
        travel_by_integration(command, actuator), abs=1e-9
    )


def test_travel_does_not_depend_on_the_clock() -> None:
    command = Impulses(times_s=np.array([0.0, 1.5]), amplitudes=np.array([1.0, -1.0]))
    later = replace(command, times_s=command.times_s + 1024.0)  # exact in binary
    assert travel(later, THESIS) == travel(command, THESIS)


def test_a_command_that_does_not_end_at_rest_has_no_travel() -> None:
    step = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
    with refused("command_not_to_rest", "amplitudes", says="of sum 0: a command to rest"):
        travel(step, THESIS)


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


def test_a_negative_speed_with_a_pulse_moves_in_minus_x() -> None:
    there, back = (
        maneuver(CRANE, THESIS, NUMZVD, speed_m_s=speed, pulse_s=1.9)
        for speed in (SPEED_M_S, -SPEED_M_S)
    )
    assert there.command.times_s.tolist() == back.command.times_s.tolist()
    assert (back.direction, back.distance_m, back.speed_m_s) == (-1, -there.distance_m, SPEED_M_S)


def test_a_pulse_is_from_first_step_to_first_step() -> None:
    move = maneuver(CRANE, THESIS, NUMZVD, speed_m_s=SPEED_M_S, pulse_s=1.75)
    assert move.pulse_s == 1.75
    assert move.start.amplitudes.tolist() == [1, -1, 1, -1, 1]
    assert move.stop.amplitudes.tolist() == [-1, 1, -1, 1, -1]
    assert move.stop.times_s[0] == 1.75
    assert move.command.times_s.tolist() == [*move.start.times_s, *move.stop.times_s]
    assert move.duration_s == move.stop.times_s[-1]


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
    shortest = min(lag.settling_time_s() for lag in (THESIS.accel_lag, THESIS.decel_lag))
    for pulse_s in (2.0, 1.0):
        move = maneuver(
            CRANE, THESIS, NUMZVD, speed_m_s=SPEED_M_S, pulse_s=pulse_s, options=options
        )
        assert move.warnings == ()
        assert np.diff(move.command.times_s).min() > 0.999 * shortest


def test_a_move_that_is_not_found_is_refused_with_the_number_of_starts() -> None:
    # Every pulse must last until the actuator has settled: there is no time for that.
    options = SettleOptions(settle=True)
    with refused("no_move_found", says=r"times its speed within .* in \d+ starts$"):
        maneuver(CRANE, THESIS, NUMZVD, speed_m_s=SPEED_M_S, pulse_s=0.05, options=options)


def test_a_pulse_shorter_than_the_lag_it_loses_goes_nowhere() -> None:
    with refused("pulse_goes_nowhere", says=r"^a pulse of 0\.05 s goes nowhere"):
        maneuver(CRANE, THESIS, UMZVD, speed_m_s=SPEED_M_S, pulse_s=0.05)


def test_a_stop_that_does_not_exist_is_named() -> None:
    # alpha = 1/3 for the start, 3 for the stop, whose three vectors cannot close.
    actuator = FirstOrder(accel_time_constant_s=0.0, decel_time_constant_s=math.sqrt(8))
    with refused("alpha_above_two", says=r"^the start exists, the stop does not: alpha"):
        maneuver(Mode(natural_frequency_rad_s=1.0), actuator, NUMZV, speed_m_s=1.0, distance_m=20.0)


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


def test_the_ideal_actuators_pulse_is_its_travel() -> None:
    move = maneuver(CRANE, IDEAL, NUMZVD, speed_m_s=SPEED_M_S, pulse_s=2.1)
    assert move.distance_m == pytest.approx(0.42, rel=1e-14)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("distance_m", [3.0, 100.0])
def test_a_drive_that_hardly_comes_to_rest_goes_as_far_as_asked(
    model: Model, distance_m: float
) -> None:
    slow = FirstOrder(accel_time_constant_s=3.0, decel_time_constant_s=2.0, model=model)
    for kind in (UMZVD, NUMZV):
        move = maneuver(CRANE, slow, kind, speed_m_s=SPEED_M_S, distance_m=distance_m)
        assert move.certificate.verified
        assert move.distance_m == pytest.approx(distance_m, rel=1e-12)


@pytest.mark.parametrize("model", MODELS)
def test_solved_as_one_on_request_a_move_takes_no_longer(model: Model) -> None:
    actuator = replace(THESIS, model=model)
    for distance_m in (0.1, 0.3, 0.42, 2.0):
        apart, one = (
            maneuver(
                CRANE, actuator, NUMZVD, speed_m_s=SPEED_M_S, distance_m=distance_m, joint=joint
            )
            for joint in (False, True)
        )
        assert one.certificate.verified
        assert one.distance_m == pytest.approx(distance_m, rel=1e-12)
        assert set(levels(one)) <= {0.0, 1.0}
        assert one.duration_s <= apart.duration_s
        if distance_m == 0.3:  # just above the overlap: half a second
            assert apart.duration_s - one.duration_s > 0.5
            assert one.joint
            assert not apart.joint


def test_a_pulse_solved_as_one_on_request_goes_as_far() -> None:
    apart, one = (
        maneuver(CRANE, THESIS, NUMZVD, speed_m_s=SPEED_M_S, pulse_s=1.5, joint=joint)
        for joint in (False, True)
    )
    assert one.distance_m == pytest.approx(apart.distance_m, rel=1e-12)
    assert one.duration_s < apart.duration_s


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("plant", [CRANE, DAMPED], ids=["undamped", "damped"])
@pytest.mark.parametrize("peak", [0.8, 1.25, 2.6])
def test_a_peak_above_or_below_the_cruise_speed_leaves_nothing(
    plant: Plant, peak: float, model: Model
) -> None:
    actuator = replace(THESIS, model=model)
    options = PeakOptions(max_velocity_ratio=peak)
    for distance_m in (0.8, -0.8):
        move = maneuver(
            plant, actuator, NUMZV, speed_m_s=SPEED_M_S, distance_m=distance_m, options=options
        )
        assert not move.joint
        assert move.start.amplitudes.tolist() == [peak, -peak, 1.0]
        assert move.stop.amplitudes.tolist() == [-1.0, peak, -peak]
        assert move.certificate.verified
        assert move.distance_m == pytest.approx(distance_m, rel=1e-12)
        assert residual_by_integration(move.command, plant.mode, actuator) < 1e-8


@pytest.mark.parametrize("model", MODELS)
def test_a_short_move_with_a_peak_is_solved_on_the_peak(model: Model) -> None:
    actuator, options = replace(THESIS, model=model), PeakOptions(max_velocity_ratio=1.25)
    move = maneuver(CRANE, actuator, NUMZV, speed_m_s=SPEED_M_S, distance_m=0.05, options=options)
    assert move.joint
    assert {round(level, 12) for level in levels(move)} == {0.0, 1.25}
    assert move.distance_m == pytest.approx(0.05, rel=1e-12)
    assert residual_by_integration(move.command, CRANE.mode, actuator) < 1e-8


@pytest.mark.parametrize("model", MODELS)
def test_a_swing_is_cancelled_with_a_peak_too(model: Model) -> None:
    move = maneuver(
        CRANE,
        replace(THESIS, model=model),
        NUMZV,
        speed_m_s=SPEED_M_S,
        distance_m=0.8,
        initial=AngleSwing(angle_rad=0.02, angle_rate_rad_s=0.03),
        options=PeakOptions(max_velocity_ratio=1.25),
    )
    assert move.start.amplitudes.tolist() == [1.25, -1.25, 1.0]
    assert move.certificate.verified


def test_as_one_on_request_and_a_peak_do_not_go_together() -> None:
    with refused("joint_beyond_unit_velocity", "joint"):
        maneuver(
            CRANE,
            THESIS,
            NUMZV,
            speed_m_s=SPEED_M_S,
            distance_m=0.8,
            joint=True,
            options=PeakOptions(max_velocity_ratio=1.25),
        )
