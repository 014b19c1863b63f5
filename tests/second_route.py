"""Second routes to what `design` computes: textbook formulas.

Nothing here calls the package's analysis, responses, shapers or solvers: actuators are read by
their parameters only.
"""

import cmath
import math

import numpy as np

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.types import ComplexArray, FloatArray


def increases(command: Impulses) -> list[bool]:
    """Which steps increase |command|, those at one time together; one of no height is none.

    Times that differ by 1e-12 of the whole command are one.
    """
    level, up = 0.0, True
    answer: list[bool] = []
    instants: list[tuple[float, list[float]]] = []
    for time, height in zip(command.times_s.tolist(), command.amplitudes.tolist(), strict=True):
        together: list[float] = []
        if instants and time - instants[-1][0] <= 1e-12 * command.duration_s:
            _, together = instants.pop()
        instants.append((time, [*together, height]))
    for _, heights in instants:
        if abs(sum(heights)) > 1e-12:
            up = abs(level + sum(heights)) > abs(level) + 1e-12
        answer += [up] * len(heights)
        level += sum(heights)
    return answer


def without_limits(actuator: Actuator) -> Actuator:
    """Return what follows the limits of an actuator: residuals are shares of its step."""
    return actuator.then if isinstance(actuator, RateLimited) else actuator


def denominator(actuator: Actuator, *, accel: bool) -> tuple[float, float]:
    """Coefficients of p and p^2 in 1/G of one set, from the actuator's own parameters."""
    if isinstance(actuator, Ideal):
        return 0.0, 0.0
    if isinstance(actuator, FirstOrder):
        return (actuator.accel_time_constant_s if accel else actuator.decel_time_constant_s), 0.0
    assert isinstance(actuator, SecondOrder)
    one = actuator.accel if accel else actuator.decel
    return 2 * one.damping_ratio / one.natural_frequency_rad_s, 1 / one.natural_frequency_rad_s**2


def gain_and_slope(
    actuator: Actuator, s: complex, *, accel: bool, height: float = 1.0
) -> tuple[complex, complex]:
    """G(s) and dG/ds of one set, with the ramp that a limit makes of a step of that height."""
    if isinstance(actuator, RateLimited):
        gain, slope = gain_and_slope(actuator.then, s, accel=accel)
        limit = actuator.accel_limit_m_s2 if accel else actuator.decel_limit_m_s2
        # exp(-y) sinh(y)/y with y half the ramp's turn: no digits are lost in short ramps.
        half = abs(height) * actuator.speed_m_s / limit / 2
        y = s * half
        wave = cmath.sinh(y) / y
        wave_slope = (cmath.cosh(y) - wave) / y if abs(y) > 0.1 else y / 3 + y**3 / 30 + y**5 / 840
        decay = cmath.exp(-y)
        ramp_slope = half * decay * (wave_slope - wave)
        return gain * decay * wave, slope * decay * wave + gain * ramp_slope
    first, second = denominator(actuator, accel=accel)
    gain = 1 / (1 + first * s + second * s * s)
    return gain, -(first + 2 * second * s) * gain * gain


def rested_s(impulses: Impulses, actuator: Actuator) -> float:
    """When the last step is over, or the last ramp behind limits, if none is cut [s]."""
    last = float(impulses.times_s[-1])
    if not isinstance(actuator, RateLimited):
        return last
    up = increases(impulses)[-1]
    limit = actuator.accel_limit_m_s2 if up else actuator.decel_limit_m_s2
    return last + abs(float(impulses.amplitudes[-1])) * actuator.speed_m_s / limit


def claims_by_formula(
    impulses: Impulses, mode: Mode, actuator: Actuator, ratio: float = 1.0
) -> dict[str, float]:
    """Residual and slope by ``V = sum A_i G_i(s) exp(-s t_i)`` and its derivative, term by term."""
    w, z = ratio * mode.natural_frequency_rad_s, mode.damping_ratio
    s = w * complex(-z, math.sqrt(1 - z * z))
    vector = slope = 0j
    start = float(impulses.times_s[0])
    steps = zip(
        impulses.times_s.tolist(),
        impulses.amplitudes.tolist(),
        increases(impulses),
        strict=True,
    )
    for time, amplitude, accel in steps:
        gain, gain_slope = gain_and_slope(actuator, s, accel=accel, height=amplitude)
        turn = amplitude * cmath.exp(-s * (time - start))
        vector += turn * gain
        slope += turn * s * (gain_slope - (time - start) * gain)
    unit = abs(gain_and_slope(without_limits(actuator), s, accel=True)[0])
    shrink = math.exp(-z * w * (rested_s(impulses, actuator) - start)) / unit
    return {"residual": abs(vector) * shrink, "slope": abs(slope) * shrink}


def ideal_derivative_by_formula(impulses: Impulses, mode: Mode, order: int) -> float:
    """``|d^k V / d(ln w)^k|`` of steps through an ideal actuator, as a Bell polynomial in s t.

    With ``x = -s t``, ``d^k exp(x) / d(ln w)^k`` is ``x``, ``x^2 + x``, ``x^3 + 3 x^2 + x`` times
    ``exp(x)``: the Touchard polynomials.
    """
    touchard = {0: (1.0,), 1: (0, 1.0), 2: (0, 1.0, 1.0), 3: (0, 1.0, 3.0, 1.0)}[order]
    z, w = mode.damping_ratio, mode.natural_frequency_rad_s
    s = w * complex(-z, math.sqrt(1 - z * z))
    total = 0j
    for time, amplitude in zip(
        impulses.times_s.tolist(), impulses.amplitudes.tolist(), strict=True
    ):
        x = -s * (time - float(impulses.times_s[0]))
        total += amplitude * cmath.exp(x) * sum(c * x**k for k, c in enumerate(touchard))
    return abs(total) * math.exp(-z * w * impulses.duration_s)


def _product(one: ComplexArray, other: ComplexArray) -> ComplexArray:
    """Product of two power series, cut to their common length."""
    return np.convolve(one, other)[: one.size]


def _reciprocal(series: ComplexArray) -> ComplexArray:
    out = np.zeros_like(series)
    out[0] = 1 / series[0]
    for n in range(1, series.size):
        out[n] = -(series[1 : n + 1] @ out[:n][::-1]) / series[0]
    return out


def derivatives_by_series(
    impulses: Impulses, mode: Mode, actuator: SecondOrder, highest: int
) -> list[float]:
    """``|d^k V / d(ln w)^k|``, k from 0 on, over the unshaped step, by power series in ln w.

    A switched set passes on ``G (second s e' - e)``, its error e carried by `scipy.linalg.expm`.
    """
    from scipy.linalg import expm

    z, w = mode.damping_ratio, mode.natural_frequency_rad_s
    s0 = w * complex(-z, math.sqrt(1 - z * z))
    powers = np.arange(highest + 1)
    factorials = np.array([math.factorial(k) for k in powers.tolist()])
    s = s0 / factorials + 0j
    one = (powers == 0) + 0j
    lags = [denominator(actuator, accel=accel) for accel in (False, True)]
    gains = [_reciprocal(one + a * s + b * _product(s, s)) for a, b in lags]
    total = np.zeros(highest + 1, dtype=np.complex128)
    state, before, last = np.zeros(2), None, float(impulses.times_s[0])
    for time, amplitude, accel in zip(
        impulses.times_s.tolist(),
        impulses.amplitudes.tolist(),
        increases(impulses),
        strict=True,
    ):
        term = amplitude * gains[accel]
        if actuator.model == "switched" and before is not None:
            a, b = lags[before]
            state = expm(np.array([[0, 1], [-1 / b, -a / b]]) * (time - last)) @ state
            for which, sign in ((int(accel), 1), (before, -1)):
                left = lags[which][1] * state[1] * s - state[0] * one
                term = term + sign * _product(gains[which], left)
        turn = one * np.exp(-s0 * (time - float(impulses.times_s[0])))
        x = -(time - float(impulses.times_s[0])) * (s - s0 * one)
        grown, power = one, one
        for k in range(1, highest + 1):
            power = _product(power, x) / k
            grown = grown + power
        total += _product(term, _product(turn, grown))
        state, before, last = state - [amplitude, 0], int(accel), time
    decay = math.exp(-z * w * impulses.duration_s)
    found: list[float] = (np.abs(total) * factorials * decay / abs(gains[1][0])).tolist()
    return found


def largest_in_band_by_formula(
    impulses: Impulses, mode: Mode, actuator: Actuator, band: tuple[float, float], points: int
) -> float:
    """Return the largest residual on an even grid over a band of ratios, by the same formula."""
    ratios = np.linspace(*band, points).tolist()
    return max(claims_by_formula(impulses, mode, actuator, ratio)["residual"] for ratio in ratios)


def curve_by_formula(
    impulses: Impulses, mode: Mode, actuator: Actuator, ratios: FloatArray
) -> FloatArray:
    """Return the residual at each ratio, shape (k,), by the same sum with one product a set."""
    z = mode.damping_ratio
    poles = mode.natural_frequency_rad_s * ratios * complex(-z, math.sqrt(1 - z * z))
    lags = rested_s(impulses, actuator) - impulses.times_s
    swings = np.exp(np.multiply.outer(poles, lags)) * impulses.amplitudes
    limited = isinstance(actuator, RateLimited)
    steps = [
        (accel, abs(amplitude) if limited else 1.0)
        for accel, amplitude in zip(increases(impulses), impulses.amplitudes.tolist(), strict=True)
    ]

    def gains(accel: bool, height: float, behind: Actuator = actuator) -> ComplexArray:
        return np.array([
            gain_and_slope(behind, pole, accel=accel, height=height)[0] for pole in poles.tolist()
        ])

    total = np.zeros(ratios.size, dtype=np.complex128)
    for step in sorted(set(steps)):
        own = np.array([one == step for one in steps])
        total += gains(*step) * swings[:, own].sum(axis=1)
    found: FloatArray = np.abs(total / gains(True, 1.0, without_limits(actuator)))
    return found
