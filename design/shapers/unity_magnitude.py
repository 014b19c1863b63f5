"""Unity-magnitude shapers, amplitudes [1, -1, 1, ...]: the equations, seeds and closed forms.

All is dimensionless: phases are times the plant's natural frequency, lags are scaled alike.
"""

import cmath
import math
from dataclasses import dataclass, replace

import numpy as np

from design.actuators import Actuator, RateLimited, ramp_responses, unit_ramps_s
from design.errors import InfeasibleDesignError
from design.plants import Mode
from design.references import ramp_factors
from design.shapers.problem import Expressions, Problem, Seed
from design.shapers.symbolic import alternating_steps, with_slopes
from design.types import FloatArray

PERIOD_RAD = 2 * math.pi

LARGEST_ALPHA = 2
"""Two unit vectors reach no further [-]."""

SHORTEST_GAP_RAD = 1e-6
"""Keeps the impulses in order; a thousandth of a degree of swing [rad]."""

ZV_POLYNOMIALS = (
    (0.16724, 0.27242, 0.20345, 0.0),
    (0.33323, 0.00533, 0.17914, 0.20125),
)
"""UMZV times over T, rows t2 and t3, ascending powers of the damping ratio [1]_."""

ZVD_POLYNOMIALS = (
    (0.08945, 0.28411, 0.23013, 0.16401),
    (0.36613, -0.08833, 0.24048, 0.17001),
    (0.64277, 0.29103, 0.23262, 0.43784),
    (0.73228, 0.00992, 0.49385, 0.38633),
)
"""UMZVD times over T, rows t2 to t5, ascending powers of the damping ratio [1]_.

References
----------
.. [1] W. Singhose, W. Seering, N. Singer, "Time-optimal negative input shapers", J. Dyn. Sys.,
   Meas., Control 119 (1997); Kim 2011, table 3-1.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class UnityMagnitude:
    """Zero vibration of one mode by alternating unit steps, with its derivatives zero too.

    Attributes
    ----------
    impulses
        Number of impulses, odd.
    derivatives
        How many derivatives of the vibration in the plant's frequency vanish too; the impulses
        must be ``2 * derivatives + 3``, so that equations match unknowns.
    switched_order
        Order of the lags of a switched actuator, 1 or 2; 0 for superposed steps of any order.
    ramped
        Whether limits make ramps of the steps, each over before the next begins.
    """

    impulses: int
    derivatives: int
    switched_order: int = 0
    ramped: bool = False

    def expressions(self) -> Expressions:
        """Build V = 0, and dV/dw = 0 with the actuator's own slope, at the plant's pole.

        ``V(w) = sum v_i exp(s (t_n - t_i)) / G_accel(s)``, ``s = w (-z + j sqrt(1 - z^2))``: the
        vibration in units of the unshaped step, referred to the last impulse. Where V is zero its
        zeros and those of dV/dw do not depend on either reference.
        Parameters are those of `lag_parameters` (Kim 2011, eqs. 3.44-3.46; 3.47-3.48 replaced by
        the exact derivative).
        """
        import casadi as ca  # noqa: PLC0415 - a third of a second that --help must not pay

        gaps = ca.SX.sym("gaps", self.impulses - 1)
        parameters = ca.SX.sym("parameters", LAG_PARAMETERS[self.ramped])
        steps = alternating_steps(ca.vertsplit(gaps), parameters, self.switched_order)
        return Expressions(
            unknowns=gaps,
            parameters=parameters,
            objective=ca.sum1(gaps),
            equations=ca.vertcat(*with_slopes(steps, self.derivatives)),
        )


ZERO_VIBRATION = UnityMagnitude(impulses=3, derivatives=0)
ZERO_VIBRATION_DERIVATIVE = UnityMagnitude(impulses=5, derivatives=1)


def switched_order(actuator: Actuator) -> int:
    """Return the order of a switched actuator's lags, 0 for superposed steps."""
    if actuator.model == "superposed":
        return 0
    return 2 if actuator.accel_lag.second_s2 > 0 else 1


LAG_PARAMETERS = {False: 5, True: 11}
"""How many numbers describe plant and actuator, without and with ramps."""


def lag_parameters(mode: Mode, actuator: Actuator) -> FloatArray:
    """Return what describes plant and actuator at w = 1, sets in order accel, decel [-].

    z, then ``first, second`` of either set; with limits also the duration of either unit ramp, and
    error and rate that either leaves in its own lag: shape (5,) or (11,).
    """
    w = mode.natural_frequency_rad_s
    lags = (actuator.accel_lag, actuator.decel_lag)
    scaled = [part for lag in lags for part in (lag.first_s * w, lag.second_s2 * w * w)]
    if isinstance(actuator, RateLimited):
        ramps = [w * ramp for ramp in actuator.unit_ramps_s]
        scaled += ramps
        first, second = np.array(scaled[0:4:2]), np.array(scaled[1:4:2])
        scaled += ramp_responses(first, second, np.array(ramps)).ravel().tolist()
    return np.array([mode.damping_ratio, *scaled])


def alternating(impulses: int) -> FloatArray:
    """Return the amplitudes +1, -1, +1 ..., shape (impulses,)."""
    return np.where(np.arange(impulses) % 2 == 0, 1.0, -1.0)


def decel_over_accel(mode: Mode, actuator: Actuator) -> complex:
    """Return G_decel / G_accel at the plant's pole: ``alpha exp(-j beta)`` (Kim 2011, 3.50).

    A ramp, where limits make one, is part of G.
    """
    pole = mode.pole_rad_s
    rise, fall = ramp_factors(np.array([pole]), np.array(unit_ramps_s(actuator))).tolist()
    lags = actuator.accel_lag.denominator(pole) / actuator.decel_lag.denominator(pole)
    return complex(lags * fall / rise)


def settling_gaps_rad(mode: Mode, actuator: Actuator, impulses: int, *, settle: bool) -> FloatArray:
    """Return the shortest gaps, shape (impulses - 1,): just ordered, or settled to 80 % [rad].

    After a step up the acceleration set has to settle before the next, after a step down the
    deceleration set (Kim 2011, eq. 3.40). A ramp, where limits make one, is over before.
    """
    gaps = np.full(impulses - 1, SHORTEST_GAP_RAD)
    w = mode.natural_frequency_rad_s
    lags = (actuator.accel_lag, actuator.decel_lag)
    for which, (lag, ramp_s) in enumerate(zip(lags, unit_ramps_s(actuator), strict=True)):
        shortest_s = ramp_s + (lag.settling_time_s() if settle else 0.0)
        gaps[which::2] = np.maximum(gaps[which::2], w * shortest_s)
    return gaps


def unity_magnitude_problem(
    model: UnityMagnitude,
    mode: Mode,
    actuator: Actuator,
    *,
    settle: bool,
    max_duration_periods: float,
) -> Problem:
    """Formulate a unity-magnitude shaper for one mode behind one actuator."""
    w = mode.natural_frequency_rad_s
    shortest = settling_gaps_rad(mode, actuator, model.impulses, settle=settle)
    horizon = max_duration_periods * PERIOD_RAD
    if shortest.sum() > horizon:
        raise InfeasibleDesignError(
            f"settling before each switch takes {shortest.sum() / PERIOD_RAD:.4g} periods in all, "
            f"more than max_duration_periods = {max_duration_periods:g}"
        )
    return Problem(
        model=replace(
            model, switched_order=switched_order(actuator), ramped=isinstance(actuator, RateLimited)
        ),
        parameters=lag_parameters(mode, actuator),
        amplitudes=alternating(model.impulses),
        natural_frequency_rad_s=w,
        shortest_gaps_rad=shortest,
        horizon_rad=horizon,
        seeds=_seeds(model, mode.damping_ratio, decel_over_accel(mode, actuator), shortest),
        designed_for=actuator,
    )


def _seeds(
    model: UnityMagnitude, damping_ratio: float, ratio: complex, shortest: FloatArray
) -> tuple[Seed, ...]:
    """Polynomials of the literature, shifted by the actuators' phase, then as published.

    A step through the deceleration set acts as if it came later by the phase of the ratio, so its
    time in the seed moves by that. Where a gap is too short to settle, no seed tells which branch
    is the fastest: all are searched.
    """
    label = "umzv_polynomials" if model.derivatives == 0 else "umzvd_polynomials"
    table = ZV_POLYNOMIALS if model.derivatives == 0 else ZVD_POLYNOMIALS
    published = [
        PERIOD_RAD * (a + damping_ratio * (b + damping_ratio * (c + damping_ratio * d)))
        for a, b, c, d in table
    ]
    shift = cmath.phase(ratio) / math.sqrt(1 - damping_ratio**2)
    shifted = [time + shift * (index % 2 == 0) for index, time in enumerate(published)]
    seeds = []
    for name, times in ((label, shifted), (f"{label}_as_published", published)):
        gaps = np.array([
            after - before for before, after in zip([0.0, *times], times, strict=False)
        ])
        if shortest.max() <= SHORTEST_GAP_RAD or (gaps >= shortest).all():
            seeds.append(Seed(name=name, gaps_rad=gaps))
    return tuple(seeds)


def undamped_times_rad(ratio: complex, shortest: FloatArray, horizon_rad: float) -> FloatArray:
    """Return the fastest three-impulse times of an undamped mode, shape (3,) [rad].

    The three vectors ``1, -alpha exp(-j (t2 + beta)), exp(-j t3)`` close when::

        t2 = ±acos(alpha / 2) - beta + 2 pi n,    t3 = ±2 acos(alpha / 2) + 2 pi m

    (Kim 2011, eqs. 3.34-3.35, whose ± is +). Of both signs and all whole n and m, the fastest
    whose gaps are at least ``shortest``.

    Raises
    ------
    InfeasibleDesignError
        If alpha > 2: no triangle closes; or if the fastest is longer than ``horizon_rad``.
    """
    alpha, beta = abs(ratio), -cmath.phase(ratio)
    if alpha > LARGEST_ALPHA:
        raise InfeasibleDesignError(
            f"alpha = |G_decel/G_accel| at the plant's frequency is {alpha!r}, and the vector "
            "diagram of three unit impulses closes only for alpha <= 2"
        )
    candidates = []
    for sign in (1, -1):
        half_angle = sign * math.acos(alpha / 2)
        t2 = _not_before(half_angle - beta, float(shortest[0]))
        t3 = _not_before(2 * half_angle, t2 + float(shortest[1]))
        candidates.append((t3, t2))
    t3, t2 = min(candidates)
    if t3 > horizon_rad:
        raise InfeasibleDesignError(
            f"the fastest ordered solution takes {t3 / PERIOD_RAD:.6g} periods, more than "
            f"max_duration_periods = {horizon_rad / PERIOD_RAD:g}"
        )
    return np.array([0.0, t2, t3])


def _not_before(angle: float, earliest: float) -> float:
    """Return the angle plus the smallest whole number of turns, at or after ``earliest`` [rad]."""
    return angle + PERIOD_RAD * math.ceil((earliest - angle) / PERIOD_RAD)
