"""What an observer saves on a crane whose cable is not the one assumed, and what noise costs."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from design.analysis.residual import residual_vibration
from design.model.impulses import Impulses
from design.rig.camera import Camera
from design.rig.controlled import run_controlled
from design.rig.crane import Crane
from design.rig.machine import Machine
from tests.design.live.machines import CRANE, KIM
from tests.design.live.test_comparison import row_of
from tests.design.live.watched import SAMPLE_S, SPEED_M_S, Controller

RELEASES_S = (0.4, 0.9, 1.2, 1.5, 1.9, 2.3, 2.7, 3.1)


@cache
def left(share: float, *, watched: bool) -> float:
    """Return the median of what presses leave on a crane whose cable is off by a share [%]."""
    plant = replace(CRANE, cable_length_m=CRANE.cable_length_m * (1 + share))
    crane = Crane(cable_length_m=plant.cable_length_m, gravity_m_s2=CRANE.gravity_m_s2)
    residuals = []
    for seed, release_s in enumerate(RELEASES_S):
        camera = Camera()
        controller = Controller(release_s, watched, camera)
        machine = Machine(crane, (KIM, KIM), SPEED_M_S)
        run_controlled(machine, controller, SAMPLE_S, release_s + 1.0, None, camera, seed)
        steps = np.diff(controller.levels, prepend=0.0)
        sent = Impulses(times_s=np.array(controller.times_s), amplitudes=steps)
        residuals.append(100 * residual_vibration(sent, plant.mode, KIM))
    return float(np.median(residuals))


@pytest.mark.parametrize("share", [-0.05, 0.05])
def test_less_is_left_on_a_crane_whose_cable_is_not_the_one_assumed(share: float) -> None:
    assert left(share, watched=True) < 0.75 * left(share, watched=False)


def test_the_table_of_the_page_is_what_is_found() -> None:
    for name, share in (("shorter by 5 %", -0.05), ("as assumed", 0.0), ("longer by 5 %", 0.05)):
        found = [left(share, watched=watched) for watched in (False, True)]
        assert row_of(name) == pytest.approx(found, abs=0.06), name


def test_noise_alone_leaves_about_what_the_samples_leave() -> None:
    assert left(0.0, watched=False) < 0.5  # switches at whole milliseconds
    assert left(0.0, watched=True) < 1.5
