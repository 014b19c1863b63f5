"""Unity-magnitude shapers of many rows by compiled Newton's method.

A row ends at the root of the single design: its seeds and branches are tried in the same order.

A row of parameters is ``[z, first, second of the acceleration set, first, second of the
deceleration set, shortest gap after a rising step, after a falling one, longest duration]``, all in
units of the plant's frequency [-], [rad].
"""

import functools
import math
from collections.abc import Callable, Iterator
from decimal import Decimal
from typing import Any

import numpy as np

from design.formulations.gaps import MIN_GAP_RAD, PERIOD_RAD
from design.formulations.published_times import ZV_POLYNOMIALS, ZVD_POLYNOMIALS
from design.formulations.vector_diagram import MAX_ALPHA
from design.model.lags import SETTLED_SHARE
from design.solvers.branches import HORIZONS_PERIODS, unit_starts
from design.tables.compiled import compiled
from design.tables.elementary import angle
from design.tables.equations import LANES, LENGTH, RATIO, Switched, enter, free_motion
from design.tables.starts import (
    BOUND_MARGIN_RAD,
    FOUND,
    NO_SEED,
    UNSURE,
    Int8Array,
    fastest,
    nearest_to_seeds,
    within,
)
from design.types import FloatArray

ZV = np.array(ZV_POLYNOMIALS)
ZVD = np.array(ZVD_POLYNOMIALS)


@compiled
def _settling_time(first: float, second: float, band: float, decay: float) -> float:
    """Return `design.model.settling.settling_time_s` in units of the plant's frequency."""
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
        row[5] = max(row[5], _settling_time(row[1], row[2], band, decay))
        row[6] = max(row[6], _settling_time(row[3], row[4], band, decay))


@compiled
def _not_before(angle: float, earliest: float) -> float:
    return angle + 2.0 * math.pi * math.ceil((earliest - angle) / (2.0 * math.pi))


@compiled
def _close_triangles(rows: FloatArray, gaps: FloatArray, ends: Int8Array) -> None:
    """Write the gaps of `design.formulations.vector_diagram.undamped_times_rad`."""
    block = np.ones(LENGTH)
    for m in range(rows.shape[0]):
        row = rows[m]
        enter(block, 0, row)
        p, q = block[RATIO], block[RATIO + LANES]
        beta, side = -angle(p, q), math.sqrt(p * p + q * q) / 2.0
        best = np.inf
        if 2.0 * side <= MAX_ALPHA:
            for sign in (1.0, -1.0):
                half = sign * angle(side, math.sqrt((1.0 - side) * (1.0 + side)))
                t2 = _not_before(half - beta, row[5])
                t3 = _not_before(2.0 * half, t2 + row[6])
                if t3 < best:
                    best = t3
                    gaps[m, 0], gaps[m, 1] = t2, t3 - t2
        ends[m] = FOUND if best <= row[7] else UNSURE


def rows_of_problems(lags: FloatArray, longest_periods: FloatArray, *, settle: bool) -> FloatArray:
    """Return the kernel's rows of parameters.

    Parameters
    ----------
    lags
        As `design.formulations.lag_parameters.lag_parameters`, shape (m, 5) [-].
    longest_periods
        Longest shaper in periods, shape (m,) [-].
    settle
        Whether each step must settle before the next.

    Returns
    -------
    FloatArray
        Shape (m, 8): ``lags`` [-], the shortest gap after a rising and after a falling step, and
        the longest shaper [rad].
    """
    rows = np.empty((len(lags), 8))
    rows[:, :5] = lags
    rows[:, 5:7] = MIN_GAP_RAD
    rows[:, 7] = longest_periods * PERIOD_RAD
    if settle:
        band = 1 - SETTLED_SHARE
        # In decimal: rounded rightly on every machine.
        _settle(rows, band, -float(Decimal(band).ln()))
    return rows


def closed_triangles(rows: FloatArray) -> tuple[FloatArray, Int8Array]:
    """Return the gaps of undamped three-impulse shapers in closed form.

    Steps are superposed.

    Parameters
    ----------
    rows
        As `rows_of_problems` returns them, shape (m, 8).

    Returns
    -------
    FloatArray
        Gaps, shape (m, 2) [rad].
    Int8Array
        How each row ended, shape (m,).
    """
    gaps, ends = np.empty((len(rows), 2)), np.empty(len(rows), dtype=np.int8)
    _close_triangles(rows, gaps, ends)
    return gaps, ends


def solve_rows(rows: FloatArray, impulses: int, *, switched: bool) -> tuple[FloatArray, Int8Array]:
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
    nearest_to_seeds(unknowns, table, model, rows, gaps, ends)
    unit = _starts(size)
    for m in np.flatnonzero(ends == NO_SEED).tolist():
        ends[m] = UNSURE
        for horizon in _horizons(rows[m], size):
            if fastest(unknowns, model, rows[m], unit, horizon, gaps[m]) < np.inf:
                if within(rows[m], gaps[m], BOUND_MARGIN_RAD):
                    ends[m] = FOUND
                break
    return gaps, ends


def calls_of_rows(
    impulses: int, *, switched: bool, settle: bool, closed: bool, solved: bool
) -> Iterator[tuple[Callable[..., Any], tuple[Any, ...]]]:
    """Yield the compiled functions that rows call at once.

    Rows whose seeds lead to no root call those of `calls_of_searches` as well.

    Parameters
    ----------
    impulses, switched
        As in `solve_rows`.
    settle
        As in `rows_of_problems`.
    closed, solved
        Whether there are rows for `closed_triangles`, and whether there are others.

    Yields
    ------
    tuple
        A compiled function, and its arguments for no rows.
    """
    rows, gaps = np.empty((0, 8)), np.empty((0, impulses - 1))
    ends = np.empty(0, dtype=np.int8)
    if settle:
        yield _settle, (rows, 0.0, 0.0)
    if closed:
        yield _close_triangles, (rows, gaps, ends)
    if solved:
        model: Switched = True if switched else None
        yield nearest_to_seeds, ((0,) * (impulses - 1), ZV, model, rows, gaps, ends)


def calls_of_searches() -> Iterator[tuple[Callable[..., Any], tuple[Any, ...]]]:
    """Yield the compiled search for each size and model, with arguments.

    Few rows come to it, and nobody knows beforehand which.
    """
    models: tuple[Switched, ...] = (None, True)
    for model in models:
        for table in (ZV, ZVD):
            size = len(table)
            yield fastest, ((0,) * size, model, np.ones(8), _starts(size)[:0], 0.0, np.empty(size))


def _horizons(row: FloatArray, size: int) -> list[float]:
    """Return the horizons that are searched one after another, the row's own last [rad]."""
    after_rising, after_falling, longest = row[5:8].tolist()
    least = size // 2 * (after_rising + after_falling)
    shorter = [PERIOD_RAD * periods for periods in HORIZONS_PERIODS]
    return [*(rad for rad in shorter if 1.5 * least < rad < longest), longest]


@functools.cache
def _starts(count: int) -> FloatArray:
    """Return the starts of the branch search over a horizon of 1, shortest first."""
    starts = unit_starts(count)
    return np.ascontiguousarray(starts[np.argsort(starts.sum(axis=1), kind="stable")])
