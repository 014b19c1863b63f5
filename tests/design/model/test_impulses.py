"""The record of impulses, and which of them accelerate."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from design.model.impulses import Impulses
from tests.refusals import refused
from tests.second_route import increases


def of(amplitudes: list[float], times: list[float] | None = None) -> Impulses:
    return Impulses(
        times_s=np.arange(float(len(amplitudes))) if times is None else np.array(times),
        amplitudes=np.array(amplitudes),
    )


@pytest.mark.parametrize(
    ("amplitudes", "accelerates"),
    [
        ([1, -1, 1, -1, 1], [True, False, True, False, True]),
        ([-1, 1, -1], [True, False, True]),
        ([0.25, 0.5, 0.25], [True, True, True]),
        ([1, -1, 1, -1, 1, -1], [True, False, True, False, True, False]),
        ([0.5, 0.5, -0.5, -0.5], [True, True, False, False]),
        ([1, 0, -1], [True, True, False]),  # a step of no height leaves the set in force
        ([1, -0.5, 0, 0.2], [True, False, False, True]),
        ([0.3, -0.5], [True, False]),
        ([0.3, -0.7], [True, True]),
    ],
)
def test_a_step_accelerates_when_it_increases_the_magnitude_of_the_command(
    amplitudes: list[float], accelerates: list[bool]
) -> None:
    assert of(amplitudes).accelerates.tolist() == accelerates


def test_a_step_to_the_opposite_level_decreases_whatever_the_rounding() -> None:
    # 0.7 + 0.1 is 0.7999999999999999: a bare comparison takes the step to -0.8 for an increase,
    # and would not if the level of 0.8 were reached at once.
    assert abs(0.7 + 0.1 - 1.6) > abs(0.7 + 0.1)
    assert not of([0.7, 0.1, -1.6]).accelerates[-1]
    assert not of([0.8, -1.6]).accelerates[-1]


AMPLITUDES = st.lists(st.sampled_from([-1.0, -0.5, 0.25, 0.5, 1.0]), min_size=1, max_size=8)


@given(amplitudes=AMPLITUDES)
def test_the_rule_holds_step_by_step_on_random_commands(amplitudes: list[float]) -> None:
    impulses = of(amplitudes)
    assert impulses.accelerates.tolist() == increases(impulses)


@given(amplitudes=AMPLITUDES, scale=st.floats(1e-3, 1e3))
def test_a_mirrored_or_scaled_command_accelerates_at_the_same_steps(
    amplitudes: list[float], scale: float
) -> None:
    plain = of(amplitudes).accelerates.tolist()
    assert of([-a for a in amplitudes]).accelerates.tolist() == plain
    assert of([scale * a for a in amplitudes]).accelerates.tolist() == plain


def test_the_duration_does_not_count_the_wait_before_the_first_step() -> None:
    assert of([1, -1, 1], [2.0, 2.5, 4.0]).duration_s == 2.0
    assert of([1], [7.0]).duration_s == 0


def test_two_steps_may_fall_on_one_time() -> None:
    assert of([0.5, 0.5], [1.0, 1.0]).duration_s == 0


def test_a_command_needs_a_step() -> None:
    with refused("no_times", "times_s"):
        Impulses(times_s=np.zeros(0), amplitudes=np.zeros(0))


def test_times_are_a_list_and_no_table() -> None:
    with refused("no_times", "times_s", says=r"one or more times, got \[2, 2\]"):
        Impulses(times_s=np.zeros((2, 2)), amplitudes=np.zeros((2, 2)))


def test_every_time_needs_its_amplitude() -> None:
    message = r"^amplitudes must be as many as times_s, which has 2, got '3 numbers'"
    with refused("amplitudes_unlike_times", "amplitudes", says=message):
        of([1.0, -1.0, 1.0], [0.0, 1.0])


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e300])
def test_times_and_amplitudes_are_of_a_size_to_compute_with(value: float) -> None:
    with refused("out_of_range", "times_s.1", says=r"between -1e\+12 and 1e\+12"):
        of([1.0, -1.0], [0.0, value])
    with refused("out_of_range", "amplitudes.1", says=r"between -1e\+12"):
        of([1.0, value])


def test_a_time_out_of_order_is_told_by_its_place() -> None:
    message = r"^times_s\.2 must be not before the time ahead of it, 1\.0, got 0\.5$"
    with refused("time_before_last", "times_s.2", says=message):
        of([1, -1, 1], [0.0, 1.0, 0.5])


def test_a_command_of_nothing_is_refused() -> None:
    with refused("amplitudes_all_zero", "amplitudes"):
        of([0.0, 0.0])
