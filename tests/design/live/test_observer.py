"""The observer of live shaping: what it finds by the readings of the rig, and what it refuses."""

from dataclasses import replace

import numpy as np

from design.live.observer import init, update, with_observed
from design.live.state import at_rest
from design.model.plants.double_pendulum import DoublePendulum
from design.rig.camera import Camera
from design.rig.controlled import run_controlled
from design.rig.crane import Crane
from design.rig.machine import Machine
from tests.design.live.machines import CRANE, KIM
from tests.design.live.watched import ASSUMED, NOISE, SAMPLE_S, SPEED_M_S, Controller
from tests.refusals import refused


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
