"""Moves that begin while the payload swings: cancelled and proven, or refused with the reason."""

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest

from design.analysis.certificate import certify
from design.analysis.residual import residual_vibration
from design.claims import zeros
from design.errors import InfeasibleDesignError
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.commands import step
from design.model.initial_state import AngleSwing, DeflectionSwing, InitialSwing, free_swing
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.moves.maneuvers import Maneuver, maneuver
from design.shapers.kind import ShaperKind
from design.shapers.peak_options import PeakOptions
from design.shapers.registry import SHAPERS
from tests.design.moves.cranes import any_actuator, levels
from tests.integration_route import integrate
from tests.refusals import refused
from tests.shaper_table import CRANE, DAMPED, FIRST_ORDER, IDEAL, THESIS

UMZV, UMZVC, NUMZV, NUMZVD = (SHAPERS[name] for name in ("umzv", "umzvc", "numzv", "numzvd"))
MODELS: tuple[Model, ...] = ("superposed", "switched")
SPEED_M_S = 0.2
SWING = AngleSwing(angle_rad=0.02, angle_rate_rad_s=0.03)
DEFLECTION = DeflectionSwing(deflection_m=0.01, deflection_rate_m_s=-0.02)


def left_behind(
    move: Maneuver, plant: Plant, actuator: Actuator, initial: InitialSwing, ratio: float = 1.0
) -> float:
    """Amplitude after the move over full speed, by integration, with the frequency off by a ratio.

    A pendulum's frequency is off as its cable is longer or shorter; its angle is what was measured.
    """
    mode = replace(plant.mode, natural_frequency_rad_s=ratio * plant.mode.natural_frequency_rad_s)
    if isinstance(initial, AngleSwing):
        assert isinstance(plant, Pendulum)
        length = plant.gravity_m_s2 / mode.natural_frequency_rad_s**2
        state = (length * initial.angle_rad, length * initial.angle_rate_rad_s)
    else:
        state = (initial.deflection_m, initial.deflection_rate_m_s)
    signed = move.direction * move.speed_m_s
    w = mode.natural_frequency_rad_s
    end = float(move.command.times_s[-1]) + 14 / w
    deflection, rate, _ = integrate(
        move.command, mode, actuator, end, (state[0] / signed, state[1] / signed)
    )
    return math.hypot(w * deflection, rate) * math.exp(14 * mode.damping_ratio)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("kind", [UMZVC, NUMZV, NUMZVD], ids=lambda kind: kind.name)
@pytest.mark.parametrize("distance_m", [0.42, -0.42, 0.1])
def test_the_payload_hangs_still_after_the_move(
    kind: ShaperKind, model: Model, distance_m: float
) -> None:
    actuator = replace(FIRST_ORDER if kind is UMZVC else THESIS, model=model)
    move = maneuver(
        CRANE, actuator, kind, speed_m_s=SPEED_M_S, distance_m=distance_m, initial=SWING
    )
    assert move.certificate.verified
    assert move.residual <= 1e-9
    assert move.distance_m == pytest.approx(distance_m, rel=1e-12)
    assert set(levels(move)) <= {0.0, 1.0}
    assert left_behind(move, CRANE, actuator, SWING) < 1e-8  # the integrator's error
    at_rest = maneuver(CRANE, actuator, kind, speed_m_s=SPEED_M_S, distance_m=distance_m)
    assert left_behind(at_rest, CRANE, actuator, SWING) > 0.1


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(
    ("plant", "initial"), [(CRANE, SWING), (DAMPED, DEFLECTION)], ids=["angle", "deflection"]
)
def test_an_error_in_frequency_counts_only_by_its_square(
    plant: Plant, initial: InitialSwing, model: Model
) -> None:
    actuator = replace(THESIS, model=model)
    robust, plain = (
        maneuver(plant, actuator, kind, speed_m_s=SPEED_M_S, distance_m=0.42, initial=initial)
        for kind in (NUMZVD, NUMZV)
    )
    for ratio in (0.999, 1.001):
        # Of second order: a thousandth leaves some times a millionth; of first, thousandths.
        assert left_behind(robust, plant, actuator, initial, ratio) < 1e-4
        assert left_behind(plain, plant, actuator, initial, ratio) > 1e-3


@pytest.mark.parametrize("kind", [UMZV, NUMZV, NUMZVD], ids=lambda kind: kind.name)
def test_by_pulse_in_minus_x_a_mirrored_swing_is_the_same_move(kind: ShaperKind) -> None:
    one = maneuver(DAMPED, IDEAL, kind, speed_m_s=0.2, pulse_s=2.0, initial=DEFLECTION)
    mirrored = DeflectionSwing(deflection_m=-0.01, deflection_rate_m_s=0.02)
    other = maneuver(DAMPED, IDEAL, kind, speed_m_s=-0.2, pulse_s=2.0, initial=mirrored)
    np.testing.assert_array_equal(one.command.times_s, other.command.times_s)
    assert other.distance_m == -one.distance_m


def test_no_swing_is_the_move_from_rest() -> None:
    still = AngleSwing(angle_rad=0.0, angle_rate_rad_s=0.0)
    one, other = (
        maneuver(CRANE, THESIS, NUMZVD, speed_m_s=SPEED_M_S, distance_m=0.42, initial=initial)
        for initial in (still, None)
    )
    np.testing.assert_array_equal(one.command.times_s, other.command.times_s)


def test_a_small_swing_moves_the_switches_a_little() -> None:
    rest = maneuver(CRANE, THESIS, NUMZVD, speed_m_s=SPEED_M_S, distance_m=0.42)
    swings = [AngleSwing(angle_rad=angle, angle_rate_rad_s=0.0) for angle in (1e-4, 2e-4)]
    moved = [
        maneuver(CRANE, THESIS, NUMZVD, speed_m_s=SPEED_M_S, distance_m=0.42, initial=swing)
        for swing in swings
    ]
    once, twice = (move.command.times_s - rest.command.times_s for move in moved)
    assert 1e-6 < np.abs(once).max() < 1e-2
    np.testing.assert_allclose(twice, 2 * once, atol=0.05 * float(np.abs(once).max()))


@pytest.mark.parametrize("plant", [CRANE, DAMPED], ids=["undamped", "damped"])
def test_in_the_dead_time_the_payload_swings_freely(plant: Plant) -> None:
    delay_s = 0.3
    initial: InitialSwing = SWING if isinstance(plant, Pendulum) else DEFLECTION
    late = replace(THESIS, dead_time_s=delay_s)
    move = maneuver(plant, late, NUMZVD, speed_m_s=SPEED_M_S, distance_m=0.42, initial=initial)
    assert move.certificate.verified
    delayed = replace(move.command, times_s=move.command.times_s + delay_s)
    # What moves nothing at time 0 only starts the integrator's clock there.
    clock = replace(
        delayed,
        times_s=np.concatenate(([0.0], delayed.times_s)),
        amplitudes=np.concatenate(([0.0], delayed.amplitudes)),
    )
    assert left_behind(replace(move, command=clock), plant, THESIS, initial) < 1e-8


def test_the_vector_of_a_swing_is_that_of_the_step_that_makes_it() -> None:
    # An ideal step at time 0 leaves the state (0, -1): the swing cancels what the step would.
    swing = free_swing(DAMPED, DeflectionSwing(deflection_m=0, deflection_rate_m_s=0.2), 0.2)
    assert swing is not None
    assert swing.vector(DAMPED) == pytest.approx(-1)
    assert residual_vibration(step(), DAMPED, IDEAL, swing) == pytest.approx(0, abs=1e-15)
    assert certify(step(), DAMPED, IDEAL, zeros(("residual",)), swing).verified


def test_a_swing_carried_on_is_its_vector_turned() -> None:
    later_s, w, z = 0.7, DAMPED.natural_frequency_rad_s, DAMPED.damping_ratio
    pole = w * complex(-z, math.sqrt(1 - z * z))
    carried = integrate(step(), DAMPED, IDEAL, later_s, (0.05, 1.2))
    # An ideal step takes 1 off the rate at once: from 1.2 to 0.2.
    before = free_swing(DAMPED, DeflectionSwing(deflection_m=0.05, deflection_rate_m_s=0.2), 1.0)
    after = free_swing(
        DAMPED,
        DeflectionSwing(deflection_m=float(carried[0]), deflection_rate_m_s=float(carried[1])),
        1.0,
    )
    assert before is not None
    assert after is not None
    turned = before.vector(DAMPED) * cmath.exp(pole * later_s)
    assert after.vector(DAMPED) == pytest.approx(turned, abs=1e-9)


@pytest.mark.parametrize("model", MODELS)
def test_a_swing_too_large_is_refused_with_its_size(model: Model) -> None:
    large = AngleSwing(angle_rad=0.6, angle_rate_rad_s=0.0)
    with refused(
        "swing_not_cancelled",
        says=r"^the swing at the first step is 8\.\d+ times that of one unshaped step.* % of it",
    ):
        maneuver(
            CRANE,
            replace(THESIS, model=model),
            NUMZV,
            speed_m_s=SPEED_M_S,
            distance_m=0.2,
            initial=large,
        )


@pytest.mark.parametrize("seed", range(16))
def test_any_swing_is_cancelled_or_refused_with_its_reason(seed: int) -> None:
    rng = np.random.default_rng(seed)
    w = float(rng.uniform(0.5, 6.0))
    mode = Mode(natural_frequency_rad_s=w, damping_ratio=float(rng.choice([0.0, 0.05, 0.15])))
    actuator = any_actuator(rng, w, MODELS[seed % 2])
    kind = (NUMZV, NUMZVD)[seed // 2 % 2]
    distance_m = float(SPEED_M_S * mode.period_s * rng.uniform(0.3, 2.0) * rng.choice([-1, 1]))
    size, phase = SPEED_M_S * rng.uniform(0, 0.3), rng.uniform(0, 2 * np.pi)
    initial = DeflectionSwing(
        deflection_m=float(size * np.cos(phase) / w),
        deflection_rate_m_s=float(size * np.sin(phase)),
    )
    try:
        move = maneuver(
            mode, actuator, kind, speed_m_s=SPEED_M_S, distance_m=distance_m, initial=initial
        )
    except InfeasibleDesignError as error:
        reason = str(error)
        if "unshaped step" not in reason:
            raise
        return
    assert move.certificate.verified
    assert set(levels(move)) <= {0.0, 1.0}
    assert move.distance_m == pytest.approx(distance_m, rel=1e-12)
    assert left_behind(move, mode, actuator, initial) < 1e-8


@pytest.mark.parametrize(
    ("plant", "initial"), [(CRANE, DEFLECTION), (DAMPED, SWING)], ids=["pendulum", "mode"]
)
def test_the_other_plants_form_of_a_swing_is_refused(plant: Plant, initial: InitialSwing) -> None:
    with refused("state_of_other_plant", "initial", says="for a (pendulum|mode)"):
        maneuver(plant, THESIS, NUMZV, speed_m_s=1.0, distance_m=1.0, initial=initial)


def test_a_swing_out_of_all_size_is_refused_by_name() -> None:
    with refused("out_of_range", "angle_rad"):
        AngleSwing(angle_rad=math.nan, angle_rate_rad_s=0.0)
    with refused("out_of_range", "deflection_rate_m_s"):
        DeflectionSwing(deflection_m=0.0, deflection_rate_m_s=math.inf)
    with refused("swing_too_large", "initial"):
        free_swing(DAMPED, DeflectionSwing(deflection_m=1e9, deflection_rate_m_s=0.0), 1e-9)


def test_a_swing_through_a_dead_time_out_of_all_proportion_is_refused() -> None:
    late = replace(THESIS, dead_time_s=1e6)
    with refused("dead_time_too_long", "actuator.dead_time_s"):
        maneuver(CRANE, late, NUMZV, speed_m_s=SPEED_M_S, distance_m=0.42, initial=SWING)


@pytest.mark.parametrize("model", MODELS)
def test_behind_a_rate_limited_actuator_a_swing_is_cancelled_too(model: Model) -> None:
    limited = RateLimited(
        accel_limit_m_s2=2.0,
        decel_limit_m_s2=3.0,
        speed_m_s=SPEED_M_S,
        then=replace(FIRST_ORDER, model=model),
    )
    for kind in (NUMZV, NUMZVD):
        move = maneuver(CRANE, limited, kind, speed_m_s=SPEED_M_S, distance_m=0.42, initial=SWING)
        assert move.certificate.verified
        assert move.residual <= 1e-9


def test_a_peak_behind_a_rate_limited_actuator_is_refused() -> None:
    limited = RateLimited(accel_limit_m_s2=2.0, decel_limit_m_s2=3.0, speed_m_s=SPEED_M_S)
    with refused("velocity_ratio_of_ramps", "shaper.max_velocity_ratio", says="1 behind"):
        maneuver(
            CRANE,
            limited,
            NUMZV,
            speed_m_s=SPEED_M_S,
            distance_m=0.42,
            options=PeakOptions(max_velocity_ratio=1.25),
        )
