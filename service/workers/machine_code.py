"""Machine code of runs and live sessions, loaded once: in the fork server."""

from design.live.hoist import HoistRequest
from design.live.hoist_kernel import search_hoisting
from design.live.kernel import search
from design.live.machine import LiveMachine
from design.live.session import Press, event, init
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.pendulum import Pendulum
from design.rig.crane import Crane
from design.rig.machine import Machine
from design.rig.march import march
from design.tables.compiled import is_kept_for_some


def move_crane() -> None:
    """Move a crane a little."""
    lag = SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8)
    drive = SecondOrder(accel=lag, decel=lag, model="switched")
    machine = Machine(Crane(cable_length_m=1.0), (drive, drive), 0.1)
    machine.command("x", 1.0)
    machine.advance(0.1)


def shape_live() -> None:
    """Press a button and let it go."""
    lag = SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8)
    drive = SecondOrder(accel=lag, decel=lag, model="switched")
    machine = LiveMachine(plant=Pendulum(cable_length_m=1.0), actuator=drive)
    state = event(machine, init(machine), 0.0, Press(x=1.0))
    event(machine, state, 0.3, Press(x=0.0))


def hoist_live() -> None:
    """Press a button while the cable is hoisted."""
    lag = SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8)
    drive = SecondOrder(accel=lag, decel=lag, model="switched")
    machine = LiveMachine(plant=Pendulum(cable_length_m=1.0), actuator=drive)
    up = HoistRequest(cable_length_m=0.8, over_s=1.0)
    event(machine, event(machine, init(machine), 0.0, up), 0.1, Press(x=1.0))


def load_machine_code() -> None:
    """Load what is on disk.

    What is not there is compiled by the first who needs it, in a worker: to compile it takes many
    seconds, in which the service would not answer.
    """
    for function, use in ((march, move_crane), (search, shape_live), (search_hoisting, hoist_live)):
        if is_kept_for_some(function):
            use()
