"""An axis carried in closed form: theory, invariance, and the matrix exponential's route."""

from dataclasses import replace

import numpy as np
import pytest

from design.live.kernel import lag_flow
from design.live.machine import LiveKind, LiveMachine
from design.live.propagation import carry
from design.live.state import AxisState, Plan, at_rest
from design.model.actuators.rate_limited import RateLimited, Unlimited
from design.model.lag_motions import free_motions
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.scheduled import Scheduled
from design.response.simulation import ringing_after
from tests.design.live.machines import CRANE, DRIVES, KIM, command, rows_of
from tests.refusals import refused

PLAN = Plan(times_s=(0.0, 0.2, 0.6, 1.3, 1.5, 1.9), levels=(1.0, 0.0, 1.0, 0.0, -1.0, -0.5))
TWO = Modes(
    modes=(
        Mode(natural_frequency_rad_s=3.2, damping_ratio=0.02),
        Mode(natural_frequency_rad_s=11.0, damping_ratio=0.05),
    )
)

by_drive = pytest.mark.parametrize("drive", DRIVES)


def carried(machine: LiveMachine, plan: Plan, until_s: float) -> AxisState:
    """Return an axis that was at rest before its plan."""
    return carry(
        rows_of(machine), replace(at_rest(len(machine.modes), machine.kind), plan=plan), until_s
    )


@by_drive
def test_a_plan_leaves_what_the_matrix_exponential_says(drive: Unlimited) -> None:
    machine = LiveMachine(plant=TWO, actuator=drive)
    done = carried(machine, PLAN, PLAN.times_s[-1])
    frequencies, dampings = (
        np.array([getattr(mode, name) for mode in TWO.modes])
        for name in ("natural_frequency_rad_s", "damping_ratio")
    )
    ringing, _, _ = ringing_after(command(PLAN.times_s, PLAN.levels), drive, frequencies, dampings)
    assert np.abs(np.array(done.vibration) - ringing).max() < 1e-12
    assert done.level == -0.5
    assert done.plan == Plan()


@by_drive
def test_the_slope_is_that_of_frequencies_beside(drive: Unlimited) -> None:
    step = 1e-5
    beside = []
    for sign in (-1, 1):
        mode = replace(TWO.modes[0], natural_frequency_rad_s=3.2 * np.exp(sign * step))
        machine = LiveMachine(plant=mode, actuator=drive)
        beside.append(carried(machine, PLAN, 2.2).vibration[0])
    done = carried(LiveMachine(plant=TWO.modes[0], actuator=drive), PLAN, 2.2)
    assert abs(done.slope[0] - (beside[1] - beside[0]) / (2 * step)) < 1e-8


@by_drive
def test_carrying_in_parts_is_carrying_at_once(drive: Unlimited) -> None:
    machine = LiveMachine(
        plant=TWO, actuator=replace(drive, dead_time_s=0.13) if drive.kind != "ideal" else drive
    )
    rows = rows_of(machine)
    parts = replace(at_rest(2, machine.kind), plan=PLAN)
    for until_s in (0.05, 0.2, 0.7, 0.75, 2.1, 2.6):
        parts = carry(rows, parts, until_s)
    whole = carried(machine, PLAN, 2.6)
    assert np.abs(parts.rings - whole.rings).max() < 1e-13
    assert np.abs(parts.lag - whole.lag).max() < 1e-13


@by_drive
def test_a_mirrored_plan_leaves_the_mirrored_state(drive: Unlimited) -> None:
    machine = LiveMachine(plant=CRANE, actuator=drive)
    mirrored = replace(PLAN, levels=tuple(-one for one in PLAN.levels))
    one, other = (carried(machine, plan, 2.0) for plan in (PLAN, mirrored))
    assert np.array_equal(one.rings, -other.rings)
    assert np.array_equal(one.lag, -other.lag)


def test_a_dead_time_shifts_all_that_happens() -> None:
    late = LiveMachine(plant=CRANE, actuator=replace(KIM, dead_time_s=0.3))
    soon = LiveMachine(plant=CRANE, actuator=KIM)
    assert carried(late, PLAN, 2.3).vibration == pytest.approx(
        carried(soon, PLAN, 2.0).vibration, abs=1e-14
    )


@pytest.mark.parametrize("first_s", [0.0, 0.05, 0.19999999, 0.2, 0.20000001, 0.21, 3.0])
def test_lags_move_as_the_closed_form_says(first_s: float) -> None:
    second_s2 = 0.01 if first_s else 0.0
    for elapsed_s in (0.0, 1e-9, 0.003, 0.2, 4.0):
        flow = np.array(lag_flow(first_s, second_s2, elapsed_s)).reshape(2, 2)
        known = free_motions(np.array(first_s), np.array(second_s2), np.array(elapsed_s))
        corner = 10.0 if first_s else 1.0
        scaled = known * np.array([[1.0, 1 / corner], [corner, 1.0]])
        assert np.abs(flow - scaled).max() < 1e-13


def test_what_is_not_served_is_refused() -> None:
    limited = RateLimited(accel_limit_m_s2=1.0, decel_limit_m_s2=2.0, speed_m_s=0.2)
    with refused("drive_not_live", "actuator.kind", says="delay line"):
        LiveMachine(plant=CRANE, actuator=limited)  # type: ignore[arg-type]
    ranged = Scheduled(first=CRANE, last=replace(CRANE, cable_length_m=1.0))
    with refused("plant_not_live", "plant.kind"):
        LiveMachine(plant=ranged, actuator=KIM)  # type: ignore[arg-type]
    with refused("kind_not_live", "kind", says="numzv, numzvd"):
        LiveKind(name="zv")
