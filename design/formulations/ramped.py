"""Minimum time behind limits to acceleration, over every course of the reference.

What follows the limits is ideal or one linear lag. Its transfer function is a common factor of all
that is left, so the course alone decides, and the problem is convex in the slope of the reference.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.polynomial import polyval

from design.claims import Promise
from design.formulations.gaps import PERIOD_RAD
from design.formulations.notches import notched_ramps
from design.formulations.published_times import ZV_POLYNOMIALS, ZVD_POLYNOMIALS
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.types import ComplexArray, FloatArray

EARLIEST_PERIODS = (0.32, 0.71)
"""What unity-magnitude commands take at least without limits, in periods of the slowest mode: with
no residual, and with no slope either [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RampedProblem:
    """The course of a limited reference that meets its targets and ends first.

    The reference r starts at 0, stays between 0 and 1, and
    ``integral of r'(t) (-t)^o_k exp(-s_k t) dt = g_k`` for every k.

    Attributes
    ----------
    unit_poles
        s, over a common frequency, shape (m,) [-].
    orders
        o: 0 for what is left in a mode, 1 for its slope in s, shape (m,).
    targets
        g, shape (m,).
    ramps_rad
        How long the reference takes from 0 to 1 and from 1 to 0, as steep as it may be [rad].
    last
        Its level at the end, 0 or 1 [-].
    natural_frequency_rad_s
        The common frequency: it turns phases into times [rad/s].
    horizon_rad
        Latest end [rad].
    earliest_rad
        An end before which, or little after which, nothing is possible: the search begins there
        [rad].
    designed_for
        The actuator of the claims.
    claims
        None: zeros, as the kind says.
    seed_name
        Name of these, as reported with the answer.
    farthest_rad
        Where the search for an end gives up: there may be none, however late [rad].
    jerk
        Largest rate of its slope; None is no limit [1/rad^2].
    seeds
        Switches to begin with, ahead of any search, shape (n,) each [rad].
    """

    unit_poles: ComplexArray
    orders: FloatArray
    targets: ComplexArray
    ramps_rad: tuple[float, float]
    last: float
    natural_frequency_rad_s: float
    horizon_rad: float
    earliest_rad: float
    designed_for: Actuator
    claims: tuple[Promise, ...] = ()
    seeds: tuple[FloatArray, ...] = ()
    seed_name: str = "none"
    farthest_rad: float = math.inf
    jerk: float | None = None


def ramped_problem(
    modes: tuple[Mode, ...],
    actuator: RateLimited,
    *,
    derivatives: int,
    max_duration_periods: float,
) -> RampedProblem:
    """Formulate the fastest shaper behind limits.

    Parameters
    ----------
    modes
        The modes in which nothing is to be left.
    actuator
        The limits, and what follows them.
    derivatives
        How many derivatives of what is left vanish too, 0 or 1.
    max_duration_periods
        Latest end in undamped periods of the slowest mode, without a ramp up and a ramp down [-].

    Returns
    -------
    RampedProblem
        In phases of the slowest mode.
    """
    w = min(mode.natural_frequency_rad_s for mode in modes)
    rise, fall = (w * ramp_s for ramp_s in actuator.unit_ramps_s)
    steep, jerk = reference_limits(actuator, w)
    poles = [mode.pole_rad_s / w for mode in modes for _ in range(derivatives + 1)]
    return RampedProblem(
        unit_poles=np.array(poles, dtype=np.complex128),
        orders=np.array([float(order) for _ in modes for order in range(derivatives + 1)]),
        targets=np.zeros(len(poles), dtype=np.complex128),
        ramps_rad=steep,
        last=1.0,
        natural_frequency_rad_s=w,
        horizon_rad=max_duration_periods * PERIOD_RAD + rise + fall,
        earliest_rad=max(rise, PERIOD_RAD * EARLIEST_PERIODS[derivatives]),
        designed_for=actuator,
        seeds=_seeds(modes[0], derivatives, rise, fall) if len(modes) == 1 else (),
        seed_name="umzvd_polynomials" if derivatives else "umzv_polynomials",
        jerk=jerk,
    )


def reference_limits(
    actuator: RateLimited, natural_frequency_rad_s: float
) -> tuple[tuple[float, float], float | None]:
    """Return the limits of a reference in phases.

    Parameters
    ----------
    actuator
        The limits.
    natural_frequency_rad_s
        Turns times into phases [rad/s].

    Returns
    -------
    tuple
        How long it takes up and down as steep as it may be [rad], and the largest rate of its
        slope, None without a limit [1/rad^2].
    """
    w, speed, jerk = natural_frequency_rad_s, actuator.speed_m_s, actuator.jerk_limit_m_s3
    limits = (actuator.accel_limit_m_s2, actuator.decel_limit_m_s2)
    steep = (w * speed / limits[0], w * speed / limits[1])
    return steep, None if jerk is None else jerk / speed / w**2


def _seeds(mode: Mode, derivatives: int, rise: float, fall: float) -> tuple[FloatArray, ...]:
    """Return the switches published for no limits, and the notches of a ramp of whole periods.

    Short ramps move the published ones little.
    """
    table = ZVD_POLYNOMIALS if derivatives else ZV_POLYNOMIALS
    times = polyval(mode.damping_ratio, np.array(table).T)
    published = PERIOD_RAD * np.append(0.0, times)
    if derivatives:
        return (published,)
    unit_pole = mode.pole_rad_s / mode.natural_frequency_rad_s
    return (published, *notched_ramps(unit_pole, rise, fall))
