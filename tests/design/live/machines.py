"""Drives and machines of the tests of live shaping."""

from dataclasses import replace

import numpy as np

from design.live.machine import IDEAL_ROW, LiveMachine, mode_rows
from design.live.propagation import Rows
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import Unlimited
from design.model.impulses import Impulses
from design.model.plants.pendulum import Pendulum
from tests.design.rig.cranes import THESIS

KIM = THESIS
CRANE = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)

DRIVES: tuple[Unlimited, ...] = (
    KIM,
    replace(KIM, model="superposed"),
    FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.0, model="switched"),
    FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05),
    Ideal(),
)


def rows_of(machine: LiveMachine) -> Rows:
    """Return a machine as the kernel knows it."""
    drive = machine.drive_row
    modes = mode_rows(machine.modes, drive)
    ideal = mode_rows(machine.modes, IDEAL_ROW)
    return Rows(drive, modes, ideal, machine.actuator.dead_time_s)


def command(times_s: tuple[float, ...], levels: tuple[float, ...]) -> Impulses:
    """Return the steps of levels from times on."""
    steps = np.diff(np.array(levels), prepend=0.0)
    return Impulses(times_s=np.array(times_s), amplitudes=steps)
