"""Which limit binds when, against the reference itself, played in small steps."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from design.analysis.binding_limits import BindingLimit, binding_limits
from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.types import FloatArray

DRIVE = RateLimited(accel_limit_m_s2=0.5, decel_limit_m_s2=0.8, speed_m_s=2.0)
STEP_S = 1e-3


def played(command: Impulses, until_s: float) -> FloatArray:
    """Return the reference's levels at every millisecond, by the rule of the drive alone."""
    levels, level = [0.0], 0.0
    for time in np.arange(0.0, until_s, STEP_S):
        wanted = float(command.amplitudes[command.times_s <= time + 1e-12].sum())
        target = 0.0 if level * wanted < 0 else wanted
        growing = abs(target) > abs(level)
        rate = (0.5 if growing else 0.8) / 2.0
        level += math.copysign(min(rate * STEP_S, abs(target - level)), target - level)
        levels.append(level)
    return np.array(levels)


def limit_at(levels: FloatArray, number: int) -> str | None:
    """Return what binds from one millisecond to the next."""
    now, following = (abs(float(levels[number + k])) for k in (0, 1))
    if following - now > 1e-9:
        return "acceleration"
    if now - following > 1e-9:
        return "deceleration"
    return "rest" if now < 1e-9 else "speed" if abs(now - 1) < 1e-9 else None


def bound_at(found: tuple[BindingLimit, ...], time: float) -> str | None:
    return next((one.limit for one in found if one.from_s <= time < one.to_s), None)


@pytest.mark.parametrize("seed", range(40))
def test_the_limits_are_those_of_the_reference_as_it_is_played(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size = int(rng.integers(1, 8))
    times = np.append(0.0, np.cumsum(rng.integers(1, 6000, size - 1))) * STEP_S
    signs = (-1.0) ** np.arange(size)
    amplitudes = signs if seed % 2 else np.round(rng.uniform(-1, 1, size), 2) + 0.001
    command = Impulses(times_s=times, amplitudes=amplitudes)
    found = binding_limits(command, DRIVE)
    levels = played(command, found[-1].to_s)
    # A millisecond in which the limit changes is of both.
    edges = np.array([edge for one in found for edge in (one.from_s, one.to_s)])
    compared = 0
    for number in range(levels.size - 1):
        middle = (number + 0.5) * STEP_S
        if np.abs(edges - middle).min() > 2 * STEP_S:
            assert bound_at(found, middle) == limit_at(levels, number), middle
            compared += 1
    assert compared > 0.9 * levels.size - 100


@pytest.mark.parametrize("seed", range(20))
def test_an_on_off_command_is_bound_all_the_time(seed: int) -> None:
    rng = np.random.default_rng(seed)
    times = np.append(0.0, np.cumsum(rng.uniform(0.01, 6, 6)))
    command = Impulses(times_s=times + seed, amplitudes=(-1.0) ** np.arange(7))
    found = binding_limits(command, DRIVE)
    assert found[0].from_s == 0
    for one, following in pairwise(found):
        assert one.to_s == pytest.approx(following.from_s, abs=1e-9)
        assert one.limit != following.limit


def test_half_speed_is_bound_by_no_limit() -> None:
    halves = Impulses(times_s=np.array([0.0, 5.0]), amplitudes=np.array([0.5, 0.5]))
    found = binding_limits(halves, DRIVE)
    assert [(one.from_s, one.to_s, one.limit) for one in found] == [
        (0.0, 2.0, "acceleration"),
        (5.0, 7.0, "acceleration"),
    ]


def test_ramps_that_meet_are_one_interval_and_a_reversal_is_two() -> None:
    command = Impulses(times_s=np.array([0.0, 2.0, 8.0]), amplitudes=np.array([0.5, 0.5, -2.0]))
    found = binding_limits(command, DRIVE)
    assert [one.limit for one in found] == [
        "acceleration", "speed", "deceleration", "acceleration",
    ]  # fmt: skip
    assert [one.to_s for one in found] == pytest.approx([4.0, 8.0, 10.5, 14.5], rel=1e-14)


def test_a_limit_to_the_jerk_binds_while_the_acceleration_changes() -> None:
    # To 0.5 m/s^2 in .25 s, there until .0625 m/s less than full speed, and back in .25 s.
    drive = replace(DRIVE, jerk_limit_m_s3=2.0)
    found = binding_limits(Impulses(times_s=np.zeros(1), amplitudes=np.ones(1)), drive)
    assert [one.limit for one in found] == ["jerk", "acceleration", "jerk"]
    ends = [0.0, 0.25, 4.0, 4.25]
    for one, (start, end) in zip(found, pairwise(ends), strict=True):
        assert (one.from_s, one.to_s) == pytest.approx((start, end), abs=1e-12)
