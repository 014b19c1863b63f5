"""Ten thousand random cranes: verified, or told how far was searched."""

from collections import Counter

import numpy as np
import pytest
from numpy.typing import NDArray

from design.errors import InfeasibleDesignError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.model import Model
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.pipeline import Design, design
from design.shapers.registry import SHAPERS

CASES = 10_000
PARTS = 20
MULTISTART_CASES = 300
RANDOM_STARTS = 200


def random_case(
    seed: int, model: Model = "superposed", poles: tuple[float, float] = (4.0, 20.0)
) -> tuple[Mode, Actuator]:
    """Draw w .5-60 rad/s, z 0-.2, poles 4-20 w, damping .4-1.6; even seeds are first order."""
    rng = np.random.default_rng(seed)
    w = float(np.exp(rng.uniform(np.log(0.5), np.log(60.0))))
    mode = Mode(natural_frequency_rad_s=w, damping_ratio=float(rng.uniform(0, 0.2)))
    accel, decel = (float(w * ratio) for ratio in rng.uniform(*poles, 2))
    damping = [float(value) for value in rng.uniform(0.4, 1.6, 2)]
    if seed % 2 == 0:
        return mode, FirstOrder(
            accel_time_constant_s=1 / accel, decel_time_constant_s=1 / decel, model=model
        )
    return mode, SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=accel, damping_ratio=damping[0]),
        decel=SecondOrderSet(natural_frequency_rad_s=decel, damping_ratio=damping[1]),
        model=model,
    )


def designed(
    seed: int, model: Model = "superposed", poles: tuple[float, float] = (4.0, 20.0)
) -> Design | str:
    """Return the NUMZVD of a case, or what the search for it says."""
    try:
        return design(*random_case(seed, model, poles), SHAPERS["numzvd"])
    except InfeasibleDesignError as error:
        return str(error)


@pytest.mark.parametrize("part", range(PARTS))
def test_random_designs_are_verified_or_say_how_far_was_searched(part: int) -> None:
    """All of first order and 99.8 % of second order; each part of 250 may miss one."""
    missed: Counter[str] = Counter()
    size = CASES // PARTS
    for seed in range(part * size, (part + 1) * size):
        found = designed(seed)
        order = "first" if seed % 2 == 0 else "second"
        if isinstance(found, str):
            assert "periods in 1026 starts; nearest miss" in found
            missed[order] += 1
            continue
        assert found.certificate.verified
        # The formula at the pole, which the certificate does not use.
        assert found.residual <= 1e-9
        assert np.all(np.diff(found.impulses.times_s) > 0)
    assert missed["first"] == 0
    assert missed["second"] <= 1


@pytest.mark.parametrize(
    ("first", "cases", "poles", "allowed"),
    [(part * 1000, 1000, (4.0, 20.0), 1) for part in range(10)]
    + [(part * 500, 500, (2.0, 4.0), 2) for part in range(4)],
)
def test_random_switched_designs_are_verified_or_say_how_far_was_searched(
    first: int, cases: int, poles: tuple[float, float], allowed: int
) -> None:
    """99.9 % of ten thousand, and 99.5 % of two thousand behind slow actuators."""
    missed = 0
    for seed in range(first, first + cases):
        found = designed(seed, "switched", poles)
        if isinstance(found, str):
            assert "nearest miss" in found
            missed += 1
            continue
        assert found.certificate.verified
        assert found.residual <= 1e-9
    assert missed <= allowed


def equations(
    times: NDArray[np.float64], mode: Mode, actuator: Actuator
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the four equations and their Jacobian, over many times of shape (m, 4), at w = 1.

    Written anew from ``V = sum A_i G_i(s) exp(-s t_i)``, without the package's formulation.
    """
    w, z = mode.natural_frequency_rad_s, mode.damping_ratio
    s = complex(-z, np.sqrt(1 - z * z))
    gains, slopes = [], []
    for lag in (actuator.accel_lag, actuator.decel_lag):
        first, second = lag.first_s * w, lag.second_s2 * w * w
        below = 1 + first * s + second * s * s
        gains.append(1 / below)
        slopes.append(-(first + 2 * second * s) / below**2)
    full = np.concatenate((np.zeros((len(times), 1)), times), axis=1)
    sets = np.array([0, 1, 0, 1, 0])
    amplitudes = np.array([1, -1, 1, -1, 1])
    gain, slope = np.array(gains)[sets], np.array(slopes)[sets]
    swing = amplitudes * np.exp(-s * full)
    vibration = (swing * gain).sum(axis=1)
    derivative = (swing * (slope - full * gain)).sum(axis=1)
    by_time = (-s * swing * gain)[:, 1:]
    derivative_by_time = (swing * (-s * (slope - full * gain) - gain))[:, 1:]
    values = np.stack([vibration.real, vibration.imag, derivative.real, derivative.imag], axis=1)
    jacobian = np.stack(
        [by_time.real, by_time.imag, derivative_by_time.real, derivative_by_time.imag], axis=1
    )
    return values, jacobian


def fastest_of_random_starts(mode: Mode, actuator: Actuator, seed: int) -> float:
    """Return the shortest ordered solution within 3 periods from random starts, in radians."""
    rng = np.random.default_rng(seed)
    horizon = 6 * np.pi
    # Half of the starts over all the horizon, half within the first period.
    spans = np.repeat([horizon, horizon / 3], RANDOM_STARTS // 2)[:, None]
    times = np.sort(rng.uniform(0, 1, (RANDOM_STARTS, 4)) * spans, axis=1)
    for _ in range(60):
        values, jacobian = equations(times, mode, actuator)
        steps = np.linalg.solve(jacobian + 1e-14 * np.eye(4), values[..., None])[..., 0]
        times = times - np.clip(steps, -0.5, 0.5)
        times = np.clip(times, -30, 60)  # the lost ones must not overflow
    values, _ = equations(times, mode, actuator)
    ordered = np.all(np.diff(times, axis=1, prepend=0.0) > 1e-6, axis=1)
    solved = (np.abs(values).max(axis=1) < 1e-10) & ordered & (times[:, -1] <= horizon)
    return float(times[solved, -1].min(initial=np.inf))


def test_no_random_start_finds_a_faster_solution() -> None:
    """In at least 99.5 % of 300 cases the design is the fastest of 200 random starts."""
    beaten = 0
    for seed in range(1, 2 * MULTISTART_CASES, 2):
        mode, actuator = random_case(seed)
        found = designed(seed)
        duration = np.inf if isinstance(found, str) else found.impulses.duration_s
        best = fastest_of_random_starts(mode, actuator, seed)
        beaten += best < duration * mode.natural_frequency_rad_s - 1e-6
    assert beaten <= 0.005 * MULTISTART_CASES
