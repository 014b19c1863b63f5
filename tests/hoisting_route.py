"""A second route to moves with a cable that is hoisted: plain integration of the angle.

Nothing here calls the package's responses, moves or solvers: drives are read by their parameters.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp

from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.hoisting import Hoisting
from design.types import FloatArray
from tests.second_route import denominator, increases

TOLERANCES = {"rtol": 1e-13, "atol": 1e-15, "method": "DOP853"}


@dataclass(frozen=True)
class _Stretch:
    """Rates of ``[angle, its rate, v, v', v, v']`` while nothing is switched."""

    begin_s: float
    length_m: float
    winding_m_s: float
    damping_ratio: float
    gravity_m_s2: float
    lags: list[tuple[float, float]]  # Coefficients of the sets that move
    levels: tuple[float, ...]

    def __call__(self, time_s: float, x: FloatArray) -> FloatArray:
        """Return the rates of a state."""
        out = np.zeros(6)
        acceleration = 0.0
        for own, (first, second) in enumerate(self.lags):
            v, v_rate = x[2 + 2 * own], x[3 + 2 * own]
            if second > 0:
                out[2 + 2 * own] = v_rate
                out[3 + 2 * own] = (self.levels[own] - v - first * v_rate) / second
            elif first > 0:
                out[2 + 2 * own] = (self.levels[own] - v) / first
            acceleration += out[2 + 2 * own]
        length = self.length_m + self.winding_m_s * (time_s - self.begin_s)
        drag = 2 * self.damping_ratio * math.sqrt(self.gravity_m_s2 * length)
        drag += 2 * self.winding_m_s
        out[0] = x[1]
        out[1] = (-acceleration - drag * x[1] - self.gravity_m_s2 * x[0]) / length
        return out


def rest_s(actuator: Actuator) -> float:
    """Return after how long a drive is at rest, 40 time constants of its slowest mode [s]."""
    slowest = 0.0
    for accel in (True, False):
        first, second = denominator(actuator, accel=accel)
        if first > 0:
            poles = np.roots([second, first, 1.0])
            slowest = max(slowest, 1 / float(-poles.real.max()))
    return 40 * slowest + 0.1  # the last step is made before the end


def hoisted_residual(
    command: Impulses, plant: Hoisting, actuator: Actuator, gravity_factor: float = 1.0
) -> float:
    """Return the amplitude of the last swing over v / (w sqrt(1 - z^2)).

    The angle obeys ``L x'' + (2 L' + 2 z sqrt(g L)) x' + g x = -v'``; all is integrated until the
    drive is at rest and the cable has its last length, and extrapolated back to the last step, or
    to the end of the hoisting if that is later.
    """
    course, z = plant.cable_length_m, plant.damping_ratio
    g = gravity_factor * plant.gravity_m_s2
    delay = actuator.dead_time_s
    steps = (command.times_s + delay).tolist()
    seen = max(course.times_s[-1], steps[-1])
    end = seen + rest_s(actuator)
    lags = [denominator(actuator, accel=accel) for accel in (True, False)]
    switched = actuator.model == "switched"
    increasing = increases(command)
    state = np.zeros(6)  # angle, its rate; v, v' of either set, or of one state in the first
    levels = [0.0, 0.0]
    chosen = 0
    moments = sorted({
        steps[0],
        end,
        *steps,
        *(one for one in course.times_s if steps[0] < one < end),
    })
    for begin, until in pairwise(moments):
        l0, l1 = (float(np.interp(at, course.times_s, course.values)) for at in (begin, until))
        rate = (l1 - l0) / (until - begin)
        for at, height, grows in zip(steps, command.amplitudes.tolist(), increasing, strict=True):
            if at != begin:
                continue
            chosen = 0 if grows else 1
            own = 0 if switched else chosen
            levels[own] += height
            first, second = lags[chosen]
            if first == second == 0:  # follows at once: a jump of the angle's rate
                jump = levels[own] - state[2 + 2 * own]
                state[1] -= jump / l0
                state[2 + 2 * own] = levels[own]

        course_now = _Stretch(
            begin, l0, rate, z, g, [lags[chosen]] if switched else lags, tuple(levels)
        )
        state = solve_ivp(course_now, (begin, until), state, **TOLERANCES).y[:, -1]
    last = course.values[-1]
    w = math.sqrt(g / last)
    damped = w * math.sqrt(1 - z**2)
    deflection, its_rate = last * state[0], last * state[1]
    amplitude = math.hypot(deflection * damped, its_rate + z * w * deflection)
    return amplitude * math.exp(z * w * (end - seen))
