"""PS-ZV, PS-ZVD: impulses whose partial sums are 1 in magnitude: the command is at 1 or -1.

They are faster than those of unity magnitude, and swing the drive twice as far.
"""

import math

import numpy as np

from design.formulations.formulation import ClosedForm, Formulation
from design.formulations.gaps import PERIOD_RAD
from design.formulations.seeds import Seed
from design.formulations.unity_magnitude import ZERO_VIBRATION, ZERO_VIBRATION_DERIVATIVE
from design.formulations.unity_magnitude_problem import unity_magnitude_problem
from design.formulations.vector_diagram import undamped_times_rad
from design.model.actuators.ideal import Ideal
from design.model.impulses import Impulses
from design.shapers.actuators import EVERY_ACTUATOR_BY_ITS_LAG
from design.shapers.damping import LAST_PULSE_VANISHES, DampingBound, damped_periods
from design.shapers.kind import DesignCase, KindOf
from design.shapers.negative import MAX_PERIODS, SOURCE
from design.shapers.options import NoOptions

PARTIAL_SUMS = np.array([1.0, -2.0, 2.0])
"""Impulses of PS-ZV: the command is at 1, -1 and 1 [-]."""

PARTIAL_SUMS_DERIVATIVE = np.array([1.0, -2.0, 2.0, -2.0, 2.0])
"""Impulses of PS-ZVD [-]."""

UNDAMPED_PARTIAL_SUMS_RAD = PERIOD_RAD * np.array([0.0, 0.152406, 0.277396, 0.631311, 0.678948])
"""Times of PS-ZVD, undamped, to six digits: the only solution of 7,000 starts within a period."""


def ps_zv(case: DesignCase[NoOptions]) -> Formulation:
    """Formulate the impulses 1, -2, 2, of sums 1 in magnitude.

    The second step takes the command from 1 to -1: which set of an asymmetric actuator drives which
    part of it no model of steps can say. So the actuator is taken to follow its command.
    """
    mode = case.mode
    if mode.damping_ratio == 0:
        phases = undamped_times_rad(1.0, np.zeros(2), 2 * math.pi, PARTIAL_SUMS)
        times = phases / mode.natural_frequency_rad_s
        return ClosedForm(
            impulses=Impulses(times_s=times, amplitudes=PARTIAL_SUMS), designed_for=Ideal()
        )
    return unity_magnitude_problem(
        ZERO_VIBRATION,
        mode,
        Ideal(),
        settle=False,
        max_duration_periods=damped_periods(mode, MAX_PERIODS),
        amplitudes=PARTIAL_SUMS,
    )


def ps_zvd(case: DesignCase[NoOptions]) -> Formulation:
    """Formulate the impulses 1, -2, 2, -2, 2, flat in frequency.

    For an actuator that follows its command, for the reason of `ps_zv`.
    """
    mode = case.mode
    gaps = np.diff(UNDAMPED_PARTIAL_SUMS_RAD) / math.sqrt(1 - mode.damping_ratio**2)
    return unity_magnitude_problem(
        ZERO_VIBRATION_DERIVATIVE,
        mode,
        Ideal(),
        settle=False,
        max_duration_periods=damped_periods(mode, MAX_PERIODS),
        amplitudes=PARTIAL_SUMS_DERIVATIVE,
        seeds=(Seed(name="undamped_partial_sums", gaps_rad=gaps),),
    )


PS_ZV = KindOf(
    name="ps_zv",
    summary="Impulses 1, -2, 2 (partial sums of magnitude 1), zero vibration, for an actuator that "
    "follows its command.",
    source=SOURCE,
    claims=("residual",),
    options=NoOptions,
    actuators=EVERY_ACTUATOR_BY_ITS_LAG,
    formulation=ps_zv,
    damping=DampingBound(most=0.97, beyond=LAST_PULSE_VANISHES),
)

PS_ZVD = KindOf(
    name="ps_zvd",
    summary="Impulses 1, -2, 2, -2, 2 (partial sums of magnitude 1), zero vibration and slope, for "
    "an actuator that follows its command.",
    source=SOURCE,
    claims=("residual", "slope"),
    options=NoOptions,
    actuators=EVERY_ACTUATOR_BY_ITS_LAG,
    formulation=ps_zvd,
    damping=DampingBound(most=0.88, beyond=LAST_PULSE_VANISHES),
)
