"""Where Newton's method ends from the starts of many rows: seeds, then all branches of one.

The starts, the steps and the order of the branches are those of `design.solvers`. Newton's method
runs from several starts side by side: each time one has ended, the next takes its lane.
"""

import math

import numpy as np
from numpy.typing import NDArray

from design.formulations.gaps import MIN_GAP_RAD, PERIOD_RAD
from design.solvers.newton import MAX_STEP_RAD, TOLERANCE
from design.tables.compiled import compiled
from design.tables.elementary import near_angle
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
)
from design.tables.newton import newton_step
from design.types import FloatArray

Int8Array = NDArray[np.int8]

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
def within(row: FloatArray, gaps: FloatArray, margin: float) -> bool:
    """Return whether gaps are within their bounds by a margin.

    They are at least the shortest, and end within the horizon.

    Parameters
    ----------
    row
        Parameters of the design, shape (8,).
    gaps
        The unknowns, shape (n,) [rad].
    margin
        Margin of both bounds [rad].

    Returns
    -------
    bool
        False for gaps that are not numbers.
    """
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
        if settled or max(row[5], row[6]) <= MIN_GAP_RAD:
            return tried
    return 0


@compiled
def nearest_to_seeds(
    unknowns: Unknowns,
    table: FloatArray,
    switched: Switched,
    rows: FloatArray,
    gaps: FloatArray,
    ends: Int8Array,
) -> None:
    """Write where full Newton steps end from the first seed within bounds.

    Parameters
    ----------
    unknowns
        As many zeros as unknowns.
    table
        The seeds, in the order in which they are tried.
    switched
        True for a switched actuator, None for superposed steps.
    rows
        Parameters of the designs, shape (m, 8).
    gaps
        Written: the gaps found, shape (m, n) [rad].
    ends
        Written: how each row ended, shape (m,).
    """
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
                if within(rows[m], gaps[m], 0.0):
                    sure = moved <= LAST_STEP_RAD and within(rows[m], gaps[m], BOUND_MARGIN_RAD)
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
def fastest(
    unknowns: Unknowns,
    switched: Switched,
    row: FloatArray,
    unit: FloatArray,
    horizon: float,
    best: FloatArray,
) -> float:
    """Write the fastest root that the starts lead to; return its duration.

    A start ends at a root, by its last step to rounding, or astray.

    Parameters
    ----------
    unknowns
        As many zeros as unknowns.
    switched
        True for a switched actuator, None for superposed steps.
    row
        Parameters of the design, shape (8,).
    unit
        Starts as shares of the time that the shortest gaps leave, shape (k, n) [-].
    horizon
        Longest shaper [rad].
    best
        Written: the gaps of the fastest root, shape (n,) [rad].

    Returns
    -------
    float
        Duration of that root [rad]; inf if there is none.
    """
    size = len(unknowns)
    block = np.ones(LENGTH)
    for lane in range(LANES):
        enter(block, lane, row)
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
                if found and within(row, x, 0.0) and total <= min(horizon, duration):
                    duration = total
                    for k in range(size):
                        best[k] = x[k]
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
        newton_step(block, switched, unknowns, MAX_STEP_RAD)
