"""The page on moves names the kinds that moves take, all of them."""

import re

from design.errors import DesignError
from design.model.actuators.first_order import FirstOrder
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import maneuver
from design.shapers.kind import ShaperKind
from design.shapers.registry import SHAPERS
from tests.pages.reading import prose

DRIVE = FirstOrder(accel_time_constant_s=0.3, decel_time_constant_s=0.15, model="switched")


def is_taken(kind: ShaperKind) -> bool:
    try:
        maneuver(Pendulum(cable_length_m=9.0), DRIVE, kind, speed_m_s=1.0, distance_m=40.0)
    except DesignError:
        return False
    return True


def test_the_page_names_the_kinds_that_moves_take() -> None:
    (line,) = re.findall(r"^- Moves take kinds .*$", prose("docs/moves.md"), flags=re.MULTILINE)
    assert set(re.findall(r"`(\w+)`", line)) == {
        name for name, kind in SHAPERS.items() if is_taken(kind)
    }
