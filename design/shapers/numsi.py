"""NUM-SI: minimum-time unity magnitude whose residual is small over a band, asymmetric actuator."""

import cmath
import math
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np

from design.checks import require_between
from design.errors import InfeasibleDesignError, InvalidInputError
from design.formulations.alternating import AlternatingBand
from design.formulations.bands import BandSearch, UnityBandProblem
from design.formulations.formulation import Formulation
from design.formulations.gaps import PERIOD_RAD, settling_gaps_rad
from design.formulations.lag_parameters import decel_over_accel, lag_parameters, switched_order
from design.formulations.ramped_band import ramped_band_problem
from design.formulations.seeds import Seed
from design.formulations.unequal_band import UnequalBandProblem
from design.formulations.unity_magnitude_problem import alternating
from design.model.actuators.rate_limited import RateLimited, follows_one_lag
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.shapers.actuators import EVERY_ACTUATOR
from design.shapers.kind import DesignCase, KindOf
from design.shapers.options import MAX_TOLERANCE, MIN_TOLERANCE, tolerance_field
from design.shapers.settle_options import SettleOptions

MIN_HALF_WIDTH = 1e-3
MAX_HALF_WIDTH = 0.6
"""Bounds of the band's half width: nine impulses reach .45 at 5 % [-]."""

MIN_PULSE_RAD = PERIOD_RAD / 100
"""Shortest gap of superposed steps, where none has to settle [rad].

Superposed sets, each answering its own steps, would make something of pulses that vanish: no drive
can, and the switched model knows no such thing.
"""

COUNTS = (3, 5, 7, 9)
"""Numbers of impulses."""

SEED_TOLERANCE = 0.05
"""Tolerance of the seeds [-]."""

SEEDS: dict[int, dict[float, tuple[float, ...]]] = {
    3: {0.020: (0.165339, 0.330679)},
    5: {
        0.035: (0.086035, 0.236075, 0.386114, 0.472149),
        0.080: (0.083093, 0.322784, 0.562475, 0.645568),
        0.160: (0.091104, 0.356731, 0.622357, 0.713461),
    },
    7: {
        0.190: (0.073100, 0.302638, 0.399542, 0.496446, 0.725984, 0.799084),
        0.230: (0.053611, 0.330638, 0.485916, 0.641194, 0.918221, 0.971832),
        0.300: (0.055713, 0.372588, 0.551200, 0.729813, 1.046688, 1.102401),
    },
    9: {
        0.350: (0.047927, 0.354645, 0.468061, 0.624045, 0.780030, 0.893446, 1.200164, 1.248091),
        0.420: (0.039169, 0.386378, 0.513340, 0.756247, 0.999153, 1.126115, 1.473324, 1.512493),
    },
}
"""Times over T of the undamped shapers for an ideal actuator at 5 %, by impulses and half width.

The shortest of dozens of random starts each, found here; digits beyond need not be exact.
"""


MAX_HALF_WIDTH_OF_COUNT = {3: 0.0285, 5: 0.187, 7: 0.337, 9: 0.455}
"""Widest half width of each number of impulses, undamped and ideal at 5 %, as found here [-]."""

FAR = 1.3
"""Times that width, a number of impulses is tried last [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class UnityBandOptions(SettleOptions):
    """Parameters of a shaper over a band.

    Attributes
    ----------
    tolerance
        Largest residual over the band [-].
    half_width
        The band goes from 1 less this to 1 plus this, ratios of the nominal frequency [-].
    impulses
        Their number, 3, 5, 7 or 9; the fewest that serve if None.
    """

    tolerance: float = tolerance_field("Largest residual over the band.")
    half_width: float = field(
        default=0.15,
        metadata={
            "description": "The band goes from 1 less this to 1 plus this, of the frequency.",
            "ge": MIN_HALF_WIDTH,
            "le": MAX_HALF_WIDTH,
        },
    )
    impulses: int | None = field(
        default=None,
        metadata={
            "description": "Number of impulses, 3, 5, 7 or 9; the fewest that serve if not given."
        },
    )

    BAND_FIELDS: ClassVar[tuple[str, ...]] = ("half_width",)

    def __post_init__(self) -> None:
        SettleOptions.__post_init__(self)
        require_between("tolerance", self.tolerance, MIN_TOLERANCE, MAX_TOLERANCE)
        require_between("half_width", self.half_width, MIN_HALF_WIDTH, MAX_HALF_WIDTH)
        if self.impulses is not None and self.impulses not in COUNTS:
            raise InvalidInputError(
                "impulses",
                self.impulses,
                "3, 5, 7 or 9, or left out",
                code="impulse_count_not_served",
            )

    def with_band(self, half_width: float) -> Self:
        """Return the same with a band of a half width around 1."""
        return replace(self, half_width=half_width)


def numsi(case: DesignCase[UnityBandOptions]) -> Formulation:
    """Formulate the fastest shaper within a tolerance over a band.

    ``|V(r)| <= tolerance`` for every ratio ``r`` of true and nominal frequency within the half
    width of 1, by the actuator's own gains at each pole; in the superposed model or the switched.
    No proof is known that a shorter one does not exist: the problem is not convex. Behind limits
    that one lag follows it is, over all courses of the reference, and proven. Behind limits that
    two lags follow it is that of so many switches as behind one, and ramps turn as well.

    Returns
    -------
    Formulation
        A search over problems, one for each number of impulses; one problem behind limits, if
        neither their number nor that drives settle is asked for.

    Raises
    ------
    InfeasibleDesignError
        If ramps and settling take longer than the longest shaper asked for.
    """
    mode, actuator, options = case.mode, case.actuator, case.options
    if isinstance(actuator, RateLimited) and not options.settle and options.impulses is None:
        alike = ramped_band_problem(
            mode,
            actuator,
            half_width=options.half_width,
            tolerance=options.tolerance,
            max_duration_periods=options.max_duration_periods,
        )
        if follows_one_lag(actuator):
            return alike
        actuator.require_straight_ramps()
        return UnequalBandProblem(alike=alike, designed_for=actuator)
    counts = COUNTS if options.impulses is None else (options.impulses,)
    horizon = options.max_duration_periods * PERIOD_RAD
    parameters = lag_parameters(mode, actuator)
    problems = []
    for count in sorted(
        counts, key=lambda one: (_alike(one, options) > FAR * MAX_HALF_WIDTH_OF_COUNT[one], one)
    ):
        shortest = settling_gaps_rad(mode, actuator, count, settle=options.settle)
        if actuator.model == "superposed":
            shortest = np.maximum(shortest, MIN_PULSE_RAD)
        if shortest.sum() <= horizon:
            problems.append(
                UnityBandProblem(
                    model=AlternatingBand(
                        impulses=count,
                        switched_order=switched_order(actuator),
                        ramped=isinstance(actuator, RateLimited),
                    ),
                    parameters=parameters,
                    amplitudes=alternating(count),
                    shortest_gaps_rad=shortest,
                    seeds=_seeds(mode, actuator, count, options),
                )
            )
    if not problems:
        raise InfeasibleDesignError(
            f"ramps and settling between {counts[0]} switches take longer than "
            f"max_duration_periods = {options.max_duration_periods:g}",
            code="switches_exceed_duration",
        )
    return BandSearch(
        problems=tuple(problems),
        tolerance=options.tolerance,
        half_width=options.half_width,
        natural_frequency_rad_s=mode.natural_frequency_rad_s,
        horizon_rad=horizon,
        designed_for=actuator,
    )


def _alike(count: int, options: UnityBandOptions) -> float:
    """Return the half width that would be as hard to reach at the tolerance of the seeds.

    n impulses cancel (n - 1) / 2 derivatives or so: the half width goes by that root of the
    tolerance.
    """
    return options.half_width * float((SEED_TOLERANCE / options.tolerance) ** (2 / (count - 1)))


def _seeds(
    mode: Mode, actuator: Actuator, count: int, options: UnityBandOptions
) -> tuple[Seed, ...]:
    """Seeds of one number of impulses, the nearest half width first.

    A step through the deceleration set acts as if it came later by the phase of the
    sets' ratio.
    """
    alike = _alike(count, options)
    z = mode.damping_ratio
    shift = cmath.phase(decel_over_accel(mode, actuator)) / math.sqrt(1 - z * z)
    seeds = []
    for half_width in sorted(SEEDS[count], key=lambda one: abs(one - alike)):
        times = PERIOD_RAD * np.array(SEEDS[count][half_width])
        times[::2] += shift
        gaps = np.diff(times, prepend=0.0)
        seeds.append(Seed(name=f"undamped_{count}_at_{half_width:g}", gaps_rad=gaps))
    return tuple(seeds)


NUM_SI = KindOf(
    name="num_si",
    summary="Minimum-time unity magnitude, residual within a tolerance over a band of frequencies, "
    "asymmetric actuator.",
    source='specified insensitivity of W. Singhose, W. Seering, N. Singer, "Input shaping for '
    'vibration reduction with specified insensitivity to modeling errors", Japan-USA Symposium on '
    "Flexible Automation (1996), for the actuators of Kim, master thesis (2011), chapter 3",
    claims=("band",),
    options=UnityBandOptions,
    actuators=EVERY_ACTUATOR,
    formulation=numsi,
)
