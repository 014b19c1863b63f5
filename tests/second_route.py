"""Second routes to what `design` computes: textbook formulas and plain integration.

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
    unit = abs(gain_and_slope(actuator, s, accel=True)[0])
    shrink = math.exp(-z * w * impulses.duration_s) / unit
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
    lags = impulses.duration_s - (impulses.times_s - impulses.times_s[0])
    swings = np.exp(np.multiply.outer(poles, lags)) * impulses.amplitudes
    limited = isinstance(actuator, RateLimited)
    steps = [
        (accel, abs(amplitude) if limited else 1.0)
        for accel, amplitude in zip(increases(impulses), impulses.amplitudes.tolist(), strict=True)
    ]

    def gains(accel: bool, height: float) -> ComplexArray:
        return np.array([
            gain_and_slope(actuator, pole, accel=accel, height=height)[0] for pole in poles.tolist()
        ])

    total = np.zeros(ratios.size, dtype=np.complex128)
    for step in sorted(set(steps)):
        own = np.array([one == step for one in steps])
        total += gains(*step) * swings[:, own].sum(axis=1)
    found: FloatArray = np.abs(total / gains(True, 1.0))
    return found


def _lag_parts(actuator: Actuator) -> list[tuple[float, float]]:
    return [denominator(actuator, accel=accel) for accel in (False, True)]


def integrate(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    until_s: float,
    initial: tuple[float, float] = (0.0, 0.0),
) -> FloatArray:
    """Integrate actuator and payload step by step; return [deflection, its rate, v] at the end.

    ``initial`` is the payload's deflection and its rate at the first step.

    The payload obeys ``d'' + 2 z w d' + w^2 d = -v'``. Each set is a lag of its own, driven by the
    sum of its steps; a set that follows at once turns a step into a jump of the rate.
    """
    from scipy.integrate import solve_ivp

    if isinstance(actuator, RateLimited):
        return _integrate_limited(impulses, mode, actuator, until_s)
    if not isinstance(actuator, Ideal) and actuator.model == "switched":
        return _integrate_switched(impulses, mode, actuator, until_s, initial)
    w, z = mode.natural_frequency_rad_s, mode.damping_ratio
    lags = _lag_parts(actuator)
    state = np.array([*initial, 0.0, 0.0, 0.0, 0.0])  # d, d', then v, v' of either set
    levels = [0.0, 0.0]

    def rates(_: float, x: FloatArray) -> FloatArray:
        out = np.zeros(6)
        acceleration = 0.0
        for index, (first, second) in enumerate(lags):
            v, rate = x[2 + 2 * index], x[3 + 2 * index]
            if second > 0:
                out[2 + 2 * index] = rate
                out[3 + 2 * index] = (levels[index] - v - first * rate) / second
                acceleration += rate
            elif first > 0:
                out[2 + 2 * index] = (levels[index] - v) / first
                acceleration += out[2 + 2 * index]
        out[0] = x[1]
        out[1] = -2 * z * w * x[1] - w * w * x[0] - acceleration
        return out

    ends = [*impulses.times_s[1:].tolist(), until_s]
    steps = zip(
        impulses.times_s.tolist(),
        ends,
        impulses.amplitudes.tolist(),
        increases(impulses),
        strict=True,
    )
    for start, end, amplitude, accel in steps:
        levels[accel] += amplitude
        if lags[accel] == (0.0, 0.0):
            state[1] -= amplitude
            state[2 + 2 * accel] += amplitude
        if end > start:
            run = solve_ivp(rates, (start, end), state, method="DOP853", rtol=1e-11, atol=1e-13)
            state = run.y[:, -1]
    return np.array([state[0], state[1], state[2] + state[4]])


def _integrate_switched(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    until_s: float,
    initial: tuple[float, float],
) -> FloatArray:
    """Integrate payload and one velocity that obeys the set of the latest change of |command|."""
    from scipy.integrate import solve_ivp

    w, z = mode.natural_frequency_rad_s, mode.damping_ratio
    lags = _lag_parts(actuator)
    state = np.array([*initial, 0.0, 0.0])  # d, d', v, v'
    level, force = 0.0, 0

    def rates(_: float, x: FloatArray) -> FloatArray:
        first, second = lags[force]
        out = np.zeros(4)
        if second > 0:
            acceleration = x[3]
            out[3] = (level - x[2] - first * x[3]) / second
        else:
            acceleration = (level - x[2]) / first if first > 0 else 0.0
        out[0] = x[1]
        out[1] = -2 * z * w * x[1] - w * w * x[0] - acceleration
        out[2] = acceleration
        return out

    ends = [*impulses.times_s[1:].tolist(), until_s]
    steps = zip(
        impulses.times_s.tolist(),
        ends,
        impulses.amplitudes.tolist(),
        increases(impulses),
        strict=True,
    )
    for start, end, amplitude, accel in steps:
        level, force = level + amplitude, int(accel)
        if lags[force] == (0.0, 0.0):
            state[1] -= level - state[2]
            state[2] = level
        if end > start:
            run = solve_ivp(rates, (start, end), state, method="DOP853", rtol=1e-11, atol=1e-13)
            state = run.y[:, -1]
    return state[:3]


def _integrate_limited(
    impulses: Impulses, mode: Mode, actuator: RateLimited, until_s: float
) -> FloatArray:
    """Integrate payload, drive and a reference that chases the command within two rates.

    Each phase, in which the reference rises, falls or holds, ends by an event of the integrator.
    """
    from scipy.integrate import solve_ivp

    w, z = mode.natural_frequency_rad_s, mode.damping_ratio
    lags = _lag_parts(actuator.then)
    limits = [actuator.decel_limit_m_s2, actuator.accel_limit_m_s2]
    share = [limit / actuator.speed_m_s for limit in limits]
    switched = not isinstance(actuator.then, Ideal) and actuator.then.model == "switched"
    # d, d', the reference, the part of it that either set follows, v and v' of either.
    state = np.zeros(9)
    force, slope, target, command = 1, 0.0, 0.0, 0.0

    def rates(_: float, x: FloatArray) -> FloatArray:
        out = np.zeros(9)
        out[2] = slope
        out[3 + force] = slope
        acceleration = 0.0
        for index, (first, second) in enumerate(lags):
            v, rate = x[5 + 2 * index], x[6 + 2 * index]
            if switched and index != force:
                continue
            wanted = x[2] if switched else x[3 + index]
            if second > 0:
                out[5 + 2 * index] = rate
                out[6 + 2 * index] = (wanted - v - first * rate) / second
            elif first > 0:
                out[5 + 2 * index] = (wanted - v) / first
            else:
                out[5 + 2 * index] = slope if index == force else 0.0
            acceleration += out[5 + 2 * index]
        out[0] = x[1]
        out[1] = -2 * z * w * x[1] - w * w * x[0] - acceleration
        return out

    def arrived(_: float, x: FloatArray) -> float:
        return float(x[2] - target)

    arrived.terminal = True  # type: ignore[attr-defined]
    ends = [*impulses.times_s[1:].tolist(), until_s]
    steps = zip(impulses.times_s.tolist(), ends, impulses.amplitudes.tolist(), strict=True)
    for start, end, amplitude in steps:
        command += amplitude
        time = start
        while time < end:
            now = float(state[2])
            if abs(now - command) < 1e-12:
                slope, events = 0.0, None
            else:
                target = 0.0 if now * command < -1e-24 else command
                was, force = force, int(abs(target) > abs(now))
                slope, events = math.copysign(share[force], target - now), arrived
                if switched and was != force:
                    state[5 + 2 * force : 7 + 2 * force] = state[5 + 2 * was : 7 + 2 * was]
                    if lags[force] == (0.0, 0.0):
                        state[1] -= now - state[5 + 2 * force]
                        state[5 + 2 * force : 7 + 2 * force] = now, 0.0
                    state[5 + 2 * was : 7 + 2 * was] = 0.0
            run = solve_ivp(
                rates, (time, end), state, method="DOP853", rtol=1e-11, atol=1e-13, events=events
            )
            state, time = run.y[:, -1], float(run.t[-1])
            if run.status == 1:
                state[2] = target
    return np.array([state[0], state[1], state[5] + state[7]])


def residual_by_integration(impulses: Impulses, mode: Mode, actuator: Actuator) -> float:
    """Residual vibration, measured on the free swing after every transient has died."""
    w, z = mode.natural_frequency_rad_s, mode.damping_ratio
    wait = 14 / w  # a set at 5 w, damped 0.6, has e^-42 left then
    conjugate = w * complex(-z, -math.sqrt(1 - z * z))

    def free_swing(command: Impulses) -> float:
        end = float(command.times_s[-1]) + wait
        deflection, rate, _ = integrate(command, mode, actuator, end)
        return float(abs(rate - conjugate * deflection))

    step = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
    return free_swing(impulses) / free_swing(step)
