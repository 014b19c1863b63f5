"""What was meant where a number is expected: following it gives the quantity that was typed."""

import json
import re
from typing import Any

import pytest

from schemas.units import in_si, other_names
from service.dispatch import respond
from service.number_texts import END_OF_SYMBOL, number_meant
from service.problems import Problem
from service.suggestions import FOREIGN_UNITS
from tests.conftest import CRANE

FIELDS = (
    *("cable_length_m", "period_s", "natural_frequency_rad_s", "speed_m_s", "accel_limit_m_s2"),
    *("jerk_limit_m_s3", "stiffness_n_m", "mass_kg", "angle_rad", "accel_time_constant_s"),
    *("damping_ratio", "tolerance"),
)

QUANTITIES = {
    "1.8 s": ("natural_frequency_rad_s", 3.490658503988659),
    "1800 ms": ("natural_frequency_rad_s", 3.490658503988659),
    "0,5 Hz": ("natural_frequency_rad_s", 3.141592653589793),
    "30 rpm": ("natural_frequency_rad_s", 3.141592653589793),
    "7.5 m": ("cable_length_m", 7.5),
    "750cm": ("cable_length_m", 7.5),
    "100 ms": ("accel_time_constant_s", 0.1),
    "90°": ("angle_rad", 1.5707963267948966),
    "48 m/min": ("speed_m_s", 0.8),
    "800 mm / s": ("speed_m_s", 0.8),
    "2 m/s²": ("accel_limit_m_s2", 2.0),
    "2000 mm/s^2": ("accel_limit_m_s2", 2.0),
    "2 N/mm": ("stiffness_n_m", 2000.0),
    "500 g": ("mass_kg", 0.5),
    "5 %": ("damping_ratio", 0.05),
}

RATIOS = [
    ("design", {"shaper": {"kind": "ei", "tolerance": 5}}, "/shaper/tolerance"),
    ("design", {"plant": {**CRANE["plant"], "damping_ratio": 5}}, "/plant/damping_ratio"),
    ("design", {"shaper": {"kind": "num_si", "half_width": 5}}, "/shaper/half_width"),
    ("recommendation", {"half_width": 5}, "/half_width"),
    ("recommendation", {"tolerance": 5}, "/tolerance"),
    ("recommendation", {"damping": {"from": 0, "to": 5}}, "/damping/to"),
    (
        "fit",
        {"fit": {"over": "/plant/cable_length_m", "from": 1, "to": 2, "max_residual": 5}},
        "/fit/max_residual",
    ),
]


def refusal(operation: str, changed: dict[str, Any]) -> tuple[str, str]:
    request = {name: CRANE[name] for name in ("plant", "actuator")}
    if operation != "recommendation":
        request["shaper"] = {"kind": "zv"}
    problem = respond(operation, json.dumps({**request, **changed}).encode())
    assert isinstance(problem, Problem)
    (fault,) = problem.errors
    return fault.pointer, fault.detail


def followed(told: str, given: str, field: str) -> float:
    """Return the value in SI units of what a message says to give."""
    found = re.fullmatch(r"; give (?:(\w+) )?([-\d.e]+)", told)
    assert found, told
    name = found[1] or given
    assert name in (field, *other_names(field))
    value: float = in_si({name: float(found[2])}, {field})[field]
    return value


@pytest.mark.parametrize("text", QUANTITIES)
def test_what_is_said_to_be_given_is_the_quantity_that_was_typed(text: str) -> None:
    field, value = QUANTITIES[text]
    for given in (field, *other_names(field)):
        assert followed(number_meant(text, given, field), given, field) == pytest.approx(value)


@pytest.mark.parametrize("symbol", END_OF_SYMBOL)
def test_each_unit_is_known_to_some_field_and_of_no_other(symbol: str) -> None:
    told = {field: number_meant(f"2 {symbol}", field, field) for field in FIELDS}
    assert [one for one in told.values() if one.startswith("; give ")]
    for field, one in told.items():
        assert one.startswith(("; give ", "; the field is in ", "; the field has no unit")), field


def test_units_of_texts_are_those_of_names() -> None:
    known = {unit.end for unit in FOREIGN_UNITS}
    ends = {end for field in FIELDS for name in (field, *other_names(field))
            for end in END_OF_SYMBOL.values() if name.endswith(end)}  # fmt: skip
    assert set(END_OF_SYMBOL.values()) <= known | ends


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("x", ""),
        ("5 apples", ""),
        ("5 m 3", ""),
        ("7.5 s", "; the field is in m"),
        ("0,8", "; give 0.8, with a point"),
    ],
)
def test_what_is_no_length_is_not_converted(text: str, told: str) -> None:
    assert number_meant(text, "cable_length_m", "cable_length_m") == told


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("natural_frequency_hz", "48 Hz", "must be a number, got '48 Hz'; give 48"),
        ("natural_frequency_rad_s", "48 Hz", "got '48 Hz'; give natural_frequency_hz 48"),
        ("period_s", "x", "must be a number, got 'x'"),
    ],
)
def test_a_text_is_not_said_to_be_read_as_another_field(name: str, text: str, told: str) -> None:
    pointer, detail = refusal("design", {"plant": {"kind": "mode", name: text}})
    assert pointer == f"/plant/{name}"
    assert detail.endswith(told)


@pytest.mark.parametrize(("operation", "changed", "pointer"), RATIOS)
def test_a_ratio_in_per_cent_is_answered_with_the_ratio(
    operation: str, changed: dict[str, Any], pointer: str
) -> None:
    found, detail = refusal(operation, changed)
    assert found == pointer
    assert detail.endswith("; 5 % is 0.05")


@pytest.mark.parametrize("value", [-5, 0, 1e4, True])
def test_what_is_no_number_of_per_cent_is_not_called_one(value: Any) -> None:
    _, detail = refusal("design", {"shaper": {"kind": "ei", "tolerance": value}})
    assert "%" not in detail


def test_a_count_is_no_share() -> None:
    _, detail = refusal("design", {"sensitivity": {"points": 500_000}})
    assert "%" not in detail


LAG = {"kind": "first_order", "accel_time_constant_s": 0.1, "decel_time_constant_s": 0.05}
ACCEL, DECEL = "accel_time_constant", "decel_time_constant"
MOVE = {"shaper": {"kind": "numzvd"}, "speed_m_s": 1.0}


@pytest.mark.parametrize(
    ("operation", "changed", "told"),
    [
        ("design", {"actuator": {**LAG, ACCEL + "_s": 400}}, f"{ACCEL}_ms 400"),
        ("design", {"actuator": {**LAG, DECEL + "_s": 400}}, f"{DECEL}_ms 400"),
        ("maneuver", {**MOVE, "distance_m": 9000}, "distance_mm 9000"),
        ("maneuver", {**MOVE, "speed_m_s": 0.2, "pulse_s": 9000}, "pulse_ms 9000"),
    ],
)
def test_what_is_far_too_long_is_answered_with_the_smaller_unit(
    operation: str, changed: dict[str, Any], told: str
) -> None:
    _, detail = refusal(operation, changed)
    assert detail.endswith(f"; was {told} meant?")


def test_what_is_in_the_smaller_unit_already_is_not_asked_about() -> None:
    _, detail = refusal("maneuver", {**MOVE, "distance_mm": 9e6})
    assert "meant" not in detail
