"""Time histories and ringing: closed forms, plain integration, invariance."""

import cmath
import math

import numpy as np
import pytest

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.response.closed_form import History, history
from design.response.simulation import ringing_after
from design.types import FloatArray
from tests.integration_route import integrate
from tests.second_route import claims_by_formula, gain_and_slope
from tests.shaper_table import CRANE, FIRST_ORDER, IDEAL, THESIS

COMMAND = Impulses(
    times_s=np.array([0.0, 0.18, 0.66, 1.18, 1.32]), amplitudes=np.array([1.0, -1, 1, -1, 1])
)
STEP = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
TIMES = np.linspace(-0.5, 6.0, 301)
DAMPED = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.07)
CRITICAL = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=1.0),
    decel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=1.0),
)
HALF_IDEAL = FirstOrder(accel_time_constant_s=0.0, decel_time_constant_s=0.1)
ACTUATORS: dict[str, Actuator] = {
    "ideal": IDEAL,
    "first order": FIRST_ORDER,
    "one set ideal": HALF_IDEAL,
    "thesis": THESIS,
    "critical": CRITICAL,
}


def swing(mode: Mode, times: FloatArray) -> FloatArray:
    """Deflection times w after a unit step of velocity at 0: the free swing, backward first."""
    w, z = mode.natural_frequency_rad_s, mode.damping_ratio
    wd = w * math.sqrt(1 - z * z)
    after = np.maximum(times, 0.0)
    return -w / wd * np.exp(-z * w * after) * np.sin(wd * after)


@pytest.mark.parametrize("z", [0.0, 0.07, 0.5])
def test_behind_an_ideal_actuator_every_step_adds_its_free_swing(z: float) -> None:
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=z)
    swings = [
        a * swing(mode, TIMES - t) for t, a in zip(COMMAND.times_s, COMMAND.amplitudes, strict=True)
    ]
    # Roundings of five terms of size one.
    assert history(COMMAND, mode, IDEAL, TIMES).deflection == pytest.approx(
        np.sum(swings, axis=0), abs=1e-13
    )


def test_a_first_order_velocity_is_made_of_exponentials_by_set() -> None:
    expected = np.zeros_like(TIMES)
    for time, amplitude in zip(COMMAND.times_s, COMMAND.amplitudes, strict=True):
        constant = 0.03 if amplitude > 0 else 0.012
        elapsed = np.maximum(TIMES - time, 0.0)
        expected += amplitude * (1 - np.exp(-elapsed / constant))
    result = history(COMMAND, DAMPED, FIRST_ORDER, TIMES)
    assert result.velocity == pytest.approx(expected, abs=1e-13)  # roundings of five terms


@pytest.mark.parametrize("name", ACTUATORS)
@pytest.mark.parametrize("until", [0.1, 0.5, 1.32, 3.0])
def test_the_history_is_what_plain_integration_gives(name: str, until: float) -> None:
    deflection, _, velocity = integrate_to(COMMAND, ACTUATORS[name], until)
    exact = history(COMMAND, DAMPED, ACTUATORS[name], np.array([until]))
    # The integration is asked for 1e-11.
    assert exact.deflection[0] == pytest.approx(3.5 * deflection, abs=1e-9)
    assert exact.velocity[0] == pytest.approx(velocity, abs=1e-9)


def integrate_to(impulses: Impulses, actuator: Actuator, until: float) -> FloatArray:
    """Integrate over the steps up to ``until`` only."""
    past = impulses.times_s <= until
    part = Impulses(times_s=impulses.times_s[past], amplitudes=impulses.amplitudes[past])
    return integrate(part, DAMPED, actuator, until)


def test_all_is_at_rest_before_the_first_step() -> None:
    later = Impulses(times_s=COMMAND.times_s + 2.0, amplitudes=COMMAND.amplitudes)
    before = history(later, DAMPED, THESIS, np.array([-1.0, 0.0, 1.999]))
    for values in (before.command, before.velocity, before.deflection):
        assert values.tolist() == [0, 0, 0]


def test_the_command_has_stepped_at_its_own_time() -> None:
    result = history(COMMAND, DAMPED, THESIS, COMMAND.times_s)
    assert result.command.tolist() == [1, 0, 1, 0, 1]
    assert result.velocity[0] == 0  # the actuator has not moved yet


def test_velocity_and_payload_come_to_rest_at_full_speed() -> None:
    late = history(COMMAND, DAMPED, THESIS, np.array([200.0]))
    # The swing has decayed by exp(-0.07 * 3.5 * 198) = 1e-21.
    assert late.velocity[0] == pytest.approx(1.0, abs=1e-13)
    assert late.deflection[0] == pytest.approx(0.0, abs=1e-13)


def parts(result: History) -> FloatArray:
    return np.array([result.command, result.velocity, result.deflection])


@pytest.mark.parametrize("name", ACTUATORS)
def test_a_mirrored_move_has_a_mirrored_history(name: str) -> None:
    mirror = Impulses(times_s=COMMAND.times_s, amplitudes=-COMMAND.amplitudes)
    plain = parts(history(COMMAND, DAMPED, ACTUATORS[name], TIMES))
    assert (parts(history(mirror, DAMPED, ACTUATORS[name], TIMES)) == -plain).all()


def test_a_later_move_has_a_later_history() -> None:
    later = Impulses(times_s=COMMAND.times_s + 4.0, amplitudes=COMMAND.amplitudes)
    plain = parts(history(COMMAND, DAMPED, THESIS, TIMES + 1 / 512))
    shifted = parts(history(later, DAMPED, THESIS, TIMES + 4.0 + 1 / 512))
    # Adding 4 rounds the times to 1e-15; the fastest rate is 146 per second.
    assert shifted == pytest.approx(plain, abs=1e-12)


def test_time_scales_with_all_lags_and_the_period() -> None:
    slow = SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=5.0, damping_ratio=0.8),
        decel=SecondOrderSet(natural_frequency_rad_s=12.5, damping_ratio=1.5),
    )
    slow_mode = Mode(natural_frequency_rad_s=3.5 / 4, damping_ratio=0.07)
    slow_command = Impulses(times_s=4 * COMMAND.times_s, amplitudes=COMMAND.amplitudes)
    plain = parts(history(COMMAND, DAMPED, THESIS, TIMES))
    # Powers of two: nothing rounds but the lags' square roots.
    slowed = parts(history(slow_command, slow_mode, slow, 4 * TIMES))
    assert slowed == pytest.approx(plain, abs=1e-12)


@pytest.mark.parametrize("name", ACTUATORS)
@pytest.mark.parametrize("z", [0.0, 0.07, 0.5])
def test_an_unshaped_step_rings_with_the_gain_of_the_acceleration_set(name: str, z: float) -> None:
    frequencies = np.array([1.0, 3.5, 40.0])
    ringing, unit, _ = ringing_after(STEP, ACTUATORS[name], frequencies, z)
    poles = frequencies * complex(-z, math.sqrt(1 - z * z))
    gains = [gain_and_slope(ACTUATORS[name], complex(s), accel=True)[0] for s in poles]
    # A 2 x 2 solve with condition number of a few hundred at most.
    assert unit == pytest.approx(np.array(gains), rel=1e-12)
    assert ringing == pytest.approx(unit, rel=1e-12)


@pytest.mark.parametrize("name", ACTUATORS)
@pytest.mark.parametrize("z", [0.0, 0.07])
def test_ringing_over_that_of_a_step_is_the_residual_of_the_formula(name: str, z: float) -> None:
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=z)
    ratios = np.array([0.4, 1.0, 1.7])
    ringing, unit, _ = ringing_after(COMMAND, ACTUATORS[name], 3.5 * ratios, z)
    expected = [
        claims_by_formula(COMMAND, mode, ACTUATORS[name], ratio)["residual"]
        for ratio in ratios.tolist()
    ]
    # 1e-12: five exponentials of matrices of norm 200.
    assert np.abs(ringing / unit) == pytest.approx(np.array(expected), abs=1e-12)


def test_ringing_goes_on_as_a_free_swing() -> None:
    # From the last step to a step of nothing 0.9 s later: one turn of the pole, no more.
    longer = Impulses(
        times_s=np.append(COMMAND.times_s, 2.22), amplitudes=np.append(COMMAND.amplitudes, 1e-300)
    )
    w = np.array([3.5])
    now, _, _ = ringing_after(COMMAND, THESIS, w, 0.07)
    then, _, _ = ringing_after(longer, THESIS, w, 0.07)
    turn = cmath.exp(DAMPED.pole_rad_s * 0.9)
    assert then[0] == pytest.approx(now[0] * turn, abs=1e-12)  # roundings of a norm of 130


def test_a_stiff_actuator_leaves_what_an_ideal_one_leaves() -> None:
    fast = FirstOrder(accel_time_constant_s=1e-9, decel_time_constant_s=1e-9)
    w = np.array([CRANE.mode.natural_frequency_rad_s])
    stiff, _, _ = ringing_after(COMMAND, fast, w, 0.0)
    ideal, _, _ = ringing_after(COMMAND, Ideal(), w, 0.0)
    # G = 1 - 3.5e-9 j on five steps.
    assert stiff[0] == pytest.approx(ideal[0], abs=2e-8)
