"""Live shaping as blocks, and what calls these: gcc, and the interpreter of the tests."""

import ctypes
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from design.export.live_blocks.block import LiveBlock, live_block
from design.export.live_blocks.c import live_in_c
from design.export.live_blocks.text import live_in_text
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.tables.rows import Real
from design.types import FloatArray
from tests.structured_text import Block

CRANE = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
SPEED_M_S = 0.2
LENGTHS_M = (0.3, 1.4)

FLAGS = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wshadow", "-Werror", "-Wdouble-promotion"]

FIELDS = ("share", "velocity_m_s", "busy", "kept", "valid", "held", "error")

CALLS = """\
#include "live.h"
void play(int calls, const int *enable, const double *wanted, const double *length_m,
          const double *cycle_s, double *seen)
{
    static @NAME@_shaper shaper;
    const @NAME@_shaper zeros = {0};
    int k;
    shaper = zeros;
    for (k = 0; k < calls; ++k) {
        @NAME@_step(&shaper, enable[k], (shapersmith_real)wanted[k], @LENGTH@
                    (shapersmith_real)cycle_s[k]);
        seen[7 * k] = (double)shaper.share;
        seen[7 * k + 1] = (double)shaper.velocity_m_s;
        seen[7 * k + 2] = shaper.busy;
        seen[7 * k + 3] = shaper.kept;
        seen[7 * k + 4] = shaper.valid;
        seen[7 * k + 5] = shaper.held;
        seen[7 * k + 6] = shaper.error;
        (void)length_m;
    }
}
"""


def second_order(
    more: tuple[float, float], less: tuple[float, float], model: str = "switched"
) -> SecondOrder:
    sets = [SecondOrderSet(natural_frequency_rad_s=w, damping_ratio=z) for w, z in (more, less)]
    return SecondOrder(
        accel=sets[0], decel=sets[1], model="switched" if model == "switched" else "superposed"
    )


THESIS = second_order((20.0, 0.8), (50.0, 1.5))
"""The drive of Kim (2011)."""

DRIVES: dict[str, Actuator] = {
    "thesis": THESIS,
    "superposed": second_order((20.0, 0.8), (50.0, 1.5), "superposed"),
    "one lag": second_order((20.0, 0.8), (20.0, 0.8)),
    "critical": second_order((20.0, 1.0), (30.0, 1.0 + 1e-9)),
    "slow": second_order((12.0, 0.3), (30.0, 0.5)),
    "first order": FirstOrder(
        accel_time_constant_s=0.12, decel_time_constant_s=0.065, model="switched"
    ),
    "first order, superposed": FirstOrder(accel_time_constant_s=0.12, decel_time_constant_s=0.065),
    "ideal": Ideal(),
}


def block_of(
    actuator: Actuator = THESIS, plant: Mode | Pendulum = CRANE, real: Real = "LREAL"
) -> LiveBlock:
    return live_block(
        plant,
        actuator,
        kind="numzv",
        lengths_m=list(LENGTHS_M),
        speed_m_s=SPEED_M_S,
        request_json=f"{plant} {actuator}",
        version="0.1.0",
        real=real,
    )


@dataclass(frozen=True)
class Seen:
    """What a block answered, call by call."""

    share: FloatArray
    velocity_m_s: FloatArray
    busy: FloatArray
    kept: FloatArray
    valid: FloatArray
    held: FloatArray
    error: FloatArray


class InC:
    """A block, compiled by gcc."""

    def __init__(self, folder: Path, block: LiveBlock, *, single: bool) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "live.h").write_text(live_in_c(block))
        length = "(shapersmith_real)length_m[k]," if isinstance(block.plant, Pendulum) else ""
        source = CALLS.replace("@NAME@", block.name).replace("@LENGTH@", length)
        (folder / "calls.c").write_text(source)
        library = folder / ("single.so" if single else "double.so")
        flags = [*FLAGS, *(["-DSHAPERSMITH_FLOAT"] if single else [])]
        subprocess.run(
            ["gcc", *flags, "-O2", "-shared", "-fPIC", "-o", str(library),
             str(folder / "calls.c"), "-lm"],
            check=True,
        )  # fmt: skip
        self.real: Real = "REAL" if single else "LREAL"
        self._play = ctypes.CDLL(str(library)).play

    def play(
        self,
        wanted: FloatArray,
        cycle_s: float | FloatArray,
        length_m: float | FloatArray = 0.8,
        enable: FloatArray | None = None,
    ) -> Seen:
        """Call the block, all zeros at first."""
        calls = len(wanted)
        on = np.ones(calls) if enable is None else enable
        enabled = np.ascontiguousarray(on, dtype=np.int32)
        given = [np.full(calls, one, dtype=float) for one in (wanted, length_m, cycle_s)]
        seen = np.zeros((calls, len(FIELDS)))
        self._play(
            calls,
            enabled.ctypes.data_as(ctypes.c_void_p),
            *(one.ctypes.data_as(ctypes.c_void_p) for one in (*given, seen)),
        )
        return Seen(*seen.T)


def play_in_text(
    text: str, name: str, wanted: FloatArray, cycle_s: float, length_m: float | None = 0.8
) -> FloatArray:
    """Call a block of Structured Text in the interpreter, and return its shares."""
    block = Block(text, f"{name}_shaper")
    cable = {} if length_m is None else {"cable_length_m": length_m}
    return np.array([
        float(block(enable=True, wanted=one, cycle_time_s=cycle_s, **cable)["share"])
        for one in wanted.tolist()
    ])


def text_of(block: LiveBlock) -> str:
    return live_in_text(block)


def held(*levels: tuple[float, float], cycle_s: float) -> FloatArray:
    """Return wanted levels of calls, each for a time."""
    return np.concatenate([np.full(max(1, round(over / cycle_s)), level) for level, over in levels])


def sent(share: FloatArray, cycle_s: float) -> Impulses:
    """Return shares that were sent as the steps between them."""
    steps = np.diff(share, prepend=0.0)
    at = np.flatnonzero(steps)
    return Impulses(times_s=at * cycle_s, amplitudes=steps[at])
