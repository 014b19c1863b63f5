"""Strings of events, and what their commands leave on a crane that is not the one assumed."""

from dataclasses import replace
from functools import cache

import numpy as np

from design.analysis.residual import residual_vibration
from design.live.machine import LiveKind, LiveMachine
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.commands import command_of_velocities, convolve
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.rig.live_events import live_commands
from design.rig.scenario import Drive, steps_of
from design.shapers.registry import SHAPERS
from tests.design.live.machines import CRANE, KIM

STRINGS = 200

Strings = list[list[Drive]]


def strings() -> Strings:
    """Return what operators do: two speeds, releases, reversals, at any time; and let go."""
    random = np.random.default_rng(5)
    made = []
    for _ in range(STRINGS):
        at_s, drives = 0.0, []
        levels = [*random.choice([-1.0, -0.5, 0.0, 0.5, 1.0], random.integers(1, 7)), 0.0]
        if levels[0] == 0.0:
            levels[0] = 1.0
        for number, level in enumerate(levels):
            drives.append(Drive(event=number, axis="x", at_s=at_s, level=float(level)))
            at_s += float(random.uniform(0.05, 2.5))
        made.append(drives)
    return made


@cache
def commands(name: str) -> list[Impulses]:
    """Return the commands of all strings, solved for the crane assumed."""
    kind, _, mode = name.partition(", ")
    kind = kind.strip("`")
    if mode == "live":
        machine = LiveMachine(plant=CRANE, actuator=KIM, kind=LiveKind(name=kind))
        return [live_commands(machine, one, {}).commands["x"] for one in strings()]
    plain = [command_of_velocities(*steps_of(one, "x")) for one in strings()]
    if not mode:
        return plain
    entry = SHAPERS[kind]
    shaper = design(CRANE, KIM, entry, entry.options()).impulses
    return [convolve(one, shaper) for one in plain]


def off(lag: SecondOrderSet, share: float) -> SecondOrderSet:
    return SecondOrderSet(
        natural_frequency_rad_s=lag.natural_frequency_rad_s * (1 + share),
        damping_ratio=lag.damping_ratio * (1 + share),
    )


def driven(accel: float, decel: float) -> SecondOrder:
    """Return the drive whose sets are off by these shares."""
    return replace(KIM, accel=off(KIM.accel, accel), decel=off(KIM.decel, decel))


def longer(share: float) -> Mode:
    return replace(CRANE, cable_length_m=CRANE.cable_length_m * (1 + share)).mode


TRUTHS: dict[str, list[tuple[Mode, SecondOrder]]] = {
    "as assumed": [(CRANE.mode, KIM)],
    "cable off by 5 %": [(longer(share), KIM) for share in (-0.05, 0.05)],
    "drive off by 10 %": [
        (CRANE.mode, driven(accel, decel)) for accel in (-0.1, 0.1) for decel in (-0.1, 0.1)
    ],
    "both": [
        (longer(share), driven(accel, decel))
        for share in (-0.05, 0.05)
        for accel in (-0.1, 0.1)
        for decel in (-0.1, 0.1)
    ],
}


def left(name: str, truth: str) -> list[float]:
    """Return the residual of each string, on each crane that it may be [%]."""
    return [
        100 * residual_vibration(one, mode, drive)
        for one in commands(name)
        for mode, drive in TRUTHS[truth]
    ]
