"""UMZVc, NUMZV: three impulses behind an actuator that brakes at another pace."""

import numpy as np

from design.errors import InvalidInputError
from design.formulations.behind_limits import behind_limits
from design.formulations.formulation import ClosedForm, Formulation
from design.formulations.gaps import PERIOD_RAD, settling_gaps_rad
from design.formulations.lag_parameters import decel_over_accel
from design.formulations.settled_steps import settled_steps
from design.formulations.unity_magnitude import ZERO_VIBRATION
from design.formulations.unity_magnitude_problem import alternating, unity_magnitude_problem
from design.formulations.vector_diagram import undamped_times_rad
from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.shapers.actuators import EVERY_ACTUATOR
from design.shapers.compiled_rows import CompiledRows
from design.shapers.kind import DesignCase, KindOf
from design.shapers.peak_options import PeakOptions

SOURCE = "Kim, master thesis (2011), chapter 3"


def numzv(case: DesignCase[PeakOptions]) -> Formulation:
    """Formulate the three-impulse shaper that knows both sets.

    Undamped, superposed steps: the closed vector diagram, `undamped_times_rad`. Damped or
    switched: its equations at the plant's pole, solved. Its first pulse is as high as
    ``max_velocity_ratio`` v says, amplitudes v, -v, 1 (Kim 2011, appendix B: UMZVc2); the negative
    of a stop has 1, -v, v.

    Returns
    -------
    Formulation
        A closed form for an undamped mode and superposed steps, else a problem in two gaps.

    Raises
    ------
    InvalidInputError
        If a peak other than 1 is asked for behind a rate-limited actuator.
    InfeasibleDesignError
        If no vector diagram closes within the longest duration asked for, settling included.
    """
    mode, actuator, options = case.mode, case.actuator, case.options
    peak = options.max_velocity_ratio
    heights = (1.0, -peak, peak) if case.is_stop else (peak, -peak, 1.0)
    if peak != 1 and isinstance(actuator, RateLimited):
        raise InvalidInputError(
            "shaper.max_velocity_ratio",
            peak,
            "1 behind a rate-limited actuator, whose ramps are taken to be those of one speed",
            code="velocity_ratio_of_ramps",
        )
    if isinstance(actuator, RateLimited) and not options.settle:
        return behind_limits(
            case.modes,
            actuator,
            derivatives=0,
            max_duration_periods=options.max_duration_periods,
        )
    amplitudes = None if peak == 1 else np.array(heights)
    if mode.damping_ratio == 0 and actuator.model == "superposed":
        phases = undamped_times_rad(
            decel_over_accel(mode, actuator),
            settling_gaps_rad(mode, actuator, 3, settle=options.settle),
            options.max_duration_periods * PERIOD_RAD,
            amplitudes,
        )
        return ClosedForm(
            impulses=Impulses(
                times_s=phases / mode.natural_frequency_rad_s,
                amplitudes=alternating(3) if amplitudes is None else amplitudes,
            ),
            designed_for=actuator,
        )
    if options.settle and peak == 1:
        return settled_steps(
            ZERO_VIBRATION, mode, actuator, max_duration_periods=options.max_duration_periods
        )
    return unity_magnitude_problem(
        ZERO_VIBRATION,
        mode,
        actuator,
        settle=options.settle,
        max_duration_periods=options.max_duration_periods,
        amplitudes=amplitudes,
    )


UMZVC = KindOf(
    name="umzvc",
    summary="Unity magnitude, zero vibration, behind a first-order asymmetric actuator.",
    source=f"{SOURCE}, section 2 and appendix B",
    claims=("residual",),
    options=PeakOptions,
    actuators=("first_order",),
    compiled_rows=CompiledRows(closed_form_undamped=True),
    has_branches=True,
    formulation=numzv,  # the same vector diagram; with G = 1/(1 + tau p) it is the published one
)

NUMZV = KindOf(
    name="numzv",
    summary="Unity magnitude, zero vibration, behind a second-order asymmetric actuator.",
    source=f"{SOURCE}, eqs. 3.34-3.41",
    claims=("residual",),
    options=PeakOptions,
    actuators=EVERY_ACTUATOR,
    formulation=numzv,
    compiled_rows=CompiledRows(closed_form_undamped=True),
    has_branches=True,
)
