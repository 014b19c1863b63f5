"""Fields that vary: numbers replaced by their paths, ranges, units by the end of a name."""

from dataclasses import replace

import numpy as np
import pytest

from design.fields import Axis, EvenRange, Spacing, space_evenly, vary
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.pictures.map_sheet import axis_label
from tests.refusals import refused
from tests.shaper_table import CRANE, THESIS


def test_a_number_is_replaced_by_its_path_and_no_other() -> None:
    changed = vary(THESIS, ("decel", "damping_ratio"), 0.9)
    assert changed == replace(THESIS, decel=replace(THESIS.decel, damping_ratio=0.9))


@pytest.mark.parametrize(
    ("path", "message"),
    [
        (("mass_kg",), r"^field must be one of cable_length_m, damping_ratio, gravity_m_s2, got"),
        (("cable_length_m", "x"), r"^field must be one of none, got"),
    ],
)
def test_a_field_that_is_not_there_is_refused(path: tuple[str, ...], message: str) -> None:
    with refused("unknown_field", "field", says=message):
        vary(CRANE, path, 1.0)


def test_words_are_no_numbers() -> None:
    with refused("not_a_number", "field"):
        vary(THESIS, ("model",), 1.0)


def test_a_number_inside_a_list_is_replaced_by_its_place() -> None:
    slow, fast = (Mode(natural_frequency_rad_s=w) for w in (3.0, 9.0))
    changed = vary(Modes(modes=(slow, fast)), ("modes", "1", "damping_ratio"), 0.1)
    assert changed.modes == (slow, replace(fast, damping_ratio=0.1))
    with refused("unknown_item", "field", says="one of 0, 1, got"):
        vary(changed, ("modes", "2", "damping_ratio"), 0.1)


@pytest.mark.parametrize("spacing", ["linear", "geometric", "chebyshev"])
def test_a_range_rises_from_end_to_end(spacing: Spacing) -> None:
    values = space_evenly(0.3, 0.7, 8, spacing)
    assert (values[0], values[-1], values.size) == (0.3, 0.7, 8)
    assert np.all(np.diff(values) > 0)


def test_ranges_are_those_of_numpy_bit_by_bit_wherever_they_are_read() -> None:
    random = np.random.default_rng(1)
    for _ in range(300):
        start = random.normal() * 10 ** random.uniform(-3, 5)
        stop, points = start + 10 ** random.uniform(-4, 5), int(random.integers(1, 300))
        linear = EvenRange(start, stop, points, "linear")
        np.testing.assert_array_equal(
            linear[np.arange(points)], np.linspace(start, stop, points), strict=True
        )
        geometric = EvenRange(abs(start), abs(start) + 1.0, points, "geometric")
        np.testing.assert_array_equal(
            geometric[np.arange(points)], np.geomspace(abs(start), abs(start) + 1.0, points)
        )
        some = random.integers(0, points, (3, 2))
        for one in (linear, geometric, EvenRange(start, stop, points, "chebyshev")):
            np.testing.assert_array_equal(one[some], one[np.arange(points)][some], strict=True)


@pytest.mark.parametrize(
    ("start", "size", "told"),
    [
        (-1.0, 11, [-1.0, 0.2, 1.0]),
        (0.0, 11, [0.0, 0.1, 1.0]),
        (0.5, 11, [0.5, 1.0]),
        (-2, 1, [-2]),
    ],
)
def test_the_telling_values_of_a_long_range(start: float, size: int, told: list[float]) -> None:
    """First, last and least above zero: of a range of 10^15 values no more is ever made."""
    assert EvenRange(start, 1.0, size, "linear").telling == pytest.approx(told)
    long = EvenRange(start, 1.0, 10**15, "linear").telling
    assert long[0] == start
    assert long[-1] == 1.0


def test_an_empty_range_and_a_logarithm_of_zero_are_refused() -> None:
    with refused("range_reversed", "to", says=r"greater than from, 1\.0, got"):
        space_evenly(1.0, 1.0, 5, "linear")
    with refused("geometric_from_zero", "from"):
        space_evenly(0.0, 1.0, 5, "geometric")


@pytest.mark.parametrize(
    ("path", "label"),
    [
        ("actuator/accel/natural_frequency_rad_s", "accel natural frequency [rad/s]"),
        ("actuator/accel_limit_m_s2", "accel limit [m/s²]"),
        ("plant/stiffness_n_m", "stiffness [N/m]"),
        ("plant/mass_kg", "mass [kg]"),
        ("plant/damping_ratio", "damping ratio [-]"),
        ("move/pulse_s", "pulse duration [s]"),
    ],
)
def test_a_label_is_the_name_in_words_with_the_unit(path: str, label: str) -> None:
    assert axis_label(Axis(path=tuple(path.split("/")), values=np.array([1.0]))) == label
