"""A second route behind a limited jerk: plain integration of the drive's own rule.

The rule is one of feedback, without a plan: where the reference would stop, braking at the limit
of the jerk from now on, decides whether it brakes or not. Nothing of the package's is called.
"""

import math

import numpy as np

from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.types import FloatArray
from tests.second_route import denominator

CLOSE = 1e-10


def integrate_jerk_limited(
    impulses: Impulses, mode: Mode, actuator: RateLimited, until_s: float
) -> FloatArray:
    """Return deflection, its rate, velocity and reference at the end."""
    from scipy.integrate import solve_ivp

    assert actuator.jerk_limit_m_s3 is not None
    w, z = mode.natural_frequency_rad_s, mode.damping_ratio
    jerk = actuator.jerk_limit_m_s3 / actuator.speed_m_s
    limits = [
        limit / actuator.speed_m_s
        for limit in (actuator.decel_limit_m_s2, actuator.accel_limit_m_s2)
    ]
    lags = [denominator(actuator.then, accel=accel) for accel in (False, True)]
    switched = not isinstance(actuator.then, Ideal) and actuator.then.model == "switched"
    # d, d', r, r', the part of r that either set follows, v and v' of either.
    state = np.zeros(10)
    force, rate_of_slope = 1, 0.0

    def rates(_: float, x: FloatArray) -> FloatArray:
        out = np.zeros(10)
        out[2], out[3], out[4 + force] = x[3], rate_of_slope, x[3]
        acceleration = 0.0
        for index, (first, second) in enumerate(lags):
            v, rate = x[6 + 2 * index], x[7 + 2 * index]
            if switched and index != force:
                continue
            wanted = x[2] if switched else x[4 + index]
            if second > 0:
                out[6 + 2 * index] = rate
                out[7 + 2 * index] = (wanted - v - first * rate) / second
            elif first > 0:
                out[6 + 2 * index] = (wanted - v) / first
            else:
                out[6 + 2 * index] = x[3] if index == force else 0.0
            acceleration += out[6 + 2 * index]
        out[0] = x[1]
        out[1] = -2 * z * w * x[1] - w * w * x[0] - acceleration
        return out

    def stop_of(x: FloatArray) -> float:
        return float(x[2] + x[3] * abs(x[3]) / (2 * jerk))

    command = 0.0
    ends = [*impulses.times_s[1:].tolist(), until_s]
    for start, end, amplitude in zip(
        impulses.times_s.tolist(), ends, impulses.amplitudes.tolist(), strict=True
    ):
        command += amplitude
        time = start
        while time < end:
            level, slope = float(state[2]), float(state[3])
            at_rest = abs(slope) < CLOSE
            goal = 0.0 if level * command < -CLOSE * CLOSE and abs(level) > CLOSE else command
            ahead = goal - stop_of(state)
            was = force
            if abs(ahead) < CLOSE:
                rate_of_slope = 0.0 if at_rest else math.copysign(jerk, -slope)
                heading = slope
            else:
                way = math.copysign(1.0, ahead)
                heading = slope if slope * way < -CLOSE else way
                away = level * heading > 0 or (abs(level) < CLOSE and goal * heading > 0)
                full = limits[int(away)] - abs(slope) < CLOSE and slope * way > 0
                rate_of_slope = 0.0 if full else way * jerk
            if rate_of_slope != 0 or abs(slope) > CLOSE:
                force = int(level * heading > 0 or (abs(level) < CLOSE and goal * heading > 0))
            if switched and was != force:
                state[6 + 2 * force : 8 + 2 * force] = state[6 + 2 * was : 8 + 2 * was]
                if lags[force] == (0.0, 0.0):
                    state[1] -= level - state[6 + 2 * force]
                    state[6 + 2 * force : 8 + 2 * force] = level, 0.0
                state[6 + 2 * was : 8 + 2 * was] = 0.0

            limit = limits[force]
            begun = [abs(slope) - limit, ahead, slope]

            def full_slope(_: float, x: FloatArray, limit: float = limit) -> float:
                return float(abs(x[3]) - limit)

            def on_the_way(_: float, x: FloatArray, goal: float = goal) -> float:
                return goal - stop_of(x)

            def resting(_: float, x: FloatArray) -> float:
                return float(x[3])

            events = []
            for event, value in zip((full_slope, on_the_way, resting), begun, strict=True):
                if abs(value) >= CLOSE:
                    event.terminal = True  # type: ignore[attr-defined]
                    events.append(event)
            if at_rest and rate_of_slope == 0:
                events = []
            run = solve_ivp(
                rates,
                (time, end),
                state,
                method="DOP853",
                rtol=1e-12,
                atol=1e-14,
                events=events or None,
                max_step=0.2 / w,
            )
            state, time = run.y[:, -1], float(run.t[-1])
            if run.status == 1 and abs(state[3]) < CLOSE:
                state[3] = 0.0
    return np.array([state[0], state[1], state[6] + state[8], state[2]])
