"""Shaped commands: what a shaper made for a start leaves of a whole command, said or nothing."""

from dataclasses import replace

import numpy as np
import pytest

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.commands import command_of_velocities, pulse, step
from design.model.impulses import Impulses
from design.model.plants.pendulum import Pendulum
from design.moves.shaped_commands import shaped_command
from design.pipeline import design
from design.shapers.registry import SHAPERS
from tests.integration_route import residual_by_integration

CRANE = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
SYMMETRIC = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.1)
ASYMMETRIC = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=50, damping_ratio=1.5),
)
DRIVES: tuple[Actuator, ...] = (
    Ideal(),
    SYMMETRIC,
    ASYMMETRIC,
    replace(ASYMMETRIC, model="switched"),
)
COMMANDS = {
    "step": step(),
    "pulse": pulse(1.5),
    "stairs": command_of_velocities(np.array([0.0, 0.7, 2.0]), np.array([0.3, 1.0, 0.4])),
    "back": command_of_velocities(np.array([0.0, 0.7, 2.0]), np.array([1.0, -1.0, 0.0])),
}
CLAIMED = {"umzv": 1e-9, "numzv": 1e-9, "zv": 1e-9, "zvd": 1e-9, "ei": 0.05}


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("actuator", DRIVES)
@pytest.mark.parametrize("kind", CLAIMED)
def test_more_than_the_shaper_claims_for_each_step_has_a_warning_and_less_has_none(
    kind: str, actuator: Actuator, command: str
) -> None:
    kinds = SHAPERS[kind]
    if actuator.kind not in kinds.actuators:
        assert kind == "numzv"
        return
    asked = COMMANDS[command]
    found = shaped_command(asked, design(CRANE, actuator, kinds), (CRANE.mode,), actuator)
    residual = residual_by_integration(found.impulses, CRANE.mode, actuator)
    lost = residual > CLAIMED[kind] * np.abs(asked.amplitudes).sum() + 1e-7
    assert len(found.warnings) == lost
    for one in found.warnings:
        assert f"{100 * residual:.3g}"[:3] in one.detail


def test_a_shaped_pulse_behind_an_asymmetric_drive_points_to_a_maneuver() -> None:
    shaper = design(CRANE, ASYMMETRIC, SHAPERS["numzv"])
    (warning,) = shaped_command(pulse(1.5), shaper, (CRANE.mode,), ASYMMETRIC).warnings
    assert warning.code == "stop_not_designed"
    assert "a maneuver designs start and stop" in warning.detail
    assert not shaped_command(step(), shaper, (CRANE.mode,), ASYMMETRIC).warnings


def test_steps_of_one_direction_that_meet_in_a_switched_drive_are_warned_of() -> None:
    drive = replace(ASYMMETRIC, model="switched")
    shaper = design(CRANE, drive, SHAPERS["numzv"])
    stairs = Impulses(times_s=np.array([0.0, 0.3]), amplitudes=np.array([0.5, 0.5]))
    (warning,) = shaped_command(stairs, shaper, (CRANE.mode,), drive).warnings
    assert warning.code == "steps_not_designed"
