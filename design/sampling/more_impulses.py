"""Commands of unity magnitude on whole samples: more impulses.

A command that takes level 0 or 1 anew on every sample can leave far less than a shaper's own
impulses moved to the best samples.
"""

import itertools
import math
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.sampling.every_command import is_listed_exactly
from design.sampling.halves import list_halves, match_halves
from design.sampling.left import TIE, cuts_ramps, residuals_of_many
from design.sampling.sample_grid import AnyIntArray, nearest_integers
from design.types import FloatArray

MAX_MATCHES = 300
"""The same for commands of more impulses, for each number: the best superposed [-]."""

MAX_COMPARED_BY_THEMSELVES = 60
"""The same where not even a list has a formula: some three milliseconds each [-]."""

MAX_ADDED_IMPULSES = 6
"""Impulses that are added at most, two at a time, as the command must end at full speed [-]."""

DESCENTS = 3
"""The best of those, whose impulses are then moved [-]."""

MAX_ROUNDS = 20
"""Moves of two impulses, one after the other, until none lowers the residual: a few do [-]."""

SHORT_REACH = 2
"""Samples to each side that two impulses are moved by at once [-]."""


def is_unity(impulses: Impulses) -> bool:
    """Return whether the amplitudes are a, -a, a, ..., a.

    Such a command is at level 0 or a at all times.
    """
    first = float(impulses.amplitudes[0])
    signs = (-1.0) ** np.arange(impulses.amplitudes.size)
    return impulses.amplitudes.size % 2 == 1 and bool(np.all(impulses.amplitudes == first * signs))


def more_impulses_on_grid(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    *,
    slope: bool,
    tolerance: float,
) -> Iterator[Impulses]:
    """Yield the best unity-magnitude commands with 2, 4 and 6 impulses more.

    Searched is every command of level 0 or 1 on each sample that is at most one period longer than
    the shaper: its vibration is the sum of those of its two halves, so that halves are listed and
    matched (meet in the middle). Of one number of impulses the shortest within the tolerance is
    taken, or, where none is, the one of least residual. More than 32 samples are first searched on
    every second, third, ... of them, a switched actuator first as if its steps were superposed;
    the best of that are moved sample by sample and compared exactly.

    Parameters
    ----------
    impulses
        The shaper, of unity magnitude.
    mode, actuator
        The plant's mode and its drive.
    sample_time_s
        Sample time, > 0 [s].
    slope
        Whether the slope counts, as in `unity_on_grid`.
    tolerance
        What is to be left at most, slope included where it counts, >= 0 [-].

    Yields
    ------
    Impulses
        For each number of impulses with which a command was found.
    """
    listed = list_halves(impulses, mode, actuator, sample_time_s)
    height = float(impulses.amplitudes[0])
    one_by_one = cuts_ramps(impulses, actuator, sample_time_s)
    for count in range(
        impulses.times_s.size + 2, impulses.times_s.size + MAX_ADDED_IMPULSES + 1, 2
    ):
        signs = (-1.0) ** np.arange(count)
        samples = listed.stride * match_halves(listed, count, slope=slope, tolerance=tolerance)
        if not samples.size:
            continue
        left_of = partial(_residuals_at, sample_time_s, signs, mode, actuator, slope)
        if one_by_one:
            listed_exactly = is_listed_exactly(actuator)
            samples = samples[: MAX_MATCHES if listed_exactly else MAX_COMPARED_BY_THEMSELVES]
        left = left_of(samples)
        # Where ramps are cut, thousands of moves would be computed one by one.
        descents = 0 if one_by_one else DESCENTS
        if not listed.exact:
            for best in samples[np.argsort(left, kind="stable")[:descents]]:
                moved = _descend(best, listed.longest, left_of)[None]
                samples = np.concatenate((samples, moved))
                left = np.concatenate((left, left_of(moved)))
        within = left <= max(tolerance, float(left.min()) + TIE)
        among = np.flatnonzero(within)
        shortest = among[samples[among, -1] == samples[among, -1].min()]
        chosen = samples[shortest[np.argmin(left[shortest])]]
        first_s = float(nearest_integers(impulses.times_s[:1] / sample_time_s)[0]) * sample_time_s
        yield Impulses(times_s=first_s + chosen * sample_time_s, amplitudes=height * signs)


def _residuals_at(
    sample_time_s: float,
    amplitudes: FloatArray,
    mode: Mode,
    actuator: Actuator,
    slope: bool,
    samples: AnyIntArray,
) -> FloatArray:
    return residuals_of_many(samples * sample_time_s, amplitudes, mode, actuator, slope=slope)


def _descend(
    samples: AnyIntArray, longest: int, left_of: Callable[[AnyIntArray], FloatArray]
) -> AnyIntArray:
    """Return the samples after moves of two impulses while these lower the residual."""
    free = samples.size - 1
    reach = range(-SHORT_REACH, SHORT_REACH + 1)
    moves = np.zeros((free * (free - 1) // 2 * len(reach) ** 2, samples.size), dtype=int)
    pairs = itertools.product(itertools.combinations(range(1, samples.size), 2), reach, reach)
    for row, (pair, first, second) in enumerate(pairs):
        moves[row, list(pair)] = first, second
    best, least = samples, math.inf
    for _ in range(MAX_ROUNDS):
        moved = best + moves
        ordered = np.all(np.diff(moved, axis=1) > 0, axis=1)
        moved = moved[ordered & (moved[:, -1] <= longest)]
        left = left_of(moved)
        if left.min() >= least - TIE:
            break
        best, least = moved[np.argmin(left)], float(left.min())
    return best
