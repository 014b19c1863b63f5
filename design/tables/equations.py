"""Equations of unity-magnitude shapers and their Jacobian, several designs side by side.

They are those of `design.formulations.unity_magnitude`, differentiated by hand. What the rows claim
is recomputed in `design.tables.proofs`, apart from them.

`LANES` designs lie in one array, which is cut into runs of that length, one for each quantity. All
innermost loops go over the lanes, and nothing in them branches, so that they become vector
instructions; a separate array for each quantity would hide from the compiler that they are
apart. Complex quantities take two runs, real part first.
"""

import math
from typing import Literal

from design.formulations.symbolic import MIN_ROOT, MIN_TIME_CONSTANT
from design.tables.compiled import compiled, inlined
from design.tables.elementary import exponential, exponential_less_one, sine_and_cosine
from design.types import FloatArray

Switched = Literal[True] | None
"""None for superposed steps, not False: by its type numba omits the other model's code."""

Unknowns = tuple[int, ...]
"""As many zeros as unknowns: numba knows the length by the type, and unrolls loops."""

LANES = 32
"""Designs side by side: a few vectors of any machine, and all their runs in its nearest cache."""

MAX_UNKNOWNS = 4

PARAMETERS = 0
"""z, then first and second of the acceleration and of the deceleration set [-]."""

POLE = PARAMETERS + 5 * LANES
"""The plant's, in units of its frequency."""

RATIO = POLE + 2 * LANES
"""G_decel / G_accel at the pole."""

RATIO_SLOPE = RATIO + 2 * LANES
"""Its derivative by w."""

GAPS = RATIO_SLOPE + 2 * LANES
"""The unknowns [rad]."""

TURNS = GAPS + MAX_UNKNOWNS * LANES
"""``exp(s L)``, L the time from each step to the last."""

LEFT = TURNS + 2 * (MAX_UNKNOWNS + 1) * LANES
"""L of the present step."""

SUM = LEFT + LANES
"""V, then dV/dw, of the steps so far."""

SYSTEM = SUM + 4 * LANES
"""Jacobian, by rows, each with its equation's value last; that becomes the Newton step."""

COLUMNS = MAX_UNKNOWNS + 1
VALUE = MAX_UNKNOWNS
"""Columns of the system, and the last."""

EXCHANGED = SYSTEM + MAX_UNKNOWNS * COLUMNS * LANES
FACTOR = EXCHANGED + LANES
"""Of the elimination of an element: whether its rows change places, and the multiplier."""

STATE = FACTOR + LANES
"""Error and rate of a switched actuator."""

ERRORS_BY_GAPS = STATE + 2 * LANES
RATES_BY_GAPS = ERRORS_BY_GAPS + MAX_UNKNOWNS * LANES
"""Their derivatives by each gap."""

MOTION = RATES_BY_GAPS + MAX_UNKNOWNS * LANES
"""Matrix [a, b; c, d] that moves error and rate over a gap, by rows."""

BY_STATE = MOTION + 4 * LANES
"""What an error of 1, and a rate of 1, add to the gain of a step up, then to its slope by w."""

MISS = BY_STATE + 8 * LANES
"""The largest equation before the step [-]."""

MOVED = MISS + LANES
"""Sum of the step's lengths in all unknowns, not finite where there is none [rad]."""

LENGTH = MOVED + LANES
"""Of the array."""


@compiled
def _write(block: FloatArray, run: int, lane: int, real: float, imaginary: float) -> None:
    block[run + lane], block[run + LANES + lane] = real, imaginary


@compiled
def enter(block: FloatArray, lane: int, row: FloatArray) -> None:
    """Write a design's parameters, and what follows from them, into its lane.

    Parameters
    ----------
    block
        Working memory of all lanes, shape (LENGTH,).
    lane
        Number of the lane, from 0.
    row
        Parameters of the design, as `design.tables.kernel.rows_of_problems` has them, shape (8,).
    """
    for k in range(5):
        block[PARAMETERS + k * LANES + lane] = row[k]
    z, first_a, second_a, first_d, second_d = row[0], row[1], row[2], row[3], row[4]
    x, y = -z, math.sqrt(1.0 - z * z)
    u, v = x * x - y * y, 2.0 * x * y
    _write(block, POLE, lane, x, y)
    # 1/G of either set, and its derivative by w at w = 1.
    above, above_turned = 1.0 + first_a * x + second_a * u, first_a * y + second_a * v
    below, below_turned = 1.0 + first_d * x + second_d * u, first_d * y + second_d * v
    by_above, by_above_turned = above - 1.0 + second_a * u, above_turned + second_a * v
    by_below, by_below_turned = below - 1.0 + second_d * u, below_turned + second_d * v
    size = below * below + below_turned * below_turned
    p = (above * below + above_turned * below_turned) / size
    q = (above_turned * below - above * below_turned) / size
    _write(block, RATIO, lane, p, q)
    r = by_above - (p * by_below - q * by_below_turned)
    s = by_above_turned - (p * by_below_turned + q * by_below)
    r, s = (r * below + s * below_turned) / size, (s * below - r * below_turned) / size
    _write(block, RATIO_SLOPE, lane, r, s)
    # A rate adds second s rate over G.
    c, d = second_a - second_d * p, -second_d * q
    c, d = c * x - d * y, c * y + d * x
    _write(block, BY_STATE, lane, p - 1.0, q)
    _write(block, BY_STATE + 2 * LANES, lane, c, d)
    _write(block, BY_STATE + 4 * LANES, lane, r, s)
    c, d = c - second_d * (r * x - s * y), d - second_d * (r * y + s * x)
    _write(block, BY_STATE + 6 * LANES, lane, c, d)


@inlined
def free_motion(gap: float, first: float, second: float) -> tuple[float, float, float, float]:
    """Return the matrix that moves a lag's error and rate over a gap.

    Parameters
    ----------
    gap
        Phase of the plant, >= 0 [rad].
    first, second
        Coefficients of the lag in units of the plant's frequency [-].

    Returns
    -------
    tuple of float
        ``a, b, c, d`` of the matrix ``[a, b; c, d]`` [-].
    """
    at_once = second == 0.0
    corner = 1.0 / math.sqrt(1.0 if at_once else second)
    damping = first * corner / 2.0
    phase = corner * gap
    root = max(math.sqrt(abs(damping * damping - 1.0)), MIN_ROOT)
    swings = damping < 1.0
    exponent = -damping * phase if swings else -phase / (damping + root)
    exponent = -gap / max(first, MIN_TIME_CONSTANT) if at_once else exponent
    size = exponential(exponent)
    sine, cosine = sine_and_cosine(root * phase)
    both = exponential_less_one(-2.0 * root * phase)
    even = size * (cosine if swings else 1.0 + both / 2.0)
    odd = size * (sine if swings else -both / 2.0) / root
    return (
        size if at_once else even + damping * odd,
        0.0 if at_once else odd / corner,
        0.0 if at_once else -odd * corner,
        1.0 if at_once else even - damping * odd,
    )


@inlined
def _turn(block: FloatArray, unknowns: Unknowns) -> None:
    """Write the turns from each step to the last, and the time from the first; clear the sums."""
    size = len(unknowns)
    for lane in range(LANES):
        block[TURNS + 2 * size * LANES + lane] = 1.0
        block[TURNS + (2 * size + 1) * LANES + lane] = 0.0
        block[LEFT + lane] = 0.0
        block[STATE + lane] = block[STATE + LANES + lane] = 0.0
        for k in range(4):
            block[SUM + k * LANES + lane] = 0.0
    for i in range(size - 1, -1, -1):
        for lane in range(LANES):
            gap = block[GAPS + i * LANES + lane]
            swing = exponential(block[POLE + lane] * gap)
            sine, cosine = sine_and_cosine(block[POLE + LANES + lane] * gap)
            x, y = swing * cosine, swing * sine
            after = TURNS + 2 * (i + 1) * LANES + lane
            u, v = block[after], block[after + LANES]
            block[after - 2 * LANES] = x * u - y * v
            block[after - LANES] = x * v + y * u
            block[LEFT + lane] += gap


@inlined
def _relax(block: FloatArray, i: int) -> None:
    """Move error and rate of a switched actuator, and their derivatives, over a gap.

    The first two loops as one would be too much for the compiler to make vectors of.
    """
    lag = PARAMETERS + (1 + 2 * (i & 1)) * LANES
    for lane in range(LANES):
        first, second = block[lag + lane], block[lag + LANES + lane]
        a, b, c, d = free_motion(block[GAPS + i * LANES + lane], first, second)
        block[MOTION + lane], block[MOTION + LANES + lane] = a, b
        block[MOTION + 2 * LANES + lane], block[MOTION + 3 * LANES + lane] = c, d
    for lane in range(LANES):
        first, second = block[lag + lane], block[lag + LANES + lane]
        a, b = block[MOTION + lane], block[MOTION + LANES + lane]
        c, d = block[MOTION + 2 * LANES + lane], block[MOTION + 3 * LANES + lane]
        error, rate = block[STATE + lane], block[STATE + LANES + lane]
        error, rate = a * error + b * rate, c * error + d * rate
        block[STATE + lane], block[STATE + LANES + lane] = error, rate
        at_once = second == 0.0
        slope = -error / max(first, MIN_TIME_CONSTANT)
        bend = -(error + first * rate) / (1.0 if at_once else second)
        block[ERRORS_BY_GAPS + i * LANES + lane] = slope if at_once else rate
        block[RATES_BY_GAPS + i * LANES + lane] = 0.0 if at_once else bend
    for k in range(i):
        for lane in range(LANES):
            a, b = block[MOTION + lane], block[MOTION + LANES + lane]
            c, d = block[MOTION + 2 * LANES + lane], block[MOTION + 3 * LANES + lane]
            error = block[ERRORS_BY_GAPS + k * LANES + lane]
            rate = block[RATES_BY_GAPS + k * LANES + lane]
            block[ERRORS_BY_GAPS + k * LANES + lane] = a * error + b * rate
            block[RATES_BY_GAPS + k * LANES + lane] = c * error + d * rate


@inlined
def _add_step(block: FloatArray, switched: Switched, i: int) -> None:
    """Add to V and dV/dw what a step adds, ``v_i g_i exp(s L_i)`` with g_i 1 or the ratio.

    A switched actuator's state adds what it would leave under the new set less what under the old.
    """
    falling = i % 2 == 1
    amplitude = -1.0 if falling else 1.0
    for lane in range(LANES):
        p = block[RATIO + lane] if falling else 1.0
        q = block[RATIO + LANES + lane] if falling else 0.0
        r = block[RATIO_SLOPE + lane] if falling else 0.0
        s = block[RATIO_SLOPE + LANES + lane] if falling else 0.0
        if switched is not None:
            error, rate = block[STATE + lane], block[STATE + LANES + lane]
            p += block[BY_STATE + lane] * error + block[BY_STATE + 2 * LANES + lane] * rate
            q += block[BY_STATE + LANES + lane] * error + block[BY_STATE + 3 * LANES + lane] * rate
            r += block[BY_STATE + 4 * LANES + lane] * error
            r += block[BY_STATE + 6 * LANES + lane] * rate
            s += block[BY_STATE + 5 * LANES + lane] * error
            s += block[BY_STATE + 7 * LANES + lane] * rate
            block[STATE + lane] = error - amplitude
        x, y = block[POLE + lane], block[POLE + LANES + lane]
        u, v = block[TURNS + 2 * i * LANES + lane], block[TURNS + (2 * i + 1) * LANES + lane]
        # With w change the gain and, by s L, the exponential.
        r += block[LEFT + lane] * (p * x - q * y)
        s += block[LEFT + lane] * (p * y + q * x)
        block[SUM + lane] += amplitude * (p * u - q * v)
        block[SUM + LANES + lane] += amplitude * (p * v + q * u)
        block[SUM + 2 * LANES + lane] += amplitude * (r * u - s * v)
        block[SUM + 3 * LANES + lane] += amplitude * (r * v + s * u)


@inlined
def _add_by_state(block: FloatArray, i: int, k: int) -> None:
    """Add to the derivatives by gap k what step i adds by the state of a switched actuator."""
    amplitude = -1.0 if i % 2 == 1 else 1.0
    for lane in range(LANES):
        error = amplitude * block[ERRORS_BY_GAPS + k * LANES + lane]
        rate = amplitude * block[RATES_BY_GAPS + k * LANES + lane]
        p = block[BY_STATE + lane] * error + block[BY_STATE + 2 * LANES + lane] * rate
        q = block[BY_STATE + LANES + lane] * error + block[BY_STATE + 3 * LANES + lane] * rate
        r = block[BY_STATE + 4 * LANES + lane] * error + block[BY_STATE + 6 * LANES + lane] * rate
        s = block[BY_STATE + 5 * LANES + lane] * error + block[BY_STATE + 7 * LANES + lane] * rate
        x, y = block[POLE + lane], block[POLE + LANES + lane]
        u, v = block[TURNS + 2 * i * LANES + lane], block[TURNS + (2 * i + 1) * LANES + lane]
        r += block[LEFT + lane] * (p * x - q * y)
        s += block[LEFT + lane] * (p * y + q * x)
        block[SYSTEM + k * LANES + lane] += p * u - q * v
        block[SYSTEM + (COLUMNS + k) * LANES + lane] += p * v + q * u
        block[SYSTEM + (2 * COLUMNS + k) * LANES + lane] += r * u - s * v
        block[SYSTEM + (3 * COLUMNS + k) * LANES + lane] += r * v + s * u


@inlined
def _write_derivatives(block: FloatArray, i: int) -> None:
    """Write what the sums so far change with a gap, as a column; leave that gap behind."""
    for lane in range(LANES):
        x, y = block[POLE + lane], block[POLE + LANES + lane]
        a, b = block[SUM + lane], block[SUM + LANES + lane]
        c, d = a + block[SUM + 2 * LANES + lane], b + block[SUM + 3 * LANES + lane]
        block[SYSTEM + i * LANES + lane] = x * a - y * b
        block[SYSTEM + (COLUMNS + i) * LANES + lane] = x * b + y * a
        block[SYSTEM + (2 * COLUMNS + i) * LANES + lane] = x * c - y * d
        block[SYSTEM + (3 * COLUMNS + i) * LANES + lane] = x * d + y * c
        block[LEFT + lane] -= block[GAPS + i * LANES + lane]


@inlined
def evaluate(block: FloatArray, switched: Switched, unknowns: Unknowns) -> None:
    """Write equations and Jacobian into the system, and the largest equation.

    ``V = sum v_i g_i exp(s L_i)`` with L_i the time from step i to the last. Each gap lengthens the
    L of all steps before it: derivatives are sums over those. A switched actuator's state before a
    step depends on all gaps before it, too.

    Parameters
    ----------
    block
        Working memory of all lanes, shape (LENGTH,), with a design and unknowns in each.
    switched
        True for a switched actuator, None for superposed steps.
    unknowns
        As many zeros as unknowns.
    """
    size = len(unknowns)
    _turn(block, unknowns)
    for i in range(size + 1):
        if switched is not None and i > 0:
            _relax(block, i - 1)
        _add_step(block, switched, i)
        if switched is not None:
            for k in range(i):
                _add_by_state(block, i, k)
        if i < size:
            _write_derivatives(block, i)
    for lane in range(LANES):
        block[MISS + lane] = 0.0
    for k in range(size):
        for lane in range(LANES):
            value = block[SUM + k * LANES + lane]
            block[SYSTEM + (k * COLUMNS + VALUE) * LANES + lane] = value
            block[MISS + lane] = max(block[MISS + lane], abs(value))
