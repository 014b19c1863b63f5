"""A second route to what `design` computes: plain integration.

Nothing here calls the package's analysis, responses, shapers or solvers: actuators are read by
their parameters only.
"""

import math

import numpy as np

from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.types import FloatArray
from tests.expm_route import end_s
from tests.second_route import denominator, increases, without_limits


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

    def free_swing(command: Impulses, behind: Actuator) -> float:
        end = end_s(command, behind) + wait
        deflection, rate, _ = integrate(command, mode, behind, end)
        return float(abs(rate - conjugate * deflection))

    step = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
    return free_swing(impulses, actuator) / free_swing(step, without_limits(actuator))
