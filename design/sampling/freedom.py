"""What amplitudes on samples may be: of one sign, within levels, or of given negative parts.

Each is a box of unknowns with linear equations and inequalities, of which amplitudes are sums:
``amplitudes = base + matrix x``. Times are in samples here.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from design.model.impulses import Impulses
from design.sampling.more_impulses import is_unity
from design.sampling.sample_grid import AnyIntArray
from design.types import BoolArray, FloatArray

MAX_ALL = 240
"""Samples that are all unknown; of more only those around the impulses are [-]."""

REACH = 4
"""How many samples to each side of an impulse those are [-]."""

LEVEL = 1e-9
"""Levels as near as this are one: it is rounding of a sum [-]."""

BEGINNING = 1e-3
"""Size of a step that begins a set, at least, where it is to begin there [-]."""

MAX_RELAXED = 80
"""Samples up to which all ways to part them are taken together."""

MAX_PATTERNS = 60
"""Ways to part samples among the steps up and down that are tried for one number of samples."""

MAX_LISTED_PATTERNS = 500
"""Of few samples all ways are, if there are no more."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Freedom:
    """Amplitudes ``base + matrix x`` on samples, ``0 <= x <= highest``.

    Attributes
    ----------
    samples
        Their numbers, rising, shape (k,).
    base, matrix
        Amplitudes of x = 0, and what x adds, shapes (k,), (k, n).
    highest
        Upper bounds, shape (n,).
    equal, right
        Equations that x keeps, shapes (e, n), (e,).
    below, most
        Inequalities that x keeps, shapes (q, n), (q,).
    cost
        How far an unknown is from the linear split, shape (n,).
    signs
        Signs of the steps where they are given, shape (k,); None where they are free or all up.
    """

    samples: AnyIntArray
    base: FloatArray
    matrix: FloatArray
    highest: FloatArray
    equal: FloatArray
    right: FloatArray
    below: FloatArray
    most: FloatArray
    cost: FloatArray
    signs: FloatArray | None = None

    @property
    def complete(self) -> bool:
        """Whether every sample from the first to the last may have a step."""
        return bool(np.unique(self.samples).size == self.samples[-1] + 1)

    def restricted(self, kept: BoolArray) -> "Freedom":
        """Return the same of given signs with fewer samples, shape (k,)."""
        return replace(
            self,
            samples=self.samples[kept],
            base=self.base[kept],
            matrix=self.matrix[np.ix_(kept, kept)],
            highest=self.highest[kept],
            equal=self.equal[:, kept],
            below=self.below[:, kept],
            cost=self.cost[kept],
            signs=None if self.signs is None else self.signs[kept],
        )

    def with_beginnings(self) -> "Freedom":
        """Return the same whose first step of each sign is never 0."""
        if self.signs is None:
            return self
        first = np.diff(self.signs, prepend=self.signs[0]) != 0
        least = np.where(first, BEGINNING, 0.0)
        return replace(
            self,
            base=self.base + self.matrix @ least,
            highest=self.highest - least,
            right=self.right - self.equal @ least,
            most=self.most - self.below @ least,
        )


def candidates(positions: FloatArray, last: int) -> AnyIntArray:
    """Return samples from 0 to the last that may have a step.

    Parameters
    ----------
    positions
        Times of the impulses between the samples [samples].
    last
        Number of the last sample.

    Returns
    -------
    AnyIntArray
        All of them, or where these are many those around the impulses, shape (k,).
    """
    if last < MAX_ALL:
        return np.arange(last + 1)
    before = np.floor(positions).astype(int)
    around = np.add.outer(before, np.arange(1 - REACH, REACH + 1)).ravel()
    ends = [0, *range(last - REACH, last + 1)]
    return np.unique(np.clip(np.concatenate((around, ends)), 0, last))


def freedoms(
    impulses: Impulses, positions: FloatArray, last: int, *, band: bool, alike: bool = True
) -> Iterator[Freedom]:
    """Yield what amplitudes may be on samples 0 to the last.

    Amplitudes of one sign stay so. Of those of both signs, a command that keeps a tolerance over a
    band, that goes beyond 0 to 1, or is at 0 or 1 always, stays within its levels. Any other, and
    one beyond 1 where steps up and down act differently, keeps the sum of each negative step, and
    steps up and down take turns as before: in each of several ways to part the samples.

    Parameters
    ----------
    impulses, positions
        The shaper, and its times from the first impulse on [samples].
    last
        Number of the last sample.
    band, alike
        As of `takes_turns`.

    Yields
    ------
    Freedom
        The likeliest first.
    """
    amplitudes = impulses.amplitudes / impulses.amplitudes.sum()
    samples = candidates(positions, last)
    if amplitudes.min() >= 0:
        yield _positive(positions, samples)
    elif takes_turns(impulses, band=band, alike=alike):
        yield from _patterns(positions, amplitudes, samples)
    else:
        yield _within_levels(positions, amplitudes, samples, _levels(impulses))


def takes_turns(impulses: Impulses, *, band: bool, alike: bool) -> bool:
    """Return whether steps take turns, and those down keep their sums.

    Parameters
    ----------
    impulses
        The shaper.
    band
        Whether a tolerance is kept over a band.
    alike
        Whether steps up and down go through one set of the drive.

    Returns
    -------
    bool
        False of one sign, and of a command that only stays within its levels.
    """
    lowest, highest = _levels(impulses)
    beyond = lowest < -LEVEL or (alike and highest > 1 + LEVEL)
    both = impulses.amplitudes.min() < 0 < impulses.amplitudes.max()
    return bool(both) and not (band or beyond or is_unity(impulses))


def _levels(impulses: Impulses) -> tuple[float, float]:
    """Return the lowest and the highest level of a command from 0 to 1."""
    levels = np.cumsum(impulses.amplitudes / impulses.amplitudes.sum())
    return min(0.0, float(levels.min())), max(1.0, float(levels.max()))


def _far(positions: FloatArray, samples: FloatArray) -> FloatArray:
    """Return the square of each place's distance to the nearest impulse."""
    after = np.searchsorted(positions, samples)
    neighbours = np.clip((after - 1, after), 0, positions.size - 1)
    squares: FloatArray = np.abs(samples - positions[neighbours]).min(axis=0) ** 2
    return squares


def _positive(positions: FloatArray, samples: AnyIntArray) -> Freedom:
    count = samples.size
    return Freedom(
        samples=samples,
        base=np.zeros(count),
        matrix=np.eye(count),
        highest=np.ones(count),
        equal=np.ones((1, count)),
        right=np.ones(1),
        below=np.zeros((0, count)),
        most=np.zeros(0),
        cost=_far(positions, samples.astype(float)),
    )


def _within_levels(
    positions: FloatArray, amplitudes: FloatArray, samples: AnyIntArray, levels: tuple[float, float]
) -> Freedom:
    """Return a command between two levels, unknown from each sample to the next, 1 at last."""
    lowest, highest = levels
    count = samples.size
    edges = samples.astype(float)
    # The mean level of the shaper from a sample to the next is that of its linear split.
    way = np.maximum(np.subtract.outer(edges, positions), 0.0) @ amplitudes
    means = np.diff(way) / np.diff(edges)
    towards = np.where(means > highest - LEVEL, -1.0, np.where(means < lowest + LEVEL, 1.0, 0.0))
    base = np.zeros(count)
    base[0], base[-1] = lowest, 1 - lowest
    return Freedom(
        samples=samples,
        base=base,
        matrix=np.eye(count, count - 1) - np.eye(count, count - 1, -1),
        highest=np.full(count - 1, highest - lowest),
        equal=np.zeros((0, count - 1)),
        right=np.zeros(0),
        below=np.zeros((0, count - 1)),
        most=np.zeros(0),
        cost=towards * (_far(positions, (edges[1:] + edges[:-1]) / 2) + 1.0),
    )


def _patterns(
    positions: FloatArray, amplitudes: FloatArray, samples: AnyIntArray
) -> Iterator[Freedom]:
    """Yield signs of the steps: each impulse has samples in a row, those next to it first."""
    ends = (positions[1:] + positions[:-1]) / 2
    places = np.searchsorted(samples, ends)
    for cuts in _cuts(places, samples.size):
        yield _signed(positions, amplitudes, samples, [0, *cuts, samples.size])


def _cuts(places: AnyIntArray, count: int) -> Iterator[tuple[int, ...]]:
    """Yield where samples are parted, all different: those nearest to some places first."""
    if math.comb(count - 1, places.size) <= MAX_LISTED_PATTERNS:
        yield from sorted(
            itertools.combinations(range(1, count), places.size),
            key=lambda cuts: (int(np.abs(cuts - places).sum()), cuts),
        )
        return
    reach = 1
    while (2 * reach + 3) ** places.size <= 3 * MAX_PATTERNS and reach < REACH:
        reach += 1
    moves = sorted(
        itertools.product(range(-reach, reach + 1), repeat=places.size),
        key=lambda move: (sum(abs(one) for one in move), move),
    )
    tried = 0
    for move in moves:
        cuts = tuple((places + np.array(move)).tolist())
        if tried < MAX_PATTERNS and all(a < b for a, b in itertools.pairwise((0, *cuts, count))):
            tried += 1
            yield cuts


def _signed(
    positions: FloatArray, amplitudes: FloatArray, samples: AnyIntArray, cuts: list[int]
) -> Freedom:
    count = samples.size
    owner = np.repeat(np.arange(positions.size), np.diff(cuts))
    signs = np.sign(amplitudes)[owner]
    negative = np.flatnonzero(amplitudes < 0)
    equal = np.concatenate(([signs], (owner == negative[:, None]).astype(float)))
    # The command is highest where steps up end, lowest where steps down do.
    ends = np.array(cuts[1:-1]) - 1
    levels = signs[ends, None] * np.where(np.arange(count) <= ends[:, None], signs, 0.0)
    return Freedom(
        samples=samples,
        base=np.zeros(count),
        matrix=np.diag(signs),
        highest=np.full(count, max(1.0, float(np.abs(amplitudes).max()))),
        equal=equal,
        right=np.concatenate(([1.0], -amplitudes[negative])),
        below=levels,
        most=np.where(signs[ends] > 0, max(1.0, float(np.cumsum(amplitudes).max())), 0.0),
        cost=(samples - positions[owner]) ** 2,
        signs=signs,
    )


def relaxed(impulses: Impulses, last: int) -> Freedom:
    """Return the freedom of a step up and one down on each sample.

    All ways to part the samples are in it: what is least here, none of them goes below.

    Parameters
    ----------
    impulses
        The shaper, of steps up and down.
    last
        Number of the last sample.

    Returns
    -------
    Freedom
        Of each sample twice, shape (2 (last + 1),).
    """
    amplitudes = impulses.amplitudes / impulses.amplitudes.sum()
    count = last + 1
    signs = np.tile([1.0, -1.0], count)
    down = (signs < 0).astype(float)
    levels = np.repeat(np.tril(np.ones((count, count))), 2, axis=1) * signs
    most = float(np.maximum(amplitudes, 0.0).sum())
    return Freedom(
        samples=np.repeat(np.arange(count), 2),
        base=np.zeros(2 * count),
        matrix=np.diag(signs),
        highest=np.full(2 * count, most),
        equal=np.array([signs, down]),
        right=np.array([1.0, most - 1.0]),
        below=np.concatenate((levels, -levels)),
        most=np.repeat([max(1.0, float(np.cumsum(amplitudes).max())), 0.0], count),
        cost=np.zeros(2 * count),
        signs=signs,
    )


def samples_of(duration: float) -> int:
    """Return how many samples after the first a duration takes [samples]."""
    return math.ceil(duration - LEVEL)
