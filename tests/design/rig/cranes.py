"""Cranes, drives and commands of the tests of the rig."""

import numpy as np

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited, Unlimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.rig.crane import Crane
from design.rig.machine import Machine
from design.rig.track import Track
from design.types import FloatArray

THESIS = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=50, damping_ratio=1.5),
    model="switched",
)
"""Drive of Kim 2011."""

CRANE = Crane(cable_length_m=0.8, gravity_m_s2=9.81)
"""Crane of Kim 2011."""

MODELS: tuple[Model, Model] = ("superposed", "switched")


def random_lag(rng: np.random.Generator) -> Unlimited:
    """Return a drive without limits, of any kind and damping."""
    kind = rng.integers(4)
    model = MODELS[rng.integers(2)]
    if kind == 0:
        return Ideal()
    if kind == 1:
        constants = rng.uniform(0.01, 0.3, 2) * (rng.random(2) < 0.8)
        return FirstOrder(
            accel_time_constant_s=float(constants[0]),
            decel_time_constant_s=float(constants[1]),
            model=model,
        )
    dampings = [1.0, float(rng.uniform(0.2, 2.5)), float(rng.uniform(0.2, 2.5))]
    accel, decel = (
        SecondOrderSet(
            natural_frequency_rad_s=float(rng.uniform(5, 60)),
            damping_ratio=dampings[rng.integers(3)],
        )
        for _ in range(2)
    )
    return SecondOrder(accel=accel, decel=decel, model=model)


def random_drive(rng: np.random.Generator, speed_m_s: float) -> Actuator:
    """Return a drive of any kind, with and without limits."""
    lag = random_lag(rng)
    if rng.random() < 0.4:
        return lag
    return RateLimited(
        accel_limit_m_s2=float(rng.uniform(0.3, 4)),
        decel_limit_m_s2=float(rng.uniform(0.3, 4)),
        speed_m_s=speed_m_s,
        then=lag,
        jerk_limit_m_s3=float(rng.uniform(2, 40)) if rng.random() < 0.6 else None,
    )


def random_levels(rng: np.random.Generator, count: int) -> tuple[FloatArray, FloatArray]:
    """Return ascending times from 0 on and levels, full speed and parts of it either way."""
    times = np.concatenate(([0.0], np.sort(rng.uniform(0.02, 3, count - 1))))
    levels = rng.choice([-1.0, 0.0, 1.0, 0.37, -0.6], count)
    levels[0] = 1.0
    return times, levels


def command_all(machine: Machine, command: Impulses) -> None:
    """Command x as impulses say."""
    for time_s, level in zip(command.times_s, np.cumsum(command.amplitudes), strict=True):
        machine.command("x", float(np.round(level, 12)), float(time_s))


def played(
    crane: Crane, drive: Actuator, command: Impulses, speed_m_s: float, times_s: FloatArray
) -> Track:
    """Play a command in x."""
    machine = Machine(crane, (drive, drive), speed_m_s)
    command_all(machine, command)
    return machine.advance(float(times_s[-1]), times_s)
