"""Live shaping as programs have it: a machine, what its block promises, and how it plans.

A block keeps the state of drive and swing in closed form. At each change of the wanted level it
plans anew, in the call of the change:

1. Candidates. The level is held for one of a few waits, none among them; a reversal waits at 0.
   Then the wanted level is sent, and one pulse of another level ends the swing. What pulse an ideal
   drive would need follows from geometry: half its turn is the angle whose sine is the swing over
   twice the pulse's height, and its middle is at the phase of the swing.
2. Newton's method on the two times of the pulse, behind the drive as it is.
3. Broyden's method on the same times, with the levels as they are sent, each the mean of its cycle,
   until what is left is within the bound [1]_. Cycles of any length cost no accuracy.

The candidates are tried in order of their last switch, and the earliest that is within the bound is
taken. Sets of the drive change with whole calls, so that what is left jumps with the times of the
pulse: where the zero is in a jump, a lower pulse has its zero elsewhere. Where no candidate is
within the bound, a reversal stops first; else the last plan goes on, and each call tries again.
When that plan is over the load hangs still, and the sequence from rest is within the bound.

References
----------
.. [1] C. G. Broyden, "A class of methods for solving nonlinear simultaneous equations", Math. Comp.
   19 (1965) 577.
"""

import hashlib
import math
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np

from design.errors import InvalidInputError
from design.export.single import digits_of
from design.live.machine import live_drive
from design.model.actuators.in_words import drive_line
from design.model.actuators.rate_limited import Unlimited
from design.model.actuators.registry import Actuator
from design.model.lags import Lag
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.tables.rows import Real

LivePlant = Mode | Pendulum
"""What a block knows: one mode, that of a cable of any length or another one."""

KIND = "numzv"
"""The shaper whose claim a block keeps."""

COUNTED: dict[Real, float] = {"LREAL": 1e-6, "REAL": 5e-5}
"""Largest residual of a plan, as the block counts it, by the type of its numbers [-]."""

ROUNDING: dict[Real, float] = {
    "LREAL": 256 * float(np.finfo(np.float64).eps) / 2,
    "REAL": 256 * float(np.finfo(np.float32).eps) / 2,
}
"""What rounding adds to it: at most six flows and six switches of unit steps. The phase of a flow
has four roundings, of up to 11 rad in all, its products six; a gain has twelve. 256 is above their
sum [-]."""

SETTLED = 1e-5
"""Share of a step that a lag may lack where a cable length is taken over [-]."""

LONGEST_SETTLING = 400.0
"""Of the lag's own times, within which it has settled: damping ratios are at most 5."""

CYCLES_PER_PERIOD = 10
"""Fewest cycles in a period of the plant: with fewer a pulse has no shape."""

JITTER_S = 1e-4
"""Of a call, of which the head has a figure [s]."""

LINE = 96
"""Letters of a line."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveBlock:
    """A machine as the writers of its block have it.

    Attributes
    ----------
    plant, actuator
        What swings, and what drives it.
    cable_length_m
        Shortest and longest cable; both 0 of a plant that is a mode [m].
    speed_m_s
        Full speed, > 0 [m/s].
    request_json
        The request as canonical JSON; names in programs hold digits of its hash.
    version
        Of the tool.
    real
        Type of numbers in Structured Text.
    cycle_s
        Of the task, in the example of a call; a usual one if None [s].
    """

    plant: LivePlant
    actuator: Unlimited
    cable_length_m: tuple[float, float]
    speed_m_s: float
    request_json: str
    version: str
    real: Real = "LREAL"
    cycle_s: float | None = None

    def __post_init__(self) -> None:
        if self.cycle_s is not None and self.cycle_s > self.longest_cycle_s:
            raise InvalidInputError(
                "shaping.sample_time_s",
                self.cycle_s,
                f"at most {self.longest_cycle_s:.6g} s in a block, a tenth of the shortest period",
                code="cycle_without_block",
            )

    @property
    def name(self) -> str:
        """What all names of the program begin with."""
        return f"live_{digits_of(self.request_json, self.real)}"

    @property
    def sha256(self) -> str:
        """Of the request, in hexadecimal."""
        return hashlib.sha256(self.request_json.encode()).hexdigest()

    @property
    def modes(self) -> tuple[Mode, Mode]:
        """The mode of the shortest cable and of the longest one."""
        if isinstance(self.plant, Mode):
            return self.plant, self.plant
        shortest, longest = self.cable_length_m
        return (
            replace(self.plant, cable_length_m=shortest).mode,
            replace(self.plant, cable_length_m=longest).mode,
        )

    @property
    def lags(self) -> tuple[Lag, Lag]:
        """For more speed, and for less."""
        return self.actuator.accel_lag, self.actuator.decel_lag

    @property
    def order(self) -> int:
        """Order of the state of a switched drive; 0 where steps add up."""
        if self.lags[0] == self.lags[1] or self.actuator.model != "switched":
            return 0
        return 2 if self.lags[0].second_s2 > 0 else 1

    @property
    def of_lags(self) -> dict[str, tuple[float, float]]:
        """Numbers of both lags by name, with their units."""
        more, less = self.lags
        damping = tuple(lag.first_s * lag.corner_rad_s / 2 for lag in self.lags)
        return {
            "first_s": (more.first_s, less.first_s),
            "second_s2": (more.second_s2, less.second_s2),
            "corner_rad_s": (more.corner_rad_s, less.corner_rad_s),
            "damping": (damping[0], damping[1]),
            "root": (math.sqrt(abs(damping[0] ** 2 - 1)), math.sqrt(abs(damping[1] ** 2 - 1))),
        }

    @property
    def longest_cycle_s(self) -> float:
        """Above it a cycle is taken for an error [s]."""
        return min(mode.period_s for mode in self.modes) / CYCLES_PER_PERIOD

    @property
    def example_cycle_s(self) -> float:
        """Cycle of the example of a call [s]."""
        if self.cycle_s is not None:
            return self.cycle_s
        return min(0.01, float(f"{self.longest_cycle_s / 5:.1g}"))

    @property
    def counts(self) -> dict[str, int]:
        """Limits of the loops by name."""
        return {
            "ITERATIONS": 8,
            "CORRECTIONS": 12,
            "WAITS": 9,
            "TRIES": 4,
            "HEIGHTS": 8,
            "SERIES": 14,
        }

    @property
    def constants(self) -> dict[str, float]:
        """Numbers of the program by name: angles are in radians, times in seconds."""
        damping = self.plant.damping_ratio
        return {
            "QUARTER": math.pi / 2,
            "EIGHTH": math.pi / 4,  # Of a period, by which a time moves in one iteration
            "EACH": math.pi / 8,  # Of a period, between two waits
            "NEAR": 3e-3,  # Left where Newton's method ends: cycles matter from there on
            "FARTHEST": 24.0,  # Eighths of a period, beyond which a pulse is none
            "LEAST": 1e-9,  # Cosine of what a step saw, below which nothing is learnt from it
            "SNAP": 1e-6,  # Share of a cycle that is none: it would change sets for rounding
            "NEVER": 1e30,
            "REACH": 1.05,  # A pulse of an ideal drive may miss by what lags make of it
            "SHORTEST": 0.05,  # Turn of the shortest pulse that is guessed
            "EARLY": 0.6,  # A guess may be so early that only its successor counts
            "SHORTTURN": 0.25,  # Below it (1 - exp(-2 x)) / (2 x) is summed as a series
            "LOWER": 0.95,  # Each height over the one before it
            "DAMPING": damping,
            "ROOT": math.sqrt(1 - damping**2),
            "SETTLED": _settled_s(self.lags),
            "SPEED": self.speed_m_s,
        }

    def remarks(self, *types: Real) -> list[str]:
        """Return the lines of the comment, with figures of some types of numbers."""
        lines: list[str] = []
        for told in (*self._machine_in_words(), *map(_type_in_words, types), *self._use_in_words()):
            lines += textwrap.wrap(told, LINE, subsequent_indent="   ", break_long_words=False)
        return lines

    def _machine_in_words(self) -> Iterator[str]:
        first, last = (mode.period_s for mode in self.modes)
        cable = ""
        if isinstance(self.plant, Pendulum):
            cable = "cable {:g} to {:g} m, ".format(*self.cable_length_m)
        periods = f"{first:.5g} s" if first == last else f"{first:.5g} to {last:.5g} s"
        yield f"plant: {cable}period {periods}, damping ratio {self.plant.damping_ratio:g}"
        yield f"drive: {drive_line(self.actuator)}"
        if self.actuator.dead_time_s:
            yield "the dead time delays all alike: the block does not need it"

    def _use_in_words(self) -> Iterator[str]:
        yield (
            "each change of wanted is solved anew from the state of drive and swing then, in the "
            "call of the change; kept says that wanted waits"
        )
        yield (
            "cycles: each level is the mean of its cycle, and the plan is solved with these "
            "levels, so that steps between two cycles leave nothing more. At most "
            f"{self.longest_cycle_s:.4g} s"
        )
        yield (
            f"calls up to {1000 * JITTER_S:g} ms early or late: some "
            f"{self._jitter_residual():.1g} more"
        )
        if isinstance(self.plant, Pendulum):
            yield (
                "cable_length_m is taken over at rest and at steady speed, once the drive has "
                "settled; held says that it is not yet. The claim is for cables that do not move "
                "from a change of wanted to its last switch"
            )
        yield "the load must hang still when enable becomes TRUE"

    def _jitter_residual(self) -> float:
        """Return what three unit steps leave, each so much off."""
        worst = 0.0
        for mode in self.modes:
            gains = [1 / abs(lag.denominator(mode.pole_rad_s)) for lag in self.lags]
            worst = max(worst, 3 * mode.natural_frequency_rad_s * JITTER_S * max(gains) / gains[0])
        return worst


def live_block(
    plant: Plant,
    actuator: Actuator,
    *,
    kind: str,
    lengths_m: list[float],
    speed_m_s: float,
    request_json: str,
    version: str,
    real: Real = "LREAL",
    cycle_s: float | None = None,
) -> LiveBlock:
    """Return a machine as the writers of its block have it.

    Parameters
    ----------
    plant, actuator
        What swings, and what drives it.
    kind
        Name of the kind of shaper whose claim the block keeps.
    lengths_m
        Cable lengths besides that of a pendulum, between all of which the block works [m].
    speed_m_s
        Full speed, > 0 [m/s].
    request_json
        The request as canonical JSON.
    version
        Of the tool.
    real
        Type of numbers in Structured Text.
    cycle_s
        Of the task; a usual one if None [s].

    Returns
    -------
    LiveBlock
        For the writers of the formats.

    Raises
    ------
    InvalidInputError
        If a block serves the kind, the plant, the drive or the cycle not.
    """
    drive = live_drive(actuator)
    if kind != KIND:
        raise InvalidInputError(
            "shaping.shaper.kind",
            kind,
            f"{KIND} in a block: it solves two times for one mode. A run has the other kinds",
            code="kind_without_block",
        )
    if not isinstance(plant, get_args(LivePlant)):
        raise InvalidInputError(
            "plant.kind",
            type(plant).__name__.lower(),
            "a pendulum or a mode in a block, which knows one mode",
            code="plant_without_block",
        )
    lengths = [plant.cable_length_m, *lengths_m] if isinstance(plant, Pendulum) else [0.0]
    return LiveBlock(
        plant=plant,
        actuator=drive,
        cable_length_m=(min(lengths), max(lengths)),
        speed_m_s=speed_m_s,
        request_json=request_json,
        version=version,
        real=real,
        cycle_s=cycle_s,
    )


def bound(of: Real) -> float:
    """Return the largest residual of a plan, rounded up to two digits [-]."""
    exact = COUNTED[of] + ROUNDING[of]
    digit = 10.0 ** (math.floor(math.log10(exact)) - 1)
    return math.ceil(exact / digit) * digit


def _type_in_words(of: Real) -> str:
    """Return the largest residual of a plan by a type of numbers, in words."""
    return (
        f"in {of}: residual at most {bound(of):.2g} of an unshaped step of full "
        f"speed for each change that begins at rest or steady speed, {ROUNDING[of]:.1g} of it "
        "rounding; each earlier change adds up to that rounding, until damping fades it"
    )


def _settled_s(lags: tuple[Lag, Lag]) -> float:
    """Return the time after which either lag lacks less than `SETTLED` of a step [s]."""
    latest = 0.0
    for lag in lags:
        own_s = lag.first_s + math.sqrt(lag.second_s2)
        times_s = np.linspace(0.0, LONGEST_SETTLING * own_s, 20_000)
        late = [time for time in times_s.tolist() if abs(lag.step_error(time)) > SETTLED]
        latest = max([latest, *late[-1:]])
    return latest
