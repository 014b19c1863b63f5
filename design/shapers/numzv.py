"""UMZVc, NUMZV, NUMZVD: unity magnitude behind an actuator that brakes at another pace."""

import numpy as np

from design.errors import InvalidInputError
from design.formulations.formulation import ClosedForm, Formulation
from design.formulations.unity_magnitude import (
    PERIOD_RAD,
    ZERO_VIBRATION,
    ZERO_VIBRATION_DERIVATIVE,
    alternating,
    decel_over_accel,
    settling_gaps_rad,
    undamped_times_rad,
    unity_magnitude_problem,
)
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.shapers.kind import PeakOptions, SettleOptions, ShaperKind

SOURCE = "Kim, master thesis (2011), chapter 3"


def numzv(mode: Mode, actuator: Actuator, options: PeakOptions) -> Formulation:
    """Formulate the three-impulse shaper that knows both sets of the actuator.

    Undamped, superposed steps: the closed vector diagram, `undamped_times_rad`. Damped or
    switched: its equations at the plant's pole, solved. Its first pulse is as high as
    ``max_velocity_ratio`` v says, amplitudes v, -v, 1 (Kim 2011, appendix B: UMZVc2).
    """
    peak = options.max_velocity_ratio
    return _three_impulses(mode, actuator, options, None if peak == 1 else (peak, -peak, 1.0))


def numzv_stop(mode: Mode, actuator: Actuator, options: PeakOptions) -> Formulation:
    """Formulate the negative of the stop, amplitudes 1, -v, v, for the actuator swapped."""
    peak = options.max_velocity_ratio
    return _three_impulses(mode, actuator, options, None if peak == 1 else (1.0, -peak, peak))


def _three_impulses(
    mode: Mode, actuator: Actuator, options: SettleOptions, heights: tuple[float, ...] | None
) -> Formulation:
    if heights is not None and isinstance(actuator, RateLimited):
        raise InvalidInputError(
            "shaper.max_velocity_ratio",
            abs(heights[1]),
            "1 behind a rate-limited actuator, whose ramps are taken to be those of one speed",
        )
    amplitudes = None if heights is None else np.array(heights)
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
    return unity_magnitude_problem(
        ZERO_VIBRATION,
        mode,
        actuator,
        settle=options.settle,
        max_duration_periods=options.max_duration_periods,
        amplitudes=amplitudes,
    )


def numzvd(mode: Mode, actuator: Actuator, options: SettleOptions) -> Formulation:
    """Formulate the five-impulse minimum-time shaper, robust in frequency.

    V = 0 and dV/dw = 0, the actuator's own slope included, which the thesis leaves out.
    """
    return unity_magnitude_problem(
        ZERO_VIBRATION_DERIVATIVE,
        mode,
        actuator,
        settle=options.settle,
        max_duration_periods=options.max_duration_periods,
    )


UMZVC = ShaperKind(
    name="umzvc",
    summary="Unity magnitude, zero vibration, behind a first-order asymmetric actuator.",
    source=f"{SOURCE}, section 2 and appendix B",
    claims=("residual",),
    options=PeakOptions,
    actuators=("first_order",),
    formulate=numzv,  # the same vector diagram; with G = 1/(1 + tau p) it is the published one
    formulate_stop=numzv_stop,
)

NUMZV = ShaperKind(
    name="numzv",
    summary="Unity magnitude, zero vibration, behind a second-order asymmetric actuator.",
    source=f"{SOURCE}, eqs. 3.34-3.41",
    claims=("residual",),
    options=PeakOptions,
    actuators=("ideal", "first_order", "second_order", "rate_limited"),
    formulate=numzv,
    formulate_stop=numzv_stop,
)

NUMZVD = ShaperKind(
    name="numzvd",
    summary="Minimum-time unity magnitude, zero vibration and slope, asymmetric actuator.",
    source=f"{SOURCE}, eqs. 3.44-3.46, slope exact",
    claims=("residual", "slope"),
    options=SettleOptions,
    actuators=("ideal", "first_order", "second_order", "rate_limited"),
    formulate=numzvd,
)
