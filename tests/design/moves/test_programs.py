"""Programs: what a controller replays, and what remains of it as it is played."""

import numpy as np
import pytest

from design.analysis.ramp_figures import end_of_reference
from design.claims import Quantity
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.commands import pulse
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.moves.maneuvers import Maneuver, maneuver
from design.moves.programs import Program, program
from design.shapers.registry import SHAPERS
from tests import expm_route
from tests.jerk_route import integrate_jerk_limited
from tests.refusals import refused

MODE = Mode(natural_frequency_rad_s=2 * np.pi, damping_ratio=0.02)
ASYMMETRIC = FirstOrder(accel_time_constant_s=0.03, decel_time_constant_s=0.06, model="switched")
LIMITED = RateLimited(accel_limit_m_s2=1.6, decel_limit_m_s2=2.5, speed_m_s=0.4)
SLOPE: tuple[Quantity, ...] = ("residual", "slope")


def as_steps(found: Program, speed_m_s: float) -> Impulses:
    """Return the velocities of a program, each held for its sample, as steps of them."""
    steps = np.diff(found.velocity_m_s / speed_m_s, prepend=0.0)
    used = np.abs(steps) > 1e-13
    return Impulses(times_s=found.times_s[used], amplitudes=steps[used])


def move_of(mode: Mode, actuator: Actuator, kind: str) -> Maneuver:
    return maneuver(mode, actuator, SHAPERS[kind], speed_m_s=0.4, distance_m=0.9)


def test_positions_are_the_integral_of_the_velocities_held() -> None:
    move = move_of(MODE, ASYMMETRIC, "numzv")
    found = program(move.command, MODE, ASYMMETRIC, -0.4, 0.0137)
    assert found.times_s == pytest.approx(0.0137 * np.arange(found.times_s.size))
    assert found.position_m[0] == 0
    assert found.velocity_m_s[-1] == 0
    held = 0.0137 * found.velocity_m_s[:-1]
    assert np.diff(found.position_m) == pytest.approx(held, abs=1e-15)


def test_where_both_sets_are_alike_the_last_position_is_the_distance() -> None:
    move = move_of(MODE, Ideal(), "numzvd")
    found = program(move.command, MODE, Ideal(), 0.4, 0.0137, claims=SLOPE)
    assert found.position_m[-1] == pytest.approx(0.9, abs=1e-14)
    assert found.distance_m == pytest.approx(0.9, abs=1e-14)


@pytest.mark.parametrize("actuator", [Ideal(), ASYMMETRIC, LIMITED], ids=str)
@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
@pytest.mark.parametrize("sample_time_s", [0.008, 0.031, 0.1])
def test_nothing_remains_as_a_program_is_played(
    actuator: Actuator, kind: str, sample_time_s: float
) -> None:
    move = move_of(MODE, actuator, kind)
    claims = SLOPE if kind == "numzvd" else ("residual",)
    found = program(move.command, MODE, actuator, 0.4, sample_time_s, claims=claims)
    steps = as_steps(found, 0.4)
    played = expm_route.outcome(steps, MODE, actuator)
    assert played.residual < 1e-11
    assert 0.4 * played.travel == pytest.approx(move.distance_m, abs=1e-12)
    assert found.distance_m == pytest.approx(move.distance_m, abs=1e-12)
    assert not found.warnings
    if kind == "numzvd":
        assert expm_route.slope(steps, MODE, actuator) < 1e-7
    assert found.velocity_m_s.min() >= 0
    assert found.velocity_m_s.max() <= 0.4 * (1 + 1e-12)
    assert found.times_s[-1] < move.duration_s + 2 * sample_time_s


@pytest.mark.parametrize("hertz", [11.0, 15.0, 23.0])
@pytest.mark.parametrize("kind", ["umzv", "umzvd"])
def test_a_period_of_few_samples_has_an_exact_program(hertz: float, kind: str) -> None:
    mode = Mode(natural_frequency_rad_s=2 * np.pi * hertz)
    move = maneuver(mode, Ideal(), SHAPERS[kind], speed_m_s=0.4, distance_m=0.42)
    found = program(move.command, mode, Ideal(), 0.4, 0.008)
    played = expm_route.outcome(as_steps(found, 0.4), mode, Ideal())
    assert played.residual < 1e-12
    assert not found.warnings


@pytest.mark.parametrize("sample_time_s", [0.008, 0.05])
def test_nothing_remains_behind_a_limit_to_the_jerk(sample_time_s: float) -> None:
    drive = RateLimited(
        accel_limit_m_s2=1.6, decel_limit_m_s2=2.0, speed_m_s=0.4, jerk_limit_m_s3=30.0
    )
    move = move_of(MODE, drive, "numzv")
    found = program(move.command, MODE, drive, 0.4, sample_time_s)
    assert not found.warnings
    steps = as_steps(found, 0.4)
    end_s = end_of_reference(steps, drive) + 0.01
    deflection, rate, velocity, _ = integrate_jerk_limited(steps, MODE, drive, end_s)
    assert np.hypot(MODE.natural_frequency_rad_s * deflection, rate) < 1e-8
    assert abs(velocity) < 1e-8


def test_a_program_is_for_the_drive_given_also_where_the_move_is_not() -> None:
    mode = Mode(natural_frequency_rad_s=2 * np.pi * 11, damping_ratio=0.02)
    drive = FirstOrder(accel_time_constant_s=0.0027, decel_time_constant_s=0.0054)
    move = maneuver(mode, drive, SHAPERS["umzvd"], speed_m_s=0.4, distance_m=0.08)
    assert move.for_ideal
    assert move.residual > 0.05
    found = program(move.command, mode, drive, 0.4, 0.008, claims=SLOPE)
    assert expm_route.outcome(as_steps(found, 0.4), mode, drive).residual < 1e-12


def test_what_cannot_be_exact_has_a_warning_with_its_figure() -> None:
    drive = FirstOrder(accel_time_constant_s=0.03, decel_time_constant_s=0.06)
    move = move_of(MODE, drive, "umzv")
    found = program(move.command, MODE, drive, 0.4, 0.001)
    played = expm_route.outcome(as_steps(found, 0.4), MODE, drive)
    assert found.residual == pytest.approx(played.residual, abs=1e-9)
    assert found.residual < move.residual
    assert found.distance_m == pytest.approx(move.distance_m, abs=1e-12)
    (warning,) = found.warnings
    assert warning.code == "program_residual"
    assert f"{100 * found.residual:.4g} %" in warning.detail


def test_a_program_whose_steps_are_samples_is_its_command() -> None:
    mode = Mode(natural_frequency_rad_s=2 * np.pi)
    command = Impulses(
        times_s=np.array([0.0, 0.5, 3.0, 3.5]), amplitudes=np.array([0.5, 0.5, -0.5, -0.5])
    )
    found = program(command, mode, Ideal(), 0.4, 0.1)
    steps = as_steps(found, 0.4)
    assert steps.times_s == pytest.approx(command.times_s)
    assert steps.amplitudes == pytest.approx(command.amplitudes)
    assert not found.warnings


def test_what_is_no_move_is_shared_as_it_is() -> None:
    command = Impulses(times_s=np.array([0.0, 0.25]), amplitudes=np.array([0.5, 0.5]))
    found = program(command, MODE, Ideal(), 0.4, 0.1)
    assert found.velocity_m_s == pytest.approx([0.2, 0.2, 0.3, 0.4])
    (warning,) = found.warnings
    assert warning.code == "program_residual"


@pytest.mark.parametrize("actuator", [Ideal(), ASYMMETRIC, LIMITED], ids=str)
def test_nearly_as_many_samples_as_are_served_are_as_exact(actuator: Actuator) -> None:
    move = move_of(MODE, actuator, "numzvd")
    sample_time_s = move.duration_s / 999_990
    found = program(move.command, MODE, actuator, 0.4, sample_time_s, claims=SLOPE)
    assert found.times_s.size >= 999_990
    assert found.residual < 1e-10
    assert found.distance_m == pytest.approx(move.distance_m, abs=1e-12)


@pytest.mark.parametrize(
    ("sample_time", "code"),
    [
        (0.0, "out_of_range"),
        (2.0, "out_of_range"),
        (0.51, "out_of_range"),
        (1e-9, "too_many_samples"),
    ],
)
def test_a_sample_time_must_suit_the_command(sample_time: float, code: str) -> None:
    with refused(code, "sample_time_s"):
        program(pulse(1.0), MODE, Ideal(), 0.2, sample_time)
