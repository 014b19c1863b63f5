"""Every command of level 0 or 1 on some positions, as two halves that are listed and matched."""

import math
from dataclasses import dataclass

import numpy as np

from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.sampling.left import DIFFERENCE, FREQUENCY_ERROR, WANTED
from design.sampling.sample_grid import AnyIntArray
from design.types import ComplexArray, FloatArray

ADDED_PERIODS = 1.0
"""How much longer than the shaper between the samples one with more impulses may be [periods].

Each sample more doubles the number of commands; one period more is about what UMZVD takes for its
robustness, and so a price that is paid elsewhere.
"""

MAX_POSITIONS = 32
"""Positions that commands are listed on: two halves of 2^15 each. On a finer grid every second,
third, ... sample is a position, and the best are moved sample by sample afterwards [-]."""

MIN_NET = 1e-3
"""What commands leave at most in the first, finest net cast for them [-]."""

MAX_NET = 1.0
"""No command with a larger residual than an unshaped step is of interest [-]."""

MAX_PAIRS = 2_000_000
"""Pairs of halves in one net, a bound on work and memory: it is narrowed to it [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Half:
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

    changes: AnyIntArray
    sums: ComplexArray
    ends: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class ListedHalves:
    """Both halves of all commands, by their number of impulses.

    Attributes
    ----------
    firsts
        From level 0.
    seconds
        To level 1, from the level that an odd or even number of impulses before leads to.
    """

    firsts: dict[int, Half]
    seconds: dict[int, Half]
    pole_rad_s: complex
    stride: int
    longest: int
    exact: bool


def list_halves(
    impulses: Impulses, mode: Mode, actuator: Actuator, sample_time_s: float
) -> ListedHalves:
    """Return the halves of all commands of level 0 or 1 on samples.

    The commands are at most one period longer than the impulses.

    Parameters
    ----------
    impulses
        The shaper, whose duration counts.
    mode, actuator
        The plant's mode and its drive.
    sample_time_s
        Sample time, > 0 [s].

    Returns
    -------
    ListedHalves
        By number of impulses, sorted for `match_halves`; on every second, third, ... sample where
        there are too many.
    """
    longest_s = impulses.duration_s + ADDED_PERIODS * mode.period_s
    longest = math.floor(longest_s / sample_time_s)
    stride = -(-longest // MAX_POSITIONS)
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

    def halves(levels: AnyIntArray, start: int) -> dict[int, Half]:
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
            # In order of what `match_halves` looks up.
            rows = rows[np.argsort(sums[0, rows].real, kind="stable")]
            grouped[count] = Half(changes[rows], sums[:, rows], ends[rows])
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
    return ListedHalves(firsts, seconds, mode.pole_rad_s, stride, longest, exact)


def _levels(count: int) -> AnyIntArray:
    """Every list of ``count`` levels 0 and 1, shape (2^count, count)."""
    listed: AnyIntArray = np.arange(2**count)[:, None] >> np.arange(count) & 1
    return listed


def match_halves(listed: ListedHalves, count: int, *, slope: bool, tolerance: float) -> AnyIntArray:
    """Return positions of commands that leave least.

    The net that catches halves holds every command with a residual below its width (superposed, on
    the positions), and is just wide enough. Those come first that leave least.

    Parameters
    ----------
    listed
        The halves.
    count
        Number of impulses n of the commands.
    slope
        Whether the slope in frequency counts too.
    tolerance
        Width of the net at first, >= 0 [-].

    Returns
    -------
    AnyIntArray
        Numbers of positions, shape (m, n), rising; of shape (0, n) where none was caught.
    """
    halves = [
        (first, listed.seconds[count - before])
        for before, first in listed.firsts.items()
        if count - before in listed.seconds
    ]
    damping_rad_s = listed.pole_rad_s.real
    enough = 1 if listed.exact else WANTED
    found: AnyIntArray = np.zeros((0, count), dtype=int)
    net = max(tolerance, MIN_NET)
    while _pairs(halves, damping_rad_s, net) > MAX_PAIRS:
        net /= 2
    while halves and net <= MAX_NET and _pairs(halves, damping_rad_s, net) <= MAX_PAIRS:
        caught = [_catch(*pair, damping_rad_s, net, slope=slope) for pair in halves]
        changes = np.concatenate([changes for changes, _ in caught])
        left = np.concatenate([left for _, left in caught])
        found = np.nonzero(changes[np.argsort(left, kind="stable")])[1].reshape(-1, count)
        if len(found) >= enough:
            break
        net *= 2
    return found


def _mates(
    first: Half, second: Half, damping_rad_s: float, net: float
) -> tuple[AnyIntArray, AnyIntArray, FloatArray]:
    """Return from where to where in ``first`` each of ``second`` may find mates; how far off."""
    # Damping lets what was left early decay until the last impulse, at which it counts.
    latest = np.maximum(second.ends, float(first.ends.max()))
    widths = net * np.exp(-damping_rad_s * latest)
    sought = -second.sums[0].real
    low: AnyIntArray = np.searchsorted(first.sums[0].real, sought - widths)
    high: AnyIntArray = np.searchsorted(first.sums[0].real, sought + widths)
    return low, high, widths


def _pairs(halves: list[tuple[Half, Half]], damping_rad_s: float, net: float) -> int:
    ranges = (_mates(first, second, damping_rad_s, net) for first, second in halves)
    return sum(int((high - low).sum()) for low, high, _ in ranges)


def _catch(
    first: Half, second: Half, damping_rad_s: float, net: float, *, slope: bool
) -> tuple[AnyIntArray, FloatArray]:
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
