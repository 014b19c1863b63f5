"""A whole move behind limits to acceleration, in minimum time."""

import math
from dataclasses import replace

import numpy as np

from design.formulations.gaps import PERIOD_RAD
from design.formulations.jerk_move import highest_level, smooth_pulses, whole_ramp_rad
from design.formulations.ramped import RampedProblem, reference_limits
from design.model.actuators.rate_limited import RateLimited
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode
from design.types import ComplexArray, FloatArray

SWING_PERIODS = 12.0
"""Time beyond that of a load without swing after which no move is looked for [-]."""

LOG_STEP = 1e-3
"""Step of ln w over which the derivative of a swing is taken, to the fourth order [-]."""


def ramped_move(
    mode: Mode,
    actuator: RateLimited,
    *,
    derivatives: int,
    travel_s: float,
    swing: FreeSwing | None,
) -> RampedProblem:
    """Formulate the fastest move from rest to rest behind limits.

    The reference starts and ends at 0, and its integral is the travel. A move that cannot reach
    full speed is formulated over the highest speed that it can reach, so that its numbers are as
    large as those of any other.

    Parameters
    ----------
    mode, actuator
        The plant's mode, and its limits; one lag follows them.
    derivatives
        How many derivatives of what is left vanish too, 0 or 1.
    travel_s
        Distance over full speed, > 0 [s].
    swing
        What the payload swings at the first step; None for one at rest.

    Returns
    -------
    RampedProblem
        In phases of the mode.
    """
    w = mode.natural_frequency_rad_s
    (rise, fall), jerk = reference_limits(actuator, w)
    travel = w * travel_s
    if jerk is None:
        highest = min(1.0, math.sqrt(2 * travel / (rise + fall)))
    else:
        highest = highest_level(travel, (rise, fall), jerk)
        jerk /= highest
    rise, fall, travel = highest * rise, highest * fall, travel / highest
    earliest = travel + sum(whole_ramp_rad(one, jerk) for one in (rise, fall)) / 2
    targets: ComplexArray = np.zeros(derivatives + 1, dtype=np.complex128)
    if swing is not None:
        targets = -_swings(swing, mode, actuator)[: derivatives + 1] / highest
    return RampedProblem(
        unit_poles=np.array([*[mode.pole_rad_s / w] * (derivatives + 1), 0j]),
        orders=np.array([*[float(order) for order in range(derivatives + 1)], 1.0]),
        targets=np.append(targets, travel),
        ramps_rad=(rise, fall),
        last=0.0,
        natural_frequency_rad_s=w,
        horizon_rad=math.inf,
        earliest_rad=earliest,
        farthest_rad=earliest + SWING_PERIODS * PERIOD_RAD,
        designed_for=actuator,
        seed_name="triangles",
        seeds=() if swing is not None else _pulses(mode, derivatives, (rise, fall), travel, jerk),
        jerk=jerk,
    )


def _pulses(
    mode: Mode, derivatives: int, ramps: tuple[float, float], travel: float, jerk: float | None
) -> tuple[FloatArray, ...]:
    """Return the switches of one pulse for each impulse of `zv` or `zvd`.

    That is what a very short move is: no grid over its duration would show its ramps. There is none
    where the pulses overlap, or would be higher than full speed. Without a limit to the jerk they
    are triangles.
    """
    stretch = math.sqrt(1 - mode.damping_ratio**2)
    decay = math.exp(-math.pi * mode.damping_ratio / stretch)
    weights = np.array([math.comb(derivatives + 1, k) * decay**k for k in range(derivatives + 2)])
    begins = math.pi / stretch * np.arange(weights.size)
    if jerk is not None:
        smooth = smooth_pulses(begins, travel * weights / weights.sum(), ramps, jerk)
        over = smooth is not None and bool((np.array(smooth[1][:-1]) < begins[1:]).all())
        return (np.array(smooth[0]),) if smooth is not None and over else ()
    rise, fall = ramps
    heights = np.sqrt(2 * travel * weights / weights.sum() / (rise + fall))
    switches = np.stack((begins, begins + heights * rise), axis=1).ravel()
    ends = begins + heights * (rise + fall)
    apart = (ends[:-1] < begins[1:]).all() and heights.max() <= 1
    return (switches,) if apart else ()


def _swings(swing: FreeSwing, mode: Mode, actuator: RateLimited) -> ComplexArray:
    """Return the swing over what follows the limits, and its derivative in s over w."""

    def over_lag(log_ratio: float) -> complex:
        ratio = math.exp(log_ratio)
        scaled = replace(mode, natural_frequency_rad_s=ratio * mode.natural_frequency_rad_s)
        vector = swing.scaled(ratio**swing.frequency_power).vector(scaled)
        return vector * actuator.accel_lag.denominator(scaled.pole_rad_s)

    near, far = (over_lag(k * LOG_STEP) - over_lag(-k * LOG_STEP) for k in (1, 2))
    in_log = (8 * near - far) / (12 * LOG_STEP)
    # d/d(ln w) is s d/ds at a fixed damping ratio.
    return np.array([over_lag(0.0), in_log * mode.natural_frequency_rad_s / mode.pole_rad_s])
