"""Changes of a reference: the ramps that limits make of steps, and what they leave in a mode."""

import math
from dataclasses import dataclass

import numpy as np

from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.types import BoolArray, ComplexArray, FloatArray


def ramp_factors(poles_rad_s: ComplexArray, ramps_s: FloatArray) -> ComplexArray:
    """Return what ramps leave in a mode over what steps at their start leave.

    ``(1 - exp(-s T)) / (s T)`` for a pole s and a ramp of duration T.

    Parameters
    ----------
    poles_rad_s
        Poles of the mode, shape (m, 1) [rad/s].
    ramps_s
        Durations, shape (n,) or (m, n) [s].

    Returns
    -------
    ComplexArray
        Shape (m, n) [-]; 1 for a step.
    """
    turns = poles_rad_s * ramps_s
    still = turns == 0
    factors: ComplexArray = np.where(still, 1.0, -np.expm1(-turns) / np.where(still, 1.0, turns))
    return factors


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reference:
    """Changes of a reference, in order of time; between them it holds.

    Attributes
    ----------
    times_s
        When each begins, shape (n,) [s].
    ramps_s
        How long it takes, shape (n,), >= 0: 0 is a step [s].
    changes
        By how much, as shares of full speed, shape (n,) [-].
    accelerates
        Which increase the reference's magnitude, shape (n,).
    """

    times_s: FloatArray
    ramps_s: FloatArray
    changes: FloatArray
    accelerates: BoolArray


def ramped(command: Impulses, actuator: RateLimited) -> Reference:
    """Return the ramps that limits make of a command's steps.

    Parameters
    ----------
    command
        The command.
    actuator
        The limits.

    Returns
    -------
    Reference
        A ramp for each step; two for one that passes zero.
    """
    rise_s, fall_s = actuator.unit_ramps_s
    found: list[tuple[float, float, float, bool]] = []
    now = 0.0
    levels = np.cumsum(command.amplitudes)
    # A command back at rest is at rest: its sum may be off by rounding.
    levels[np.abs(levels) <= 1e-12 * np.abs(command.amplitudes).sum()] = 0.0
    ends = [*command.times_s[1:].tolist(), math.inf]
    for start, end, level in zip(command.times_s.tolist(), ends, levels.tolist(), strict=True):
        time = start
        while now != level and time < end:
            target = 0.0 if now * level < 0 else level
            growing = abs(target) > abs(now)
            change = target - now
            ramp = abs(change) * (rise_s if growing else fall_s)
            if time + ramp > end:
                change *= (end - time) / ramp
                ramp = end - time
                target = now + change
            found.append((time, ramp, change, growing))
            now, time = target, time + ramp
    times, ramps, changes, accelerates = zip(*found, strict=True)
    return Reference(
        times_s=np.array(times),
        ramps_s=np.array(ramps),
        changes=np.array(changes),
        accelerates=np.array(accelerates),
    )
