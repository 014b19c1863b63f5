"""Certificates of many rows: actuator and mode carried from step to step, compiled.

Apart from the equations that the kernel solves: there the vibration is a sum of transfer functions
at the plant's pole; here the states of real lags and a real oscillator pass from step to step and
are taken apart at the end, as in `design.analysis.certificate`, whose limits and differencing in
frequency these are.

Between steps, in units of the plant's frequency, with e the distance of a lag from the command::

    e + first e' + second e'' = 0
    q'' + 2 z r q' + r^2 q = r^2 sum e        q counted from the command, r near 1; p = q' / r

q is a free swing and what the lags force, ``a e + b e'``, whose a and b follow by comparison.
"""

import math

import numpy as np

from design.analysis.certificate import STEP_PHASE_RAD
from design.tables.compiled import compiled
from design.types import FloatArray

CRITICAL_ROOT = 1e-7
"""Distance of a lag's poles from critical damping below which the double-pole form is exact [-]."""


@compiled
def _forced(z: float, r: float, first: float, second: float, out: FloatArray) -> None:
    """Write what a lag's e and e' force: q by each, p by each."""
    if second > 0.0:
        alpha = second * r * r - 1.0
        beta = 2.0 * z * r * second - first
        below = alpha * alpha + beta * (beta - alpha * first) / second
        a = r * r * second * (alpha - beta * first / second) / below
        b = -r * r * second * beta / below
        out[0], out[1] = a, b
        out[2], out[3] = -b / second / r, (a - b * first / second) / r
        return
    a = 0.0
    if first > 0.0:
        turn = r * first
        a = turn * turn / (1.0 - 2.0 * z * turn + turn * turn)
        out[2] = -a / (first * r)
    else:
        out[2] = 0.0
    out[0], out[1], out[3] = a, 0.0, 0.0


@compiled
def _relaxed(gap: float, first: float, second: float, state: FloatArray) -> None:
    """Move a lag's e and e' over a gap, in place."""
    e, d = state[0], state[1]
    if second > 0.0:
        corner = 1.0 / math.sqrt(second)
        damping = first * corner / 2.0
        phase = corner * gap
        squared = damping * damping - 1.0
        root = math.sqrt(abs(squared))
        if root < CRITICAL_ROOT:
            even = math.exp(-damping * phase)
            odd = even * phase
        elif squared < 0.0:
            decay = math.exp(-damping * phase)
            even, odd = decay * math.cos(root * phase), decay * math.sin(root * phase) / root
        else:
            fast = damping + root
            slow_part, fast_part = math.exp(-phase / fast), math.exp(-phase * fast)
            even, odd = (slow_part + fast_part) / 2.0, (slow_part - fast_part) / (2.0 * root)
        state[0] = even * e + odd * (damping * e + d / corner)
        state[1] = even * d - odd * (damping * d + corner * e)
    elif first > 0.0:
        state[0], state[1] = e * math.exp(-gap / first), 0.0


@compiled
def _little_turn(exponent: complex) -> complex:
    """Return the exponential of at most `STEP_PHASE_RAD`: the next term is below rounding."""
    return 1.0 + exponent * (1.0 + exponent / 2.0 * (1.0 + exponent / 3.0))


@compiled
def _prove(
    switched: bool,
    lags: FloatArray,
    w: FloatArray,
    times: FloatArray,
    slopes: bool,
    out: FloatArray,
) -> None:
    steps = times.shape[1]
    count = 3 if slopes else 1
    ratios, left = np.ones(3), np.empty(3, dtype=np.complex128)
    forced = np.empty((3, 2, 4))
    lag, swing = np.zeros((2, 2)), np.zeros((3, 2))
    for m in range(times.shape[0]):
        z = lags[m, 0]
        root = math.sqrt(1.0 - z * z)
        duration = w[m] * times[m, steps - 1]
        step = STEP_PHASE_RAD / max(1.0, duration)
        ratios[1], ratios[2] = 1.0 - step, 1.0 + step
        for f in range(count):
            for k in range(2):
                _forced(z, ratios[f], lags[m, 1 + 2 * k], lags[m, 2 + 2 * k], forced[f, k])
        # An unshaped step through the acceleration set.
        q, p = -1.0, 0.0
        if lags[m, 1] > 0.0 or lags[m, 2] > 0.0:
            q, p = q + forced[0, 0, 0], p + forced[0, 0, 2]
        unit = abs(complex(-q - z * p, root * p))
        lag[:] = 0.0
        swing[:] = 0.0
        force = 0
        for i in range(steps):
            amplitude = 1.0 if i % 2 == 0 else -1.0
            if i > 0:
                gap = w[m] * (times[m, i] - times[m, i - 1])
                decay = math.exp(-z * gap)
                turn = complex(decay * math.cos(root * gap), decay * math.sin(root * gap))
                for f in range(count):
                    x = forced[f]
                    # The free part of the swing turns by itself.
                    q, p = swing[f, 0], swing[f, 1]
                    for k in range(2):
                        q -= x[k, 0] * lag[k, 0] + x[k, 1] * lag[k, 1]
                        p -= x[k, 2] * lag[k, 0] + x[k, 3] * lag[k, 1]
                    turned = turn
                    if f > 0:
                        turned *= _little_turn(complex(-z, root) * ((ratios[f] - 1.0) * gap))
                    c, s = turned.real, turned.imag / root
                    swing[f, 0], swing[f, 1] = c * q + s * (z * q + p), c * p - s * (q + z * p)
                for k in range(2):
                    if not switched or k == force:
                        _relaxed(gap, lags[m, 1 + 2 * k], lags[m, 2 + 2 * k], lag[k])
                for f in range(count):
                    x = forced[f]
                    for k in range(2):
                        swing[f, 0] += x[k, 0] * lag[k, 0] + x[k, 1] * lag[k, 1]
                        swing[f, 1] += x[k, 2] * lag[k, 0] + x[k, 3] * lag[k, 1]
            into = i % 2
            if switched and into != force:
                # One actuator: its state passes to the other set.
                lag[into, 0], lag[into, 1] = lag[force, 0], lag[force, 1]
                lag[force, 0] = lag[force, 1] = 0.0
            force = into
            if lags[m, 1 + 2 * into] > 0.0 or lags[m, 2 + 2 * into] > 0.0:
                lag[into, 0] -= amplitude
            else:
                lag[into, 0] = lag[into, 1] = 0.0
            for f in range(count):
                swing[f, 0] -= amplitude
        for f in range(count):
            x = forced[f]
            q, p = swing[f, 0], swing[f, 1]
            for k in range(2):
                q -= x[k, 0] * lag[k, 0] + x[k, 1] * lag[k, 1]
                p -= x[k, 2] * lag[k, 0] + x[k, 3] * lag[k, 1]
            left[f] = complex(-q - z * p, root * p)
        out[m, 0] = abs(left[0]) / unit
        out[m, 1] = np.nan
        if slopes:
            for f in range(1, 3):
                # From the last step back to the first, the origin of V(w).
                off = (1.0 - ratios[f]) * duration
                left[f] *= _little_turn(complex(-z, root) * off)
            out[m, 1] = abs(left[2] - left[1]) / (2.0 * step) / unit


def proven(
    lags: FloatArray,
    natural_frequencies_rad_s: FloatArray,
    times_s: FloatArray,
    *,
    switched: bool,
    slopes: bool,
) -> FloatArray:
    """Return what alternating unit steps leave, for many plants and actuators.

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
    _prove(switched, lags, natural_frequencies_rad_s, times_s, slopes, out)
    return out
