"""Whole moves in a run: a start and a stop of their own, beside what events command."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.merging import merged
from design.model.reference_ramps import reference
from design.rig.crane import AxisName
from design.rig.scenario import SAME_TIME_S

Span = tuple[float, float]
"""Begin and end of what keeps an axis busy [s]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WholeMove:
    """A move from rest to rest that is played as it was designed.

    Attributes
    ----------
    event
        Which event of the run it belongs to.
    axis
        Which axis.
    at_s
        When its first step is [s].
    command
        Its steps, signed shares of full speed; the first at 0.
    """

    event: int
    axis: AxisName
    at_s: float
    command: Impulses

    @property
    def last_switch_s(self) -> float:
        """When its last step is [s]."""
        return self.at_s + float(self.command.times_s[-1])

    @property
    def placed(self) -> Impulses:
        """Its steps at the times of the run."""
        return Impulses(
            times_s=self.at_s + self.command.times_s, amplitudes=self.command.amplitudes
        )


def with_moves(
    command: Impulses | None, moves: Sequence[WholeMove], axis: AxisName, drive: Actuator
) -> Impulses | None:
    """Return the command of an axis with its whole moves.

    Parameters
    ----------
    command
        What other events command, shaped; None if they do not move the axis.
    moves
        Whole moves of any axes, in any order.
    axis
        Which axis.
    drive
        What drives it: behind limits a move lasts until its last ramp is over.

    Returns
    -------
    Impulses or None
        None if the axis is never moved.

    Raises
    ------
    InvalidInputError
        If something else commands the axis during a move.
    """
    ours = sorted((one for one in moves if one.axis == axis), key=lambda one: one.at_s)
    busy = [] if command is None else _busy(command, drive)
    for number, move in enumerate(ours):
        begin, end = move.at_s, max(span[1] for span in _busy(move.placed, drive))
        for other in busy:
            if other[0] < end - SAME_TIME_S and begin < other[1] - SAME_TIME_S:
                _raise_overlap(move, (begin, end), other)
        if number + 1 < len(ours) and ours[number + 1].at_s < end - SAME_TIME_S:
            later = ours[number + 1]
            others = max(span[1] for span in _busy(later.placed, drive))
            _raise_overlap(later, (later.at_s, others), (begin, end))
    if not ours:
        return command
    every = [move.placed for move in ours] + ([] if command is None else [command])
    times = np.concatenate([one.times_s for one in every])
    amplitudes = np.concatenate([one.amplitudes for one in every])
    order = np.argsort(times, kind="stable")
    return merged(Impulses(times_s=times[order], amplitudes=amplitudes[order]))


def _busy(command: Impulses, drive: Actuator) -> list[Span]:
    """Return when a command holds an axis or its reference moves."""
    levels = np.cumsum(command.amplitudes)
    held = np.abs(levels) > 1e-12 * np.abs(command.amplitudes).sum()  # rounding of the sum
    ends = np.append(command.times_s[1:], np.inf)
    spans = list(zip(command.times_s[held].tolist(), ends[held].tolist(), strict=True))
    changes = reference(command, drive)
    until = changes.times_s + changes.ramps_s
    return [*spans, *zip(changes.times_s.tolist(), until.tolist(), strict=True)]


def _raise_overlap(move: WholeMove, span: Span, other: Span) -> NoReturn:
    """Raise InvalidInputError: something else commands the axis during a move."""
    lasts = "for good" if other[1] == np.inf else f"until {other[1]:.9g} s"
    raise InvalidInputError(
        ("events", str(move.event), "move", f"{move.axis}_m"),
        f"a move from {span[0]:.9g} to {span[1]:.9g} s",
        f"at a time when no other command of {move.axis} lasts: one does from {other[0]:.9g} s "
        f"{lasts}, with the tail of its shaper and its ramps",
        code="moves_overlap",
    )
