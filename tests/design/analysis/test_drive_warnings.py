"""Warnings of the drive: one a set, however many switches are early."""

import math

import numpy as np

from design.analysis.drive_warnings import drive_warnings
from design.model.actuators.first_order import FirstOrder
from design.model.impulses import Impulses
from design.model.plants.mode import Mode

MODE = Mode(natural_frequency_rad_s=2.0, damping_ratio=0.0)
DRIVE = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.2)


COUNTED_ON = "; the design counts on it, and is right where the model of the drive is"
"""How each of these warnings ends."""


def test_early_switches_of_a_set_are_one_warning_of_the_least_settled() -> None:
    times = np.array([0.0, 0.05, 0.15, 0.55, 0.6, 2.0])
    command = Impulses(times_s=times, amplitudes=np.array([1.0, -1.0, 1.0, -1.0, 0.5, 0.5]))
    accel, decel = drive_warnings(command, (MODE,), DRIVE)
    # Gaps: .05 s after a rise, .1 after a fall, .4 after a rise, .05 after a fall, 1.4 after one.
    assert accel.detail == (
        f"the accel set has made {100 * (1 - math.exp(-0.5)):.3g} % of switch 1 when the next one "
        f"follows, 0.05 s after it{COUNTED_ON}"
    )
    assert decel.detail == (
        f"the decel set has made {100 * (1 - math.exp(-0.25)):.3g} % of switch 4 when the next one "
        f"follows, 0.05 s after it; 1 more of its switches are early{COUNTED_ON}"
    )
    assert {accel.code, decel.code} == {"actuator_not_settled"}
