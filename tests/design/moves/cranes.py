"""Cranes and kinds of the tests of moves."""

import numpy as np

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.model import Model
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.moves.maneuvers import Maneuver
from design.shapers.registry import SHAPERS
from tests.integration_route import integrate

NUMZV, NUMZVD, UMZVC, UMZVD = (SHAPERS[name] for name in ("numzv", "numzvd", "umzvc", "umzvd"))
MODELS: tuple[Model, ...] = ("superposed", "switched")
SPEED_M_S = 0.2


def levels(move: Maneuver) -> list[float]:
    return [float(level) for level in np.cumsum(move.command.amplitudes)]


def travel_by_integration(command: Impulses, actuator: Actuator) -> float:
    """How far a command goes: the deflection of a payload without restoring force is -x."""
    floating = Mode(natural_frequency_rad_s=1e-9)
    slowest = max(
        lag.first_s + lag.second_s2**0.5 for lag in (actuator.accel_lag, actuator.decel_lag)
    )
    end = float(command.times_s[-1]) + 40 * slowest  # e^-40 of the transient is left
    return -float(integrate(command, floating, actuator, end)[0])


def any_actuator(rng: np.random.Generator, w: float, model: Model) -> Actuator:
    corners = (w * rng.uniform(4, 20, 2)).tolist()
    if rng.random() < 0.3:
        return FirstOrder(
            accel_time_constant_s=1 / corners[0], decel_time_constant_s=1 / corners[1], model=model
        )
    accel, decel = (
        SecondOrderSet(natural_frequency_rad_s=corner, damping_ratio=float(rng.uniform(0.4, 1.6)))
        for corner in corners
    )
    return SecondOrder(accel=accel, decel=decel, model=model)
