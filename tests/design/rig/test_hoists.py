"""Courses of lengths as hoists, and what swings from a moment on."""

from itertools import pairwise

import numpy as np
import pytest

from design.model.plants.hoisting import Hoisting, LengthCourse
from design.model.plants.pendulum import Pendulum
from design.rig.crane import Crane
from design.rig.hoists import hoists_of, plant_from
from design.rig.machine import Machine
from design.rig.scenario import HoistTo
from tests.design.rig.cranes import THESIS

FIRST = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81, damping_ratio=0.01)


def hoist(at_s: float, over_s: float, length_m: float) -> HoistTo:
    return HoistTo(event=0, at_s=at_s, over_s=over_s, cable_length_m=length_m)


def lengths(hoists: list[HoistTo], times_s: np.ndarray) -> np.ndarray:
    """Return what the machine makes of hoists."""
    machine = Machine(Crane(cable_length_m=0.8, model="linear"), (THESIS, THESIS), 0.2)
    for one in hoists:
        machine.hoist(one.cable_length_m, one.over_s, one.at_s)
    return machine.advance(float(times_s[-1]), times_s).cable_length_m


def test_the_machine_makes_the_course() -> None:
    course = LengthCourse(times_s=(0.5, 2.0, 3.0, 5.0), values=(0.8, 1.1, 1.1, 0.45))
    made = hoists_of(course)
    assert [(one.at_s, one.over_s) for one in made] == [(0.5, 1.5), (3.0, 2.0)]
    times = np.linspace(0.0, 6.0, 61)
    asked = [course.at(time) for time in times.tolist()]
    assert lengths(made, times) == pytest.approx(asked, abs=1e-14)


@pytest.mark.parametrize("seed", range(8))
def test_what_swings_from_a_moment_on_has_the_lengths_of_the_machine(seed: int) -> None:
    rng = np.random.default_rng(seed)
    # Hoists that end others among them, and two at one time.
    begins = [*rng.uniform(0, 5, 4).tolist(), 1.0, 1.0]
    hoists = [
        hoist(begin, float(rng.uniform(0.5, 3)), float(rng.uniform(0.3, 1.2))) for begin in begins
    ]
    for at_s in (0.0, 1.0, 2.7, 4.1):
        plant = plant_from(FIRST, hoists, at_s)
        assert isinstance(plant, Hoisting)
        times = np.linspace(at_s, 10.0, 41)
        asked = [plant.at(time - at_s).cable_length_m for time in times.tolist()]
        assert lengths(hoists, times) == pytest.approx(asked, abs=1e-12)
        assert plant.damping_ratio == FIRST.damping_ratio
        assert all(one < other for one, other in pairwise(plant.cable_length_m.times_s))


def test_a_cable_that_stays_is_a_pendulum() -> None:
    assert plant_from(FIRST, [], 1.0) == FIRST
    hoists = [hoist(0.0, 2.0, 0.5)]
    for at_s in (2.0, 3.0):
        late = plant_from(FIRST, hoists, at_s)
        assert isinstance(late, Pendulum)
        assert late.cable_length_m == 0.5
    assert isinstance(plant_from(FIRST, hoists, 1.99), Hoisting)
    assert isinstance(plant_from(FIRST, [hoist(5.0, 1.0, 0.5)], 2.0), Hoisting)
    assert isinstance(plant_from(FIRST, [hoist(5.0, 1.0, 0.8)], 2.0), Pendulum)


def test_a_course_keeps_its_times_where_it_begins_later() -> None:
    course = LengthCourse(times_s=(1.0, 2.0), values=(0.8, 0.5))
    plant = plant_from(FIRST, hoists_of(course), 0.0)
    assert isinstance(plant, Hoisting)
    assert plant.cable_length_m == course
    later = plant_from(FIRST, hoists_of(course), 1.5)
    assert isinstance(later, Hoisting)
    assert later.cable_length_m.values == pytest.approx((0.65, 0.5))
