"""Unity-magnitude shapers of many rows by compiled Newton's method.

The starts, the steps and the order of the branches are those of `design.solvers`, so that a row
ends at the root of the single design. Newton's method runs for several starts side by side
(`design.tables.equations`): each time one has ended, the next takes its lane.

A row of parameters is ``[z, first, second of the acceleration set, first, second of the
deceleration set, shortest gap after a rising step, after a falling one, longest duration]``, all in
units of the plant's frequency [-], [rad].
"""

import functools
import math
from decimal import Decimal

import numpy as np
from numpy.typing import NDArray

from design.actuators import SETTLED_SHARE
from design.shapers.unity_magnitude import (
    LARGEST_ALPHA,
    PERIOD_RAD,
    SHORTEST_GAP_RAD,
    ZV_POLYNOMIALS,
    ZVD_POLYNOMIALS,
)
from design.solvers.newton import LARGEST_STEP_RAD, TOLERANCE
from design.solvers.search import HORIZONS_PERIODS, unit_starts
from design.tables.compiled import compiled
from design.tables.elementary import angle, near_angle
from design.tables.equations import (
    GAPS,
    LANES,
    LENGTH,
    MISS,
    MOVED,
    POLE,
    RATIO,
    Switched,
    Unknowns,
    enter,
    free_motion,
    newton_step,
)
from design.types import FloatArray

IntArray = NDArray[np.int8]

ZV = np.array(ZV_POLYNOMIALS)
ZVD = np.array(ZVD_POLYNOMIALS)
HORIZONS = np.array(HORIZONS_PERIODS)

FULL_STEPS = 12
"""Newton steps from a seed, as the single design's root finder takes [-]."""

CAPPED_STEPS = 20
"""Newton steps from a start of the branch search [-].

The single design takes 30, from all starts. Of 5 to 30 starts that lead to the fastest root one or
two need more than 20, go further astray than `ASTRAY_RAD` before they come back, or are longer than
that root by more than `LONGER_RAD`; leaving those out saves nine tenths of the work.
"""

ASTRAY_RAD = 0.3
"""How far a gap may fall below zero, or all exceed the horizon, on the way to a root [rad]."""

LONGER_RAD = 0.75 * PERIOD_RAD
"""Starts are not tried that are longer than the fastest root so far by this [rad]."""

LAST_STEP_RAD = 1e-7
"""After a step as short as this, all unknowns together, the next would be below rounding.

Convergence is quadratic.
"""

BOUND_MARGIN_RAD = 1e-3
"""A root this close to a bound is left to the pipeline [rad].

IPOPT moves a start away from a bound nearer than 0.01; of 400 such roots it came back to each.
"""

FOUND, NO_SEED, UNSURE = 0, 1, 2
"""How a row ended: at a root; no seed leads to one within bounds; the pipeline has to tell."""

SEEDS = 2
"""The polynomials shifted by the actuators' phase, then as published."""

IDLE = -1
"""Stands for a row's number in a lane that has none."""


@compiled
def _shortest(row: FloatArray, index: int) -> float:
    shortest: float = row[5] if index % 2 == 0 else row[6]
    return shortest


@compiled
def _within(row: FloatArray, gaps: FloatArray, margin: float) -> bool:
    """Whether gaps are at least the shortest and end within the horizon, with a margin."""
    total = 0.0
    for k in range(gaps.size):
        if not gaps[k] >= _shortest(row, k) + margin:
            return False
        total += gaps[k]
    ends_early: bool = total <= row[7] - margin
    return ends_early


@compiled
def _start(block: FloatArray, lane: int, table: FloatArray, row: FloatArray, tried: int) -> int:
    """Write a row's next seed that the single design would use into a lane.

    Return how many of the row's seeds are tried with that, or 0 if none was left.
    """
    z = row[0]
    while tried < SEEDS:
        shift = 0.0
        if tried == 0:
            phase = near_angle(block[RATIO + lane], block[RATIO + LANES + lane])
            shift = phase / block[POLE + LANES + lane]
        tried += 1
        before, settled = 0.0, True
        for k in range(table.shape[0]):
            polynomial = table[k, 0] + z * (table[k, 1] + z * (table[k, 2] + z * table[k, 3]))
            time = 2.0 * math.pi * polynomial
            if k % 2 == 0:
                time += shift
            block[GAPS + k * LANES + lane] = time - before
            settled = settled and time - before >= _shortest(row, k)
            before = time
        if settled or max(row[5], row[6]) <= SHORTEST_GAP_RAD:
            return tried
    return 0


@compiled
def _nearest_to_seeds(
    unknowns: Unknowns,
    table: FloatArray,
    switched: Switched,
    rows: FloatArray,
    gaps: FloatArray,
    ends: IntArray,
) -> None:
    """Write where full Newton steps end from the first seed that leads within bounds."""
    block = np.ones(LENGTH)
    row_in = np.full(LANES, IDLE)
    tried, steps = np.zeros(LANES, dtype=np.int64), np.zeros(LANES, dtype=np.int64)
    entered = 0
    ends[:] = NO_SEED
    while True:
        busy = False
        for lane in range(LANES):
            m = row_in[lane]
            if m != IDLE:
                steps[lane] += 1
                moved = block[MOVED + lane]
                if LAST_STEP_RAD < moved < np.inf and steps[lane] < FULL_STEPS:
                    busy = True
                    continue
                for k in range(gaps.shape[1]):
                    gaps[m, k] = block[GAPS + k * LANES + lane]
                if _within(rows[m], gaps[m], 0.0):
                    sure = moved <= LAST_STEP_RAD and _within(rows[m], gaps[m], BOUND_MARGIN_RAD)
                    ends[m] = FOUND if sure else UNSURE
                    m = IDLE
            while m != IDLE or entered < rows.shape[0]:
                if m == IDLE:
                    m = entered
                    entered += 1
                    enter(block, lane, rows[m])
                    tried[lane] = 0
                tried[lane] = _start(block, lane, table, rows[m], tried[lane])
                if tried[lane] > 0:
                    steps[lane] = 0
                    busy = True
                    break
                m = IDLE
            row_in[lane] = m
        if not busy:
            return
        newton_step(block, switched, unknowns, np.inf)


@compiled
def _went_astray(block: FloatArray, lane: int, size: int, horizon: float) -> bool:
    total = 0.0
    for k in range(size):
        gap = block[GAPS + k * LANES + lane]
        if not gap >= -ASTRAY_RAD:
            return True
        total += gap
    too_long: bool = total > horizon + ASTRAY_RAD
    return too_long


@compiled
def _fastest(
    unknowns: Unknowns,
    switched: Switched,
    row: FloatArray,
    unit: FloatArray,
    horizon: float,
    best: FloatArray,
    block: FloatArray,
) -> float:
    """Write the fastest root that the starts lead to; return its duration.

    The row has entered all lanes. A start ends at a root, by its last step to rounding, or astray.
    """
    size = len(unknowns)
    steps = np.full(LANES, IDLE)
    x = np.empty(size)
    free = horizon
    for k in range(size):
        free -= _shortest(row, k)
    duration = np.inf
    begun = 0
    while True:
        busy = False
        for lane in range(LANES):
            if steps[lane] != IDLE:
                steps[lane] += 1
                found = block[MISS + lane] <= TOLERANCE / 10
                lost = steps[lane] > CAPPED_STEPS or not block[MOVED + lane] < np.inf
                if not (found or lost or _went_astray(block, lane, size, horizon)):
                    busy = True
                    continue
                steps[lane] = IDLE
                total = 0.0
                for k in range(size):
                    x[k] = block[GAPS + k * LANES + lane]
                    total += x[k]
                if found and _within(row, x, 0.0) and total <= min(horizon, duration):
                    duration = total
                    best[:] = x
            if begun < unit.shape[0]:
                total = 0.0
                for k in range(size):
                    gap = _shortest(row, k) + free * unit[begun, k]
                    block[GAPS + k * LANES + lane] = gap
                    total += gap
                if total > duration + LONGER_RAD:
                    begun = unit.shape[0]
                    continue
                begun += 1
                steps[lane] = 0
                busy = True
        if not busy:
            return duration
        newton_step(block, switched, unknowns, LARGEST_STEP_RAD)


@compiled
def _of_all_branches(
    unknowns: Unknowns,
    switched: Switched,
    unit: FloatArray,
    rows: FloatArray,
    gaps: FloatArray,
    ends: IntArray,
) -> None:
    block = np.ones(LENGTH)
    for m in range(rows.shape[0]):
        row, x = rows[m], gaps[m]
        for lane in range(LANES):
            enter(block, lane, row)
        least = 0.0
        for k in range(x.size):
            least += _shortest(row, k)
        ends[m] = UNSURE
        for h in range(HORIZONS.size + 1):
            horizon = row[7] if h == HORIZONS.size else 2.0 * math.pi * HORIZONS[h]
            if h < HORIZONS.size and not 1.5 * least < horizon < row[7]:
                continue
            if _fastest(unknowns, switched, row, unit, horizon, x, block) < np.inf:
                if _within(row, x, BOUND_MARGIN_RAD):
                    ends[m] = FOUND
                break


@compiled
def _settled(first: float, second: float, band: float, decay: float) -> float:
    """Return `design.actuators.Lag.settling_time_s` in units of the plant's frequency."""
    if second == 0.0:
        return first * decay
    frequency = 1.0 / math.sqrt(second)
    damping = first * frequency / 2.0
    if damping < 1.0:
        half_period = math.pi / (frequency * math.sqrt(1.0 - damping * damping))
        extrema = math.ceil(decay / (damping * frequency * half_period)) - 1
        low, high = extrema * half_period, (extrema + 1) * half_period
    else:
        low, high = 0.0, 1.0 / frequency
        while abs(free_motion(high, first, second)[0]) > band:
            low, high = high, 2.0 * high
    while high - low > 1e-12 * high:
        middle = (low + high) / 2.0
        if abs(free_motion(middle, first, second)[0]) > band:
            low = middle
        else:
            high = middle
    return high


@compiled
def _settle(rows: FloatArray, band: float, decay: float) -> None:
    for m in range(rows.shape[0]):
        row = rows[m]
        row[5] = max(row[5], _settled(row[1], row[2], band, decay))
        row[6] = max(row[6], _settled(row[3], row[4], band, decay))


@compiled
def _not_before(angle: float, earliest: float) -> float:
    return angle + 2.0 * math.pi * math.ceil((earliest - angle) / (2.0 * math.pi))


@compiled
def _close_triangles(rows: FloatArray, gaps: FloatArray, ends: IntArray) -> None:
    """Write the gaps of `design.shapers.unity_magnitude.undamped_times_rad`."""
    block = np.ones(LENGTH)
    for m in range(rows.shape[0]):
        row = rows[m]
        enter(block, 0, row)
        p, q = block[RATIO], block[RATIO + LANES]
        beta, side = -angle(p, q), math.sqrt(p * p + q * q) / 2.0
        best = np.inf
        if 2.0 * side <= LARGEST_ALPHA:
            for sign in (1.0, -1.0):
                half = sign * angle(side, math.sqrt((1.0 - side) * (1.0 + side)))
                t2 = _not_before(half - beta, row[5])
                t3 = _not_before(2.0 * half, t2 + row[6])
                if t3 < best:
                    best = t3
                    gaps[m, 0], gaps[m, 1] = t2, t3 - t2
        ends[m] = FOUND if best <= row[7] else UNSURE


def rows_of_problems(lags: FloatArray, longest_periods: FloatArray, *, settle: bool) -> FloatArray:
    """Return the kernel's rows of parameters, shape (m, 8).

    Parameters
    ----------
    lags
        As `design.shapers.unity_magnitude.lag_parameters`, shape (m, 5) [-].
    longest_periods
        Longest shaper in periods, shape (m,) [-].
    settle
        Whether each step must settle before the next.
    """
    rows = np.empty((len(lags), 8))
    rows[:, :5] = lags
    rows[:, 5:7] = SHORTEST_GAP_RAD
    rows[:, 7] = longest_periods * PERIOD_RAD
    if settle:
        band = 1 - SETTLED_SHARE
        # In decimal: rounded rightly on every machine.
        _settle(rows, band, -float(Decimal(band).ln()))
    return rows


def closed_triangles(rows: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the gaps of undamped three-impulse shapers of superposed steps, and how rows ended."""
    gaps, ends = np.empty((len(rows), 2)), np.empty(len(rows), dtype=np.int8)
    _close_triangles(rows, gaps, ends)
    return gaps, ends


def solved(rows: FloatArray, impulses: int, *, switched: bool) -> tuple[FloatArray, IntArray]:
    """Solve the problems of many rows.

    Parameters
    ----------
    rows
        Parameters, shape (m, 8), contiguous.
    impulses
        3 for zero vibration, 5 for zero vibration and slope.
    switched
        Whether one actuator is switched, else steps are superposed.

    Returns
    -------
    tuple
        Gaps, shape (m, impulses - 1) [rad], and how each row ended, shape (m,): gaps count where
        that is `FOUND`.
    """
    size = impulses - 1
    gaps, ends = np.empty((len(rows), size)), np.empty(len(rows), dtype=np.int8)
    table = ZV if impulses == len(ZV) + 1 else ZVD
    unknowns = (0,) * size
    model: Switched = True if switched else None
    _nearest_to_seeds(unknowns, table, model, rows, gaps, ends)
    left = np.flatnonzero(ends == NO_SEED)
    if left.size:
        others, ends_of_others = np.empty((left.size, size)), np.empty(left.size, dtype=np.int8)
        _of_all_branches(unknowns, model, _starts(size), rows[left], others, ends_of_others)
        gaps[left], ends[left] = others, ends_of_others
    return gaps, ends


@functools.cache
def _starts(count: int) -> FloatArray:
    """Return the starts of the branch search over a horizon of 1, shortest first."""
    starts = unit_starts(count)
    return np.ascontiguousarray(starts[np.argsort(starts.sum(axis=1), kind="stable")])
