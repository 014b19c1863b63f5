"""The vector diagram in closed form, and the equations that solvers see."""

import cmath
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from design.formulations.gaps import settling_gaps_rad
from design.formulations.lag_parameters import decel_over_accel
from design.formulations.unity_magnitude import (
    ZERO_VIBRATION,
    ZERO_VIBRATION_DERIVATIVE,
    UnityMagnitude,
)
from design.formulations.unity_magnitude_problem import alternating, unity_magnitude_problem
from design.formulations.vector_diagram import undamped_times_rad
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.second_order import SecondOrder
from design.model.plants.mode import Mode
from design.types import FloatArray
from tests.refusals import refused
from tests.second_route import gain_and_slope
from tests.shaper_table import CRANE, DAMPED, FIRST_ORDER, IDEAL, THESIS

ORDERED = np.array([1e-6, 1e-6])
FAR = 1e9


def brute_force(alpha: float, beta: float, shortest: FloatArray) -> float:
    """Least t3 over both signs and all turns of Kim 2011, eqs. 3.34-3.35."""
    best = math.inf
    for sign in (1, -1):
        for n in range(-3, 6):
            for m in range(-3, 9):
                t2 = sign * math.acos(alpha / 2) - beta + 2 * math.pi * n
                t3 = 2 * sign * math.acos(alpha / 2) + 2 * math.pi * m
                if t2 >= shortest[0] and t3 - t2 >= shortest[1]:
                    best = min(best, t3)
    return best


@settings(max_examples=400)
@given(
    alpha=st.floats(0.01, 2.0),
    beta=st.floats(-3.1, 3.1),
    first=st.floats(1e-6, 9.0),
    second=st.floats(1e-6, 9.0),
)
def test_the_closed_form_is_the_fastest_of_all_signs_and_turns(
    alpha: float, beta: float, first: float, second: float
) -> None:
    shortest = np.array([first, second])
    ratio = alpha * cmath.exp(-1j * beta)
    t1, t2, t3 = undamped_times_rad(ratio, shortest, FAR).tolist()
    assert t1 == 0
    # Gaps and vectors are rounded at phases up to 40 rad; the diagram is closed to the same.
    assert t2 >= first - 1e-13
    assert t3 - t2 >= second - 1e-13
    assert abs(1 - ratio * cmath.exp(-1j * t2) + cmath.exp(-1j * t3)) <= 1e-13
    assert t3 == pytest.approx(brute_force(alpha, beta, shortest), abs=1e-9)


def test_equal_sets_give_a_sixth_and_a_third_of_the_period() -> None:
    times = undamped_times_rad(1 + 0j, ORDERED, FAR)
    assert times == pytest.approx([0, math.pi / 3, 2 * math.pi / 3], abs=1e-15)  # one rounding


def test_a_late_deceleration_set_is_served_faster_by_the_minus_sign() -> None:
    # beta = 1.5 pushes the plus family's t2 below 0 and so to a full turn later; the minus family
    # goes t2 = 2 pi - acos(1/2) - 1.5 = 3.736, t3 = 2 pi - 2 acos(1/2) = 4.189.
    times = undamped_times_rad(cmath.exp(-1.5j), ORDERED, FAR)
    assert times == pytest.approx([0, 5 * math.pi / 3 - 1.5, 4 * math.pi / 3], abs=1e-14)
    assert times[2] < 2 * math.pi / 3 + 2 * math.pi  # the plus family's


def test_a_diagram_of_one_long_vector_is_flat() -> None:
    # alpha = 2: the middle vector points back exactly, and all are whole turns apart.
    times = undamped_times_rad(2 + 0j, ORDERED, FAR)
    assert times == pytest.approx([0, 2 * math.pi, 4 * math.pi], abs=1e-14)


def test_a_vector_of_more_than_two_closes_no_triangle() -> None:
    with refused("alpha_above_two", says=r"^alpha = .* is 2\.01, and .* alpha <= 2$"):
        undamped_times_rad(2.01 + 0j, ORDERED, FAR)


def test_a_solution_beyond_the_horizon_is_told_with_its_length() -> None:
    message = r"fastest ordered solution takes 0\.333333 periods, more than max_duration_periods = "
    with refused("ordered_exceeds_duration", says=message + r"0\.3$"):
        undamped_times_rad(1 + 0j, ORDERED, 0.3 * 2 * math.pi)


def test_amplitudes_alternate_from_plus_one() -> None:
    assert alternating(5).tolist() == [1, -1, 1, -1, 1]


@pytest.mark.parametrize("mode", [CRANE.mode, DAMPED])
@pytest.mark.parametrize("actuator", [IDEAL, FIRST_ORDER, THESIS])
def test_the_ratio_of_the_sets_is_that_of_their_gains_at_the_pole(
    mode: Mode, actuator: Ideal | FirstOrder | SecondOrder
) -> None:
    s = mode.pole_rad_s
    expected = (
        gain_and_slope(actuator, s, accel=False)[0] / gain_and_slope(actuator, s, accel=True)[0]
    )
    # A handful of roundings.
    assert cmath.isclose(decel_over_accel(mode, actuator), expected, rel_tol=1e-14)


def test_gaps_to_settle_alternate_between_the_sets() -> None:
    actuator = FirstOrder(accel_time_constant_s=0.5, decel_time_constant_s=0.25)
    mode = Mode(natural_frequency_rad_s=2.0)
    gaps = settling_gaps_rad(mode, actuator, 5, settle=True)
    # 80 % of a first-order step takes log 5 time constants; here in radians of the plant.
    assert gaps == pytest.approx(np.log(5) * np.array([1.0, 0.5, 1.0, 0.5]), rel=1e-14)
    assert settling_gaps_rad(mode, actuator, 5, settle=False).tolist() == [1e-6] * 4


def test_settling_longer_than_the_horizon_is_refused_before_any_search() -> None:
    actuator = FirstOrder(accel_time_constant_s=4.0, decel_time_constant_s=4.0)
    with refused(
        "settling_exceeds_duration",
        says=r"^ramps and settling between switches take 4\.098 periods in all, more than "
        r"max_duration_periods = 3$",
    ):
        unity_magnitude_problem(
            ZERO_VIBRATION_DERIVATIVE,
            Mode(natural_frequency_rad_s=1.0),
            actuator,
            settle=True,
            max_duration_periods=3.0,
        )


def vibration(gaps: FloatArray, mode: Mode, actuator: Ideal | FirstOrder | SecondOrder) -> complex:
    """V over the unshaped step's at the last impulse, by the textbook."""
    until_last = np.append(np.cumsum(gaps[::-1])[::-1], 0.0) / 3.0
    s = mode.pole_rad_s
    gains = [gain_and_slope(actuator, s, accel=index % 2 == 0)[0] for index in range(gaps.size + 1)]
    return complex(
        sum(
            a * g / gains[0] * cmath.exp(s * t)
            for a, g, t in zip(alternating(gaps.size + 1), gains, until_last, strict=True)
        )
    )


@pytest.mark.parametrize("model", [ZERO_VIBRATION, ZERO_VIBRATION_DERIVATIVE])
@pytest.mark.parametrize("z", [0.0, 0.15])
@pytest.mark.parametrize("actuator", [IDEAL, FIRST_ORDER, THESIS])
def test_the_equations_are_the_textbook_sum_and_its_slope(
    model: UnityMagnitude, z: float, actuator: Ideal | FirstOrder | SecondOrder
) -> None:
    import casadi as ca

    mode = Mode(natural_frequency_rad_s=3.0, damping_ratio=z)
    problem = unity_magnitude_problem(model, mode, actuator, settle=False, max_duration_periods=3.0)
    parts = model.expressions()
    function = ca.Function(
        "f", [parts.unknowns, parts.parameters], [parts.equations, parts.objective]
    )
    gaps = np.random.default_rng(2).uniform(0.2, 2.0, model.impulses - 1)
    equations, duration = function(gaps, problem.parameters)
    values = np.asarray(equations).ravel()
    expected = vibration(gaps, mode, actuator)
    # Exponentials of moderate phases.
    assert complex(values[0], values[1]) == pytest.approx(expected, abs=1e-13)
    assert float(duration) == pytest.approx(gaps.sum(), rel=1e-15)
    if model is ZERO_VIBRATION_DERIVATIVE:
        step = 1e-5
        moved = [
            vibration(gaps, Mode(natural_frequency_rad_s=3.0 * r, damping_ratio=z), actuator)
            for r in (1 + step, 1 - step)
        ]
        slope = (moved[0] - moved[1]) / (2 * step)
        # Central difference: step^2 times the third derivative, up to 6^3.
        assert complex(values[2], values[3]) == pytest.approx(slope, abs=1e-7)


def test_equations_match_unknowns() -> None:
    for model in (ZERO_VIBRATION, ZERO_VIBRATION_DERIVATIVE):
        parts = model.expressions()
        assert parts.unknowns.shape == parts.equations.shape == (model.impulses - 1, 1)


def test_seeds_move_the_decelerating_steps_by_the_phase_of_the_ratio() -> None:
    mode = CRANE.mode
    problem = unity_magnitude_problem(
        ZERO_VIBRATION_DERIVATIVE, mode, THESIS, settle=False, max_duration_periods=3.0
    )
    assert [seed.name for seed in problem.seeds] == [
        "umzvd_polynomials",
        "umzvd_polynomials_as_published",
    ]
    shifted, published = (np.cumsum(seed.gaps_rad) for seed in problem.seeds)
    phase = cmath.phase(decel_over_accel(mode, THESIS))
    assert shifted - published == pytest.approx([phase, 0, phase, 0], abs=1e-14)  # roundings


@pytest.mark.parametrize(("time_constant_s", "seeds"), [(1.0, 0), (0.1, 2)])
def test_a_seed_too_short_to_settle_is_none(time_constant_s: float, seeds: int) -> None:
    # pi/3 < log 5: both gaps of the UMZV are too short for a lag of 1 s, and enough for 0.1 s.
    actuator = FirstOrder(
        accel_time_constant_s=time_constant_s, decel_time_constant_s=time_constant_s
    )
    problem = unity_magnitude_problem(
        ZERO_VIBRATION,
        Mode(natural_frequency_rad_s=1.0),
        actuator,
        settle=True,
        max_duration_periods=3.0,
    )
    assert len(problem.seeds) == seeds
    assert problem.shortest_gaps_rad == pytest.approx(math.log(5) * time_constant_s)
