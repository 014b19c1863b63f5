"""The observer of live shaping, on the rig: what it finds, and what it saves on another crane."""

from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np
import pytest

from design.analysis.residual import residual_vibration
from design.live.machine import LiveMachine
from design.live.observer import Noise, init, update, with_observed
from design.live.planning import solve_plan, task_of
from design.live.propagation import carry
from design.live.state import AxisState, at_rest
from design.model.impulses import Impulses
from design.model.plants.double_pendulum import DoublePendulum
from design.rig.camera import Camera, Frame
from design.rig.controlled import Reading, run_controlled
from design.rig.crane import Crane
from design.rig.machine import Machine
from tests.design.live.machines import CRANE, KIM
from tests.design.live.test_comparison import row_of
from tests.refusals import refused

ASSUMED = LiveMachine(plant=CRANE, actuator=KIM)
TASK = task_of(KIM, ASSUMED.modes, ASSUMED.max_iterations)
SPEED_M_S, SAMPLE_S = 0.2, 0.001

# A pulse of the encoder is 0.98 full speeds in a sample, a pixel of the camera 5 ms of deflection.
NOISE = Noise(velocity=1.5, deflection_s=0.006, drive_drift=0.1, swing_drift=0.15)

RELEASES_S = (0.4, 0.9, 1.2, 1.5, 1.9, 2.3, 2.7, 3.1)


def planned(axis: AxisState, target: float) -> AxisState:
    found = solve_plan(TASK, axis.kind, axis, target)
    assert found is not None
    return found


@dataclass
class Controller:
    """Live shaping of a press that is let go, from the state observed or the model's."""

    release_s: float
    watched: bool
    camera: Camera
    times_s: list[float] = field(default_factory=list)
    levels: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.model = planned(at_rest(1, ASSUMED.kind), 1.0)
        self.observer = init(ASSUMED, self.model)
        self.position_m: float | None = None
        self.frame: Frame | None = None
        self.released = False

    def __call__(self, reading: Reading) -> tuple[float, float]:
        velocity = deflection_s = None
        if self.position_m is not None:
            velocity = (reading.position_m[0] - self.position_m) / SAMPLE_S / SPEED_M_S
        self.position_m = reading.position_m[0]
        if reading.frame is not None and reading.frame is not self.frame:
            self.frame = reading.frame
            angle = float(self.camera.angles_rad(reading.frame, reading.cable_length_m)[0])
            deflection_s = reading.cable_length_m * angle / SPEED_M_S
        now_s = reading.at_s
        self.model = carry(TASK.rows, self.model, now_s)
        self.observer = update(
            ASSUMED, self.observer, now_s, NOISE, velocity=velocity, deflection_s=deflection_s
        )
        if not self.released and now_s >= self.release_s:
            self.released = True
            start = with_observed(self.model, self.observer) if self.watched else self.model
            self.model = carry(TASK.rows, planned(start, 0.0), now_s)
            seen = replace(self.observer.axis, plan=planned(start, 0.0).plan)
            self.observer = replace(self.observer, axis=carry(TASK.rows, seen, now_s))
            self.observer = update(ASSUMED, self.observer, now_s, NOISE)
        if not self.levels or self.model.level != self.levels[-1]:
            self.times_s.append(now_s)
            self.levels.append(self.model.level)
        return self.model.level, 0.0


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


def test_a_wrong_state_is_found_by_the_readings_of_the_rig() -> None:
    camera = Camera()
    controller = Controller(9.0, False, camera)
    axis = controller.observer.axis
    wrong = replace(axis, rings=axis.rings + np.array([[0.3, -0.2, 0.0, 0.0]]))
    controller.observer = replace(init(ASSUMED, wrong), covariance=np.diag([0.0, 0.0, 0.1, 0.1]))
    crane = Crane(cable_length_m=CRANE.cable_length_m, gravity_m_s2=CRANE.gravity_m_s2)
    run_controlled(Machine(crane, (KIM, KIM), SPEED_M_S), controller, SAMPLE_S, 4.0, None, camera)
    found, true = controller.observer.axis.vibration[0], controller.model.vibration[0]
    assert abs(found - true) < 0.02


def test_what_cannot_be_observed_is_refused() -> None:
    double = DoublePendulum(
        hook_mass_kg=1.0, load_mass_kg=1.0, cable_length_m=0.5, load_length_m=0.3
    )
    with refused("modes_not_observed", "plant.modes", says="one mode"):
        init(replace(ASSUMED, plant=double), at_rest(2, ASSUMED.kind))
    superposed = replace(ASSUMED, actuator=replace(KIM, model="superposed"))
    rest = at_rest(1, ASSUMED.kind)
    with refused("drive_not_observed", "actuator.model", says="superposed"):
        init(superposed, rest)
    later = update(ASSUMED, init(ASSUMED, rest), 1.0, NOISE)
    with refused("sample_in_the_past", "at_s", says="at 1 s"):
        update(ASSUMED, later, 0.5, NOISE)
    with refused("observer_of_another_state", "observer", says="at 1 s"):
        with_observed(rest, later)
    with refused("not_positive", "velocity"):
        replace(NOISE, velocity=0.0)
    with refused("out_of_range", "velocity", says="nan"):
        update(ASSUMED, later, 1.1, NOISE, velocity=float("nan"))
