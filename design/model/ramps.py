"""Changes of a reference: the ramps that limits make of steps, and what they leave in a mode."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import leggauss

from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.model.jerk_ramps import Piece, jerk_limited_pieces
from design.types import BoolArray, ComplexArray, FloatArray

NODES, WEIGHTS = ((1 + leggauss(12)[0]) / 2, leggauss(12)[1] / 2)
"""Of the mean from 0 to 1: of what bent ramps leave up to `SHORT_TURN` exact to rounding."""

SHORT_TURN = 4.0
"""Turn of the mode over a bent ramp from which the closed form loses no more than a digit [rad]."""


def ramp_factors(
    poles_rad_s: ComplexArray, ramps_s: FloatArray, bends: FloatArray | None = None
) -> ComplexArray:
    """Return what ramps leave in a mode over what steps at their start leave.

    ``(1 - exp(-s T)) / (s T)`` for a pole s and a ramp of duration T; a bend b adds b times the
    mean of ``(2 u - 1) exp(-s T u)`` over u from 0 to 1.

    Parameters
    ----------
    poles_rad_s
        Poles of the mode, shape (m, 1) [rad/s].
    ramps_s
        Durations, shape (n,) or (m, n) [s].
    bends
        Of each, as of a `Reference`, shape (n,); None of straight ramps [-].

    Returns
    -------
    ComplexArray
        Shape (m, n) [-]; 1 for a step.
    """
    turns = poles_rad_s * ramps_s
    still = turns == 0
    factors: ComplexArray = np.where(still, 1.0, -np.expm1(-turns) / np.where(still, 1.0, turns))
    if bends is not None and bends.any():
        factors += bends * _tilts(turns)
    return factors


def _tilts(turns: ComplexArray) -> ComplexArray:
    """Return the mean of ``(2 u - 1) exp(-x u)`` over u from 0 to 1."""
    by_nodes = np.exp(-turns[..., None] * NODES) @ (WEIGHTS * (2 * NODES - 1))
    short = np.abs(turns) <= SHORT_TURN
    x = np.where(short, SHORT_TURN, turns)
    closed = (2 * (1 - np.exp(-x)) / x - 1 - np.exp(-x)) / x
    tilts: ComplexArray = np.where(short, by_nodes, closed)
    return tilts


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
    bends
        Slope of each at its end less that at its start, over twice its mean slope, from -1 to 1,
        shape (n,): 0 of steps and of straight ramps [-].
    """

    times_s: FloatArray
    ramps_s: FloatArray
    changes: FloatArray
    accelerates: BoolArray
    bends: FloatArray

    def factors(self, poles_rad_s: ComplexArray) -> ComplexArray:
        """Return the `ramp_factors` at poles of shape (m, 1), (m, n)."""
        return ramp_factors(poles_rad_s, self.ramps_s, self.bends)


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
        A ramp for each step; two for one that passes zero. With a limit to the jerk, pieces of
        constant jerk instead.
    """
    levels = np.cumsum(command.amplitudes)
    # A command back at rest is at rest: its sum may be off by rounding.
    levels[np.abs(levels) <= 1e-12 * np.abs(command.amplitudes).sum()] = 0.0
    starts = command.times_s.tolist()
    if actuator.jerk_limit_m_s3 is None:
        found = _straight_ramps(starts, levels.tolist(), *actuator.unit_ramps_s)
    else:
        found = jerk_limited_pieces(starts, levels.tolist(), actuator, actuator.jerk_limit_m_s3)
    times, ramps, changes, accelerates, bends = zip(*found, strict=True)
    return Reference(
        times_s=np.array(times),
        ramps_s=np.array(ramps),
        changes=np.array(changes),
        accelerates=np.array(accelerates),
        bends=np.array(bends),
    )


def _straight_ramps(
    starts: list[float], levels: list[float], rise_s: float, fall_s: float
) -> list[Piece]:
    found: list[Piece] = []
    now = 0.0
    for start, end, level in zip(starts, [*starts[1:], math.inf], levels, strict=True):
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
            found.append((time, ramp, change, growing, 0.0))
            now, time = target, time + ramp
    return found
