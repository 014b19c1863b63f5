"""Programs: what a controller replays, and what remains of it as it is played."""

import numpy as np
import pytest

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.commands import pulse
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.moves.maneuvers import maneuver
from design.moves.programs import Program, program
from design.shapers.registry import SHAPERS
from tests.integration_route import residual_by_integration
from tests.refusals import refused

MODE = Mode(natural_frequency_rad_s=2 * np.pi)
ASYMMETRIC = FirstOrder(accel_time_constant_s=0.03, decel_time_constant_s=0.06, model="switched")


def as_steps(found: Program, speed_m_s: float) -> Impulses:
    """Return the velocities of a program, each held for its sample, as steps of them."""
    steps = np.diff(found.velocity_m_s / speed_m_s, prepend=0.0)
    used = steps != 0
    return Impulses(times_s=found.times_s[used], amplitudes=steps[used])


def test_a_program_is_exact_at_its_samples_and_ends_at_rest() -> None:
    command = Impulses(times_s=np.array([0.0, 0.35, 1.0]), amplitudes=np.array([1.0, -0.5, -0.5]))
    found = program(command, MODE, Ideal(), -0.2, 0.1)
    assert found.times_s == pytest.approx(0.1 * np.arange(11))
    # -0.2 m/s for 0.35 s, then half of it for 0.65 s.
    assert found.position_m[-1] == pytest.approx(-0.2 * (0.35 + 0.325))
    assert found.position_m[3] == pytest.approx(-0.2 * 0.3)
    assert found.velocity_m_s[3] == pytest.approx(-0.2 * 0.75)
    assert found.velocity_m_s[-1] == 0
    assert np.diff(found.position_m) == pytest.approx(0.1 * found.velocity_m_s[:-1])


@pytest.mark.parametrize("actuator", [Ideal(), ASYMMETRIC])
@pytest.mark.parametrize("kind", ["umzv", "umzvd"])
@pytest.mark.parametrize("sample_time_s", [0.008, 0.031])
def test_the_residual_of_a_program_is_that_of_its_velocities_played(
    actuator: Actuator, kind: str, sample_time_s: float
) -> None:
    move = maneuver(MODE, actuator, SHAPERS[kind], speed_m_s=0.4, distance_m=0.9)
    found = program(move.command, MODE, actuator, 0.4, sample_time_s)
    played = residual_by_integration(as_steps(found, 0.4), MODE, actuator)
    assert found.residual == pytest.approx(played, abs=1e-6)
    (warning,) = found.warnings
    assert warning.code == "program_residual"
    assert f"{100 * found.residual:.4g} %" in warning.detail


def test_a_program_whose_steps_are_samples_has_the_residual_of_its_command() -> None:
    command = Impulses(
        times_s=np.array([0.0, 0.5, 3.0, 3.5]), amplitudes=np.array([0.5, 0.5, -0.5, -0.5])
    )
    found = program(command, MODE, Ideal(), 0.4, 0.1)
    assert found.residual < 1e-14
    assert not found.warnings


def test_two_steps_within_one_sample_are_played_together() -> None:
    command = Impulses(
        times_s=np.array([0.0, 0.42, 0.47, 1.0]), amplitudes=np.array([1.0, -1.0, 1.0, -1.0])
    )
    found = program(command, MODE, Ideal(), 1.0, 0.1)
    assert found.velocity_m_s == pytest.approx([1, 1, 1, 1, 0.5, 1, 1, 1, 1, 1, 0])
    played = residual_by_integration(as_steps(found, 1.0), MODE, Ideal())
    assert found.residual == pytest.approx(played, abs=1e-6)


@pytest.mark.parametrize(
    ("sample_time", "code"),
    [(0.0, "out_of_range"), (2.0, "out_of_range"), (1e-9, "too_many_samples")],
)
def test_a_sample_time_must_suit_the_command(sample_time: float, code: str) -> None:
    with refused(code, "sample_time_s"):
        program(pulse(1.0), MODE, Ideal(), 0.2, sample_time)
