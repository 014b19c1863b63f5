"""Unity magnitude for several modes behind an actuator that brakes at another pace."""

import math
from dataclasses import dataclass, field, replace

from design.checks import require_between
from design.errors import InvalidInputError
from design.formulations.behind_limits import behind_limits
from design.formulations.formulation import Formulation
from design.formulations.gaps import PERIOD_RAD
from design.formulations.steps_for_modes import promises_of, steps_problem
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.modes import MAX_MODES
from design.shapers.actuators import EVERY_ACTUATOR
from design.shapers.kind import DesignCase, KindOf
from design.shapers.options import ShaperOptions
from design.shapers.settle_options import MAX_HORIZON_PERIODS, MIN_HORIZON_PERIODS

LEAST_PULSE_SHARE = 0.01
"""Usual least pulse of superposed steps of two sets, over the period of the fastest mode [-].

Two steps that nearly coincide leave something in that model alone, where each is answered by
another set: no drive can follow them.
"""

MAX_LEAST_PULSE_S = 1e3
"""Longest least pulse that may be asked for: more than any shaper takes [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeveralModesOptions(ShaperOptions):
    """Parameters of steps for several modes.

    Attributes
    ----------
    slope
        Whether the residual of each mode is flat at its frequency too.
    least_pulse_s
        Shortest time between two steps; None for what the model of the actuator needs [s].
    max_duration_periods
        Longest shaper searched, in undamped periods of the slowest mode [-].
    """

    slope: bool = field(
        default=False,
        metadata={"description": "Make the slope of each mode's residual zero too."},
    )
    least_pulse_s: float | None = field(
        default=None,
        metadata={
            "description": "Shortest time between two steps [s]. If not given, superposed steps "
            "of two sets keep a hundredth of the fastest period, and others only their order.",
            "ge": 0.0,
            "le": MAX_LEAST_PULSE_S,
        },
    )
    max_duration_periods: float = field(
        default=3.0,
        metadata={
            "description": "Longest shaper searched, in undamped periods of the slowest mode.",
            "ge": MIN_HORIZON_PERIODS,
            "le": MAX_HORIZON_PERIODS,
        },
    )

    def __post_init__(self) -> None:
        require_between(
            "max_duration_periods",
            self.max_duration_periods,
            MIN_HORIZON_PERIODS,
            MAX_HORIZON_PERIODS,
        )
        if self.least_pulse_s is not None:
            require_between("least_pulse_s", self.least_pulse_s, 0.0, MAX_LEAST_PULSE_S)


def num_multi(case: DesignCase[SeveralModesOptions]) -> Formulation:
    """Formulate the fastest steps up and down that leave nothing in any mode.

    V = 0 at the pole of each mode, and dV/d ln w = 0 too where slopes are asked for, the actuator's
    own slope included: 2n + 1 steps for n modes, or 4n + 1. Behind limits it has as many as the
    fastest course of the reference takes.

    Returns
    -------
    Formulation
        A problem in the gaps, or one of the reference behind limits.

    Raises
    ------
    InvalidInputError
        If a least pulse is given behind limits, or is too long for the steps.
    """
    options, count = case.options, len(case.modes)
    if isinstance(case.actuator, RateLimited):
        if options.least_pulse_s is not None:
            raise InvalidInputError(
                "shaper.least_pulse_s",
                options.least_pulse_s,
                "left out behind a rate-limited actuator, where the fastest course of the "
                "reference says when its command changes",
                code="least_pulse_behind_limits",
            )
        problem = behind_limits(
            case.modes,
            case.actuator,
            derivatives=int(options.slope),
            max_duration_periods=options.max_duration_periods,
        )
        return replace(problem, claims=promises_of(count, slopes=options.slope))
    return steps_problem(
        case.modes,
        case.actuator,
        slopes=options.slope,
        shortest_gap_s=_least_pulse_s(case),
        max_duration_periods=options.max_duration_periods,
    )


def _least_pulse_s(case: DesignCase[SeveralModesOptions]) -> float:
    """Return the shortest time between two steps [s]; 0 for any."""
    options = case.options
    if options.least_pulse_s is None:
        drive = case.actuator
        added = drive.model == "superposed" and drive.accel_lag != drive.decel_lag
        fastest_s = min(mode.period_s for mode in case.modes)
        return LEAST_PULSE_SHARE * fastest_s if added else 0.0
    gaps = 2 * len(case.modes) * (1 + options.slope)
    slowest_rad_s = min(mode.natural_frequency_rad_s for mode in case.modes)
    most_s = options.max_duration_periods * PERIOD_RAD / slowest_rad_s / gaps
    if options.least_pulse_s >= most_s:
        raise InvalidInputError(
            "shaper.least_pulse_s",
            options.least_pulse_s,
            f"below {math.floor(most_s * 1e4) / 1e4:g} s here, so that {gaps} of them take less "
            f"than max_duration_periods, {options.max_duration_periods:g} periods of the slowest "
            "mode",
            code="least_pulse_too_long",
        )
    return options.least_pulse_s


NUM_MULTI = KindOf(
    name="num_multi",
    summary="Minimum-time unity magnitude, zero vibration in each of up to six modes, and slope if "
    "asked, asymmetric actuator.",
    source="Kim, master thesis (2011), chapter 3, eqs. 3.44-3.46 for one mode; for several modes "
    "of a double-pendulum crane: W. Singhose, D. Kim, M. Kenison, J. Dyn. Sys., Meas., Control "
    "130 (2008)",
    claims=("residual",),
    options=SeveralModesOptions,
    actuators=EVERY_ACTUATOR,
    formulation=num_multi,
    most_modes=MAX_MODES,
)
