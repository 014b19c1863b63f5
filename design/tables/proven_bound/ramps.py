"""The ramps that limits make of steps, where it is not sure which of them are turned.

Which ramps there are depends on questions, as whether one is over before the next step. With the
answers given everything is an analytic function of the phases: `courses` follows such answers. On
a cell a question may have either answer. Then the cell has both courses, each continued over all of
it. The residual at a point is that of one of them, so a bound of both is one of the residual.
"""

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass

import numpy as np

from design.tables.proven_bound.balls import Ball, Number
from design.types import BoolArray, IntArray

Answers = tuple[bool, ...]
"""To the questions of a course, in order."""

MOST_COURSES = 64
"""Of all cells together; with more, the rows say too little."""


@dataclass(frozen=True, slots=True, eq=False)
class PhaseRamp:
    """A change of the reference over the plant's phase."""

    start: Number  # When it begins [rad]
    duration: Number  # How long it takes, >= 0 [rad]
    change: Number  # By how much, as a share of full speed [-]
    grows: bool  # Whether it increases the reference's magnitude


Course = Generator[Number, bool, list[PhaseRamp]]
"""Asks whether numbers are positive, and returns ramps."""


def course(phases: Sequence[Number], levels: Sequence[float], rise: Number, fall: Number) -> Course:
    """Follow a command through limits to its rate.

    What `design.model.ramps` does with numbers.

    Parameters
    ----------
    phases
        ``w t`` of each step, in order [rad].
    levels
        Of the command after each step, as shares of full speed [-].
    rise, fall
        Turn of the plant while the reference goes to full speed, and from it to rest [rad].

    Yields
    ------
    Number
        What is asked whether it is positive. Where it is 0, both answers have the same course.

    Returns
    -------
    list of PhaseRamp
        In order.
    """
    found: list[PhaseRamp] = []
    now: Number = 0.0
    for number, (start, level) in enumerate(zip(phases, levels, strict=True)):
        end = phases[number + 1] if number + 1 < len(phases) else None
        time = start
        going = True
        while going and not (isinstance(now, float) and now == level):
            side = float(np.sign(level))
            reverses = side != 0 and (yield -side * now)
            target = 0.0 if reverses else level
            way = 1.0 if (yield target - now) else -1.0
            grows = target != 0 and way == side
            unit = rise if grows else fall
            whole = way * (target - now) * unit
            if end is not None and (yield time + whole - end):
                duration = end - time
                change = way * duration / unit
                now, going = now + change, False
            else:
                duration, change = whole, target - now
                now, going = target, target != level
            found.append(PhaseRamp(time, duration, change, grows))
            time = time + duration
    return found


def ramps_by(answers: Answers, following: Course) -> list[PhaseRamp]:
    """Return the ramps of a course.

    Parameters
    ----------
    answers
        To all of its questions.
    following
        The course.

    Returns
    -------
    list of PhaseRamp
        In order.
    """
    return _follow(following, answers, lambda _: None)[1]


def courses(
    cells: int, following: Callable[[IntArray], Course]
) -> tuple[list[tuple[Answers, IntArray]], IntArray]:
    """Return the courses that cells may have, and which cells.

    Parameters
    ----------
    cells
        How many there are.
    following
        The course of some cells, of balls.

    Returns
    -------
    list of tuple, and IntArray
        Answers, and places of the cells that may have them; a cell may be in several. And places of
        cells that may have others too, of which there are too many.
    """
    done: list[tuple[Answers, IntArray]] = []
    todo: list[tuple[Answers, IntArray]] = [((), np.arange(cells))]
    while todo:
        if len(done) + len(todo) > MOST_COURSES:
            return done, np.unique(np.concatenate([places for _, places in todo]))
        answers, places = todo.pop()
        asked, split = _explore(following(places), answers, places)
        if split is None:
            done.append((asked, places))
            continue
        todo += [
            ((*asked, answer), some) for answer, some in zip((True, False), split, strict=True)
        ]
    return done, np.array([], dtype=np.intp)


def _explore(
    following: Course, answers: Answers, places: IntArray
) -> tuple[Answers, tuple[IntArray, IntArray] | None]:
    """Return answers as far as all cells have the same, and the cells that may have either next."""
    split: list[tuple[IntArray, IntArray]] = []

    def answer(asked: Number) -> bool | None:
        positive, negative = _sure(asked, len(places))
        if positive.all():
            return True
        if negative.all():
            return False
        split.append((places[~negative], places[~positive]))
        return None

    found, _ = _follow(following, answers, answer)
    return found, split[0] if split else None


def _follow(
    following: Course, answers: Answers, answer: Callable[[Number], bool | None]
) -> tuple[Answers, list[PhaseRamp]]:
    """Answer the questions of a course; the first that has no answer ends it, without ramps."""
    given: list[bool] = []
    try:
        asked = next(following)
        while True:
            known = answers[len(given)] if len(given) < len(answers) else answer(asked)
            if known is None:
                following.close()
                return tuple(given), []
            given.append(known)
            asked = following.send(known)
    except StopIteration as end:
        return tuple(given), end.value


def _sure(asked: Number, cells: int) -> tuple[BoolArray, BoolArray]:
    """Return in which cells a number is positive for sure, and in which negative."""
    if not isinstance(asked, Ball):
        value = np.full(cells, float(asked))
        return value > 0, value <= 0
    far = asked.radius + asked.error
    found = asked.centre.real
    return (
        np.broadcast_to(found > far, cells),
        np.broadcast_to(found < -far, cells),
    )
