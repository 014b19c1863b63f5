"""UMZVc, NUMZV, NUMZVD: unity magnitude behind an actuator that brakes at another pace."""

from design.actuators import Actuator
from design.impulses import Impulses
from design.plants import Mode
from design.shapers.kind import SettleOptions, ShaperKind
from design.shapers.problem import ClosedForm, Formulation
from design.shapers.unity_magnitude import (
    PERIOD_RAD,
    ZERO_VIBRATION,
    ZERO_VIBRATION_DERIVATIVE,
    alternating,
    decel_over_accel,
    settling_gaps_rad,
    undamped_times_rad,
    unity_magnitude_problem,
)

SOURCE = "Kim, master thesis (2011), chapter 3"


def numzv(mode: Mode, actuator: Actuator, options: SettleOptions) -> Formulation:
    """Formulate the three-impulse shaper that knows both sets of the actuator.

    Undamped, superposed steps: the closed vector diagram, `undamped_times_rad`. Damped or
    switched: its equations at the plant's pole, solved.
    """
    if mode.damping_ratio == 0 and actuator.model == "superposed":
        phases = undamped_times_rad(
            decel_over_accel(mode, actuator),
            settling_gaps_rad(mode, actuator, 3, settle=options.settle),
            options.max_duration_periods * PERIOD_RAD,
        )
        return ClosedForm(
            impulses=Impulses(
                times_s=phases / mode.natural_frequency_rad_s, amplitudes=alternating(3)
            ),
            designed_for=actuator,
        )
    return unity_magnitude_problem(
        ZERO_VIBRATION,
        mode,
        actuator,
        settle=options.settle,
        max_duration_periods=options.max_duration_periods,
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
    source=f"{SOURCE}, section 2",
    claims=("residual",),
    options=SettleOptions,
    actuators=("first_order",),
    formulate=numzv,  # the same vector diagram; with G = 1/(1 + tau p) it is the published one
)

NUMZV = ShaperKind(
    name="numzv",
    summary="Unity magnitude, zero vibration, behind a second-order asymmetric actuator.",
    source=f"{SOURCE}, eqs. 3.34-3.41",
    claims=("residual",),
    options=SettleOptions,
    actuators=("ideal", "first_order", "second_order", "rate_limited"),
    formulate=numzv,
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
