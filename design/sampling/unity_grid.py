"""Commands of unity magnitude on whole samples: the impulses moved, or more of them.

A shaper of amplitudes +1, -1, +1, ... cannot be made exact on a grid. Moved to the best samples it
leaves what it must; a command that takes level 0 or 1 anew on every sample can leave far less.
"""

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from design.analysis.residuals_of_many import vectors_of_many
from design.analysis.workable import require_workable
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.sampling.sample_grid import IntArray, require_gaps, rounded
from design.types import ComplexArray, FloatArray

Band = tuple[float, float]
"""Ends of a band of frequencies, over the nominal one [-]."""

WIDEST_REACH = 4
"""Samples on each side of an impulse that are looked at [-]."""

MOST_CANDIDATES = 50_000
"""Largest number of rounded shapers that one search compares; it narrows for more impulses."""

MOST_ONE_BY_ONE = 1_000
"""The same where ramps are cut, so that the formula of many commands at once does not hold: each
takes some one or two milliseconds then."""

MOST_MATCHED = 300
"""The same for commands of more impulses, for each number: the best superposed [-]."""

FREQUENCY_ERROR = 0.05
"""Relative error in frequency that a shaper with zero slope is to stand [-]."""

DIFFERENCE = 1e-5
"""Relative step of the central difference in frequency: its error and rounding are 1e-10 [-]."""

BAND_POINTS = 17
"""Frequencies at which what is left over a band is compared [-]."""

TIE = 1e-12
"""Shapers this near in what they leave are equally good: it is rounding [-]."""

MOST_ADDED = 6
"""Impulses that are added at most, two at a time, as the command must end at full speed [-]."""

ADDED_PERIODS = 1.0
"""How much longer than the shaper between the samples one with more impulses may be [periods].

Each sample more doubles the number of commands; one period more is about what UMZVD takes for its
robustness, and so a price that is paid elsewhere.
"""

MOST_POSITIONS = 32
"""Positions that commands are listed on: two halves of 2^15 each. On a finer grid every second,
third, ... sample is a position, and the best are moved sample by sample afterwards [-]."""

FINEST_NET = 1e-3
"""What commands leave at most in the first, finest net cast for them [-]."""

WIDEST_NET = 1.0
"""No command that leaves more than an unshaped step is of interest [-]."""

MOST_PAIRS = 2_000_000
"""Pairs of halves in one net, a bound on work and memory: it is narrowed to it [-]."""

WANTED = 100
"""Commands that are compared exactly where the list is of a coarser grid or another actuator."""

DESCENTS = 3
"""The best of those, whose impulses are then moved [-]."""

MOST_ROUNDS = 20
"""Moves of two impulses, one after the other, until none leaves less: a few do [-]."""

SHORT_REACH = 2
"""Samples to each side that two impulses are moved by at once [-]."""


def unity_on_grid(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    *,
    slope: bool,
    band: Band | None = None,
) -> Impulses:
    """Return the impulses with amplitudes unchanged, at the best whole samples around them.

    Compared is every choice of samples, up to four on each side of the nearest (fewer for more
    than five impulses, or where ramps are cut), in order. The first impulse stays at its nearest
    sample: all of them later by a sample leave the same. What is minimised is the residual |V|, and
    with ``slope`` ``|V| + 0.05 |dV/d ln w|``: to first order the most that 5 % of error in
    frequency leaves. With a band it is the largest residual over that.

    Parameters
    ----------
    impulses
        The shaper.
    mode, actuator
        The plant's mode and its drive.
    sample_time_s
        Sample time, > 0, at most the shortest gap between two impulses [s].
    slope
        Whether the slope in frequency counts too.
    band
        Lowest and highest ratio of true and nominal frequency that count; None for 1 alone [-].

    Returns
    -------
    Impulses
        The choice that leaves least; the shorter, then the earlier, of two that leave the same.
        It leaves something: ask `design.analysis.residual` how much.

    Raises
    ------
    InvalidInputError
        If the sample time breaks its rule, a set of the actuator is out of all proportion to the
        plant, or there are more than ten impulses.
    """
    require_workable(mode, actuator)
    require_gaps(impulses, sample_time_s)
    cut = cuts_ramps(impulses, actuator, sample_time_s)
    most = MOST_ONE_BY_ONE if cut else MOST_CANDIDATES
    samples = _choices(rounded(impulses.times_s / sample_time_s), most)
    times = samples * sample_time_s
    if band is None:
        left = left_of_many(times, impulses.amplitudes, mode, actuator, slope=slope)
    else:
        left = _left_over_band(times, impulses.amplitudes, mode, actuator, band)
    chosen = samples[_shortest(samples, np.flatnonzero(left <= left.min() + TIE))]
    return Impulses(times_s=chosen * sample_time_s, amplitudes=impulses.amplitudes)


def cuts_ramps(impulses: Impulses, actuator: Actuator, sample_time_s: float) -> bool:
    """Return whether steps moved by a sample may begin before the ramp of the last one is over.

    Or a step reverses the command, whose two ramps a formula of many commands does not know.
    """
    accelerating, braking = unit_ramps_s(actuator)
    if max(accelerating, braking) == 0:
        return False
    sizes, rising = np.abs(impulses.amplitudes), impulses.accelerates
    ramps = sizes * np.where(rising, accelerating, braking)
    levels = np.cumsum(impulses.amplitudes)
    reversed_steps = bool((levels * impulses.amplitudes.sum() < -REVERSED).any())
    gaps = np.diff(impulses.times_s)
    return reversed_steps or bool((gaps - 2 * sample_time_s < ramps[:-1]).any())


REVERSED = 1e-9
"""Level on the other side of zero that is no rounding [-]."""


def is_unity(impulses: Impulses) -> bool:
    """Return whether the amplitudes are a, -a, a, ..., a: at all times level 0 or a."""
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
    """Yield the best commands of unity magnitude with 2, 4 and 6 impulses more, on whole samples.

    Searched is every command of level 0 or 1 on each sample that is at most one period longer than
    the shaper: it leaves a sum of what its two halves leave, so that halves are listed and matched
    (meet in the middle). Of one number of impulses the shortest within the tolerance is taken, or,
    where none is, the one that leaves least. More than 32 samples are first searched on
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
    listed = _listed(impulses, mode, actuator, sample_time_s)
    height = float(impulses.amplitudes[0])
    one_by_one = cuts_ramps(impulses, actuator, sample_time_s)
    for count in range(impulses.times_s.size + 2, impulses.times_s.size + MOST_ADDED + 1, 2):
        signs = (-1.0) ** np.arange(count)
        samples = listed.stride * _matched(listed, count, slope=slope, tolerance=tolerance)
        if not samples.size:
            continue
        left_of = partial(_left_at, sample_time_s, signs, mode, actuator, slope)
        if one_by_one:
            samples = samples[:MOST_MATCHED]
        left = left_of(samples)
        # Where ramps are cut, thousands of moves would be computed one by one.
        descents = 0 if one_by_one else DESCENTS
        if not listed.exact:
            for best in samples[np.argsort(left, kind="stable")[:descents]]:
                moved = _descended(best, listed.longest, left_of)[None]
                samples = np.concatenate((samples, moved))
                left = np.concatenate((left, left_of(moved)))
        within = left <= max(tolerance, float(left.min()) + TIE)
        among = np.flatnonzero(within)
        shortest = among[samples[among, -1] == samples[among, -1].min()]
        chosen = samples[shortest[np.argmin(left[shortest])]]
        first_s = float(rounded(impulses.times_s[:1] / sample_time_s)[0]) * sample_time_s
        yield Impulses(times_s=first_s + chosen * sample_time_s, amplitudes=height * signs)


def left_of_many(
    times_s: FloatArray,
    amplitudes: FloatArray,
    mode: Mode,
    actuator: Actuator,
    *,
    slope: bool,
    band: Band | None = None,
) -> FloatArray:
    """Return what `unity_on_grid` minimises of many shapers, times of shape (m, n): shape (m,)."""
    lag = actuator.accel_lag

    def vibration(ratio: float) -> ComplexArray:
        pole = mode.pole_rad_s * ratio
        poles = np.full(len(times_s), pole)
        # Phase and unit of the nominal frequency, so that only V itself differs.
        unit = lag.denominator(mode.pole_rad_s) / lag.denominator(pole)
        turn = np.exp((mode.pole_rad_s - pole) * (times_s[:, -1] - times_s[:, 0]))
        vectors: ComplexArray = vectors_of_many(times_s, amplitudes, poles, actuator) * turn * unit
        return vectors

    if band is not None:
        ratios = np.linspace(*band, BAND_POINTS)
        return _largest_at(times_s, amplitudes, mode, actuator, ratios)
    left: FloatArray = np.abs(vibration(1.0))
    if slope:
        change = vibration(1 + DIFFERENCE) - vibration(1 - DIFFERENCE)
        left = left + FREQUENCY_ERROR * np.abs(change) / (2 * DIFFERENCE)
    return left


def _largest_at(
    times_s: FloatArray,
    amplitudes: FloatArray,
    mode: Mode,
    actuator: Actuator,
    ratios: FloatArray,
) -> FloatArray:
    """Return the largest residual of each of many shapers at some ratios of frequency."""
    largest: FloatArray = np.zeros(len(times_s))
    for ratio in ratios.tolist():
        poles = np.full(len(times_s), mode.pole_rad_s * ratio)
        left = np.abs(vectors_of_many(times_s, amplitudes, poles, actuator))
        largest = np.maximum(largest, left)
    return largest


def _left_over_band(
    times_s: FloatArray, amplitudes: FloatArray, mode: Mode, actuator: Actuator, band: Band
) -> FloatArray:
    """Return the largest residual over a band of those shapers that may leave least, inf of others.

    What one leaves at three frequencies it leaves at all of them, at least.
    """
    least = _largest_at(times_s, amplitudes, mode, actuator, np.linspace(*band, 3))
    order = np.argsort(least, kind="stable")
    largest: FloatArray = np.full(len(times_s), np.inf)

    def look_at(ones: IntArray) -> None:
        if ones.size:
            largest[ones] = left_of_many(
                times_s[ones], amplitudes, mode, actuator, slope=False, band=band
            )

    look_at(order[:WANTED])
    others = order[WANTED:]
    look_at(others[least[others] <= largest.min()])
    return largest


def _left_at(
    sample_time_s: float,
    amplitudes: FloatArray,
    mode: Mode,
    actuator: Actuator,
    slope: bool,
    samples: IntArray,
) -> FloatArray:
    return left_of_many(samples * sample_time_s, amplitudes, mode, actuator, slope=slope)


def _choices(centres: IntArray, most: int) -> IntArray:
    """Every ordered choice of samples around the centres, in lexical order, shape (m, n)."""
    free = centres.size - 1
    reach = WIDEST_REACH
    while (2 * reach + 1) ** free > (most if reach > 1 else MOST_CANDIDATES):
        reach -= 1
    if reach == 0:
        raise InvalidInputError("impulses", centres.size, "few enough to search: at most 10")
    moves = list(itertools.product(range(-reach, reach + 1), repeat=free))
    samples = np.repeat(centres[None], len(moves), axis=0)
    samples[:, 1:] += np.array(moves, dtype=int)
    ordered: IntArray = samples[np.all(np.diff(samples, axis=1) > 0, axis=1)]
    return ordered


def _shortest(samples: IntArray, among: IntArray) -> int:
    """Return the first of the shortest: rows come in lexical order, so that it is the earlier."""
    return int(among[np.argmin(samples[among, -1])])


def _descended(
    samples: IntArray, longest: int, left_of: Callable[[IntArray], FloatArray]
) -> IntArray:
    """Return the samples after moving two impulses at a time while that leaves less."""
    free = samples.size - 1
    reach = range(-SHORT_REACH, SHORT_REACH + 1)
    moves = np.zeros((free * (free - 1) // 2 * len(reach) ** 2, samples.size), dtype=int)
    pairs = itertools.product(itertools.combinations(range(1, samples.size), 2), reach, reach)
    for row, (pair, first, second) in enumerate(pairs):
        moves[row, list(pair)] = first, second
    best, least = samples, math.inf
    for _ in range(MOST_ROUNDS):
        moved = best + moves
        ordered = np.all(np.diff(moved, axis=1) > 0, axis=1)
        moved = moved[ordered & (moved[:, -1] <= longest)]
        left = left_of(moved)
        if left.min() >= least - TIE:
            break
        best, least = moved[np.argmin(left)], float(left.min())
    return best


@dataclass(frozen=True, slots=True, eq=False)
class _Half:
    """Every half of a command that has one number of impulses.

    Attributes
    ----------
    changes
        At each of its positions +1, -1 or 0, shape (m, p).
    sums
        V and its slope, superposed, over G of the acceleration set, shape (2, m).
    ends
        Time of its last impulse, shape (m,); minus infinity without one.
    """

    changes: IntArray
    sums: ComplexArray
    ends: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Listed:
    """Both halves of all commands, by their number of impulses.

    Attributes
    ----------
    firsts
        From level 0.
    seconds
        To level 1, from the level that an odd or even number of impulses before leads to.
    """

    firsts: dict[int, _Half]
    seconds: dict[int, _Half]
    pole_rad_s: complex
    stride: int
    longest: int
    exact: bool


def _listed(impulses: Impulses, mode: Mode, actuator: Actuator, sample_time_s: float) -> _Listed:
    longest_s = impulses.duration_s + ADDED_PERIODS * mode.period_s
    longest = math.floor(longest_s / sample_time_s)
    stride = -(-longest // MOST_POSITIONS)
    positions = longest // stride + 1
    times = stride * sample_time_s * np.arange(positions)
    middle = positions // 2
    lags = (actuator.accel_lag, actuator.decel_lag)
    unit = 1 / lags[0].denominator(mode.pole_rad_s)
    vectors = []
    for ratio in (1.0, 1 + DIFFERENCE, 1 - DIFFERENCE):
        pole = mode.pole_rad_s * ratio
        swings = np.exp(-pole * times)
        vectors.append([swings / (lag.denominator(pole) * unit) for lag in lags])
    rising, falling = np.array(vectors).transpose(1, 0, 2)

    def halves(levels: IntArray, start: int) -> dict[int, _Half]:
        """Group by number of impulses; the first column is the level before."""
        changes = np.diff(levels, axis=1)
        part = slice(start, start + changes.shape[1])
        at = (changes > 0) @ rising[:, part].T - (changes < 0) @ falling[:, part].T
        sums = np.stack((at[:, 0], (at[:, 1] - at[:, 2]) / (2 * DIFFERENCE)))
        ends = np.where(changes != 0, times[part], -math.inf).max(axis=1)
        counts = np.count_nonzero(changes, axis=1)
        grouped = {}
        for count in np.unique(counts).tolist():
            rows = np.flatnonzero(counts == count)
            # In order of what `_matched` looks up.
            rows = rows[np.argsort(sums[0, rows].real, kind="stable")]
            grouped[count] = _Half(changes[rows], sums[:, rows], ends[rows])
        return grouped

    first = _levels(middle - 1)
    ones = np.ones((len(first), 1), dtype=int)
    firsts = halves(np.hstack((0 * ones, ones, first)), 0)
    second = _levels(positions - middle - 1)
    ones = np.ones((len(second), 1), dtype=int)
    # From level 0 an odd number of impulses leads to level 1, from level 1 an even one.
    seconds = halves(np.hstack((0 * ones, second, ones)), middle)
    seconds |= halves(np.hstack((ones, second, ones)), middle)
    exact = stride == 1 and actuator.model == "superposed"
    return _Listed(firsts, seconds, mode.pole_rad_s, stride, longest, exact)


def _levels(count: int) -> IntArray:
    """Every list of ``count`` levels 0 and 1, shape (2^count, count)."""
    listed: IntArray = np.arange(2**count)[:, None] >> np.arange(count) & 1
    return listed


def _matched(listed: _Listed, count: int, *, slope: bool, tolerance: float) -> IntArray:
    """Return positions of commands of ``count`` impulses in a net just wide enough, shape (m, n).

    The net holds every command that leaves less than its width (superposed, on the positions).
    Those come first that leave least.
    """
    halves = [
        (first, listed.seconds[count - before])
        for before, first in listed.firsts.items()
        if count - before in listed.seconds
    ]
    damping_rad_s = listed.pole_rad_s.real
    enough = 1 if listed.exact else WANTED
    found: IntArray = np.zeros((0, count), dtype=int)
    net = max(tolerance, FINEST_NET)
    while _pairs(halves, damping_rad_s, net) > MOST_PAIRS:
        net /= 2
    while halves and net <= WIDEST_NET and _pairs(halves, damping_rad_s, net) <= MOST_PAIRS:
        caught = [_caught(*pair, damping_rad_s, net, slope=slope) for pair in halves]
        changes = np.concatenate([changes for changes, _ in caught])
        left = np.concatenate([left for _, left in caught])
        found = np.nonzero(changes[np.argsort(left, kind="stable")])[1].reshape(-1, count)
        if len(found) >= enough:
            break
        net *= 2
    return found


def _mates(
    first: _Half, second: _Half, damping_rad_s: float, net: float
) -> tuple[IntArray, IntArray, FloatArray]:
    """Return from where to where in ``first`` each of ``second`` may find mates; how far off."""
    # Damping lets what was left early decay until the last impulse, at which it counts.
    latest = np.maximum(second.ends, float(first.ends.max()))
    widths = net * np.exp(-damping_rad_s * latest)
    sought = -second.sums[0].real
    low: IntArray = np.searchsorted(first.sums[0].real, sought - widths)
    high: IntArray = np.searchsorted(first.sums[0].real, sought + widths)
    return low, high, widths


def _pairs(halves: list[tuple[_Half, _Half]], damping_rad_s: float, net: float) -> int:
    ranges = (_mates(first, second, damping_rad_s, net) for first, second in halves)
    return sum(int((high - low).sum()) for low, high, _ in ranges)


def _caught(
    first: _Half, second: _Half, damping_rad_s: float, net: float, *, slope: bool
) -> tuple[IntArray, FloatArray]:
    """Return the pairs of halves within ``net``: changes, shape (m, p), and what is left."""
    low, high, widths = _mates(first, second, damping_rad_s, net)
    sizes = high - low
    mates = np.repeat(np.arange(sizes.size), sizes)
    ones = np.arange(mates.size) - np.repeat(np.cumsum(sizes) - sizes - low, sizes)
    near = np.abs(first.sums[0, ones].imag + second.sums[0, mates].imag) <= widths[mates]
    ones, mates = ones[near], mates[near]
    sums = np.abs(first.sums[:, ones] + second.sums[:, mates])
    left = sums[0] + FREQUENCY_ERROR * sums[1] * slope
    left *= np.exp(damping_rad_s * np.maximum(first.ends[ones], second.ends[mates]))
    kept = left <= net
    return np.hstack((first.changes[ones[kept]], second.changes[mates[kept]])), left[kept]
