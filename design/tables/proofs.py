"""Certificates of many rows: actuator and mode carried from step to step, compiled.

Apart from the equations that the kernel solves: there the vibration is a sum of transfer functions
at the plant's pole; here the states of real lags and a real oscillator pass from step to step and
are taken apart at the end, as in `design.analysis.certificate`, whose limits and differencing in
frequency these are. Only exponential, sine and cosine are common to both.

Between steps, in units of the plant's frequency, with e the distance of a lag from the command::

    e + first e' + second e'' = 0
    q'' + 2 z r q' + r^2 q = r^2 sum e        q counted from the command, r near 1; p = q' / r

q is a free swing and what the lags force, ``a e + b e'``, whose a and b follow by comparison.

`LANES` rows lie in one array, which is cut into runs of that length, one for each quantity. All
innermost loops go over the lanes, and nothing in them branches, so that they become vector
instructions.
"""

import math
from typing import Literal

import numpy as np

from design.analysis.certificate import STEP_PHASE_RAD
from design.tables.compiled import compiled, inlined
from design.tables.elementary import exponential, sine_and_cosine
from design.types import FloatArray

Optional = Literal[True] | None
"""None for no, not False: by its type numba omits what is not wanted."""

CRITICAL_ROOT = 1e-7
"""Distance of a lag's poles from critical damping below which the double-pole form is exact [-]."""

LANES = 32
"""Rows side by side: a few vectors of any machine, and all their runs in its nearest cache."""

FREQUENCIES = 3
OWN, BELOW, ABOVE = (np.intp(f) for f in range(FREQUENCIES))
"""The plant's own, and those on either side whose difference makes the slope.

NumPy's numbers: numba would compile a function that takes them anew for each of Python's.
"""

ACCEL, DECEL = (np.intp(k) for k in range(2))
"""The two sets."""

DAMPING = 0
"""z, then sqrt(1 - z^2)."""

DURATION = DAMPING + 2 * LANES
"""From the first step to the last."""

GAP = DURATION + LANES
"""From the step before to the present one."""

TURN = GAP + LANES
"""Of the free swing over that gap at the plant's own frequency, real and imaginary part."""

LAGS = TURN + 2 * LANES
"""first and second of the acceleration set, then of the deceleration set."""

AT_STEP = LAGS + 4 * LANES
"""e and e' of the acceleration set, then of the deceleration set, right after the step before."""

STATES = AT_STEP + 4 * LANES
"""The same at present."""

RATIOS = STATES + 4 * LANES
"""r of each frequency."""

FORCED = RATIOS + FREQUENCIES * LANES
"""At each frequency, what the acceleration set forces, q by e, q by e', p by e, p by e', and what
the deceleration set forces."""

SWING = FORCED + 8 * FREQUENCIES * LANES
"""At each frequency q, p."""

UNIT = SWING + 2 * FREQUENCIES * LANES
"""Residual of an unshaped step."""

RESULTS = UNIT + LANES
"""Residual, then slope."""

LENGTH = RESULTS + 2 * LANES
"""Of the array."""


@inlined
def _forcing(z: float, r: float, first: float, second: float) -> tuple[float, float, float, float]:
    """Return what a lag's e and e' force: q by each, p by each."""
    swings = second > 0.0
    lag = second if swings else 1.0
    alpha = lag * r * r - 1.0
    beta = 2.0 * z * r * lag - first
    below = alpha * alpha + beta * (beta - alpha * first) / lag
    a = r * r * lag * (alpha - beta * first / lag) / below
    b = -r * r * lag * beta / below
    turn = r * first
    alone = turn / (1.0 - 2.0 * z * turn + turn * turn)
    return (
        a if swings else turn * alone,
        b if swings else 0.0,
        -b / lag / r if swings else -alone,
        (a - b * first / lag) / r if swings else 0.0,
    )


@inlined
def _relax_lag(gap: float, first: float, second: float, e: float, d: float) -> tuple[float, float]:
    """Return a lag's e and e' after a gap."""
    has_rate, has_error = second > 0.0, first > 0.0
    corner = 1.0 / math.sqrt(second if has_rate else 1.0)
    damping = first * corner / 2.0
    phase = corner * gap
    squared = damping * damping - 1.0
    root = math.sqrt(abs(squared))
    critical, swings = root < CRITICAL_ROOT, squared < 0.0
    apart = 1.0 if critical else root
    slow = -phase / (damping + root)
    slow = -damping * phase if critical or swings else slow
    slow = slow if has_rate else -gap / (first if has_error else 1.0)
    decay, fast = exponential(slow), exponential(-phase * (damping + root))
    sine, cosine = sine_and_cosine(root * phase)
    even = decay * cosine if swings else (decay + fast) / 2.0
    odd = decay * sine / apart if swings else (decay - fast) / (2.0 * apart)
    even = decay if critical else even
    odd = decay * phase if critical else odd
    moved = even * e + odd * (damping * e + d / corner)
    rate = even * d - odd * (damping * d + corner * e)
    at_once = e * decay if has_error else e
    return moved if has_rate else at_once, rate if has_rate else (0.0 if has_error else d)


@inlined
def _little_turn(x: float, y: float) -> tuple[float, float]:
    """Return the exponential of at most `STEP_PHASE_RAD`: the next term is below rounding."""
    u, v = 1.0 + x / 3.0, y / 3.0
    u, v = 1.0 + (x * u - y * v) / 2.0, (x * v + y * u) / 2.0
    return 1.0 + x * u - y * v, x * v + y * u


@inlined
def _write_forcing(block: FloatArray, f: np.intp, k: np.intp) -> None:
    """Write what a lag's e and e' force at a frequency: q by each, p by each."""
    out, lags = FORCED + (8 * f + 4 * k) * LANES, LAGS + 2 * k * LANES
    for lane in range(LANES):
        z, r = block[DAMPING + lane], block[RATIOS + f * LANES + lane]
        first, second = block[lags + lane], block[lags + LANES + lane]
        a, b, c, d = _forcing(z, r, first, second)
        block[out + lane], block[out + LANES + lane] = a, b
        block[out + 2 * LANES + lane], block[out + 3 * LANES + lane] = c, d


@inlined
def _begin(block: FloatArray) -> None:
    """Put all at rest; write the frequencies, and the residual of an unshaped step."""
    for k in range(8):
        for lane in range(LANES):
            block[AT_STEP + k * LANES + lane] = 0.0
    for k in range(2 * FREQUENCIES):
        for lane in range(LANES):
            block[SWING + k * LANES + lane] = 0.0
    for lane in range(LANES):
        step = STEP_PHASE_RAD / max(1.0, block[DURATION + lane])
        block[RATIOS + lane] = 1.0
        block[RATIOS + LANES + lane], block[RATIOS + 2 * LANES + lane] = 1.0 - step, 1.0 + step
    _write_forcing(block, OWN, ACCEL)
    for lane in range(LANES):
        # Through the acceleration set; an ideal one forces nothing.
        q, p = block[FORCED + lane] - 1.0, block[FORCED + 2 * LANES + lane]
        x, y = -q - block[DAMPING + lane] * p, block[DAMPING + LANES + lane] * p
        block[UNIT + lane] = math.sqrt(x * x + y * y)


@inlined
def _begin_turn(block: FloatArray) -> None:
    for lane in range(LANES):
        gap = block[GAP + lane]
        decay = exponential(-block[DAMPING + lane] * gap)
        sine, cosine = sine_and_cosine(block[DAMPING + LANES + lane] * gap)
        block[TURN + lane], block[TURN + LANES + lane] = decay * cosine, decay * sine


@inlined
def _relax(block: FloatArray, k: np.intp) -> None:
    """Move a lag over the gap."""
    state, lags = STATES + 2 * k * LANES, LAGS + 2 * k * LANES
    for lane in range(LANES):
        first, second = block[lags + lane], block[lags + LANES + lane]
        e, d = block[state + lane], block[state + LANES + lane]
        e, d = _relax_lag(block[GAP + lane], first, second, e, d)
        block[state + lane], block[state + LANES + lane] = e, d


@inlined
def _swing(block: FloatArray, f: np.intp) -> None:
    """Move the oscillator over the gap, the lags being over it already."""
    swing, forced = SWING + 2 * f * LANES, FORCED + 8 * f * LANES
    for lane in range(LANES):
        # The free part of the swing turns by itself.
        e, d = block[AT_STEP + lane], block[AT_STEP + LANES + lane]
        q, p = block[swing + lane], block[swing + LANES + lane]
        q -= block[forced + lane] * e + block[forced + LANES + lane] * d
        p -= block[forced + 2 * LANES + lane] * e + block[forced + 3 * LANES + lane] * d
        e, d = block[AT_STEP + 2 * LANES + lane], block[AT_STEP + 3 * LANES + lane]
        q -= block[forced + 4 * LANES + lane] * e + block[forced + 5 * LANES + lane] * d
        p -= block[forced + 6 * LANES + lane] * e + block[forced + 7 * LANES + lane] * d
        z, root = block[DAMPING + lane], block[DAMPING + LANES + lane]
        more = (block[RATIOS + f * LANES + lane] - 1.0) * block[GAP + lane]
        u, v = _little_turn(-z * more, root * more)
        x, y = block[TURN + lane], block[TURN + LANES + lane]
        c, s = x * u - y * v, (x * v + y * u) / root
        q, p = c * q + s * (z * q + p), c * p - s * (q + z * p)
        e, d = block[STATES + lane], block[STATES + LANES + lane]
        q += block[forced + lane] * e + block[forced + LANES + lane] * d
        p += block[forced + 2 * LANES + lane] * e + block[forced + 3 * LANES + lane] * d
        e, d = block[STATES + 2 * LANES + lane], block[STATES + 3 * LANES + lane]
        q += block[forced + 4 * LANES + lane] * e + block[forced + 5 * LANES + lane] * d
        p += block[forced + 6 * LANES + lane] * e + block[forced + 7 * LANES + lane] * d
        block[swing + lane], block[swing + LANES + lane] = q, p


@inlined
def _take_step(block: FloatArray, switched: Optional, into: np.intp) -> None:
    """Move the command up through the acceleration set, or down through the deceleration set."""
    amplitude = 1.0 - 2.0 * into
    new, old = STATES + 2 * into * LANES, STATES + 2 * (1 - into) * LANES
    lags = LAGS + 2 * into * LANES
    for lane in range(LANES):
        e, d = block[new + lane], block[new + LANES + lane]
        if switched is not None:
            # One actuator: its state passes to the other set.
            e, d = e + block[old + lane], d + block[old + LANES + lane]
            block[old + lane] = block[old + LANES + lane] = 0.0
        ideal = block[lags + lane] + block[lags + LANES + lane] == 0.0
        block[new + lane] = 0.0 if ideal else e - amplitude
        block[new + LANES + lane] = 0.0 if ideal else d
    for k in range(4):
        for lane in range(LANES):
            block[AT_STEP + k * LANES + lane] = block[STATES + k * LANES + lane]
    for f in range(FREQUENCIES):
        for lane in range(LANES):
            block[SWING + 2 * f * LANES + lane] -= amplitude


@inlined
def _end(block: FloatArray, f: np.intp) -> None:
    """Replace the swing by its free part, turned back from the last step to the first."""
    swing, forced = SWING + 2 * f * LANES, FORCED + 8 * f * LANES
    for lane in range(LANES):
        e, d = block[STATES + lane], block[STATES + LANES + lane]
        q, p = block[swing + lane], block[swing + LANES + lane]
        q -= block[forced + lane] * e + block[forced + LANES + lane] * d
        p -= block[forced + 2 * LANES + lane] * e + block[forced + 3 * LANES + lane] * d
        e, d = block[STATES + 2 * LANES + lane], block[STATES + 3 * LANES + lane]
        q -= block[forced + 4 * LANES + lane] * e + block[forced + 5 * LANES + lane] * d
        p -= block[forced + 6 * LANES + lane] * e + block[forced + 7 * LANES + lane] * d
        z, root = block[DAMPING + lane], block[DAMPING + LANES + lane]
        off = (1.0 - block[RATIOS + f * LANES + lane]) * block[DURATION + lane]
        # The first step is the origin of V(w).
        u, v = _little_turn(-z * off, root * off)
        x, y = -q - z * p, root * p
        block[swing + lane], block[swing + LANES + lane] = x * u - y * v, x * v + y * u


@inlined
def _write_results(block: FloatArray) -> None:
    for lane in range(LANES):
        x, y = block[SWING + lane], block[SWING + LANES + lane]
        block[RESULTS + lane] = math.sqrt(x * x + y * y) / block[UNIT + lane]
        x = block[SWING + 4 * LANES + lane] - block[SWING + 2 * LANES + lane]
        y = block[SWING + 5 * LANES + lane] - block[SWING + 3 * LANES + lane]
        apart = block[RATIOS + 2 * LANES + lane] - block[RATIOS + LANES + lane]
        block[RESULTS + LANES + lane] = math.sqrt(x * x + y * y) / apart / block[UNIT + lane]


@compiled
def prove_rows(
    switched: Optional,
    slopes: Optional,
    lags: FloatArray,
    w: FloatArray,
    times: FloatArray,
    out: FloatArray,
) -> None:
    """Write the figures of each row.

    Parameters
    ----------
    switched, slopes
        None, or anything: whether the sets are switched, and whether slopes are wanted.
    lags, w, times
        Damping ratio and lags, shape (m, 5), natural frequencies, shape (m,) [rad/s], and times of
        the impulses, shape (m, n) [s].
    out
        Where they go, shape (m, 2) [-].
    """
    block = np.ones(LENGTH)
    for start in range(0, times.shape[0], LANES):
        for lane in range(LANES):
            m = min(start + lane, times.shape[0] - 1)
            z = lags[m, 0]
            block[DAMPING + lane], block[DAMPING + LANES + lane] = z, math.sqrt(1.0 - z * z)
            for k in range(4):
                block[LAGS + k * LANES + lane] = lags[m, 1 + k]
            block[DURATION + lane] = w[m] * times[m, times.shape[1] - 1]
        _begin(block)
        _write_forcing(block, OWN, DECEL)
        if slopes is not None:
            _write_forcing(block, BELOW, ACCEL)
            _write_forcing(block, BELOW, DECEL)
            _write_forcing(block, ABOVE, ACCEL)
            _write_forcing(block, ABOVE, DECEL)
        _take_step(block, switched, ACCEL)
        for i in range(1, times.shape[1]):
            for lane in range(LANES):
                m = min(start + lane, times.shape[0] - 1)
                block[GAP + lane] = w[m] * (times[m, i] - times[m, i - 1])
            rising = i % 2 == 0
            if switched is None or not rising:
                _relax(block, ACCEL)
            if switched is None or rising:
                _relax(block, DECEL)
            _begin_turn(block)
            _swing(block, OWN)
            if slopes is not None:
                _swing(block, BELOW)
                _swing(block, ABOVE)
            if rising:
                _take_step(block, switched, ACCEL)
            else:
                _take_step(block, switched, DECEL)
        _end(block, OWN)
        if slopes is not None:
            _end(block, BELOW)
            _end(block, ABOVE)
        _write_results(block)
        for lane in range(min(LANES, times.shape[0] - start)):
            out[start + lane, 0] = block[RESULTS + lane]
            out[start + lane, 1] = np.nan if slopes is None else block[RESULTS + LANES + lane]


def proven(
    lags: FloatArray,
    natural_frequencies_rad_s: FloatArray,
    times_s: FloatArray,
    *,
    switched: bool,
    slopes: bool,
) -> FloatArray:
    """Return what alternating unit steps leave, for plants and actuators.

    Parameters
    ----------
    lags
        Damping ratio of each plant, and ``first, second`` of its actuator's acceleration and
        deceleration set in units of the plant's frequency, shape (m, 5) [-].
    natural_frequencies_rad_s
        Of the plants, shape (m,) [rad/s].
    times_s
        Times of the steps, shape (m, n), the first 0 [s].
    switched
        Whether one actuator is switched, else steps are superposed.
    slopes
        Whether to difference in frequency as well, three times the work.

    Returns
    -------
    FloatArray
        Residual and slope, shape (m, 2) [-]; slopes are not numbers if not asked for.
    """
    out = np.empty((len(times_s), 2))
    prove_rows(
        True if switched else None,
        True if slopes else None,
        lags,
        natural_frequencies_rad_s,
        times_s,
        out,
    )
    return out
