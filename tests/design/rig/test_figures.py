"""Figures of the theory that hold on the rig: large swings, hoisting, the double pendulum."""

import math
from functools import cache

import numpy as np
import pytest

from design.model.impulses import Impulses
from design.model.plants.pendulum import Pendulum
from design.pipeline import design
from design.rig.crane import Crane
from design.rig.machine import Machine
from design.shapers.registry import SHAPERS
from design.types import FloatArray
from tests.design.rig.cranes import CRANE, THESIS, command_all, played

SPEEDS_M_S = 0.2, 0.5, 1.0, 1.5


@cache
def shaper(kind: str) -> Impulses:
    pendulum = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
    return design(pendulum, THESIS, SHAPERS[kind]).impulses


def energy_left(command: Impulses, speed_m_s: float) -> float:
    """Energy of the swing in the trolley's frame, long after the last step [J]."""
    return float(played(CRANE, THESIS, command, speed_m_s, np.array([12.0])).swing_energy_j[0])


@pytest.mark.parametrize(
    ("kind", "percent"),
    [
        ("umzv", (7.36, 7.48, 8.53, 11.71)),
        ("numzv", (0.174, 1.089, 4.36, 9.80)),
        ("numzvd", (0.0162, 0.0993, 0.373, 0.757)),
    ],
)
def test_what_shapers_for_small_swings_leave_of_large_ones(
    kind: str, percent: tuple[float, ...]
) -> None:
    step = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
    found = [
        100 * math.sqrt(energy_left(shaper(kind), speed) / energy_left(step, speed))
        for speed in SPEEDS_M_S
    ]
    assert found == pytest.approx(percent, rel=0.01)


@pytest.mark.parametrize(
    ("speed_m_s", "times"), [(1.0, (0.32841049, 0.61548383)), (1.5, (0.33822728, 0.63569303))]
)
def test_a_shaper_that_knows_its_amplitude_leaves_nothing(
    speed_m_s: float, times: tuple[float, float]
) -> None:
    aware = Impulses(times_s=np.array([0.0, *times]), amplitudes=np.array([1.0, -1.0, 1.0]))
    step = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
    left = math.sqrt(energy_left(aware, speed_m_s) / energy_left(step, speed_m_s))
    assert left < 1e-7  # times of eight digits


def state_at(crane: Crane, command: Impulses, at_s: float) -> tuple[float, float]:
    """Play, hoisted from 0 to 5 s to 0.5 m; return deflection and its rate."""
    machine = Machine(crane, (THESIS, THESIS), 0.2)
    command_all(machine, command)
    machine.hoist(0.5, 5.0, at_s=0.0)
    track = machine.advance(at_s)
    return float(track.load_m[0, 0]), float(track.load_rate_m_s[0, 0])


def move(start: FloatArray, stop: FloatArray) -> Impulses:
    signs = np.array([1.0, -1.0, 1.0])
    return Impulses(
        times_s=np.concatenate((start, stop)), amplitudes=np.concatenate((signs, -signs))
    )


def test_a_stop_timed_for_the_hoisted_cable_leaves_nothing() -> None:
    # L x'' + 2 L' x' + g x = -a, 0.8 to 0.5 m in 5 s; NUMZV2 of the first length leaves 44.2 %.
    crane = Crane(cable_length_m=0.8, gravity_m_s2=9.81, model="linear")
    start = shaper("numzv").times_s
    timed = np.array([4.0, 4.21401809, 4.48326774])
    frequency = math.sqrt(9.81 / 0.5)
    deflection, rate = state_at(crane, move(start, timed), 10.0)
    assert math.hypot(deflection, rate / frequency) * frequency / 0.2 < 1e-7
