"""What commands leave behind any drive, played without the package, for judges of answers."""

import math
from dataclasses import replace

import numpy as np

from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.types import FloatArray
from tests import expm_route
from tests.acceptance.judges import has_formula
from tests.jerk_route import integrate_jerk_limited
from tests.second_route import curve_by_formula, denominator, without_limits

SETTLED = 32.0
"""Decays of the slowest lag after which it is at rest: to 1e-14 [-]."""

INTEGRATED = 2e-7
"""What the integrated route may be off: 1e-12 a step, over what an unshaped step leaves [-]."""

MAX_INTEGRATED_STEPS = 40
"""Steps of a command that is integrated, at most."""


def limits_jerk(actuator: Actuator) -> bool:
    """Whether only integration plays a command behind this drive."""
    return isinstance(actuator, RateLimited) and actuator.jerk_limit_m_s3 is not None


def residual_of(command: Impulses, mode: Mode, actuator: Actuator, end_s: float) -> float:
    """Return the residual; behind a limited jerk as of the time ``end_s`` that its ramps end."""
    if isinstance(actuator, RateLimited) and actuator.jerk_limit_m_s3 is not None:
        return _residual_behind_jerk(command, mode, actuator, end_s)
    return expm_route.outcome(command, mode, actuator).residual


def curve_of(command: Impulses, mode: Mode, actuator: Actuator, ratios: FloatArray) -> FloatArray:
    """Return the residual at each ratio of frequency, shape (k,); not behind a limited jerk."""
    if has_formula(command, actuator):
        return curve_by_formula(command, mode, actuator, ratios)
    at = (replace(mode, natural_frequency_rad_s=mode.natural_frequency_rad_s * r) for r in ratios)
    return np.array([expm_route.outcome(command, one, actuator).residual for one in at])


def _residual_behind_jerk(
    command: Impulses, mode: Mode, actuator: RateLimited, end_s: float
) -> float:
    slowest = math.inf
    for accel in (False, True):
        first, second = denominator(actuator.then, accel=accel)
        if first > 0:
            roots = np.roots([second, first, 1.0] if second > 0 else [first, 1.0])
            slowest = min(slowest, float(np.abs(roots.real).min()))
    until_s = end_s + SETTLED / slowest + 1e-6 * mode.period_s
    deflection, rate, _, _ = integrate_jerk_limited(command, mode, actuator, until_s)
    pole = mode.pole_rad_s
    left = abs(rate - pole.conjugate() * deflection)
    step = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
    unit = abs(expm_route.outcome(step, mode, without_limits(actuator)).unit)
    return float(left * math.exp(-pole.real * (until_s - end_s)) / unit)
