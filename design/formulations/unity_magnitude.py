"""Shapers of steps up and down, mostly [1, -1, 1, ...]: the equations, seeds and closed forms.

All is dimensionless: phases are times the plant's natural frequency, lags are scaled alike.
"""

import cmath
import math
from dataclasses import dataclass, replace

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.equations import Expressions, GapProblem, Seed
from design.formulations.lag_parameters import LAG_PARAMETERS, lag_parameters, switched_order
from design.formulations.symbolic import alternating_steps, with_slopes, with_swing
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.plants.mode import Mode
from design.model.reference_ramps import ramp_factors
from design.types import FloatArray

PERIOD_RAD = 2 * math.pi

MAX_ALPHA = 2
"""Two unit vectors reach no further [-]."""

MIN_GAP_RAD = 1e-6
"""Keeps the impulses in order; a thousandth of a degree of swing [rad]."""

LAST_PULSE_VANISHES = f"its last pulse is shorter than impulses are kept apart, {MIN_GAP_RAD:g} rad"
"""What becomes of steps up and down in turn as damping grows: early swings decay by themselves."""

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
    """Zero vibration of one mode by steps up and down in turn, with its derivatives zero too.

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
    weighted
        Whether the amplitudes are parameters; +1, -1, +1, ... if not.
    swings
        Whether the payload swings already at the first step.
    """

    impulses: int
    derivatives: int
    switched_order: int = 0
    ramped: bool = False
    weighted: bool = False
    swings: bool = False

    def expressions(self) -> Expressions:
        """Build V = 0 at the plant's pole, and its slope where it counts.

        The slope dV/dw = 0 has the actuator's own slope in it.

        ``V(w) = sum v_i exp(s (t_n - t_i)) / G_accel(s)``, ``s = w (-z + j sqrt(1 - z^2))``: the
        vibration in units of the unshaped step, referred to the last impulse. Where V is zero its
        zeros and those of dV/dw do not depend on either reference.
        Parameters are those of `lag_parameters` (Kim 2011, eqs. 3.44-3.46; 3.47-3.48 replaced by
        the exact derivative), then the amplitudes if weighted, then the four of `with_swing` if it
        swings.
        """
        import casadi as ca  # noqa: PLC0415 - a third of a second that --help must not pay

        gaps = ca.SX.sym("gaps", self.impulses - 1)
        own, weights = LAG_PARAMETERS[self.ramped], self.impulses * self.weighted
        parameters = ca.SX.sym("parameters", own + weights + 4 * self.swings)
        lags, amplitudes, swing = ca.vertsplit(
            parameters, [0, own, own + weights, parameters.numel()]
        )
        each = ca.vertsplit(gaps)
        steps = alternating_steps(each, lags, self.switched_order, ca.vertsplit(amplitudes))
        if self.swings:
            steps = with_swing(steps, each, lags, swing)
        return Expressions(
            unknowns=gaps,
            parameters=parameters,
            objective=ca.sum1(gaps),
            equations=ca.vertcat(*with_slopes(steps, self.derivatives)),
        )


ZERO_VIBRATION = UnityMagnitude(impulses=3, derivatives=0)
ZERO_VIBRATION_DERIVATIVE = UnityMagnitude(impulses=5, derivatives=1)


def damped_periods(mode: Mode, periods: float) -> float:
    """Return in undamped periods how long some damped ones are [-].

    Parameters
    ----------
    mode
        The mode.
    periods
        Number of damped periods [-].

    Returns
    -------
    float
        Number of undamped periods [-].
    """
    return periods / math.sqrt(1 - mode.damping_ratio**2)


def alternating(impulses: int) -> FloatArray:
    """Return the amplitudes +1, -1, +1 ..., shape (impulses,)."""
    return np.array([1.0 - 2.0 * (number % 2) for number in range(impulses)])


def decel_over_accel(mode: Mode, actuator: Actuator) -> complex:
    """Return G_decel / G_accel at the plant's pole (Kim 2011, 3.50).

    It is ``alpha exp(-j beta)``. A ramp, where limits make one, is part of G.

    Parameters
    ----------
    mode, actuator
        The plant's mode and its drive.

    Returns
    -------
    complex
        1 behind equal sets [-].
    """
    pole = mode.pole_rad_s
    lags = actuator.accel_lag.denominator(pole) / actuator.decel_lag.denominator(pole)
    if not isinstance(actuator, RateLimited):
        return lags
    rise, fall = ramp_factors(np.array([pole]), np.array(actuator.unit_ramps_s)).tolist()
    return complex(lags * fall / rise)


def settling_gaps_rad(mode: Mode, actuator: Actuator, impulses: int, *, settle: bool) -> FloatArray:
    """Return the shortest gaps: just ordered, or settled to 80 %.

    After a step up the acceleration set has to settle before the next, after a step down the
    deceleration set (Kim 2011, eq. 3.40). A ramp, where limits make one, is over before.

    Parameters
    ----------
    mode, actuator
        The plant's mode and its drive.
    impulses
        Number of impulses n.
    settle
        Whether each step must settle.

    Returns
    -------
    FloatArray
        Shape (n - 1,) [rad].
    """
    w = mode.natural_frequency_rad_s
    ramps = unit_ramps_s(actuator)
    settling = (0.0, 0.0)
    if settle:
        settling = actuator.accel_lag.settling_time_s(), actuator.decel_lag.settling_time_s()
    shortest = [
        max(MIN_GAP_RAD, w * (ramp_s + settling_s))
        for ramp_s, settling_s in zip(ramps, settling, strict=True)
    ]
    return np.array([shortest[number % 2] for number in range(impulses - 1)])


def unity_magnitude_problem(
    model: UnityMagnitude,
    mode: Mode,
    actuator: Actuator,
    *,
    settle: bool,
    max_duration_periods: float,
    amplitudes: FloatArray | None = None,
    seeds: tuple[Seed, ...] = (),
) -> GapProblem:
    """Formulate a shaper of steps up and down for one mode.

    Parameters
    ----------
    model
        Number of impulses and order of the equations.
    mode, actuator
        The plant's mode and its drive.
    settle
        Whether each step must settle to 80 % before the next.
    max_duration_periods
        Longest shaper in undamped periods [-].
    amplitudes
        Heights, +1, -1, +1, ... if not given. Of three others the undamped triangle is the seed.
    seeds
        Starts; needed for more than three other amplitudes.

    Returns
    -------
    Problem
        In the gaps.

    Raises
    ------
    InfeasibleDesignError
        If settling before each switch takes longer than the longest shaper.
    """
    w = mode.natural_frequency_rad_s
    shortest = settling_gaps_rad(mode, actuator, model.impulses, settle=settle)
    horizon = max_duration_periods * PERIOD_RAD
    if shortest.sum() > horizon:
        raise InfeasibleDesignError(
            f"settling before each switch takes {shortest.sum() / PERIOD_RAD:.4g} periods in all, "
            f"more than max_duration_periods = {max_duration_periods:g}",
            code="settling_exceeds_duration",
        )
    ratio = decel_over_accel(mode, actuator)
    if amplitudes is None:
        weights: FloatArray = np.zeros(0)
        heights = alternating(model.impulses)
        seeds = _seeds(model, mode.damping_ratio, ratio, shortest)
    else:
        weights = heights = amplitudes
        seeds = seeds or _undamped_seeds(ratio, shortest, horizon, amplitudes)
    return GapProblem(
        model=replace(
            model,
            switched_order=switched_order(actuator),
            ramped=isinstance(actuator, RateLimited),
            weighted=weights.size > 0,
        ),
        parameters=np.concatenate((lag_parameters(mode, actuator), weights)),
        amplitudes=heights,
        natural_frequency_rad_s=w,
        shortest_gaps_rad=shortest,
        horizon_rad=horizon,
        seeds=seeds,
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
        if shortest.max() <= MIN_GAP_RAD or (gaps >= shortest).all():
            seeds.append(Seed(name=name, gaps_rad=gaps))
    return tuple(seeds)


def _undamped_seeds(
    ratio: complex, shortest: FloatArray, horizon_rad: float, amplitudes: FloatArray
) -> tuple[Seed, ...]:
    """Where the undamped triangle closes, its times are near; all branches are searched else."""
    try:
        times = undamped_times_rad(ratio, shortest, horizon_rad, amplitudes)
    except InfeasibleDesignError:  # says nothing of the damped or switched equations
        return ()
    return (Seed(name="undamped_triangle", gaps_rad=np.diff(times)),)


def undamped_times_rad(
    ratio: complex,
    shortest: FloatArray,
    horizon_rad: float,
    amplitudes: FloatArray | None = None,
) -> FloatArray:
    """Return the fastest three-impulse times of an undamped mode.

    The three vectors ``1, -alpha exp(-j (t2 + beta)), exp(-j t3)`` close when::

        t2 = ±acos(alpha / 2) - beta + 2 pi n,    t3 = ±2 acos(alpha / 2) + 2 pi m

    (Kim 2011, eqs. 3.34-3.35, whose ± is +). Of amplitudes ``a, -b, c`` the triangle has the sides
    ``a, b alpha, c``, and by the law of cosines::

        t2 = ±acos((a^2 + (b alpha)^2 - c^2) / (2 a b alpha)) - beta + 2 pi n
        t3 = ±acos(((b alpha)^2 - a^2 - c^2) / (2 a c)) + 2 pi m

    (Kim 2011, appendix B, eqs. 1, 2, 4, 5). Of both signs and all whole n and m, the fastest whose
    gaps are at least ``shortest``.

    Parameters
    ----------
    ratio
        ``alpha exp(-j beta)``, see `decel_over_accel` [-].
    shortest
        Shortest gaps, shape (2,) [rad].
    horizon_rad
        Longest duration [rad].
    amplitudes
        Heights a, -b, c, shape (3,); 1, -1, 1 if not given [-].

    Returns
    -------
    FloatArray
        Times from 0, shape (3,) [rad].

    Raises
    ------
    InfeasibleDesignError
        If no triangle closes: of unit impulses where alpha > 2; or if the fastest is longer than
        ``horizon_rad``.
    """
    alpha, beta = abs(ratio), -cmath.phase(ratio)
    angles = _unit_triangle(alpha) if amplitudes is None else _triangle(alpha, amplitudes)
    candidates = []
    for sign in (1, -1):
        t2 = _not_before(sign * angles[0] - beta, float(shortest[0]))
        t3 = _not_before(sign * angles[1], t2 + float(shortest[1]))
        candidates.append((t3, t2))
    t3, t2 = min(candidates)
    if t3 > horizon_rad:
        raise InfeasibleDesignError(
            f"the fastest ordered solution takes {t3 / PERIOD_RAD:.6g} periods, more than "
            f"max_duration_periods = {horizon_rad / PERIOD_RAD:g}",
            code="ordered_exceeds_duration",
        )
    return np.array([0.0, t2, t3])


def _unit_triangle(alpha: float) -> tuple[float, float]:
    if alpha > MAX_ALPHA:
        raise InfeasibleDesignError(
            f"alpha = |G_decel/G_accel| at the plant's frequency is {alpha!r}, and the vector "
            "diagram of three unit impulses closes only for alpha <= 2",
            code="alpha_above_two",
        )
    half_angle = math.acos(alpha / 2)
    return half_angle, 2 * half_angle


def _triangle(alpha: float, amplitudes: FloatArray) -> tuple[float, float]:
    """Angles from the first side to the second and, reversed, to the third [rad]."""
    a, b, c = (float(abs(one)) for one in amplitudes)
    sides = (a, b * alpha, c)
    if 2 * max(sides) > sum(sides):
        raise InfeasibleDesignError(
            f"the vector diagram does not close: of its sides {sides[0]:.6g}, {sides[1]:.6g} and "
            f"{sides[2]:.6g} none may be longer than the other two together (amplitudes {a:g}, "
            f"{-b:g}, {c:g}; alpha = |G of the second step / G of the others| = {alpha:.6g} at the "
            "plant's frequency)",
            code="diagram_open",
        )
    # Closed but for rounding, a cosine may be beyond 1 by as much.
    second = math.acos(min(1.0, (a * a + sides[1] ** 2 - c * c) / (2 * a * sides[1])))
    third = math.acos(max(-1.0, (sides[1] ** 2 - a * a - c * c) / (2 * a * c)))
    return second, third


def _not_before(angle: float, earliest: float) -> float:
    """Return the angle plus the smallest whole number of turns, at or after ``earliest`` [rad]."""
    return angle + PERIOD_RAD * math.ceil((earliest - angle) / PERIOD_RAD)
