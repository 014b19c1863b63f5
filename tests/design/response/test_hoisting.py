"""Two routes to the swing on a cable that is hoisted, theory, and plain integration."""

import numpy as np
import pytest
from scipy.special import jv, yv

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.hoisting import Hoisting, LengthCourse
from design.response.closed_form import history
from design.response.hoisting_kernel import hoisting_kernel
from design.response.hoisting_simulation import hoisting_history, simulated_vibration
from design.response.hoisting_vibration import (
    hoisting_residual,
    hoisting_vibration,
    residual_reference_s,
)
from tests.hoisting_route import hoisted_residual, rest_s
from tests.second_route import denominator

G = 9.81
THESIS = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=50.0, damping_ratio=1.5),
    model="switched",
)
ROUTES_AGREE = 2e-12
"""Both are exact to rounding; the longest of these commands turns the swing by some 60 rad."""


def hoisting(times_s: list[float], values: list[float], damping_ratio: float = 0.0) -> Hoisting:
    course = LengthCourse(times_s=tuple(times_s), values=tuple(values))
    return Hoisting(cable_length_m=course, damping_ratio=damping_ratio, gravity_m_s2=G)


def drawn_case(rng: np.random.Generator) -> tuple[Impulses, Hoisting, Actuator]:
    count = int(rng.integers(2, 5))
    plant = hoisting(
        np.cumsum(rng.uniform(0.05, 2.0, count)).tolist(),
        rng.uniform(0.2, 2.0, count).tolist(),
        float(rng.choice([0.0, 0.02, 0.3])),
    )
    times = np.sort(np.concatenate(([0.0], rng.uniform(0, 6, 5))))
    command = Impulses(times_s=times, amplitudes=np.array([1.0, -1.0] * 3))
    model: Model = "switched" if rng.random() < 0.5 else "superposed"
    kind = rng.integers(4)
    if kind == 0:
        return command, plant, Ideal()
    if kind == 1:
        constants = 10 ** rng.uniform(-4, -0.3), float(rng.choice([0.0, 0.05, 1e-3]))
        return command, plant, FirstOrder(
            accel_time_constant_s=float(constants[0]), decel_time_constant_s=constants[1],
            model=model, dead_time_s=0.2,
        )  # fmt: skip
    accel, decel = (
        SecondOrderSet(
            natural_frequency_rad_s=float(10 ** rng.uniform(0.7, 2.5)),
            damping_ratio=float(rng.uniform(0.1, 4)),
        )
        for _ in range(2)
    )
    return command, plant, SecondOrder(accel=accel, decel=decel, model=model)


CASES = [drawn_case(np.random.default_rng(seed)) for seed in range(60)]


@pytest.mark.parametrize("lengths_m", [(0.8, 0.5), (0.3, 2.0), (2.0, 0.004)])
def test_the_kernel_of_linear_hoisting_is_bessel_functions(lengths_m: tuple[float, float]) -> None:
    # L k'' + g k = 0: k = x (a J1(x) + b Y1(x)) with x = 2 sqrt(g L) / |c|.
    plant = hoisting([0.0, 3.0], list(lengths_m))
    times = np.linspace(0.0, 2.999, 41)
    rate = (lengths_m[1] - lengths_m[0]) / 3
    x = 2 * np.sqrt(G * (lengths_m[0] + rate * times)) / abs(rate)
    basis = np.column_stack((x * jv(1, x), x * yv(1, x)))
    found = hoisting_kernel(plant).at(times)
    fitted = np.linalg.lstsq(basis / basis.max(), found, rcond=None)[0]
    assert np.abs(basis / basis.max() @ fitted - found).max() <= 1e-12 * np.abs(found).max()


@pytest.mark.parametrize("damping_ratio", [0.0, 0.1, 0.9])
def test_a_course_that_hardly_changes_is_a_pendulum(damping_ratio: float) -> None:
    plant = hoisting([0.5, 2.0, 4.0], [0.8, 0.8, 0.8 + 1e-15], damping_ratio)
    times = np.linspace(0.0, 6.0, 25)
    by_mode = np.exp(-plant.last.mode.pole_rad_s * (times - 4.0))
    found = hoisting_kernel(plant).at(times)
    assert np.abs(found / by_mode - 1).max() <= 1e-13


@pytest.mark.parametrize("number", range(len(CASES)))
def test_the_kernel_and_the_steps_through_time_agree(number: int) -> None:
    command, plant, actuator = CASES[number]
    by_kernel = hoisting_vibration(command, plant, actuator)
    later_s = residual_reference_s(command, plant, actuator) - plant.end_s
    there = by_kernel * np.exp(plant.last.mode.pole_rad_s * later_s)
    by_steps = simulated_vibration(command, plant, actuator)
    assert abs(there - by_steps) <= ROUTES_AGREE


def _decays_late(plant: Hoisting, actuator: Actuator) -> bool:
    """Whether what is extrapolated back from the drive's rest keeps its digits."""
    return -plant.last.mode.pole_rad_s.real * rest_s(actuator) <= 7.0


INTEGRATED = [
    number for number, (_, plant, actuator) in enumerate(CASES) if _decays_late(plant, actuator)
][::3]


@pytest.mark.parametrize("number", INTEGRATED)
def test_integration_of_the_angle_finds_the_same_residual(number: int) -> None:
    command, plant, actuator = CASES[number]
    found = hoisting_residual(command, plant, actuator)
    # An integrator's own error, after up to some 40,000 steps.
    assert found == pytest.approx(hoisted_residual(command, plant, actuator), abs=1e-9)


def test_on_a_cable_that_stays_it_is_the_residual_over_an_ideal_step() -> None:
    plant = hoisting([0.0, 0.4], [0.8, 0.8], 0.05)
    command = Impulses(times_s=np.array([0.0, 0.5, 3.0]), amplitudes=np.array([1.0, -1.0, 1.0]))
    drive = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)
    mode = plant.last.mode
    pole = mode.pole_rad_s
    vector = 0j
    for time_s, height, accel in ((0.0, 1.0, True), (0.5, -1.0, False), (3.0, 1.0, True)):
        first, second = denominator(drive, accel=accel)
        vector += height * np.exp(-pole * time_s) / (1 + first * pole + second * pole**2)
    by_mode = abs(vector) * np.exp(pole.real * 3.0)
    assert hoisting_residual(command, plant, drive) == pytest.approx(by_mode, abs=1e-14)


def test_lengths_and_times_scale_together() -> None:
    """Four times the lengths in twice the time, at twice the time constants: the same numbers."""
    command = Impulses(times_s=np.array([0.0, 0.5, 3.0]), amplitudes=np.array([1.0, -1.0, 1.0]))
    slow = Impulses(times_s=2 * command.times_s, amplitudes=command.amplitudes)
    found = [
        hoisting_residual(one, plant, drive)
        for one, plant, drive in (
            (command, hoisting([0.3, 4.0], [0.8, 0.4], 0.1), _drive(1.0)),
            (slow, hoisting([0.6, 8.0], [3.2, 1.6], 0.1), _drive(2.0)),
        )
    ]
    assert found[0] == pytest.approx(found[1], rel=1e-12)


def _drive(slowness: float) -> FirstOrder:
    return FirstOrder(
        accel_time_constant_s=0.1 * slowness,
        decel_time_constant_s=0.05 * slowness,
        model="switched",
    )


def test_the_history_of_a_cable_that_stays_is_that_of_its_mode() -> None:
    plant = hoisting([0.0, 1.0], [0.8, 0.8], 0.05)
    command = Impulses(times_s=np.array([0.0, 0.5, 3.0]), amplitudes=np.array([1.0, -1.0, 1.0]))
    times = np.linspace(-0.5, 6.0, 301)
    mode = plant.last.mode
    expected = history(command, mode, THESIS, times)
    found = hoisting_history(command, plant, THESIS, times)
    assert found.command.tolist() == expected.command.tolist()
    assert np.abs(found.velocity - expected.velocity).max() <= 1e-12
    deflection = expected.deflection / mode.natural_frequency_rad_s
    assert np.abs(found.deflection - deflection).max() <= 1e-12


def test_a_history_rings_on_as_the_kernel_says() -> None:
    plant = hoisting([0.5, 2.0], [0.8, 0.5], 0.05)
    command = Impulses(times_s=np.array([0.0, 0.5, 3.0]), amplitudes=np.array([1.0, -1.0, 1.0]))
    pole = plant.last.mode.pole_rad_s
    times = np.linspace(8.0, 12.0, 101)  # the drive is at rest, to e^-50
    vector = hoisting_vibration(command, plant, THESIS) * np.exp(pole * (times - plant.end_s))
    found = hoisting_history(command, plant, THESIS, times).deflection
    assert np.abs(found + vector.imag / pole.imag).max() <= 1e-12
