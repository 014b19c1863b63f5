"""Commands as steps."""

import math

import numpy as np
import pytest

from design.model.commands import command_of_velocities, convolve, pulse, step
from design.model.impulses import Impulses
from tests.refusals import refused


def test_a_pulse_is_a_step_up_and_a_step_down() -> None:
    command = pulse(1.5)
    assert command.times_s.tolist() == [0.0, 1.5]
    assert command.amplitudes.tolist() == [1.0, -1.0]


@pytest.mark.parametrize("length", [0.0, -1.0])
def test_a_pulse_must_last(length: float) -> None:
    with refused("out_of_range", "pulse_s", says="between 1e-12"):
        pulse(length)


def test_a_list_holds_each_velocity() -> None:
    command = command_of_velocities(np.array([0.0, 1.0, 3.0]), np.array([0.5, 1.0, 0.0]))
    assert command.amplitudes.tolist() == [0.5, 0.5, -1.0]


def test_a_list_whose_time_runs_backwards_is_refused() -> None:
    with refused("time_before_last", "times_s.2"):
        command_of_velocities(np.array([0.0, 2.0, 1.0]), np.ones(3))


def test_a_list_of_another_length_and_one_at_rest_are_refused() -> None:
    with refused("velocities_unlike_times", "velocity_m_s", says="as many as the times, 2"):
        command_of_velocities(np.array([0.0, 2.0]), np.ones(3))
    with refused("velocities_all_zero", "velocity_m_s"):
        command_of_velocities(np.array([0.0, 2.0]), np.zeros(2))


def test_a_shaped_step_is_the_shaper_and_a_shaped_pulse_ends_at_rest() -> None:
    shaper = Impulses(times_s=np.array([0.0, 0.4, 0.9]), amplitudes=np.array([0.25, 0.5, 0.25]))
    assert convolve(step(), shaper).amplitudes.tolist() == shaper.amplitudes.tolist()
    shaped = convolve(pulse(0.5), shaper)
    assert np.all(np.diff(shaped.times_s) >= 0)
    assert np.cumsum(shaped.amplitudes)[-1] == pytest.approx(0, abs=1e-15)
    # 0.5 + 0.4 is 0.9, where the shaper's own last step is: one step, down by 0.25.
    assert shaped.times_s.tolist() == pytest.approx([0.0, 0.4, 0.5, 0.9, 1.4])
    assert shaped.amplitudes.tolist() == [0.25, 0.5, -0.25, -0.25, -0.25]


def test_of_velocities_at_one_time_the_last_counts() -> None:
    told = command_of_velocities(
        np.array([0.0, 0.0, 1.0, 1.0, 1.0]), np.array([9.0, 0.5, 7.0, -3.0, 0.0])
    )
    assert told.times_s.tolist() == [0.0, 1.0]
    assert told.amplitudes.tolist() == [0.5, -0.5]


def test_a_velocity_that_stays_is_no_step() -> None:
    told = command_of_velocities(
        np.array([0.0, 1.0, 2.0, 3.0, 4.0]), np.array([0.0, 0.5, 0.5, 1.0, 1.0])
    )
    assert told.times_s.tolist() == [1.0, 3.0]
    assert told.amplitudes.tolist() == [0.5, 0.5]
    with refused("velocities_all_zero", "velocity_m_s"):
        command_of_velocities(np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e12])
def test_a_velocity_of_no_size_is_named_by_its_place(value: float) -> None:
    with refused("velocity_out_of_range", "velocity_m_s.1", says=r"a number, at most 5e\+11"):
        command_of_velocities(np.array([0.0, 1.0]), np.array([0.5, value]))


def test_steps_of_a_shaped_pulse_that_meet_and_cancel_are_none() -> None:
    # In numbers, 0.1 + 0.2 is not 0.3.
    shaper = Impulses(times_s=np.array([0.0, 0.1, 0.3]), amplitudes=np.array([0.5, 0.25, 0.25]))
    shaped = convolve(pulse(0.2), shaper)
    assert shaped.times_s.tolist() == pytest.approx([0.0, 0.1, 0.2, 0.5])  # up, down at 0.3
    assert shaped.amplitudes.tolist() == [0.5, 0.25, -0.5, -0.25]
