"""NUM-EI: extra-insensitive unity magnitude behind an actuator that brakes at another pace."""

import cmath
import functools
import math
from dataclasses import dataclass

import numpy as np

from design.checks import require_between
from design.claims import ZERO_LIMITS, Promise, within
from design.errors import InfeasibleDesignError
from design.formulations.alternating import AlternatingBand
from design.formulations.equal_sets import with_equal_sets
from design.formulations.equations import GapProblem
from design.formulations.expressions import Expressions
from design.formulations.formulation import Formulation
from design.formulations.gaps import PERIOD_RAD, settling_gaps_rad
from design.formulations.humps import (
    UNITY_ONE_HUMP,
    UNITY_TOLERANCE,
    UNITY_TWO_HUMPS,
    Ends,
    Humps,
    follow_from_undamped,
)
from design.formulations.lag_parameters import decel_over_accel, lag_parameters, switched_order
from design.formulations.ramped_humps import ramped_humps_problem
from design.formulations.seeds import Ratios, Seed
from design.formulations.unequal_humps import UnequalHumpsProblem
from design.formulations.unity_magnitude_problem import alternating
from design.model.actuators.rate_limited import RateLimited, follows_one_lag
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.shapers.actuators import EVERY_ACTUATOR
from design.shapers.kind import DesignCase, KindOf, ShaperKind
from design.shapers.options import MAX_TOLERANCE, MIN_TOLERANCE, tolerance_field
from design.shapers.settle_options import SettleOptions
from design.types import FloatArray

SOURCE = (
    'W. Singhose, W. Seering, N. Singer, "Time-optimal negative input shapers", J. Dyn. Sys., '
    "Meas., Control 119 (1997), for the actuators of Kim, master thesis (2011), chapter 3"
)

IDEAL_KINDS = {1: ("um_ei", UNITY_ONE_HUMP), 2: ("um_2ei", UNITY_TWO_HUMPS)}
"""By number of humps, the shaper of an ideal actuator and its undamped form at 5 %."""

LIGHTNESS = 1e-4
"""Weight of the duration in the objective [-].

Multipliers grow as the humps become low, 500 times the weight and more at 0.1 %, and so does their
rounding, which IPOPT wants below 1e-12; with as many equations as unknowns they decide nothing.
"""

RATIO_BOUNDS = (0.01, 100.0)
"""How far zeros and peaks of the curve are looked for, ratios of the nominal frequency [-]."""

MIN_DISTANCE_FROM_ONE = 1e-4
"""How near to 1 a zero or peak may be, other than that which is there: apart at all [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HumpOptions(SettleOptions):
    """Parameters of the extra-insensitive shapers behind asymmetric actuators.

    Attributes
    ----------
    tolerance
        Height of each hump [-].
    """

    tolerance: float = tolerance_field("Residual vibration that each hump of the curve reaches.")

    def __post_init__(self) -> None:
        SettleOptions.__post_init__(self)
        require_between("tolerance", self.tolerance, MIN_TOLERANCE, MAX_TOLERANCE)


@dataclass(frozen=True, slots=True, kw_only=True)
class AlternatingHumps:
    """Steps up and down in turn whose curve has humps of one height between zeros.

    Attributes
    ----------
    humps
        Number of humps.
    switched_order, ramped
        As of `AlternatingBand`.
    """

    humps: int
    switched_order: int
    ramped: bool

    @property
    def impulses(self) -> int:
        """Number of impulses: unknowns and equations are then as many."""
        return 2 * self.humps + 3

    def expressions(self) -> Expressions:
        """Build the equations of `formulations.humps` with an actuator.

        Gains and slopes are the actuator's own.

        With V(r) the residual's vector at the ratio r of true and nominal frequency::

            V = 0 at each zero,    |V| = tolerance and d|V|/dr = 0 at each peak

        Parameters are those of `lag_parameters`, then the tolerance.
        """
        import casadi as ca  # noqa: PLC0415

        band = AlternatingBand(
            impulses=self.impulses, switched_order=self.switched_order, ramped=self.ramped
        ).expressions()
        vector, ratio = band.vibration, band.ratio
        slope = ca.jacobian(vector, ratio)
        tolerance, ratios = ca.SX.sym("tolerance"), ca.SX.sym("ratios", 2 * self.humps)
        each = ca.vertsplit(ratios)
        points = [*each[: self.humps], ca.SX(1), *each[self.humps :]]
        equations = [ca.substitute(vector, ratio, zero) for zero in points[::2]]
        for peak in points[1::2]:
            left, change = (ca.substitute(one, ratio, peak) for one in (vector, slope))
            equations += [
                (ca.sumsqr(left) / tolerance - tolerance) / 2,
                ca.dot(left, change) / tolerance,
            ]
        return Expressions(
            unknowns=ca.vertcat(band.unknowns, ratios),
            parameters=ca.vertcat(band.parameters, tolerance),
            objective=LIGHTNESS * ca.sum1(band.unknowns),
            equations=ca.vertcat(*equations),
        )


def numei(case: DesignCase[HumpOptions], *, humps: int) -> Formulation:
    """Formulate the fastest shaper with one hump of the tolerance, or two.

    Zeros and peaks are at frequencies that are unknown as well, except for the middle one, which is
    at the nominal frequency.

    Parameters
    ----------
    case
        Mode, actuator and options.
    humps
        Number of humps, 1 or 2.

    Returns
    -------
    Formulation
        A problem in gaps and in ratios of frequency; one in switches behind limits, unless drives
        settle.

    Raises
    ------
    InfeasibleDesignError
        If ramps and settling take longer than the longest shaper asked for.
    """
    mode, actuator, options = case.mode, case.actuator, case.options
    name, near, (damping_ratio, tolerance) = _ideal(mode, options.tolerance, humps)
    if isinstance(actuator, RateLimited) and not options.settle:
        alike = ramped_humps_problem(
            mode,
            actuator,
            zeros=(float(near.zeros[0]), float(near.zeros[-1])),
            humps=humps,
            tolerance=options.tolerance,
            max_duration_periods=options.max_duration_periods,
        )
        if follows_one_lag(actuator):
            return alike
        actuator.require_straight_ramps()
        return UnequalHumpsProblem(alike=alike, designed_for=actuator)
    model = AlternatingHumps(
        humps=humps,
        switched_order=switched_order(actuator),
        ramped=isinstance(actuator, RateLimited),
    )
    parameters = np.append(lag_parameters(mode, actuator), options.tolerance)
    shortest = settling_gaps_rad(mode, actuator, model.impulses, settle=options.settle)
    horizon = options.max_duration_periods * PERIOD_RAD
    if shortest.sum() > horizon:
        raise InfeasibleDesignError(
            f"ramps and settling between switches take {shortest.sum() / PERIOD_RAD:.4g} periods "
            f"in all, more than max_duration_periods = {options.max_duration_periods:g}",
            code="settling_exceeds_duration",
        )
    equal = with_equal_sets(parameters)
    equal[0], equal[-1] = damping_ratio, tolerance
    lowest, highest = RATIO_BOUNDS
    nominal = options.tolerance if humps == 1 else ZERO_LIMITS["residual"]
    below = np.arange(2 * humps) < humps
    return GapProblem(
        model=model,
        parameters=parameters,
        amplitudes=alternating(model.impulses),
        natural_frequency_rad_s=mode.natural_frequency_rad_s,
        shortest_gaps_rad=shortest,
        horizon_rad=horizon,
        seeds=_seeds(mode, actuator, name, near, equal),
        designed_for=actuator,
        claims=(
            Promise(quantity="residual", limit=nominal),
            within(options.tolerance, band=None),
        ),
        ratios=Ratios(
            lowest=np.where(below, lowest, 1 + MIN_DISTANCE_FROM_ONE),
            highest=np.where(below, 1 - MIN_DISTANCE_FROM_ONE, highest),
            usual=_moving(near),
        ),
    )


def _ideal(mode: Mode, tolerance: float, humps: int) -> tuple[str, Humps, Ends]:
    """Return the shaper of an ideal actuator: its name, itself, and what it is for.

    The undamped one of 5 % where there is none, which says nothing of other actuators.
    """
    kind, undamped = IDEAL_KINDS[humps]
    try:
        found = follow_from_undamped(kind, mode.damping_ratio, tolerance)
    except InfeasibleDesignError:
        return f"{kind}_undamped", undamped, (0.0, UNITY_TOLERANCE)
    return kind, found, (mode.damping_ratio, tolerance)


def _moving(humps: Humps) -> FloatArray:
    """Return zeros and peaks in turn without the middle one, which stays at 1."""
    points = np.empty(humps.zeros.size + humps.peaks.size)
    points[0::2], points[1::2] = humps.zeros, humps.peaks
    return np.delete(points, points.size // 2)


def _seeds(
    mode: Mode, actuator: Actuator, name: str, near: Humps, equal: FloatArray
) -> tuple[Seed, ...]:
    """Return the ideal shaper, steps down shifted by the phase of the sets' ratio, and as it is.

    As it is, it solves its equations behind any actuator of two equal sets: from there the
    decelerating one is led to what it is.
    """
    z = mode.damping_ratio
    shift = cmath.phase(decel_over_accel(mode, actuator)) / math.sqrt(1 - z * z)
    shifted = near.phases_rad + shift * (np.arange(near.phases_rad.size) % 2)
    return (
        Seed(name=name, gaps_rad=np.diff(shifted)),
        Seed(
            name=f"{name}_followed",
            gaps_rad=np.diff(near.phases_rad),
            solves=equal,
        ),
    )


def _kind(name: str, summary: str, humps: int) -> ShaperKind:
    return KindOf(
        name=name,
        summary=summary,
        source=SOURCE,
        claims=("residual", "band"),
        options=HumpOptions,
        actuators=EVERY_ACTUATOR,
        formulation=functools.partial(numei, humps=humps),
    )


NUM_EI = _kind(
    "num_ei",
    "Minimum-time unity magnitude, five impulses, one hump of the tolerance at the nominal "
    "frequency, asymmetric actuator.",
    humps=1,
)
NUM_2EI = _kind(
    "num_2ei",
    "Minimum-time unity magnitude, seven impulses, zero at the nominal frequency, a hump of the "
    "tolerance on either side, asymmetric actuator.",
    humps=2,
)
