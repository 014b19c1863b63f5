"""The shortest command on samples within a tolerance: full enumeration, bounds, asked figures."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from design.analysis.residual import residual_vibration
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.sampling.on_off_search import Searched, search_on_off
from design.types import FloatArray
from tests import expm_route

ROUNDING = 1e-8
"""Of the slope, which the search takes by a central difference, good to 1e-9 [-]."""


def search(
    hertz: float,
    damping: float,
    sample_time_s: float,
    tolerance: float,
    *,
    slope: bool = False,
    actuator: Actuator | None = None,
    samples: int | None = None,
) -> Searched:
    """Search up to three periods, or so many samples."""
    mode = Mode(natural_frequency_rad_s=2 * math.pi * hertz, damping_ratio=damping)
    return search_on_off(
        mode,
        actuator or Ideal(),
        sample_time_s,
        samples or math.floor(3 / (hertz * sample_time_s)),
        slope=slope,
        tolerance=tolerance,
        known=1.0,
    )


# Figures that were asked for.


def test_60_hz_at_2_ms_leave_less_than_a_third_of_a_percent_in_20_samples() -> None:
    found = search(60, 0.08, 0.002, 0.0031)
    assert found.samples is not None
    assert found.samples.tolist() == [0, 2, 3, 6, 7, 9, 12, 13, 16, 18, 19]
    assert found.left == pytest.approx(3.2e-4, abs=1e-5)
    assert (found.searched, found.complete, found.bound) == (19, True, found.left)


def test_commands_are_found_where_a_sample_is_longer_than_the_shortest_gap() -> None:
    # As measured; each of them is proven to be the least of all up to its samples.
    eleven = search(11, 0.0, 0.008, 0.01, slope=True)
    assert eleven.searched == 28
    assert eleven.left == pytest.approx(8.195e-3, abs=1e-6)
    sixty = search(60, 0.0, 0.002, 0.01, slope=True)
    assert sixty.searched == 25
    assert sixty.left == pytest.approx(2.9028e-2, abs=1e-6)
    twenty_three = search(23, 0.0, 0.008, 0.01)
    assert twenty_three.searched == 16
    assert twenty_three.left == pytest.approx(1.8485e-2, abs=1e-6)
    for one in (eleven, sixty, twenty_three):
        assert one.complete
        assert one.bound == one.left


# Every command, by a route that shares no code.


def drive_factors(actuator: Actuator, pole: complex) -> tuple[complex, complex, complex, complex]:
    """Return factors of a step up and of one down over that of one up, and their derivatives."""

    def below(number: int, s: complex) -> tuple[complex, complex]:
        if isinstance(actuator, FirstOrder):
            lag_s = (actuator.accel_time_constant_s, actuator.decel_time_constant_s)[number]
            return 1 + lag_s * s, lag_s
        if isinstance(actuator, SecondOrder):
            drive = (actuator.accel, actuator.decel)[number]
            w, z = drive.natural_frequency_rad_s, drive.damping_ratio
            return 1 + 2 * z * s / w + s**2 / w**2, 2 * z / w + 2 * s / w**2
        return 1.0, 0.0

    unit = below(0, pole)[0]
    up, up_rate = below(0, pole)
    down, down_rate = below(1, pole)
    return unit / up, -unit * up_rate / up**2, unit / down, -unit * down_rate / down**2


def left_by_enumeration(samples: int, mode: Mode, actuator: Actuator, *, slope: bool) -> FloatArray:
    """Sum exponentials over the steps of each command of exactly so many samples of a second."""
    levels = np.array([(1, *free, 0) for free in itertools.product((0, 1), repeat=samples - 2)])
    changes = np.diff(levels, prepend=0, append=1, axis=1)
    w, z = mode.natural_frequency_rad_s, mode.damping_ratio
    pole = w * complex(-z, math.sqrt(1 - z * z))
    times = np.arange(samples + 1.0)
    up, up_rate, down, down_rate = drive_factors(actuator, pole)
    swings = np.exp(-pole * times)
    signs_up, signs_down = (changes > 0) * 1.0, (changes < 0) * 1.0
    end = abs(np.exp(pole * samples))
    left: FloatArray = end * np.abs(signs_up @ (swings * up) - signs_down @ (swings * down))
    if slope:
        rate = signs_up @ (swings * (up_rate - times * up))
        rate = rate - signs_down @ (swings * (down_rate - times * down))
        left = left + 0.05 * end * abs(pole) * np.abs(rate)
    return left


def small_case(seed: int) -> tuple[Mode, Actuator, bool, float, int]:
    rng = np.random.default_rng(seed)
    mode = Mode(
        natural_frequency_rad_s=2 * math.pi / float(rng.uniform(3.0, 14.0)),
        damping_ratio=float(rng.uniform(0.0, 0.3)) * (seed % 3 > 0),
    )
    sets = [
        SecondOrderSet(
            natural_frequency_rad_s=float(rng.uniform(3, 20)) * mode.natural_frequency_rad_s,
            damping_ratio=float(rng.uniform(0.4, 1.6)),
        )
        for _ in range(2)
    ]
    lags = rng.uniform(0.02, 0.3, 2) / mode.natural_frequency_rad_s
    actuator: Actuator = (
        Ideal(),
        FirstOrder(accel_time_constant_s=float(lags[0]), decel_time_constant_s=float(lags[1])),
        SecondOrder(accel=sets[0], decel=sets[1]),
    )[seed // 2 % 3]
    tolerance = float(rng.choice([0.0, 0.003, 0.01, 0.03, 0.1]))
    return mode, actuator, seed % 2 == 1, tolerance, int(rng.integers(6, 15))


@pytest.mark.parametrize("block", range(10))
def test_no_command_beats_what_is_found_in_300_random_small_cases(block: int) -> None:
    for seed in range(30 * block, 30 * block + 30):
        mode, actuator, slope, tolerance, longest = small_case(seed)
        found = search_on_off(
            mode, actuator, 1.0, longest, slope=slope, tolerance=tolerance, known=1.0
        )
        least = [
            float(left_by_enumeration(samples, mode, actuator, slope=slope).min())
            for samples in range(2, longest + 1)
        ]
        within = [at for at, left in enumerate(least) if left <= tolerance]
        assert found.complete
        if min(least) >= 1.0:  # near resonance none leaves less than an unshaped step
            assert found.samples is None
            assert found.bound == 1.0
            continue
        assert found.samples is not None
        if within:
            assert found.samples[-1] == found.searched == within[0] + 2
            assert found.left == pytest.approx(least[within[0]], abs=ROUNDING)
        else:
            assert found.searched == longest
            assert found.left == pytest.approx(min(least), abs=ROUNDING)
        assert found.bound == pytest.approx(found.left, abs=ROUNDING)


RATE_LIMITED = RateLimited(
    accel_limit_m_s2=1.0,
    decel_limit_m_s2=0.6,
    speed_m_s=1.5,
    then=FirstOrder(accel_time_constant_s=0.2, decel_time_constant_s=0.2),
)
SWITCHED = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=3.0, damping_ratio=0.6),
    decel=SecondOrderSet(natural_frequency_rad_s=5.0, damping_ratio=1.4),
    model="switched",
)


@pytest.mark.parametrize(
    ("actuator", "slope"),
    [(SWITCHED, False), (SWITCHED, True), (RATE_LIMITED, False)],
    ids=["switched", "switched, slope", "rate_limited"],
)
def test_no_command_beats_what_is_found_behind_drives_whose_steps_do_not_add(
    actuator: Actuator, slope: bool
) -> None:
    mode = Mode(natural_frequency_rad_s=2 * math.pi / 6, damping_ratio=0.05)
    found = search_on_off(mode, actuator, 1.0, 7, slope=slope, tolerance=0.0, known=1.0)
    least = math.inf
    for samples in range(2, 8):
        for free in itertools.product((0, 1), repeat=samples - 2):
            steps = np.flatnonzero(np.diff((1, *free, 0), prepend=0, append=1))
            signs = (-1.0) ** np.arange(steps.size)
            command = Impulses(times_s=steps.astype(float), amplitudes=signs)
            left = expm_route.outcome(command, mode, actuator).residual
            if slope:
                left += 0.05 * expm_route.slope(command, mode, actuator)
            least = min(least, left)
    assert found.left == pytest.approx(least, abs=ROUNDING)
    assert found.complete
    assert found.bound == found.left


# What is proven, and what is not.


def test_a_search_that_is_not_complete_says_so_and_bounds_what_it_searched() -> None:
    found = search(7.3, 0.02, 0.004, 1e-5)
    assert found.samples is not None
    assert not found.complete
    assert found.searched < found.samples[-1] or found.left > 1e-5
    # A wider net over the samples that were searched finds nothing below the bound.
    shorter = search(7.3, 0.02, 0.004, 0.0, samples=24)
    assert shorter.complete
    assert found.bound <= shorter.left


def test_on_grids_too_fine_to_search_nothing_is_claimed() -> None:
    mode = Mode(natural_frequency_rad_s=2 * math.pi)
    found = search_on_off(mode, Ideal(), 1e-4, 30_000, slope=True, tolerance=1e-6, known=1e-3)
    assert found.samples is None
    assert not found.complete
    assert found.bound == 1e-3


def test_behind_a_drive_without_a_formula_nothing_is_proven() -> None:
    jerk = replace(RATE_LIMITED, jerk_limit_m_s3=5.0)
    found = search(1 / 6, 0.05, 1.0, 0.05, actuator=jerk, samples=9)
    assert found.samples is not None
    assert (found.searched, found.complete, found.bound) == (1, False, 0.0)
    signs = (-1.0) ** np.arange(found.samples.size)
    mode = Mode(natural_frequency_rad_s=2 * math.pi / 6, damping_ratio=0.05)
    told = Impulses(times_s=found.samples.astype(float), amplitudes=signs)
    assert residual_vibration(told, mode, jerk) == pytest.approx(found.left, abs=1e-12)


def test_a_longer_horizon_never_leaves_more() -> None:
    left = [search(23, 0.01, 0.008, 0.0, samples=samples).left for samples in range(4, 20)]
    assert all(later <= earlier + 1e-12 for earlier, later in itertools.pairwise(left))


def test_scaling_time_changes_nothing() -> None:
    one, other = search(11, 0.03, 0.008, 0.01), search(11 / 4, 0.03, 0.032, 0.01)
    assert one.samples is not None
    assert other.samples is not None
    assert one.samples.tolist() == other.samples.tolist()
    assert one.left == pytest.approx(other.left, abs=1e-12)


@pytest.mark.parametrize("actuator", [SWITCHED, RATE_LIMITED], ids=["switched", "rate_limited"])
def test_longer_commands_are_moved_behind_drives_whose_steps_do_not_add(
    actuator: Actuator,
) -> None:
    mode = Mode(natural_frequency_rad_s=2 * math.pi / 9, damping_ratio=0.02)
    found = search_on_off(mode, actuator, 1.0, 22, slope=True, tolerance=0.0, known=1.0)
    listed = search_on_off(mode, actuator, 1.0, 14, slope=True, tolerance=0.0, known=1.0)
    assert found.searched == listed.searched == 14
    assert listed.complete
    assert not found.complete
    assert found.left <= listed.left
    assert found.bound == listed.left
