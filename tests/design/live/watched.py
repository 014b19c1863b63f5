"""Live shaping on the rig by sampled readings, from the state observed or from the model's."""

from dataclasses import dataclass, field, replace

from design.live.machine import LiveMachine
from design.live.observer import Noise, init, update, with_observed
from design.live.planning import solve_plan, task_of
from design.live.propagation import carry
from design.live.state import AxisState, at_rest
from design.rig.camera import Camera, Frame
from design.rig.controlled import Reading
from tests.design.live.machines import CRANE, KIM

ASSUMED = LiveMachine(plant=CRANE, actuator=KIM)
TASK = task_of(KIM, ASSUMED.modes, ASSUMED.max_iterations)
SPEED_M_S, SAMPLE_S = 0.2, 0.001

# A pulse of the encoder is 0.98 full speeds in a sample, a pixel of the camera 5 ms of deflection.
NOISE = Noise(velocity=1.5, deflection_s=0.006, drive_drift=0.1, swing_drift=0.15)


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
