"""Moves to be written as programs, and what plays these: gcc, and the interpreter of the tests."""

import math
import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from design.errors import InfeasibleDesignError, SolverFailedError
from design.export.move import MoveBlocks, move_blocks
from design.export.registry import EXPORTS
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.moves.maneuvers import Maneuver, maneuver
from design.moves.programs import Program, program
from design.shapers.registry import SHAPERS
from design.tables.rows import Real
from design.types import FloatArray
from tests.design.moves.cranes import MODELS, any_actuator
from tests.structured_text import Block

KINDS = ("numzv", "numzvd", "umzvc")
"""The last for drives of the first order alone."""

FLAGS = ["-std=c99", "-Wall", "-Wextra", "-Wshadow", "-Werror", "-O1"]

DRIVER = """\
#include <stdio.h>
@INCLUDES@
int main(void)
{
    int which, calls, execute, cancel;
    double cycle_s;
    while (scanf("%d %d", &which, &calls) == 2) {
        @SEQUENCES@
        for (; calls > 0; --calls) {
            double share = 0, velocity_m_s = 0;
            int busy = 0, done = 0, error = 0;
            if (scanf("%d %d %lf", &execute, &cancel, &cycle_s) != 3) {
                return 1;
            }
            @CALLS@
            printf("%.17g %.17g %d %d %d\\n", share, velocity_m_s, busy, done, error);
        }
    }
    return 0;
}
"""


@dataclass(frozen=True, kw_only=True)
class Case:
    """A move, and what it was designed for."""

    move: Maneuver
    plant: Plant
    actuator: Actuator
    kind: str
    request: str
    program: Program | None = None

    @property
    def mode(self) -> Mode:
        return self.plant.mode

    @property
    def swing(self) -> tuple[float, float]:
        """The payload's state at the first step, over the speed, in the direction of the move."""
        swing = self.move.swing
        return (0.0, 0.0) if swing is None else (swing.deflection_s, swing.rate)

    def blocks(self, real: Real = "LREAL") -> MoveBlocks:
        return move_blocks(
            self.move,
            self.plant,
            self.actuator,
            kind=self.kind,
            request_json=self.request,
            version="0.1.0",
            real=real,
            program=self.program,
        )

    def written(self, name: str, real: Real = "LREAL") -> bytes:
        write = EXPORTS[name].move
        assert write is not None
        return write(self.blocks(real))


def case(plant: Plant, actuator: Actuator, kind: str, *, options: Any = None, **asked: Any) -> Case:
    """Design a move; with ``sample_time_s`` its program too."""
    sample_time_s = asked.pop("sample_time_s", None)
    move = maneuver(plant, actuator, SHAPERS[kind], options=options, **asked)
    signed = move.direction * move.speed_m_s
    played = None
    if sample_time_s is not None:
        played = program(move.command, plant.mode, actuator, signed, sample_time_s, move.swing)
    request = f"{plant} {actuator} {kind} {options} {asked} {sample_time_s}"
    return Case(
        move=move, plant=plant, actuator=actuator, kind=kind, request=request, program=played
    )


def random_cases(count: int, seed: int) -> list[Case]:
    """Design random moves: models in turn, either direction, long and short, some with limits."""
    return list(_random_cases(count, np.random.default_rng(seed)))


def _random_cases(count: int, rng: np.random.Generator) -> Iterator[Case]:
    found = 0
    while found < count:
        w = float(rng.uniform(2.0, 12.0))
        damping = float(rng.choice([0.0, rng.uniform(0.005, 0.08)]))
        plant: Plant = Mode(natural_frequency_rad_s=w, damping_ratio=damping)
        if rng.random() < 0.4:
            plant = Pendulum(cable_length_m=9.80665 / w**2)
        actuator: Actuator = any_actuator(rng, w, MODELS[found % 2])
        speed = float(rng.uniform(0.05, 2.0))
        kinds = KINDS if isinstance(actuator, FirstOrder) else KINDS[:2]
        kind = kinds[found // 2 % len(kinds)]
        if found % 10 == 9:
            limit = speed * w / float(rng.uniform(0.3, 1.5))
            actuator = RateLimited(
                accel_limit_m_s2=limit, decel_limit_m_s2=1.3 * limit, speed_m_s=speed, then=Ideal()
            )
            kind = "numzv"
        way = speed * float(rng.uniform(0.6, 5.0)) * plant.mode.period_s
        try:
            yield case(
                plant,
                actuator,
                kind,
                speed_m_s=speed,
                distance_m=way * (-1 if rng.random() < 0.5 else 1),
                joint=bool(rng.random() < 0.2),
            )
        except (InfeasibleDesignError, SolverFailedError):
            continue
        found += 1


@dataclass(frozen=True)
class Played:
    """What a sequence gave, call by call."""

    share: FloatArray
    velocity_m_s: FloatArray
    busy: FloatArray
    done: FloatArray
    error: FloatArray


Calls = list[tuple[bool, bool, float]]
"""execute, cancel and cycle of each call."""


class InC:
    """All moves in one program of C, compiled by gcc."""

    def __init__(self, folder: Path, cases: list[Case], *, single: bool) -> None:
        texts = [one.written("c").decode() for one in cases]
        self.order: list[str] = []
        for place, text in enumerate(texts):
            (folder / f"move{place}.h").write_text(text)
            self.order += re.findall(
                r"^static inline void (\w+_(?:start|stop|move))\($", text, re.M
            )
        owners = [name.rpartition("_")[0] for name in self.order]
        fields = ("share", "velocity_m_s", "busy", "done", "error")
        calls = [
            f"if (which == {place}) {{ {name}(&of{place}, execute, cancel, "
            f"(shapersmith_real)cycle_s); "
            + " ".join(f"{field} = of{place}.{field};" for field in fields)
            + " }"
            for place, name in enumerate(self.order)
        ]
        source = DRIVER.replace(
            "@INCLUDES@", "\n".join(f'#include "move{at}.h"' for at in range(len(texts)))
        )
        zeros = "{0}"
        source = source.replace(
            "@SEQUENCES@",
            "\n".join(
                f"{owner}_sequence of{place} = {zeros};" for place, owner in enumerate(owners)
            ),
        ).replace("@CALLS@", "\n".join(calls))
        (folder / "main.c").write_text(source)
        self.binary = folder / ("single" if single else "double")
        flags = [*FLAGS, "-Wno-missing-field-initializers"]
        if single:
            flags.append("-DSHAPERSMITH_FLOAT")
        subprocess.run(
            ["gcc", *flags, "-o", str(self.binary), str(folder / "main.c")],
            check=True,
        )

    def play(self, name: str, calls: Calls) -> Played:
        """Call a sequence, zeros at first."""
        told = [f"{self.order.index(name)} {len(calls)}"]
        told += [f"{int(execute)} {int(cancel)} {cycle!r}" for execute, cancel, cycle in calls]
        done = subprocess.run(
            [str(self.binary)], input="\n".join(told), capture_output=True, text=True, check=True
        )
        table = np.array([
            [float(word) for word in line.split()] for line in done.stdout.split("\n")[:-1]
        ])
        return Played(*table.T)


def play_in_text(text: str, name: str, calls: Calls) -> Played:
    """Call a block of Structured Text in the interpreter."""
    block = Block(text, name)
    rows = []
    for execute, cancel, cycle_s in calls:
        held = block(execute=execute, cancel=cancel, cycle_time_s=cycle_s)
        rows.append([
            float(held[name]) for name in ("share", "velocity_m_s", "busy", "done", "error")
        ])
    return Played(*np.array(rows).T)


def mean_levels(command: Impulses, cycle_s: float, calls: int) -> FloatArray:
    """Return the mean level of a command in each cycle, by its integral at their ends."""
    ends = cycle_s * np.arange(calls + 1)
    ways = np.maximum(ends[:, None] - command.times_s, 0.0) @ command.amplitudes
    return np.diff(ways) / cycle_s


def steady(cycle_s: float, until_s: float) -> Calls:
    """Return calls of one cycle until a time is over."""
    return [(True, False, cycle_s)] * (math.ceil(until_s / cycle_s) + 2)


def on_steps(times_s: FloatArray) -> Calls:
    """Return calls of cycles, all as long between two steps, that begin on each step."""
    gaps = np.diff(times_s)
    shortest = float(gaps.min()) / 3
    calls: Calls = [(True, False, shortest)]
    for gap in gaps.tolist():
        count = math.ceil(gap / shortest)
        calls += [(True, False, gap / count)] * count
    return [*calls, (True, False, shortest)]


def steps_of(levels: FloatArray, times_s: FloatArray) -> Impulses:
    """Return levels that begin at times as the steps between them."""
    steps = np.diff(levels, prepend=0.0)
    held = np.flatnonzero(steps)
    return Impulses(times_s=times_s[held], amplitudes=steps[held])
