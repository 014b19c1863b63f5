"""Cases and fields of the tests of maps."""

from typing import Any, Literal

import numpy as np

from design.fields import Axis
from design.maps.map_case import MapCase, Move, Quantity, Recipe
from design.model.actuators.registry import Actuator
from design.shapers.registry import SHAPERS
from tests.shaper_table import CRANE, THESIS

LENGTH = Axis(path=("plant", "cable_length_m"), values=np.linspace(0.5, 1.2, 7))

CORNER = Axis(
    path=("actuator", "accel", "natural_frequency_rad_s"), values=np.linspace(12.0, 40.0, 5)
)

PULSES = Axis(path=("move", "pulse_s"), values=np.linspace(0.2, 3.0, 15))
FREQUENCY = 3.5017852589786254  # of the crane, sqrt(9.81 / 0.8)


def case(
    name: str,
    actuator: Actuator = THESIS,
    *,
    each: bool = True,
    move: Move | None = None,
    quantity: Quantity = "residual",
    designed_for: Literal["superposed", "switched"] | None = None,
    speed_m_s: float | None = None,
    **options: Any,
) -> MapCase:
    kind = SHAPERS[name]
    recipe = Recipe(
        kind=kind, options=kind.options(**options), each=each, designed_for=designed_for
    )
    return MapCase(
        plant=CRANE,
        actuator=actuator,
        shaper=recipe,
        move=move,
        quantity=quantity,
        speed_m_s=speed_m_s,
    )
