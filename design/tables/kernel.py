"""Unity-magnitude shapers of many rows by compiled Newton's method.

The equations are those of `design.shapers.unity_magnitude`, differentiated by hand; the starts, the
steps and the order of the branches are those of `design.solvers`, so that a row ends at the root of
the single design. What the rows claim is recomputed in `design.tables.proofs`.

A row of parameters is ``[z, first, second of the acceleration set, first, second of the
deceleration set, shortest gap after a rising step, after a falling one, longest duration]``, all in
units of the plant's frequency [-], [rad].
"""

import functools
import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from design.actuators import SETTLED_SHARE
from design.shapers.symbolic import SHORTEST_TIME_CONSTANT, SMALLEST_ROOT
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
from design.types import ComplexArray, FloatArray

IntArray = NDArray[np.int8]

Gains = tuple[complex, complex, complex]
"""The plant's unit pole, G_decel / G_accel there and its derivative by w."""

Switched = Literal[True] | None
"""None for superposed steps, not False: by its type numba leaves out the other model's code."""

Unknowns = tuple[int, ...]
"""As many zeros as unknowns: numba knows the length by the type, and unrolls loops."""

Work = tuple[FloatArray, FloatArray, ComplexArray, ComplexArray, ComplexArray, FloatArray, Unknowns]
"""Room for equations, Jacobian and what they are made of, taken once for all rows."""

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
"""After a step as short as this, the next would be below rounding: convergence is quadratic."""

BOUND_MARGIN_RAD = 1e-3
"""A root this close to a bound is left to the pipeline [rad].

IPOPT moves a start away from a bound nearer than 0.01; of 400 such roots it came back to each.
"""

FOUND, NO_SEED, UNSURE = 0, 1, 2
"""How a row ended: at a root; no seed leads to one within bounds; the pipeline has to tell."""


@compiled
def _solve(matrix: FloatArray, right: FloatArray, unknowns: Unknowns) -> bool:
    """Solve in place by elimination with row pivots; False if the matrix is singular."""
    size = len(unknowns)
    for column in range(size):
        pivot = column
        for row in range(column + 1, size):
            if abs(matrix[row, column]) > abs(matrix[pivot, column]):
                pivot = row
        if not abs(matrix[pivot, column]) > 0.0:
            return False
        if pivot != column:
            for k in range(column, size):
                matrix[column, k], matrix[pivot, k] = matrix[pivot, k], matrix[column, k]
            right[column], right[pivot] = right[pivot], right[column]
        inverse = 1.0 / matrix[column, column]
        for row in range(column + 1, size):
            factor = matrix[row, column] * inverse
            for k in range(column + 1, size):
                matrix[row, k] -= factor * matrix[column, k]
            right[row] -= factor * right[column]
    for row in range(size - 1, -1, -1):
        for k in range(row + 1, size):
            right[row] -= matrix[row, k] * right[k]
        right[row] /= matrix[row, row]
    return True


@compiled
def _gains(row: FloatArray) -> Gains:
    """Return the unit pole, G_decel / G_accel there and its derivative by w."""
    z, first_a, second_a, first_d, second_d = row[0], row[1], row[2], row[3], row[4]
    s = complex(-z, math.sqrt(1.0 - z * z))
    below = 1.0 + s * (first_d + s * second_d)
    ratio = (1.0 + s * (first_a + s * second_a)) / below
    slope = s * (first_a + 2.0 * second_a * s - ratio * (first_d + 2.0 * second_d * s)) / below
    return s, ratio, slope


@compiled
def _fill(
    values: FloatArray,
    jacobian: FloatArray,
    totals: ComplexArray,
    by_gap: ComplexArray,
    unknowns: Unknowns,
) -> float:
    """Write complex equations and derivatives as real ones; return the largest equation."""
    size = len(unknowns)
    miss = 0.0
    for k in range(size // 2):
        values[2 * k], values[2 * k + 1] = totals[k].real, totals[k].imag
        for j in range(size):
            jacobian[2 * k, j], jacobian[2 * k + 1, j] = by_gap[k, j].real, by_gap[k, j].imag
    for k in range(size):
        # Not a number must come out as such: no comparison holds for it.
        miss = max(miss, abs(values[k])) if abs(values[k]) == abs(values[k]) else np.nan
        if miss != miss:
            return miss
    return miss


@compiled
def _superposed(gains: Gains, gaps: FloatArray, work: Work) -> float:
    """Evaluate equations and Jacobian of superposed steps; return the largest equation.

    ``V = sum v_i exp(s L_i)`` with L_i the time from step i to the last, v_i = 1 or -ratio.
    Each gap lengthens the L of all steps before it: derivatives are sums over those.
    """
    values, jacobian, turns, totals, by_gap, _, unknowns = work
    s, ratio, slope = gains
    size = len(unknowns)
    turns[size] = 1.0
    left = 0.0
    for i in range(size - 1, -1, -1):
        swing = math.exp(s.real * gaps[i])
        angle = s.imag * gaps[i]
        turns[i] = turns[i + 1] * complex(swing * math.cos(angle), swing * math.sin(angle))
        left += gaps[i]
    vector, change = 0j, 0j
    for i in range(size + 1):
        if i % 2 == 0:
            term = turns[i]
            change += term * s * left
        else:
            term = -ratio * turns[i]
            change += term * s * left - slope * turns[i]
        vector += term
        if i < size:
            by_gap[0, i] = s * vector
            by_gap[1, i] = s * (change + vector)
            left -= gaps[i]
    totals[0], totals[1] = vector, change
    return _fill(values, jacobian, totals, by_gap, unknowns)


@compiled
def _free_motion(gap: float, first: float, second: float) -> tuple[float, float, float, float]:
    """Return the matrix [a, b; c, d] that moves a lag's error and rate over a gap."""
    if second == 0.0:
        return math.exp(-gap / max(first, SHORTEST_TIME_CONSTANT)), 0.0, 0.0, 1.0
    corner = 1.0 / math.sqrt(second)
    damping = first * corner / 2.0
    phase = corner * gap
    root = max(math.sqrt(abs(damping * damping - 1.0)), SMALLEST_ROOT)
    if damping < 1.0:
        size = math.exp(-damping * phase)
        even, odd = size * math.cos(root * phase), size * math.sin(root * phase) / root
    else:
        size = math.exp(-phase / (damping + root))
        both = math.expm1(-2.0 * root * phase)
        even, odd = size * (1.0 + both / 2.0), -size * both / (2.0 * root)
    return even + damping * odd, odd / corner, -odd * corner, even - damping * odd


@compiled
def _switched(gains: Gains, row: FloatArray, gaps: FloatArray, work: Work) -> float:
    """Evaluate equations and Jacobian of a switched actuator; return the largest equation.

    Step i adds ``g_i (v_i + r_i) - g_(i-1) r_(i-1)`` with ``r = second s rate - error``: what the
    actuator's state would leave under the new set less what under the old. State and rate before a
    step depend on all gaps before it; `states` holds those derivatives.
    """
    values, jacobian, turns, totals, by_gap, states, unknowns = work
    s, ratio, slope = gains
    size = len(unknowns)
    turns[size] = 1.0
    left = 0.0
    for i in range(size - 1, -1, -1):
        swing = math.exp(s.real * gaps[i])
        angle = s.imag * gaps[i]
        turns[i] = turns[i + 1] * complex(swing * math.cos(angle), swing * math.sin(angle))
        left += gaps[i]
        by_gap[0, i] = by_gap[1, i] = 0j
    vector, change = 0j, 0j
    error, rate = 0.0, 0.0
    for i in range(size + 1):
        rising = i % 2 == 0
        amplitude = 1.0 if rising else -1.0
        g_new, g_old, slope_new, slope_old = 1.0 + 0j, ratio, 0j, slope
        first_old, second_old, second_new = row[3], row[4], row[2]
        if not rising:
            g_new, g_old, slope_new, slope_old = ratio, 1.0 + 0j, slope, 0j
            first_old, second_old, second_new = row[1], row[2], row[4]
        added, added_slope = g_new * amplitude, slope_new * amplitude
        if i > 0:
            a, b, c, d = _free_motion(gaps[i - 1], first_old, second_old)
            error, rate = a * error + b * rate, c * error + d * rate
            for k in range(i - 1):
                e_k, r_k = states[0, k], states[1, k]
                states[0, k], states[1, k] = a * e_k + b * r_k, c * e_k + d * r_k
            if second_old == 0.0:
                states[0, i - 1] = -error / max(first_old, SHORTEST_TIME_CONSTANT)
                states[1, i - 1] = 0.0
            else:
                states[0, i - 1] = rate
                states[1, i - 1] = -(error + first_old * rate) / second_old
            # What an error and a rate add, and how that changes with w.
            by_error, by_error_slope = g_old - g_new, slope_old - slope_new
            by_rate = s * (g_new * second_new - g_old * second_old)
            by_rate_slope = s * (slope_new * second_new - slope_old * second_old) + by_rate
            added += by_error * error + by_rate * rate
            added_slope += by_error_slope * error + by_rate_slope * rate
            for k in range(i):
                one = (by_error * states[0, k] + by_rate * states[1, k]) * turns[i]
                two = (by_error_slope * states[0, k] + by_rate_slope * states[1, k]) * turns[i]
                by_gap[0, k] += one
                by_gap[1, k] += two + one * s * left
        error -= amplitude
        vector += added * turns[i]
        change += (added_slope + added * s * left) * turns[i]
        if i < size:
            by_gap[0, i] += s * vector
            by_gap[1, i] += s * (change + vector)
            left -= gaps[i]
    totals[0], totals[1] = vector, change
    return _fill(values, jacobian, totals, by_gap, unknowns)


@compiled
def _workspace(unknowns: Unknowns) -> Work:
    size = len(unknowns)
    return (
        np.empty(size),
        np.empty((size, size)),
        np.empty(size + 1, dtype=np.complex128),
        np.empty(2, dtype=np.complex128),
        np.empty((2, size), dtype=np.complex128),
        np.empty((2, size)),
        unknowns,
    )


@compiled
def _equations(
    switched: Switched, gains: Gains, row: FloatArray, gaps: FloatArray, work: Work
) -> float:
    if switched is None:
        return _superposed(gains, gaps, work)
    return _switched(gains, row, gaps, work)


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
def _from_seed(
    switched: Switched, gains: Gains, row: FloatArray, gaps: FloatArray, work: Work
) -> bool:
    """Take full Newton steps in place; return whether they converged."""
    for _ in range(FULL_STEPS):
        miss = _equations(switched, gains, row, gaps, work)
        if not math.isfinite(miss) or not _solve(work[1], work[0], work[6]):
            return False
        longest = 0.0
        for k in range(gaps.size):
            gaps[k] -= work[0][k]
            longest = max(longest, abs(work[0][k]))
        if longest <= LAST_STEP_RAD:
            return True
    return False


@compiled
def _seed(table: FloatArray, row: FloatArray, shift: float, gaps: FloatArray) -> bool:
    """Write the gaps of a seed; return whether the single design would use it."""
    z = row[0]
    before, settled = 0.0, True
    for k in range(gaps.size):
        polynomial = table[k, 0] + z * (table[k, 1] + z * (table[k, 2] + z * table[k, 3]))
        time = 2.0 * math.pi * polynomial
        if k % 2 == 0:
            time += shift
        gaps[k] = time - before
        before = time
        settled = settled and gaps[k] >= _shortest(row, k)
    return settled or max(row[5], row[6]) <= SHORTEST_GAP_RAD


@compiled
def _nearest_to_seeds(
    unknowns: Unknowns,
    table: FloatArray,
    switched: Switched,
    rows: FloatArray,
    gaps: FloatArray,
    ends: IntArray,
) -> None:
    work = _workspace(unknowns)
    for m in range(rows.shape[0]):
        row, x = rows[m], gaps[m]
        gains = _gains(row)
        phase = math.atan2(gains[1].imag, gains[1].real) / gains[0].imag
        ends[m] = NO_SEED
        for shift in (phase, 0.0):
            if not _seed(table, row, shift, x):
                continue
            converged = _from_seed(switched, gains, row, x, work)
            if _within(row, x, 0.0):
                sure = converged and _within(row, x, BOUND_MARGIN_RAD)
                ends[m] = FOUND if sure else UNSURE
                break


@compiled
def _from_start(
    switched: Switched, gains: Gains, row: FloatArray, horizon: float, gaps: FloatArray, work: Work
) -> bool:
    """Take capped Newton steps in place; return whether they ended at a root."""
    size = gaps.size
    for iteration in range(CAPPED_STEPS + 1):
        total = 0.0
        for k in range(size):
            total += gaps[k]
            if not gaps[k] >= -ASTRAY_RAD:
                return False
        if total > horizon + ASTRAY_RAD:
            return False
        miss = _equations(switched, gains, row, gaps, work)
        if not math.isfinite(miss):
            return False
        found = miss <= TOLERANCE / 10
        if iteration == CAPPED_STEPS and not found:
            return False
        largest = 0.0
        for k in range(size):
            for j in range(size):
                largest = max(largest, abs(work[1][k, j]))
        for k in range(size):
            work[1][k, k] += max(1e-14 * largest, 1e-300)
        if not _solve(work[1], work[0], work[6]):
            return False
        longest = 0.0
        for k in range(size):
            longest = max(longest, abs(work[0][k]))
        factor = min(1.0, LARGEST_STEP_RAD / max(longest, 1e-300))
        for k in range(size):
            gaps[k] -= factor * work[0][k]
        if found:
            return True  # and by its last step to rounding
    return False


@compiled
def _fastest(
    switched: Switched,
    gains: Gains,
    row: FloatArray,
    unit: FloatArray,
    horizon: float,
    best: FloatArray,
    work: Work,
) -> float:
    """Write the fastest root that the starts lead to; return its duration."""
    size = best.size
    x = np.empty(size)
    free = horizon
    for k in range(size):
        free -= _shortest(row, k)
    duration = np.inf
    for start in range(unit.shape[0]):
        total = 0.0
        for k in range(size):
            x[k] = _shortest(row, k) + free * unit[start, k]
            total += x[k]
        if total > duration + LONGER_RAD:
            break
        if _from_start(switched, gains, row, horizon, x, work) and _within(row, x, 0.0):
            total = 0.0
            for k in range(size):
                total += x[k]
            if total <= horizon and total < duration:
                duration = total
                for k in range(size):
                    best[k] = x[k]
    return duration


@compiled
def _of_all_branches(
    unknowns: Unknowns,
    switched: Switched,
    unit: FloatArray,
    rows: FloatArray,
    gaps: FloatArray,
    ends: IntArray,
) -> None:
    work = _workspace(unknowns)
    for m in range(rows.shape[0]):
        row, x = rows[m], gaps[m]
        gains = _gains(row)
        least = 0.0
        for k in range(x.size):
            least += _shortest(row, k)
        ends[m] = UNSURE
        for h in range(HORIZONS.size + 1):
            horizon = row[7] if h == HORIZONS.size else 2.0 * math.pi * HORIZONS[h]
            if h < HORIZONS.size and not 1.5 * least < horizon < row[7]:
                continue
            if _fastest(switched, gains, row, unit, horizon, x, work) < np.inf:
                if _within(row, x, BOUND_MARGIN_RAD):
                    ends[m] = FOUND
                break


@compiled
def _settled(first: float, second: float, band: float) -> float:
    """Return `design.actuators.Lag.settling_time_s` in units of the plant's frequency."""
    if second == 0.0:
        return -first * math.log(band)
    frequency = 1.0 / math.sqrt(second)
    damping = first * frequency / 2.0
    if damping < 1.0:
        half_period = math.pi / (frequency * math.sqrt(1.0 - damping * damping))
        extrema = math.ceil(-math.log(band) / (damping * frequency * half_period)) - 1
        low, high = extrema * half_period, (extrema + 1) * half_period
    else:
        low, high = 0.0, 1.0 / frequency
        while abs(_free_motion(high, first, second)[0]) > band:
            low, high = high, 2.0 * high
    while high - low > 1e-12 * high:
        middle = (low + high) / 2.0
        if abs(_free_motion(middle, first, second)[0]) > band:
            low = middle
        else:
            high = middle
    return high


@compiled
def _settle(rows: FloatArray, band: float) -> None:
    for m in range(rows.shape[0]):
        row = rows[m]
        row[5] = max(row[5], _settled(row[1], row[2], band))
        row[6] = max(row[6], _settled(row[3], row[4], band))


@compiled
def _not_before(angle: float, earliest: float) -> float:
    return angle + 2.0 * math.pi * math.ceil((earliest - angle) / (2.0 * math.pi))


@compiled
def _close_triangles(rows: FloatArray, gaps: FloatArray, ends: IntArray) -> None:
    """Write the gaps of `design.shapers.unity_magnitude.undamped_times_rad`."""
    for m in range(rows.shape[0]):
        row = rows[m]
        ratio = _gains(row)[1]
        beta = -math.atan2(ratio.imag, ratio.real)
        best = np.inf
        if abs(ratio) <= LARGEST_ALPHA:
            for sign in (1.0, -1.0):
                half = sign * math.acos(abs(ratio) / 2.0)
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
        _settle(rows, 1 - SETTLED_SHARE)
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
