"""Pictures of maps: units, titles, equal bytes."""

import numpy as np
import pytest

from design.fields import Axis
from design.maps.field_map import field_map
from design.maps.map_case import Map, MapCase, Move
from design.pictures.design_sheet import figure_bytes
from design.pictures.map_sheet import map_sheet
from tests.map_cases import CORNER, LENGTH, PULSES, case
from tests.shaper_table import CRANE, THESIS


def test_a_picture_of_a_map_has_units_and_equal_bytes() -> None:
    of = case("numzvd", each=False)
    found = field_map(of, CORNER, LENGTH)
    figure = map_sheet(of, CORNER, LENGTH, found)
    assert figure.axes[0].get_xlabel() == "accel natural frequency [rad/s]"
    assert figure.axes[0].get_ylabel() == "cable length [m]"
    assert figure.axes[-1].get_ylabel() == "residual vibration [%]"
    first, second = (
        figure_bytes(map_sheet(of, CORNER, LENGTH, found), "png") for _ in range(2)
    )  # fmt: skip
    assert first == second


PICTURED: dict[str, tuple[MapCase, Axis, Axis | None, int]] = {
    "times, curves": (case("numzvd", quantity="times_s"), LENGTH, None, 1),
    "times, panels": (case("numzv", quantity="times_s"), LENGTH, CORNER, 3),
    "branch": (case("numzv", quantity="branch", settle=True), LENGTH, CORNER, 4),
    "alpha": (MapCase(plant=CRANE, actuator=THESIS, quantity="alpha"), LENGTH, CORNER, 2),
    "beta": (MapCase(plant=CRANE, actuator=THESIS, quantity="beta_rad"), LENGTH, None, 1),
    "moves": (case("umzv", each=False, move=Move(pulse_s=2.0)), PULSES, CORNER, 2),
    "one cell": (
        case("umzv"),
        Axis(path=LENGTH.path, values=np.array([0.8])),
        Axis(path=CORNER.path, values=np.array([20.0])),
        2,
    ),
    "nothing": (case("numzv", max_duration_periods=0.2), LENGTH, CORNER, 2),
    "no curve": (case("numzv", max_duration_periods=0.2), LENGTH, None, 1),
}


@pytest.mark.parametrize("name", PICTURED)
def test_each_quantity_is_drawn_with_a_title_and_units(name: str) -> None:
    of, x, y, panels = PICTURED[name]
    found: Map = field_map(of, x, y)
    figure = map_sheet(of, x, y, found)
    assert len(figure.axes) == panels  # that of the colours included
    assert figure.get_suptitle()
    assert figure_bytes(figure, "png").startswith(b"\x89PNG")
