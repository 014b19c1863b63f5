"""What a course of lengths must be, and what a plant that changes answers."""

import math

import pytest

from design.errors import InvalidInputError
from design.model.plants.hoisting import Hoisting, LengthCourse
from tests.refusals import refused

COURSE = LengthCourse(times_s=(1.0, 3.0, 4.0), values=(0.8, 0.5, 0.6))


def test_a_length_is_linear_between_points_and_held_beside_them() -> None:
    lengths = [COURSE.at(time_s) for time_s in (0.0, 1.0, 2.0, 3.0, 3.5, 4.0, 9.0)]
    assert lengths == pytest.approx([0.8, 0.8, 0.65, 0.5, 0.55, 0.6, 0.6], abs=1e-15)


def test_the_turn_of_the_swing_is_the_integral_of_its_frequency() -> None:
    from scipy.integrate import quad

    crane = Hoisting(cable_length_m=COURSE, gravity_m_s2=9.81)
    by_quadrature = sum(
        quad(lambda t: math.sqrt(9.81 / COURSE.at(t)), *ends)[0]
        for ends in ((0, 1), (1, 3), (3, 4))
    )
    assert crane.hoisting_turn_rad == pytest.approx(by_quadrature, abs=1e-12)


@pytest.mark.parametrize(
    ("times_s", "values", "code", "field"),
    [
        ((0.0,), (0.8,), "course_without_change", "values"),
        ((0.0, 5.0, 6.0), (0.8, 0.5), "course_times_unlike_values", "times_s"),
        ((0.0, 5.0, 5.0), (0.8, 0.5, 0.6), "course_times_not_rising", "times_s.2"),
        ((0.0, 5.0, 4.0), (0.8, 0.5, 0.6), "course_times_not_rising", "times_s.2"),
        ((-1.0, 5.0), (0.8, 0.5), "out_of_range", "times_s.0"),
        ((0.0, math.nan), (0.8, 0.5), "out_of_range", "times_s.1"),
        ((0.0, 5.0), (0.8, 0.0), "hoisted_through_zero", "values.1"),
        ((0.0, 5.0), (0.8, -0.5), "hoisted_through_zero", "values.1"),
        ((0.0, 5.0), (math.nan, 0.5), "hoisted_through_zero", "values.0"),
        ((0.0, 5.0), (math.inf, 0.5), "not_positive", "values.0"),
        ((0.0, 5.0), (900.0, 0.5), "course_too_wide", "values"),
    ],
)
def test_a_course_that_is_none_is_refused(
    times_s: tuple[float, ...], values: tuple[float, ...], code: str, field: str
) -> None:
    with refused(code, field):
        LengthCourse(times_s=times_s, values=values)


def test_a_hoisting_of_too_many_swings_is_refused() -> None:
    course = LengthCourse(times_s=(0.0, 3000.0), values=(0.8, 0.5))
    with refused("course_too_long", "cable_length_m.times_s", says="1000 times"):
        Hoisting(cable_length_m=course)


@pytest.mark.parametrize("name", ["mode", "modes"])
def test_a_plant_that_changes_has_no_mode_and_says_where_it_is_served(name: str) -> None:
    with pytest.raises(InvalidInputError, match="Give a maneuver") as caught:
        getattr(Hoisting(cable_length_m=COURSE), name)
    assert (caught.value.code, caught.value.name) == ("plant_that_changes", "plant.kind")


def test_the_mode_of_a_moment_is_that_of_its_length() -> None:
    crane = Hoisting(cable_length_m=COURSE, gravity_m_s2=9.81, damping_ratio=0.1)
    assert crane.at(2.0).mode.natural_frequency_rad_s == pytest.approx(math.sqrt(9.81 / 0.65))
    assert crane.last.cable_length_m == 0.6
    assert crane.shortest.cable_length_m == 0.5
    assert [one.damping_ratio for one in crane.modes_of_moments] == [0.1, 0.1, 0.1]
