"""Pictures of maps: units, titles, equal bytes."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from design.fields import Axis, vary
from design.maps.field_map import field_map
from design.maps.map_case import Map, MapCase, Move
from design.model.actuators.ideal import Ideal
from design.model.commands import pulse
from design.pictures.files import figure_bytes
from design.pictures.map_sheet import map_sheet
from design.pipeline import design
from design.shapers.registry import SHAPERS
from tests.integration_route import residual_by_integration
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


MARKED: dict[str, tuple[MapCase, Axis, Axis, tuple[float, float]]] = {
    "once": (case("numzv", each=False), LENGTH, CORNER, (0.8, 20.0)),
    "each": (case("numzv", quantity="times_s"), CORNER, LENGTH, (20.0, 0.8)),
    "move": (case("umzv", each=False, move=Move(pulse_s=2.0)), PULSES, CORNER, (2.0, 20.0)),
    "gains": (MapCase(plant=CRANE, actuator=THESIS, quantity="alpha"), LENGTH, CORNER, (0.8, 20.0)),
}


def marks(figure: Figure) -> list[tuple[float, float]]:
    """Places of the marks of what was given; of a curve the place along the axis."""
    lines = [line for axes in figure.axes for line in axes.lines]
    found = [line for line in lines if line.get_gid() == "as-given"]
    ends = [(np.ravel(one.get_xdata())[0], np.ravel(one.get_ydata())[-1]) for one in found]
    return sorted({(float(across), float(up)) for across, up in ends})


@pytest.mark.parametrize("name", MARKED)
def test_the_plant_as_given_is_marked_in_every_panel(name: str) -> None:
    of, x, y, point = MARKED[name]
    found = field_map(of, x, y)
    figure = map_sheet(of, x, y, found)
    assert marks(figure) == [pytest.approx(point)]
    panels = [axes for axes in figure.axes if axes.collections and axes.get_xlabel() is not None]
    with_mark = [axes for axes in panels if any(one.get_gid() == "as-given" for one in axes.lines)]
    assert len(with_mark) == len(figure.axes) - 1  # all but the scale of colours


def test_a_plant_outside_of_the_map_is_said_to_be_and_not_marked() -> None:
    beyond = Axis(path=LENGTH.path, values=np.array([1.0, 1.2]))
    of = case("umzv", each=False)
    figure = map_sheet(of, beyond, CORNER, field_map(of, beyond, CORNER))
    assert marks(figure) == []
    assert "(outside)" in words(figure)


def test_a_curve_is_marked_by_a_line() -> None:
    of = case("umzv", each=False)
    (mark,) = marks(map_sheet(of, LENGTH, None, field_map(of, LENGTH)))
    assert mark[0] == pytest.approx(0.8)


def words(figure: Figure) -> str:
    return " ".join(text.get_text() for text in figure.texts)


def test_title_and_subtitle_say_what_is_mapped_of_which_shaper_designed_when() -> None:
    told = {}
    for each in (True, False):
        of = case("numzv", each=each)
        figure = map_sheet(of, LENGTH, CORNER, field_map(of, LENGTH, CORNER))
        assert figure.get_suptitle() == "Residual vibration of numzv"
        told[each] = words(figure)
    assert "designed anew in each cell" in told[True]
    assert "designed once, for plant and actuator as given (marked)" in told[False]
    assert "judged by the superposed model" in told[False]
    held = MapCase(plant=CRANE, actuator=Ideal(), shaper=pulse(1.0))
    figure = map_sheet(held, LENGTH, None, field_map(held, LENGTH))
    assert figure.get_suptitle() == "Residual vibration of 2 impulses"
    assert "held in each cell" in words(figure)


DECEL = Axis(
    path=("actuator", "decel", "natural_frequency_rad_s"), values=np.linspace(40.0, 60.0, 3)
)


def written_on(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.texts]


def test_a_map_over_drives_says_where_the_residual_of_the_held_design_is_largest() -> None:
    of = case("numzvd", replace(THESIS, model="switched"), each=False)
    found = field_map(of, CORNER, DECEL)
    command = design(CRANE, of.actuator, SHAPERS["numzvd"]).impulses
    each = {
        (w, v): residual_by_integration(
            command,
            CRANE.mode,
            vary(vary(of.actuator, CORNER.path[1:], w), DECEL.path[1:], v),
        )
        for w in CORNER.values.tolist()
        for v in DECEL.values.tolist()
    }
    (w, v), worst = max(each.items(), key=lambda one: one[1])
    sentence = (
        f"largest {100 * worst:.3g} %, at accel natural frequency {w:g} rad/s, "
        f"decel natural frequency {v:g} rad/s"
    )
    assert sentence in written_on(map_sheet(of, CORNER, DECEL, found))
    anew = case("numzvd", of.actuator, each=True)
    for other, x in ((anew, CORNER), (of, LENGTH)):
        drawn = map_sheet(other, x, DECEL, field_map(other, x, DECEL))
        assert not any(line.startswith("largest ") for line in written_on(drawn))
