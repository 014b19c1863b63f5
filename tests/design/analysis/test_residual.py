"""Residual vibration: closed forms, invariance, and two further routes."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from design.analysis.residual import evenly_spaced_vectors, residual_vectors, residual_vibration
from design.analysis.residuals_of_many import residual_curve
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.response.simulation import ringing_after
from tests.integration_route import residual_by_integration
from tests.second_route import claims_by_formula
from tests.shaper_table import CRANE, FIRST_ORDER, IDEAL, THESIS

OSCILLATING = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=25.0, damping_ratio=0.6),
    decel=SecondOrderSet(natural_frequency_rad_s=40.0, damping_ratio=1.0),
)
COMMANDS = {
    "a shaper": ([0.0, 0.18, 0.66, 1.18, 1.32], [1.0, -1, 1, -1, 1]),
    "a move": ([0.0, 0.2, 0.6, 2.0, 2.3, 2.7], [1.0, -1, 1, -1, 1, -1]),
    "a mirrored move": ([0.0, 0.2, 0.6, 2.0], [-0.5, -0.5, 0.4, 0.6]),
    "through zero": ([0.0, 0.5, 1.1], [0.6, -1.4, 0.8]),
}
ACTUATORS: dict[str, Actuator] = {
    "ideal": IDEAL,
    "first order": FIRST_ORDER,
    "thesis": THESIS,
    "other": OSCILLATING,
}


def command(name: str) -> Impulses:
    times, amplitudes = COMMANDS[name]
    return Impulses(times_s=np.array(times), amplitudes=np.array(amplitudes))


IMPULSES = st.lists(
    st.tuples(st.floats(0.0, 3.0), st.sampled_from([-1.0, -0.5, 0.3, 0.5, 1.0])),
    min_size=1,
    max_size=7,
).map(
    lambda rows: Impulses(
        times_s=np.array(sorted(time for time, _ in rows)),
        amplitudes=np.array([amplitude for _, amplitude in rows]),
    )
)
MODES = st.builds(
    Mode, natural_frequency_rad_s=st.floats(0.5, 20.0), damping_ratio=st.floats(0.0, 0.5)
)


def lags(scale: float) -> list[Actuator]:
    return [
        Ideal(),
        FirstOrder(accel_time_constant_s=0.03 * scale, decel_time_constant_s=0.1 * scale),
        SecondOrder(
            accel=SecondOrderSet(natural_frequency_rad_s=20.0 / scale, damping_ratio=0.8),
            decel=SecondOrderSet(natural_frequency_rad_s=50.0 / scale, damping_ratio=1.5),
        ),
    ]


@pytest.mark.parametrize("name", ACTUATORS)
@pytest.mark.parametrize("z", [0.0, 0.1])
def test_an_unshaped_step_leaves_one(name: str, z: float) -> None:
    step = Impulses(times_s=np.array([0.7]), amplitudes=np.array([1.0]))
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=z)
    assert residual_vibration(step, mode, ACTUATORS[name]) == 1


@given(phase=st.floats(0.01, 20.0))
def test_two_half_steps_leave_the_cosine_of_half_their_phase(phase: float) -> None:
    halves = Impulses(times_s=np.array([0.0, phase]), amplitudes=np.array([0.5, 0.5]))
    result = residual_vibration(halves, Mode(natural_frequency_rad_s=1.0), Ideal())
    assert result == pytest.approx(abs(math.cos(phase / 2)), abs=1e-14)  # a few roundings


@given(z=st.floats(0.0, 0.5))
def test_a_damped_zv_shaper_with_the_right_decay_leaves_nothing(z: float) -> None:
    mode = Mode(natural_frequency_rad_s=2.0, damping_ratio=z)
    root = math.sqrt(1 - z * z)
    k = math.exp(-math.pi * z / root)
    shaper = Impulses(
        times_s=np.array([0.0, math.pi / (2 * root)]), amplitudes=np.array([1.0, k]) / (1 + k)
    )
    assert residual_vibration(shaper, mode, Ideal()) <= 1e-14  # a few roundings


@settings(max_examples=200)
@given(impulses=IMPULSES, mode=MODES, which=st.integers(0, 2))
def test_the_residual_is_the_textbook_sum(impulses: Impulses, mode: Mode, which: int) -> None:
    actuator = lags(1.0)[which]
    expected = claims_by_formula(impulses, mode, actuator)["residual"]
    # The textbook sum starts at the first step and grows as the residual shrinks: exp(z w t_n).
    growth = math.exp(mode.damping_ratio * mode.natural_frequency_rad_s * impulses.duration_s)
    result = residual_vibration(impulses, mode, actuator)
    assert result == pytest.approx(expected, rel=1e-12, abs=1e-13 * max(1.0, growth) / growth)


@given(impulses=IMPULSES, mode=MODES, which=st.integers(0, 2))
def test_the_formula_agrees_with_the_simulated_ringing(
    impulses: Impulses, mode: Mode, which: int
) -> None:
    actuator = lags(1.0)[which]
    frequencies = np.array([mode.natural_frequency_rad_s])
    ringing, unit, _ = ringing_after(impulses, actuator, frequencies, mode.damping_ratio)
    result = residual_vibration(impulses, mode, actuator)
    # Exponentials of matrices of norm up to 3 s * 150 / s.
    assert result == pytest.approx(abs(ringing[0] / unit[0]), rel=1e-10, abs=1e-11)


@pytest.mark.parametrize("actuator", ACTUATORS)
@pytest.mark.parametrize("name", COMMANDS)
def test_the_formula_agrees_with_integrating_actuator_and_payload(name: str, actuator: str) -> None:
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.04)
    expected = residual_by_integration(command(name), mode, ACTUATORS[actuator])
    # Integrated to 1e-11; what the actuator's transient still shakes is far below.
    assert residual_vibration(command(name), mode, ACTUATORS[actuator]) == pytest.approx(
        expected, abs=1e-8
    )


@given(impulses=IMPULSES, mode=MODES, which=st.integers(0, 2), scale=st.floats(0.1, 10.0))
def test_scaling_time_changes_no_residual(
    impulses: Impulses, mode: Mode, which: int, scale: float
) -> None:
    slow = Impulses(times_s=scale * impulses.times_s, amplitudes=impulses.amplitudes)
    slow_mode = Mode(
        natural_frequency_rad_s=mode.natural_frequency_rad_s / scale,
        damping_ratio=mode.damping_ratio,
    )
    plain = residual_vibration(impulses, mode, lags(1.0)[which])
    # Phases up to 60 rad round by 1e-14.
    assert residual_vibration(slow, slow_mode, lags(scale)[which]) == pytest.approx(
        plain, rel=1e-11, abs=1e-12
    )


@given(impulses=IMPULSES, mode=MODES, which=st.integers(0, 2), delay=st.floats(0.0, 5.0))
def test_neither_waiting_nor_mirroring_changes_the_residual(
    impulses: Impulses, mode: Mode, which: int, delay: float
) -> None:
    actuator = lags(1.0)[which]
    plain = residual_vibration(impulses, mode, actuator)
    later = Impulses(times_s=impulses.times_s + delay, amplitudes=impulses.amplitudes)
    mirror = Impulses(times_s=impulses.times_s, amplitudes=-impulses.amplitudes)
    # The shifted times round by 1e-15, at 20 rad/s and ratios of gains up to 5.
    assert residual_vibration(later, mode, actuator) == pytest.approx(plain, abs=1e-12)
    assert residual_vibration(mirror, mode, actuator) == plain


def test_the_curve_moves_the_pole_and_the_unit_along() -> None:
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.05)
    ratios = np.array([0.3, 0.9, 1.0, 1.4])
    moved = [
        residual_vibration(
            command("a shaper"),
            Mode(natural_frequency_rad_s=3.5 * ratio, damping_ratio=0.05),
            THESIS,
        )
        for ratio in ratios.tolist()
    ]
    curve = residual_curve(command("a shaper"), mode, THESIS, ratios)
    assert curve == pytest.approx(np.array(moved), rel=1e-13)  # the pole rounds once more


@pytest.mark.parametrize("points", [2, 3, 4, 5, 9, 10, 11, 200, 201, 1000])
@pytest.mark.parametrize("z", [0.0, 0.2])
def test_evenly_spaced_vectors_are_the_vectors_one_by_one(points: int, z: float) -> None:
    pole = Mode(natural_frequency_rad_s=CRANE.mode.natural_frequency_rad_s, damping_ratio=z)
    first, last = 0.5 * pole.pole_rad_s, 1.5 * pole.pole_rad_s
    line = evenly_spaced_vectors(command("a move"), first, last, points, THESIS)
    each = residual_vectors(command("a move"), np.linspace(first, last, points), THESIS)
    assert line == pytest.approx(each, abs=1e-13)  # products of two exponentials of size one
