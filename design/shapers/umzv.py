"""UMZV and UMZVD: unity magnitude for an actuator that follows its command."""

import numpy as np

from design.formulations.formulation import ClosedForm, Formulation
from design.formulations.ramped import RampedProblem, ramped_problem
from design.formulations.unity_magnitude import ZERO_VIBRATION, ZERO_VIBRATION_DERIVATIVE
from design.formulations.unity_magnitude_problem import alternating, unity_magnitude_problem
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited, follows_one_lag
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.shapers.actuators import EVERY_ACTUATOR
from design.shapers.compiled_rows import CompiledRows
from design.shapers.damping import LAST_PULSE_VANISHES, DampingBound, damped_periods
from design.shapers.kind import DesignCase, KindOf
from design.shapers.options import NoOptions

SOURCE = (
    'W. Singhose, W. Seering, N. Singer, "Time-optimal negative input shapers", '
    "J. Dyn. Sys., Meas., Control 119 (1997)"
)

MAX_PERIODS, MAX_PERIODS_BEHIND_LIMITS = 1.5, 3.0
"""Both shapers take less than one damped period; behind limits a ramp up and one down more [-]."""


def umzv(case: DesignCase[NoOptions]) -> Formulation:
    """Formulate the unity-magnitude zero-vibration shaper of one mode.

    Undamped: steps +1, -1, +1 at 0, T/6, T/3. Damped: the same two equations, solved.
    Of the actuator it knows limits alone, and those only where one lag follows them; the design
    reports the residual behind another.
    """
    mode = case.mode
    if follows_one_lag(case.actuator):
        return _behind_limits(case.modes, case.actuator, derivatives=0)
    if mode.damping_ratio == 0:
        times = mode.period_s * np.array([0.0, 1 / 6, 1 / 3])
        return ClosedForm(
            impulses=Impulses(times_s=times, amplitudes=alternating(3)), designed_for=Ideal()
        )
    return unity_magnitude_problem(
        ZERO_VIBRATION,
        mode,
        Ideal(),
        settle=False,
        max_duration_periods=damped_periods(mode, MAX_PERIODS),
    )


def umzvd(case: DesignCase[NoOptions]) -> Formulation:
    """Formulate `umzv` with zero slope, robust in frequency."""
    mode = case.mode
    if follows_one_lag(case.actuator):
        return _behind_limits(case.modes, case.actuator, derivatives=1)
    return unity_magnitude_problem(
        ZERO_VIBRATION_DERIVATIVE,
        mode,
        Ideal(),
        settle=False,
        max_duration_periods=damped_periods(mode, MAX_PERIODS),
    )


def _behind_limits(
    modes: tuple[Mode, ...], actuator: RateLimited, *, derivatives: int
) -> RampedProblem:
    return ramped_problem(
        modes,
        actuator,
        derivatives=derivatives,
        max_duration_periods=damped_periods(modes[0], MAX_PERIODS_BEHIND_LIMITS),
    )


UMZV = KindOf(
    name="umzv",
    summary="Unity magnitude, zero vibration, for an actuator that follows its command.",
    source=SOURCE,
    claims=("residual",),
    options=NoOptions,
    actuators=EVERY_ACTUATOR,
    formulation=umzv,
    compiled_rows=CompiledRows(for_ideal=True, closed_form_undamped=True),
    damping=DampingBound(most=0.97, beyond=LAST_PULSE_VANISHES),
)

UMZVD = KindOf(
    name="umzvd",
    summary="Unity magnitude, zero vibration and slope, for an actuator that follows its command.",
    source=SOURCE,
    claims=("residual", "slope"),
    options=NoOptions,
    actuators=EVERY_ACTUATOR,
    formulation=umzvd,
    compiled_rows=CompiledRows(for_ideal=True),
    damping=DampingBound(most=0.9, beyond=LAST_PULSE_VANISHES),
)
