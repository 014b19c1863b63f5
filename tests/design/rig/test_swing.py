"""The swinging cable against Lagrange's equations in angles, energy and small swings."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.response.closed_form import history
from design.rig.crane import Crane, Load
from design.rig.machine import Machine
from design.rig.track import Track
from design.types import FloatArray
from tests.design.rig.cranes import CRANE, THESIS, command_all, played, random_drive

LOAD = Load(mass_kg=0.6, length_m=0.25)
DOUBLE = Crane(cable_length_m=0.8, gravity_m_s2=9.81, load=LOAD)
MOVE = Impulses(
    times_s=np.array([0.0, 0.3, 0.55, 1.5, 1.8]), amplitudes=np.array([1.0, -1.0, 1.0, -1.0, -0.5])
)
SPEED_M_S = 1.2

Accelerations = Callable[[float], tuple[float, float]]


def tracked(machine: Machine, times_s: FloatArray) -> Track:
    return machine.advance(float(times_s[-1]), times_s)


def by_angles(
    accelerations: Accelerations, length_m: float, gravity: float, times: FloatArray
) -> FloatArray:
    """Integrate (2.1) of Kim 2011, its second line corrected; return the payload by (2.8).

    The angles are phi toward -x and theta toward +y: x = -L sin(phi), y = L cos(phi) sin(theta).
    """

    def rates(time: float, state: FloatArray) -> list[float]:
        phi, phi_rate, theta, theta_rate = state
        along_x, along_y = accelerations(time)
        second_phi = (
            -(theta_rate**2) * math.cos(phi) * math.sin(phi)
            - gravity / length_m * math.sin(phi) * math.cos(theta)
            + along_x / length_m * math.cos(phi)
            + along_y / length_m * math.sin(phi) * math.sin(theta)
        )
        second_theta = (
            2 * phi_rate * theta_rate * math.tan(phi)
            - gravity / length_m * math.sin(theta) / math.cos(phi)
            - along_y / length_m * math.cos(theta) / math.cos(phi)
        )
        return [phi_rate, second_phi, theta_rate, second_theta]

    route = solve_ivp(
        rates,
        (0.0, float(times[-1])),
        np.zeros(4),
        method="DOP853",
        t_eval=times,
        rtol=1e-12,
        atol=1e-13,
        max_step=0.01,
    )
    phi, theta = route.y[0], route.y[2]
    return length_m * np.stack([-np.sin(phi), np.cos(phi) * np.sin(theta)], axis=1)


def test_both_axes_move_by_the_lagrangian_in_angles() -> None:
    # One lag an axis: its acceleration after a step is an exponential, for the other route.
    slow = FirstOrder(accel_time_constant_s=0.2, decel_time_constant_s=0.2)
    machine = Machine(CRANE, (slow, slow), 1.5)
    machine.command("x", 1.0)
    machine.command("y", -0.7)
    times = np.linspace(0, 8, 81)
    track = tracked(machine, times)

    def accelerations(time: float) -> tuple[float, float]:
        decay = 1.5 * math.exp(-time / 0.2) / 0.2
        return decay, -0.7 * decay

    told = by_angles(accelerations, 0.8, 9.81, times)
    assert np.abs(track.angle_rad).max() > 0.45  # large enough to tell one law from another
    assert track.hook_m[:, :2] == pytest.approx(told, abs=1e-9)


def test_the_double_pendulum_moves_by_its_lagrangian_in_angles() -> None:
    # Planar, angles a and b from the vertical toward +x, textbook form of the two equations.
    hook, load, upper, lower, gravity = 0.385, 0.6, 0.8, 0.25, 9.81

    def rates(time: float, state: FloatArray) -> list[float]:
        a, a_rate, b, b_rate = state
        pulled = 1.2 * math.exp(-time / 0.3) / 0.3
        mass = np.array([
            [(hook + load) * upper, load * lower * math.cos(a - b)],
            [upper * math.cos(a - b), lower],
        ])
        force = np.array([
            -load * lower * b_rate**2 * math.sin(a - b)
            - (hook + load) * (gravity * math.sin(a) + pulled * math.cos(a)),
            upper * a_rate**2 * math.sin(a - b) - gravity * math.sin(b) - pulled * math.cos(b),
        ])
        second = np.linalg.solve(mass, force)
        return [a_rate, second[0], b_rate, second[1]]

    times = np.linspace(0, 6, 61)
    route = solve_ivp(
        rates, (0, 6), np.zeros(4), method="DOP853", t_eval=times, rtol=1e-12, atol=1e-13
    )
    slow = FirstOrder(accel_time_constant_s=0.3, decel_time_constant_s=0.3)
    track = played(
        DOUBLE, slow, Impulses(times_s=np.zeros(1), amplitudes=np.ones(1)), SPEED_M_S, times
    )
    told = upper * np.sin(route.y[0]) + lower * np.sin(route.y[2])
    assert np.abs(told).max() > 0.25
    assert track.load_m[:, 0] == pytest.approx(told, abs=1e-9)
    assert track.hook_m[:, 0] == pytest.approx(upper * np.sin(route.y[0]), abs=1e-9)


@pytest.mark.parametrize("load", [None, LOAD], ids=["hook", "load"])
@pytest.mark.parametrize("model", ["linear", "nonlinear"])
def test_the_frequencies_are_those_of_the_reference(load: Load | None, model: str) -> None:
    # THEORY of the project: 3.18121 and 11.02933 rad/s for the double pendulum.
    crane = Crane(
        cable_length_m=0.8,
        gravity_m_s2=9.81,
        load=load,
        model="linear" if model == "linear" else "nonlinear",
    )
    if load is None:
        assert crane.slowest_rad_s == pytest.approx(3.50178526, abs=1e-8)
        expected = [crane.slowest_rad_s]
    else:
        assert crane.slowest_rad_s == pytest.approx(3.18121, abs=5e-6)
        expected = [3.18121, 11.02933]
    step = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
    apart = 0.05
    found = played(crane, Ideal(), step, 1e-3, np.arange(400) * apart).load_m[:, 0]
    # A sum of free oscillations obeys a recursion whose roots are exp(+-j w apart).
    order = 2 * len(expected)
    middle = order // 2
    rows = np.stack([found[shift : shift + 390] for shift in range(order + 1)], axis=1)
    even = np.stack([rows[:, k] + rows[:, order - k] for k in range(middle)], axis=1)
    weights = np.linalg.lstsq(even, -rows[:, middle], rcond=None)[0]
    polynomial = np.array([*weights, 1.0, *weights[::-1]])
    turns = np.sort(np.unique(np.round(np.abs(np.angle(np.roots(polynomial))), 9)))
    assert turns / apart == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("load", [None, LOAD], ids=["hook", "load"])
def test_energy_stays_while_the_trolley_rests(load: Load | None) -> None:
    crane = Crane(cable_length_m=0.8, gravity_m_s2=9.81, load=load)
    drive = FirstOrder(accel_time_constant_s=0.05, decel_time_constant_s=0.02)
    machine = Machine(crane, (drive, drive), 1.0)
    for axis in ("x", "y"):
        machine.command("x" if axis == "x" else "y", 1.0)
    machine.command("x", 0.0, 0.5)
    machine.command("y", 0.0, 0.3)
    machine.advance(3.0)  # e^-50 of the lags is left
    track = machine.advance(63.0, np.linspace(3, 63, 601))
    assert track.swing_energy_j.min() > 0.05
    assert np.ptp(track.energy_j) < 1e-9
    assert np.ptp(track.swing_energy_j) < 1e-9


@pytest.mark.parametrize("seed", range(12))
def test_energy_is_the_work_while_hoisting(seed: int) -> None:
    rng = np.random.default_rng(seed)
    crane = Crane(
        cable_length_m=0.8,
        gravity_m_s2=9.81,
        damping_ratio=float(rng.uniform(0, 0.1)) * (seed % 2),
        load=LOAD if seed % 3 == 0 else None,
    )
    drives = random_drive(rng, 0.6), random_drive(rng, 0.6)
    machine = Machine(crane, drives, 0.6)
    command_all(machine, MOVE)
    machine.command("y", -0.8, 0.2)
    machine.command("y", 0.0, 1.1)
    machine.hoist(0.5, 2.0, at_s=0.4)
    machine.hoist(0.9, 1.5, at_s=1.9)  # before the first has ended
    track = machine.advance(6.0, np.linspace(0, 6, 301))
    gained = track.energy_j - track.energy_j[0]
    assert np.abs(gained).max() > 0.5
    assert gained == pytest.approx(track.work_j, abs=1e-8)
    assert np.linalg.norm(track.hook_m, axis=1) == pytest.approx(track.cable_length_m, abs=1e-14)
    assert track.cable_length_m[-1] == 0.9


@pytest.mark.parametrize("damping_ratio", [0.0, 0.07])
@pytest.mark.parametrize("seed", range(10))
def test_the_linear_model_is_the_closed_form(seed: int, damping_ratio: float) -> None:
    drive = random_drive(np.random.default_rng(seed), 0.5)
    crane = Crane(
        cable_length_m=0.8, gravity_m_s2=9.81, damping_ratio=damping_ratio, model="linear"
    )
    times = np.linspace(0, 5, 101)
    frequency = math.sqrt(9.81 / 0.8)
    told = history(
        MOVE, Mode(natural_frequency_rad_s=frequency, damping_ratio=damping_ratio), drive, times
    )
    track = played(crane, drive, MOVE, 0.5, times)
    assert track.load_m[:, 0] == pytest.approx(0.5 / frequency * told.deflection, abs=1e-11)
    assert track.load_m[:, 1] == pytest.approx(0, abs=0)


@pytest.mark.parametrize("load", [None, LOAD], ids=["hook", "load"])
def test_small_swings_are_linear(load: Load | None) -> None:
    times = np.linspace(0, 5, 51)
    tracks = []
    for model in ("linear", "nonlinear"):
        crane = Crane(
            cable_length_m=0.8,
            gravity_m_s2=9.81,
            damping_ratio=0.05,
            load=load,
            model="linear" if model == "linear" else "nonlinear",
        )
        machine = Machine(crane, (Ideal(), THESIS), 1e-4)
        command_all(machine, MOVE)
        machine.command("y", 1.0, 0.3)
        machine.hoist(0.6, 1.0, at_s=0.7)
        tracks.append(tracked(machine, times).load_m[:, :2])
    assert np.abs(tracks[0]).max() > 2e-5
    assert tracks[1] == pytest.approx(tracks[0], abs=1e-11)  # (1e-4)^3 of the speed is not linear


@pytest.mark.parametrize("load", [None, LOAD], ids=["hook", "load"])
def test_a_drive_that_jumps_is_the_limit_of_quick_ones(load: Load | None) -> None:
    crane = Crane(cable_length_m=0.8, gravity_m_s2=9.81, load=load)
    times = np.linspace(0, 4, 41)
    at_once = played(crane, Ideal(), MOVE, 0.8, times).load_m
    for constant, apart in ((1e-3, 5e-3), (1e-5, 5e-5)):
        quick = FirstOrder(accel_time_constant_s=constant, decel_time_constant_s=constant)
        track = played(crane, quick, MOVE, 0.8, times)
        assert track.load_m == pytest.approx(at_once, abs=apart)


def test_a_swing_has_no_singular_place() -> None:
    # The x-y frame turned about the vertical turns the motion: also through phi = 0.
    for turn in (0.0, math.pi / 4, math.pi / 2):
        machine = Machine(CRANE, (THESIS, THESIS), 1.0)
        for axis, share in (("x", math.cos(turn)), ("y", math.sin(turn))):
            for time, level in ((0.0, 1.0), (0.4, 0.0)):
                machine.command("x" if axis == "x" else "y", share * level, time)
        track = machine.advance(5.0, np.linspace(0, 5, 51))
        along = track.load_m[:, 0] * math.cos(turn) + track.load_m[:, 1] * math.sin(turn)
        if turn == 0.0:
            first = along
        assert along == pytest.approx(first, abs=1e-11)


def test_damping_takes_a_swing_away_at_its_ratio() -> None:
    crane = Crane(cable_length_m=0.8, gravity_m_s2=9.81, damping_ratio=0.02)
    machine = Machine(crane, (Ideal(), Ideal()), 1e-3)
    machine.command("x", 1.0)
    period = 2 * math.pi / (crane.slowest_rad_s * math.sqrt(1 - 0.02**2))
    energy = machine.advance(10 * period, period * np.arange(1, 11)).swing_energy_j
    decay = math.exp(-4 * math.pi * 0.02 / math.sqrt(1 - 0.02**2))
    assert energy[1:] / energy[:-1] == pytest.approx(decay, rel=1e-6)
