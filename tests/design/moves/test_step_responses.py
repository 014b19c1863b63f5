"""What steps make, held against a simulation that shares no code with it."""

import numpy as np
import pytest

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode
from design.moves.step_responses import step_responses
from design.solvers.nearest_point import Polyhedron, nearest_point
from tests import expm_route

MODE = Mode(natural_frequency_rad_s=5.0, damping_ratio=0.04)
SETS = (
    SecondOrderSet(natural_frequency_rad_s=17.0, damping_ratio=0.7),
    SecondOrderSet(natural_frequency_rad_s=23.0, damping_ratio=0.5),
)
DRIVES = [
    Ideal(),
    FirstOrder(accel_time_constant_s=0.05, decel_time_constant_s=0.11),
    FirstOrder(accel_time_constant_s=0.05, decel_time_constant_s=0.11, model="switched"),
    SecondOrder(accel=SETS[0], decel=SETS[1], model="switched"),
]


@pytest.mark.parametrize("drive", DRIVES)
def test_all_is_linear_in_the_steps(drive: Actuator) -> None:
    times = np.array([0.0, 0.1, 0.3, 0.5, 0.9, 1.0, 1.7, 1.8, 2.2])
    steps = np.array([0.3, 0.7, -0.8, -0.2, 0.4, 0.6, -0.9, 0.1, -0.2])
    found = step_responses(times, steps > 0, MODE, drive, swing=None, slope=False)
    played = expm_route.outcome(Impulses(times_s=times, amplitudes=steps), MODE, drive)
    assert abs(found.vectors[0] @ steps) == pytest.approx(played.residual, abs=1e-12)
    assert found.travel_s @ steps == pytest.approx(played.travel, abs=1e-12)


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("frequency_power", [0, -2])
def test_a_swing_adds_to_it(drive: Actuator, frequency_power: int) -> None:
    times, steps = np.array([0.0, 0.4, 1.1]), np.array([0.6, 0.4, -1.0])
    swing = FreeSwing(deflection_s=0.03, rate=-0.2, frequency_power=frequency_power)
    found = step_responses(times, steps > 0, MODE, drive, swing=swing, slope=False)
    command = Impulses(times_s=times, amplitudes=steps)
    played = expm_route.outcome(command, MODE, drive, (0.03, -0.2))
    left = found.vectors[0] @ steps + found.swings[0]
    assert abs(left) == pytest.approx(played.residual, abs=1e-12)


@pytest.mark.parametrize("drive", DRIVES)
def test_the_second_row_is_the_slope_where_nothing_remains(drive: Actuator) -> None:
    times = np.linspace(0.0, 2.4, 9)
    rising = np.arange(9) % 2 == 0
    found = step_responses(times, rising, MODE, drive, swing=None, slope=True)
    signs = np.where(rising, 1.0, -1.0)
    nothing_remains = Polyhedron(
        equations=np.array([found.vectors[0].real, found.vectors[0].imag]),
        wanted=np.zeros(2),
        bounds=np.diag(signs),
        least=np.full(times.size, 0.01),
    )
    steps = nearest_point(0.3 * signs, nothing_remains)
    assert steps is not None
    command = Impulses(times_s=times, amplitudes=steps)
    assert expm_route.outcome(command, MODE, drive).residual < 1e-12
    slope = expm_route.slope(command, MODE, drive)
    assert abs(found.vectors[1] @ steps) == pytest.approx(slope, rel=1e-6)
