"""Every command of level 0 or 1 on a number of samples, as two halves that are pruned and matched.

The residual vector of a command is a sum over its steps. Halves grow from both ends, sample by
sample. One that no other half can bring near zero is dropped: how far all other halves reach in a
direction follows from one sweep over the samples (dynamic programming over their two levels).
"""

import math
from dataclasses import dataclass

import numpy as np

from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.plants.mode import Mode
from design.model.ramps import ramp_factors
from design.sampling.left import DIFFERENCE, FREQUENCY_ERROR
from design.sampling.sample_grid import AnyIntArray
from design.solvers.budget import Budget
from design.types import BoolArray, FloatArray

MAX_HALVES, FEW_HALVES = 2**17, 2**9
"""Halves that are kept on each side and level, while there is work left and after; where more are
cut, the list is not complete [-]."""

MAX_PAIRS = 1_000_000
"""Pairs of halves that are compared for one number of samples [-]."""

PRUNED_FROM = 64
"""Halves from which on those are dropped that cannot come near zero [-]."""

AT_ONCE = 512
"""Halves whose products stay in the cache of a core [-]."""

ANGLES, CROSSED_ANGLES = 48, 8
"""Directions in which reach is computed: of V alone, and of V and its slope together [-]."""

RATIOS = ((1.0, 1.0), (0.3, 1.0), (0.1, 1.0), (0.03, 1.0))
"""Lengths of the two parts of those: what is left of V is much more than of the slope [-]."""

ROUNDS, TRIED, KEPT, LEAST_PART = 10, 200, 12, 0.02
"""Rounds in which directions are refined, how many are tried and kept in each, and by what
share of the whole each part may change at least [-]."""

MIN_BAND = 1e-5
"""Width of the bands that halves are sorted by, at least: sums of band and value keep digits."""

ROUNDING = 1e-11
"""What is added to a net for the rounding of sums [-]."""

WORK_PER_HALF, WORK_PER_PRODUCT, WORK_PER_PAIR, WORK_PER_SAMPLE = 0.25, 0.0025, 0.25, 50.0
"""Time that these take [units of `design.solvers.budget`]."""

VALUE_PARTS = 2
"""Of V alone; the slope has as many more [-]."""

WORD_BITS = 63
"""Samples whose levels one integer holds [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """Vectors of a step at each sample, seen from the last one, and how far sums of them reach.

    Attributes
    ----------
    rising, falling
        Real and imaginary part of V and of the slope times `FREQUENCY_ERROR`, shape (n + 1, p).
    directions
        Shape (p, d); the largest sum of two parts of a vector within a net is the net.
    before, after
        Reach of all steps before, or from, each sample, by the level there, shape (n + 2, 2, d).
    """

    rising: FloatArray
    falling: FloatArray
    directions: FloatArray
    before: FloatArray
    after: FloatArray

    @property
    def least(self) -> float:
        """What is left at least by any command, of level between 0 and 1 too [-]."""
        start = self.rising[0] @ self.directions + self.after[1, 1]
        return max(0.0, -float(start.min()))


def steps_of(
    samples: int,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    *,
    slope: bool,
    shorter: bool = False,
) -> Steps:
    """Return what steps leave at the end of a command of so many samples.

    Steps add as of a superposed drive, ramps as if none were cut.

    Parameters
    ----------
    samples
        From the first step to the last, >= 1 [-].
    mode, actuator
        The plant's mode and its drive.
    sample_time_s
        Sample time [s].
    slope
        Whether the slope in frequency counts.
    shorter
        Whether reach and `least` are of shorter commands too, as they are left by then.

    Returns
    -------
    Steps
        Of each sample.
    """
    times = sample_time_s * np.arange(samples + 1)
    lags, ramps = (actuator.accel_lag, actuator.decel_lag), unit_ramps_s(actuator)
    unit = lags[0].denominator(mode.pole_rad_s)
    by_ratio = []
    for ratio in (1.0, 1 + DIFFERENCE, 1 - DIFFERENCE)[: 3 if slope else 1]:
        pole = mode.pole_rad_s * ratio
        factors = ramp_factors(np.array([[pole]]), np.array(ramps))[0]
        swings = np.exp(mode.pole_rad_s * times[-1] + pole * (ramps[0] - times))
        by_ratio.append([
            swings * unit / lag.denominator(pole) * factor
            for lag, factor in zip(lags, factors, strict=True)
        ])
    parts = [np.array(by_ratio[0])]
    if slope:
        change = (np.array(by_ratio[1]) - np.array(by_ratio[2])) / (2 * DIFFERENCE)
        parts.append(FREQUENCY_ERROR * change)
    both = np.stack([real for part in parts for real in (part.real, part.imag)], axis=-1)
    directions = _directions(slope=slope)
    if slope:
        directions = _refined(both[0], both[1], directions, shorter=shorter)
    before, after = _reach(both[0] @ directions, both[1] @ directions, shorter=shorter)
    return Steps(both[0], both[1], directions, before, after)


def _refined(
    rising: FloatArray, falling: FloatArray, directions: FloatArray, *, shorter: bool
) -> FloatArray:
    """Return directions, and those near the ones that bound all commands best.

    Any direction bounds what commands leave. The slope is small beside V, so that a grid of four
    dimensions has few that bound it well.
    """
    random = np.random.default_rng(0)
    kept, size = [directions], 0.5
    found, value = directions, -math.inf
    for _ in range(ROUNDS):
        _, after = _reach(rising @ found, falling @ found, shorter=shorter)
        bounds = -(rising[0] @ found + after[1, 1])
        order = np.argsort(-bounds, kind="stable")
        if bounds[order[0]] > value:
            value, best = float(bounds[order[0]]), found[:, order[0]]
        else:
            size /= 2
        if found is not directions:
            kept.append(found[:, order[:KEPT]])
        sizes = np.repeat(np.hypot(best[::2], best[1::2]), 2) + LEAST_PART
        moves = size * sizes[:, None] * random.normal(size=(4, TRIED))
        found = best[:, None] + moves
        found /= np.hypot(found[::2], found[1::2]).max(axis=0)
    return np.hstack(kept)


def _directions(*, slope: bool) -> FloatArray:
    def unit(count: int) -> FloatArray:
        angles = 2 * math.pi * np.arange(count) / count
        return np.stack((np.cos(angles), np.sin(angles)))

    around = unit(ANGLES)
    if not slope:
        return around
    few = unit(CROSSED_ANGLES)
    first, second = np.repeat(few, CROSSED_ANGLES, axis=1), np.tile(few, CROSSED_ANGLES)
    nothing = np.zeros_like(around)
    parts = [(around, nothing), (nothing, around)]
    parts += [(a * first, b * second) for a, b in RATIOS]
    return np.hstack([np.vstack(part) for part in parts])


def _reach(
    rising: FloatArray, falling: FloatArray, *, shorter: bool
) -> tuple[FloatArray, FloatArray]:
    """Return `before` and `after` of `Steps`; the first and the last step are up."""
    count, width = rising.shape
    before = np.full((count + 1, 2, width), -math.inf)
    after = np.full((count + 1, 2, width), -math.inf)
    before[1, 1] = rising[0]
    for at in range(1, count - 1):
        low, high = before[at]
        before[at + 1, 0] = np.maximum(low, high - falling[at])
        before[at + 1, 1] = np.maximum(high, low + rising[at])
    after[count - 1, 0] = rising[-1]
    if shorter:
        after[count - 1, 1] = 0.0
    for at in range(count - 2, 0, -1):
        low, high = after[at + 1]
        after[at, 0] = np.maximum(low, high + rising[at])
        after[at, 1] = np.maximum(high, low - falling[at])
    return before, after


@dataclass(slots=True, eq=False)
class Half:
    """Halves of commands that pass the middle at one level: their sums and their steps."""

    sums: FloatArray  # Shape (m, p)
    steps: AnyIntArray  # A bit for each sample that has a step, shape (m, words)

    def stepped(self, vector: FloatArray, at: int) -> "Half":
        """Return the halves with one step more.

        Parameters
        ----------
        vector
            What it adds, shape (p,).
        at
            Its sample.

        Returns
        -------
        Half
            As many halves.
        """
        steps = self.steps.copy()
        steps[:, at // WORD_BITS] |= 1 << (at % WORD_BITS)
        return Half(self.sums + vector, steps)

    def joined(self, other: "Half") -> "Half":
        """Return both lists as one."""
        return Half(
            np.concatenate((self.sums, other.sums)), np.concatenate((self.steps, other.steps))
        )

    def only(self, rows: BoolArray | AnyIntArray) -> "Half":
        """Return some of the halves."""
        return Half(self.sums[rows], self.steps[rows])


@dataclass(frozen=True, slots=True, eq=False)
class Listed:
    """Commands of one number of samples that leave little, the least first.

    Attributes
    ----------
    samples
        Of the steps of each.
    left
        Residual of each, slope included where it counts, shape (m,) [-].
    complete
        Whether no command within the net is missing that has less than the first.
    """

    samples: list[AnyIntArray]
    left: FloatArray
    complete: bool


def commands_within(steps: Steps, net: float, budget: Budget, *, wanted: int) -> Listed:
    """Return commands of level 0 or 1 that leave at most a net.

    Parameters
    ----------
    steps
        What steps leave.
    net
        What commands may leave [-].
    budget
        Work that is left; the search spends from it.
    wanted
        How many are returned at most [-].

    Returns
    -------
    Listed
        The commands.
    """
    last = len(steps.rising) - 1
    width, words = steps.rising.shape[1], last // WORD_BITS + 1
    none = Half(np.zeros((0, width)), np.zeros((0, words), dtype=np.int64))
    one = Half(np.zeros((1, width)), np.zeros((1, words), dtype=np.int64))
    firsts = [none, one.stepped(steps.rising[0], 0)]
    seconds = [one.stepped(steps.rising[last], last), none]
    start, end, complete = 1, last, True
    while start < end:
        rows = [len(firsts[0].sums) + len(firsts[1].sums)]
        rows.append(len(seconds[0].sums) + len(seconds[1].sums))
        if min(rows) == 0:
            break
        if rows[0] <= rows[1]:
            firsts = _grown(firsts, steps.rising[start], -steps.falling[start], start)
            start += 1
            reach, grown = steps.after[start], firsts
        else:
            end -= 1
            seconds = _grown(seconds, steps.rising[end], -steps.falling[end], end, backwards=True)
            reach, grown = steps.before[end], seconds
        for level in (0, 1):
            grown[level], whole = _pruned(grown[level], steps.directions, reach[level], net, budget)
            complete &= whole
    pairs = list(zip(firsts, seconds, strict=True))
    return _matched(pairs, net, budget, wanted=wanted, complete=complete)


def _grown(
    halves: list[Half], rise: FloatArray, fall: FloatArray, at: int, *, backwards: bool = False
) -> list[Half]:
    low, high = halves
    to_low, to_high = (rise, fall) if backwards else (fall, rise)
    return [low.joined(high.stepped(to_low, at)), high.joined(low.stepped(to_high, at))]


def _pruned(
    half: Half, directions: FloatArray, reach: FloatArray, net: float, budget: Budget
) -> tuple[Half, bool]:
    """Drop halves that cannot come near zero; return the others, and whether they are all."""
    count = len(half.sums)
    budget.spend(WORK_PER_HALF * count + WORK_PER_SAMPLE)
    if count < PRUNED_FROM:
        return half, True
    budget.spend(WORK_PER_PRODUCT * count * reach.size)
    room = np.concatenate([
        (half.sums[start : start + AT_ONCE] @ directions + reach).min(axis=1)
        for start in range(0, count, AT_ONCE)
    ])
    most = FEW_HALVES if budget.spent else MAX_HALVES
    kept = np.flatnonzero(room >= -net - ROUNDING)
    if len(kept) <= most:
        return half.only(kept), True
    # Those that can come nearest: what is in the midst of the reach of the others.
    chosen = np.sort(kept[np.argpartition(-room[kept], most)[:most]])
    return half.only(chosen), False


def _matched(
    pairs: list[tuple[Half, Half]], net: float, budget: Budget, *, wanted: int, complete: bool
) -> Listed:
    pairs = [(first, second) for first, second in pairs if len(first.sums) and len(second.sums)]
    sought = [(first, second, _mates(first, second, net)) for first, second in pairs]
    narrow = net
    while sum(int((high - low).sum()) for *_, (_, low, high) in sought) > MAX_PAIRS:
        narrow /= 2
        sought = [(first, second, _mates(first, second, narrow)) for first, second in pairs]
    samples: list[AnyIntArray] = []
    left: list[float] = []
    for first, second, (order, low, high) in sought:
        sizes = (high - low).ravel()
        budget.spend(WORK_PER_PAIR * (float(sizes.sum()) + 3 * low.shape[1] + len(first.sums)))
        of = np.repeat(np.tile(np.arange(low.shape[1]), len(low)), sizes)
        ones = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes - low.ravel(), sizes)
        ones = order[ones]
        sums = first.sums[ones] + second.sums[of]
        each = np.hypot(sums[:, 0], sums[:, 1])
        if sums.shape[1] > VALUE_PARTS:
            each = each + np.hypot(sums[:, 2], sums[:, 3])
        best = np.flatnonzero(each <= narrow + ROUNDING)
        best = best[np.argsort(each[best], kind="stable")[:wanted]]
        left += each[best].tolist()
        bits = first.steps[ones[best]] | second.steps[of[best]]
        samples += [_samples_of(row) for row in bits]
    best = np.argsort(np.array(left), kind="stable")[:wanted]
    # A narrower net holds the least of all, if it holds any.
    return Listed(
        [samples[one] for one in best.tolist()],
        np.array(left)[best],
        complete and (narrow == net or len(best) > 0),
    )


def _mates(first: Half, second: Half, net: float) -> tuple[AnyIntArray, AnyIntArray, AnyIntArray]:
    """Return an order of ``first``, and from where to where in it ``second`` may find mates.

    In order of bands of the real part, and in a band of the imaginary part.
    """
    width = max(net, MIN_BAND) + ROUNDING
    scale = 2 * (float(np.abs(first.sums[:, 1]).max()) + float(np.abs(second.sums[:, 1]).max())) + 4
    keys = np.floor(first.sums[:, 0] / width) * scale + first.sums[:, 1]
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    bands = np.floor(-second.sums[:, 0] / width)
    sought = (bands + np.array([[-1], [0], [1]])) * scale - second.sums[:, 1]
    low = np.searchsorted(keys, sought - width)
    high = np.searchsorted(keys, sought + width)
    return order, low, high


def _samples_of(words: AnyIntArray) -> AnyIntArray:
    found: AnyIntArray = np.flatnonzero(words[:, None] >> np.arange(WORD_BITS) & 1)
    return found
