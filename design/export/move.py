"""A whole move as programs have it: sequences of levels, and the facts of its comment."""

import hashlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.export.move_remarks import (
    figures_in_words,
    move_remarks,
    played_program,
    remarks_on_parts,
    warnings_in_words,
)
from design.export.single import digits_of
from design.model.actuators.registry import Actuator
from design.model.plants.registry import Plant
from design.moves.cycles import reached_s
from design.moves.later_stops import RIGHT, later_stops
from design.moves.maneuvers import Maneuver
from design.moves.programs import Program
from design.tables.rows import Real
from design.types import FloatArray

LONGEST_CYCLE = 0.5
"""Of the plant's period, above which a cycle is taken for an error, as in programs on samples."""

USUAL_CYCLE_S = 0.01
"""Of a task, in examples of a call; of a fast plant a tenth of its period [s]."""

SAME_LEVEL = 1e-12
"""Levels that differ by less are one: rounding of their sum [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sequence:
    """Levels that a block plays one after the other.

    Attributes
    ----------
    name
        Of the block, behind the name of the move: start, stop or move.
    remark
        What it is for: a sentence.
    times_s
        When each level begins, after the first, shape (n,) [s].
    levels
        The level ahead of them, then each, shape (n + 1,): shares of full speed in +x [-].
    end_s
        When the sequence is done: its last level is reached, behind limits by the last ramp, and of
        a start the drive has settled for a stop [s].
    sample_time_s
        Of levels on the samples of a controller; None of others [s].
    """

    name: str
    remark: str
    times_s: FloatArray
    levels: FloatArray
    end_s: float
    sample_time_s: float | None = None

    @property
    def toggles(self) -> float | None:
        """The level that alternates with 0; None where there are others."""
        height = float(self.levels[np.argmax(np.abs(self.levels))])
        first = 0.0 if self.levels[0] == 0 else height
        odd = np.arange(self.levels.size) % 2 == 1
        alternating = np.where(odd, height - first, first)
        return height if np.array_equal(alternating, self.levels) else None

    @property
    def samples(self) -> NDArray[np.int_]:
        """Numbers of the samples on which levels begin, shape (n,)."""
        numbers: NDArray[np.int_] = np.rint(self.times_s / (self.sample_time_s or 1.0)).astype(int)
        return numbers

    @property
    def last_sample(self) -> int:
        """Number of the sample on which the end is reached."""
        return int(np.ceil(self.end_s / (self.sample_time_s or 1.0) - SAME_LEVEL))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MoveBlocks:
    """A move as programs have it.

    Attributes
    ----------
    name
        What all names of the program begin with.
    version
        Of the tool.
    sha256
        Of the request, in hexadecimal.
    real
        Type of numbers in Structured Text.
    speed_m_s
        Full speed, > 0 [m/s].
    longest_cycle_s
        Above it a cycle is taken for an error [s].
    sequences
        The whole move last.
    remarks
        Lines of the comment.
    figures
        Further lines by type of number: what is left of the sequences as they are played.
    """

    name: str
    version: str
    sha256: str
    real: Real
    speed_m_s: float
    longest_cycle_s: float
    sequences: tuple[Sequence, ...]
    remarks: tuple[str, ...]
    figures: dict[Real, tuple[str, ...]]

    @property
    def numbers(self) -> int:
        """Numbers in the tables of all blocks."""
        return sum(
            one.times_s.size * (1 if one.toggles is not None and one.sample_time_s is None else 2)
            for one in self.sequences
        )

    @property
    def example_cycle_s(self) -> float:
        """Cycle of the example of a call: that of the samples, or a usual one [s]."""
        sampled = self.sequences[-1].sample_time_s
        usual_s = min(USUAL_CYCLE_S, float(f"{self.longest_cycle_s / 5:.1g}"))
        return usual_s if sampled is None else sampled


def move_blocks(
    move: Maneuver,
    plant: Plant,
    actuator: Actuator,
    *,
    kind: str,
    request_json: str,
    version: str,
    real: Real = "LREAL",
    program: Program | None = None,
) -> MoveBlocks:
    """Return a move as programs have it.

    Start and stop are sequences too where each is one. They are not in a move that was solved as
    one or is played on samples, nor where the start has a swing left or the stop is right after its
    own cruise alone.

    Parameters
    ----------
    move, plant, actuator
        The move, what moves, and what drives it.
    kind
        Name of the kind of shaper.
    request_json
        The request as canonical JSON; names in programs hold digits of its hash.
    version
        Of the tool.
    real
        Type of numbers in Structured Text.
    program
        The move on samples, where it was asked for.

    Returns
    -------
    MoveBlocks
        For the writers of the formats.
    """
    apart = program is None and not move.joint and move.start.times_s.size > 1
    stops = later_stops(move, plant.mode, actuator) if apart else None
    parts: tuple[Sequence, ...] = ()
    if stops is not None and (stops.residual <= RIGHT or move.for_ideal):
        parts = _start_and_stop(move, actuator, stops.wait_s)
    whole = _whole(move, actuator) if program is None else _on_samples(move, program, actuator)
    return MoveBlocks(
        name=f"move_{kind}_{digits_of(request_json, real)}",
        version=version,
        sha256=hashlib.sha256(request_json.encode()).hexdigest(),
        real=real,
        speed_m_s=move.speed_m_s,
        longest_cycle_s=LONGEST_CYCLE * plant.mode.period_s,
        sequences=(*parts, whole),
        remarks=(
            *move_remarks(move, plant, actuator, kind, program),
            *remarks_on_parts(move, plant.mode, actuator, stops, program),
            *warnings_in_words(move, program),
        ),
        figures={
            of: tuple(figures_in_words(move, plant.mode, actuator, of, program))
            for of in ("LREAL", "REAL")
        },
    )


def _whole(move: Maneuver, actuator: Actuator) -> Sequence:
    command = move.command
    return Sequence(
        name="move",
        remark=f"The whole move of {move.distance_m:.9g} m, from rest to rest.",
        times_s=command.times_s,
        levels=_levels(move, command.amplitudes, 0.0),
        end_s=reached_s(command, actuator),
    )


def _start_and_stop(move: Maneuver, actuator: Actuator, wait_s: float) -> tuple[Sequence, Sequence]:
    start, stop = move.start, move.stop
    cruise = float(start.amplitudes.sum())
    return (
        Sequence(
            name="start",
            remark="The start of the move, to its cruise, which it holds while execute is TRUE.",
            times_s=start.times_s,
            levels=_levels(move, start.amplitudes, 0.0),
            end_s=reached_s(start, actuator) + wait_s,
        ),
        Sequence(
            name="stop",
            remark="The stop of the move, from its cruise to rest.",
            times_s=stop.times_s - stop.times_s[0],
            levels=_levels(move, stop.amplitudes, cruise),
            end_s=reached_s(move.command, actuator) - move.pulse_s,
        ),
    )


def _on_samples(move: Maneuver, program: Program, actuator: Actuator) -> Sequence:
    sample_time_s = float(program.times_s[1])
    levels = program.velocity_m_s / move.speed_m_s
    changes = np.flatnonzero(np.diff(levels, prepend=0.0))
    return Sequence(
        name="move",
        remark=f"The whole move of {program.distance_m:.9g} m, from rest to rest, on samples.",
        times_s=program.times_s[changes],
        levels=np.concatenate(([0.0], levels[changes])),
        end_s=reached_s(played_program(move, program), actuator),
        sample_time_s=sample_time_s,
    )


def _levels(move: Maneuver, amplitudes: FloatArray, before: float) -> FloatArray:
    """Return levels in +x, those that differ by rounding as one."""
    levels = np.cumsum(np.concatenate(([before], amplitudes)))
    named = np.array([0.0, 1.0, float(np.abs(levels).max())])
    near = named[np.argmin(np.abs(levels[:, None] - named), axis=1)]
    rounded: FloatArray = np.where(np.abs(levels - near) < SAME_LEVEL, near, levels)
    return move.direction * rounded + 0.0
