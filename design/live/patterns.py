"""Patterns of levels that a command may go through on its way to a new level.

A pattern is a list of arcs, each with a level that is held for some time, and the last level. As
many gaps are unknown as there are equations; the others are given. Patterns stand in order of
length: the short ones are what a command at rest or at speed needs, the longer ones serve swings
that are larger or of another phase.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from design.model.plants.mode import Mode
from design.types import FloatArray

WAITS = (0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0)
"""Given gaps that are tried, in halves of the slowest mode's damped period [-]."""

PAIR_FIRST = (0.04, 0.12, 0.25, 0.4, 0.6, 0.8)
PAIR_SECOND = (0.05, 0.15, 0.3, 0.45)
"""Guesses of two unknown gaps, in periods of the mode [-]."""

TUPLES = 24
"""Guesses of more than two unknown gaps."""

SHORTEST_GUESS, LONGEST_GUESS = 0.04, 0.55
"""Range of these gaps, in periods of the slowest mode: evenly in their logarithm [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pattern:
    """Levels of a command in order.

    Attributes
    ----------
    levels
        Of each arc, and the last one, shape (arcs + 1,) [-].
    given_s
        Length of each arc that is given, nan where it is unknown, shape (arcs,) [s].
    """

    levels: tuple[float, ...]
    given_s: tuple[float, ...]


def patterns(
    level: float,
    target: float,
    others: tuple[float, ...],
    half_s: float,
    rest_s: float,
    unknowns: int,
) -> Iterator[tuple[Pattern, ...]]:
    """Yield the patterns from a level to another, the short ones first.

    Parameters
    ----------
    level, target
        Level now, and the new one, signed [-].
    others
        Levels that may stand beside the new one, of its sign or 0, other than itself [-].
    half_s
        Half the damped period of the slowest mode [s].
    rest_s
        Least time at rest between two directions [s].
    unknowns
        Number of equations, even.

    Yields
    ------
    tuple of Pattern
        Patterns of one length.
    """
    free = math.nan

    def alternating(other: float, before: tuple[tuple[float, float], ...] = ()) -> Pattern:
        levels = [*(one for one, _ in before), *[target, other] * (unknowns // 2), target]
        given = [*(gap for _, gap in before), *[free] * unknowns]
        return Pattern(levels=tuple(levels), given_s=tuple(given))

    if level * target < 0:
        yield tuple(alternating(other, ((0.0, rest_s),)) for other in others)
        # Through zero: the last of the old direction, and the first of the new.
        yield tuple(
            Pattern(
                levels=(0.0, 0.0, between, 0.0, target),
                given_s=(rest_s, free, share * half_s, free),
            )
            if unknowns == len((level, target))
            else alternating(0.0, ((0.0, share * half_s),))
            for between, share in itertools.product((level, target), WAITS)
        )
        return
    yield tuple(alternating(other) for other in others)
    if unknowns == len((level, target)):
        yield tuple(
            Pattern(levels=(other, target, other, target), given_s=(free, half_s, free))
            for other in others
        )
        yield tuple(
            Pattern(
                levels=(target, other, target, other, target),
                given_s=(free, half_s, half_s, free),
            )
            for other in others
        )
    else:
        yield tuple(
            alternating(other, ((level, share * half_s),))
            for other, share in itertools.product(others, WAITS)
            if level != target
        )


def guesses_s(modes: tuple[Mode, ...], unknowns: int) -> FloatArray:
    """Return guesses of unknown gaps, shape (guesses, unknowns) [s].

    Parameters
    ----------
    modes
        The modes.
    unknowns
        How many gaps are unknown.

    Returns
    -------
    FloatArray
        A grid of two gaps; of more a sequence of low discrepancy (Halton 1960).
    """
    slowest_s = max(mode.period_s for mode in modes)
    if unknowns == len((PAIR_FIRST, PAIR_SECOND)):
        return slowest_s * np.array(list(itertools.product(PAIR_FIRST, PAIR_SECOND)))
    bases = [n for n in range(2, 100) if all(n % k for k in range(2, n))][:unknowns]
    points = [[_radical_inverse(n, base) for base in bases] for n in range(1, TUPLES + 1)]
    spread = (LONGEST_GUESS / SHORTEST_GUESS) ** np.array(points)
    return SHORTEST_GUESS * slowest_s * spread


def _radical_inverse(number: int, base: int) -> float:
    inverse, place = 0.0, 1.0
    while number:
        place /= base
        inverse += place * (number % base)
        number //= base
    return inverse
