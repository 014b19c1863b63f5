"""A value that is hardly meant is answered, with field, value and what may be meant."""

import copy
import json
import re
from pathlib import Path
from typing import Any

import pytest

from schemas.usual_ranges import PRINTED, USUAL_RANGES, VARIED
from service.dispatch import respond
from service.implausible import implausible_values
from service.operations.table import TABLE, load
from service.problems import Problem
from tests.conftest import CRANE
from tests.shapersmith.requests import REQUESTS

ROOT = Path(__file__).parents[2]

LAG = {"kind": "first_order", "accel_time_constant_s": 0.1, "decel_time_constant_s": 0.05}
SPRING = {"kind": "spring_mass", "mass_kg": 1.0, "stiffness_n_m": 10.0}
MODE = {"kind": "mode", "period_s": 1.8}

IDEAL = {"kind": "ideal"}
PENDULUM = CRANE["plant"]
FREQUENCY = "natural_frequency_rad_s"
HERTZ = "natural_frequency_hz"

SLIPS: list[tuple[dict[str, Any], str, str, str]] = [
    ({"plant": {**PENDULUM, "cable_length_m": 800}}, "cable_length_m", "800 m", "0.8 m"),
    ({"plant": {**PENDULUM, "cable_length_m": 0.0008}}, "cable_length_m", "0.0008 m", "0.8 m"),
    ({"plant": {**PENDULUM, "gravity_m_s2": 9810}}, "gravity_m_s2", "9810 m/s^2", "9.81 m"),
    ({"plant": {**MODE, "period_s": 1800}}, "period_s", "1800 s", "1.8 s"),
    ({"plant": {**MODE, "period_s": 5e-4}, "actuator": IDEAL}, "period_s", "0.0005 s", "0.5 s"),
    (
        {"plant": {"kind": "mode", "natural_frequency_hz": 1e-3}},
        "natural_frequency_hz",
        "1000 s",
        "1 s",
    ),
    ({"plant": {"kind": "mode", FREQUENCY: 0.005}}, FREQUENCY, "1256.64 s", "1.25664 s"),
    (
        {"plant": {"kind": "pendulum", "cable_length_mm": 0.8}},
        "cable_length_mm",
        "0.0008 m",
        "0.8 m",
    ),
    ({"plant": {**SPRING, "stiffness_n_m": 1e-5}}, "stiffness_n_m", "1986.92 s", "1.98692 s"),
    ({"actuator": {**LAG, "accel_time_constant_s": 10}}, "accel_time_constant_s", "10 s", "0.01 s"),
    ({"actuator": {**LAG, "decel_time_constant_s": 20}}, "decel_time_constant_s", "20 s", "0.02 s"),
    (
        {"actuator": {**CRANE["actuator"], "accel": {"period_s": 100, "damping_ratio": 0.8}}},
        "accel/period_s",
        "100 s",
        "0.1 s",
    ),
]


def implausible(request: dict[str, Any], operation: str = "design") -> list[str]:
    """Return the warnings of that code; nothing is designed."""
    read = load(operation).request.model_validate_json(json.dumps(request))
    return [f"{pointer} {quantity:.6g}" for pointer, _, quantity, _ in implausible_values(read)]


@pytest.mark.parametrize(("changed", "field", "value", "meant"), SLIPS)
def test_a_warning_names_field_value_and_what_may_be_meant(
    changed: dict[str, Any], field: str, value: str, meant: str
) -> None:
    request = {**CRANE, **changed, "shaper": {"kind": "zv"}, "sensitivity": None}
    answer = respond("design", json.dumps(request).encode())
    assert not isinstance(answer, Problem)
    first = answer.warnings[0]  # type: ignore[attr-defined]
    part = next(iter(changed))
    assert first.code == "implausible_value"
    assert first.detail.startswith(f"/{part}/{field}: ")
    assert f"{value}, " in first.detail
    assert (
        f"was {'a period of ' * ('period' in first.detail.split(', ')[0])}{meant}" in first.detail
    )


@pytest.mark.parametrize("operation", TABLE)
def test_each_operation_with_a_plant_warns(operation: str) -> None:
    request = copy.deepcopy(REQUESTS[operation])
    assert implausible(request, operation) == []
    request["plant"] = {"kind": "pendulum", "cable_length_m": 0.8, "gravity_m_s2": 31}
    answer = respond(operation, json.dumps(request).encode())
    assert not isinstance(answer, Problem), answer
    told = answer.model_dump()
    warnings = told.get("warnings", told.get("recommended", {}).get("warnings"))
    assert warnings[0]["code"] == "implausible_value"
    assert "/plant/gravity_m_s2: 31 m/s^2, " in warnings[0]["detail"]
    assert all(one["code"] != "implausible_value" for one in warnings[1:])


def warnings(operation: str, request: dict[str, Any]) -> list[str]:
    """Return the details of the warnings of that code."""
    answer = respond(operation, json.dumps(request).encode())
    assert not isinstance(answer, Problem), answer
    told = answer.model_dump()
    found = told.get("warnings", told.get("recommended", {}).get("warnings"))
    return [one["detail"] for one in found if one["code"] == "implausible_value"]


SPEED = "48 m/s, usual is less than 10 m/s; was 0.048 m/s meant"
FAST = "9000 m/s, usual is less than 10 m/s; was 9 m/s meant"


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("speed_m_s", 48, f"{SPEED}, speed_mm_s 48? 48 m/min is 0.8 m/s"),
        ("speed_m_s", 9000, f"{FAST}, speed_mm_s 9000?"),
        ("speed_mm_s", 48000, f"{SPEED}?"),
    ],
)
def test_speeds_are_looked_at_beside_plant_and_drive(name: str, value: float, told: str) -> None:
    request = {**REQUESTS["simulation"], name: value}
    assert warnings("simulation", request) == [f"/{name}: {told}"]


def test_a_move_backwards_is_as_usual_as_one_forwards() -> None:
    for speed_m_s, found in ((-0.2, []), (0.2, []), (-48, ["/speed_m_s -48"])):
        request = {**CRANE, "speed_m_s": speed_m_s, "pulse_s": 3.0}
        assert implausible(request, "maneuver") == found


def test_a_distance_is_looked_at_as_a_speed_is() -> None:
    for distance_m, found in ((-500, []), (999, []), (-2000, ["/distance_m -2000"])):
        request = {**CRANE, "speed_m_s": 0.2, "distance_m": distance_m}
        assert implausible(request, "maneuver") == found
    request = {**CRANE, "speed_m_s": 800, "distance_m": 10000}
    assert implausible(request, "maneuver") == ["/speed_m_s 800", "/distance_m 10000"]


LENGTH = {"field": "/plant/cable_length_m"}
PERIOD = {"field": "/plant/period_s"}


@pytest.mark.parametrize(
    ("axis", "found"),
    [
        ({**LENGTH, "from": 2000, "to": 10000, "points": 3}, ["from: 2000 m", "to: 10000 m"]),
        ({**LENGTH, "from": 1, "to": 301, "points": 3}, ["to: 301 m"]),
        ({**LENGTH, "values": [301, 1, 302, 2]}, ["values/2: 302 m"]),
        ({**LENGTH, "values": [0.009, 1]}, ["values/0: 0.009 m"]),
        ({"field": "/plant/cable_length_mm", "values": [5, 800]}, ["values/0: 0.005 m"]),
        ({"field": "/plant/gravity_m_s2", "values": [9.81, 31]}, ["values/1: 31 m/s^2"]),
        ({"field": "/plant/damping_ratio", "values": [0, 0.1]}, []),
        ({"field": "/actuator/decel_time_constant_s", "values": [0.1, 9]}, ["values/1: 9 s"]),
    ],
)
def test_a_range_of_values_is_looked_at_as_its_field(
    axis: dict[str, Any], found: list[str]
) -> None:
    bare = {**CRANE, "actuator": LAG, "shaper": {"kind": "zv"}}
    other = {"field": "/actuator/accel_time_constant_s", "values": [0.1]}
    for name in ("x", "y"):
        told = warnings("map", {**bare, "x": other, name: axis})
        assert [one.split(",")[0] for one in told] == [f"/{name}/{one}" for one in found]


@pytest.mark.parametrize(
    ("axis", "found"),
    [
        ({**PERIOD, "from": 5, "to": 90, "points": 3}, ["to: a period of 90 s"]),
        ({**PERIOD, "from": 5e-4, "to": 5, "points": 3}, ["from: a period of 0.0005 s"]),
        ({**PERIOD, "values": [5, 90]}, ["values/1: a period of 90 s"]),
    ],
)
def test_ranges_of_periods_are_warned_about_as_they_were_typed(
    axis: dict[str, Any], found: list[str]
) -> None:
    request = {"plant": MODE, "actuator": IDEAL, "shaper": {"kind": "zv"}, "x": axis}
    assert [one.split(",")[0] for one in warnings("map", request)] == [f"/x/{one}" for one in found]


@pytest.mark.parametrize("operation", ["fit", "design"])
def test_a_fit_over_kilometres_of_cable_is_warned_about(operation: str) -> None:
    fit = {"over": "/plant/cable_length_m", "from": 2000, "to": 10000, "degree": 2}
    request = {**CRANE, "actuator": LAG, "shaper": {"kind": "zv"}, "fit": fit}
    assert [one.partition(", usual")[0] for one in warnings(operation, request)] == [
        "/fit/from: 2000 m",
        "/fit/to: 10000 m",
    ]


def test_what_varies_has_the_ranges_of_its_field() -> None:
    for (part, name), usual in list(USUAL_RANGES.items()):
        if part in {"plant", "actuator"}:
            assert all(USUAL_RANGES[of, f"{part}/{name}"] is usual for of in VARIED)


@pytest.mark.parametrize(
    ("plant", "found", "meant"),
    [
        ({"period_s": 48}, "48 s, 0.02083 Hz", f"{HERTZ} 48 meant?"),
        ({"period_s": 20}, "20 s, 0.05 Hz", f"{HERTZ} 20 meant?"),
        ({HERTZ: 0.05}, "20 s, 0.05 Hz", "period_s 0.05 meant?"),
        ({HERTZ: 301}, "0.00332226 s, 301 Hz", "is it that of a printer?"),
        ({FREQUENCY: 3}, "2.0944 s, 0.4775 Hz", "is it that of a printer?"),
    ],
)
def test_a_plant_that_is_no_printer_is_warned_about_beside_a_firmware(
    plant: dict[str, float], found: str, meant: str
) -> None:
    request = {"plant": {"kind": "mode", **plant}, "actuator": IDEAL}
    assert warnings("recommendation", request) == []
    (told,) = warnings("recommendation", {**request, "firmware": "klipper"})
    assert told.startswith(f"/plant/{next(iter(plant))}: a period of {found}, usual of a printer")
    assert told.endswith(meant)


@pytest.mark.parametrize("frequency_hz", [5, 48, 300])
def test_the_ends_of_what_printers_have_are_usual(frequency_hz: float) -> None:
    for plant in ({"natural_frequency_hz": frequency_hz}, {"period_s": 1 / frequency_hz}):
        request = {"plant": {"kind": "mode", **plant}, "actuator": IDEAL, "firmware": "rrf"}
        assert implausible(request, "recommendation") == []


TWO_MODES = {"kind": "modes", "modes": [{"period_s": 1}, {"period_s": 0.1}]}
LENGTHS = {"over": "cable_length_m", "from": 0.009, "to": 0.8}
FREQUENCIES = {"over": FREQUENCY, "from": 30, "to": 90}


@pytest.mark.parametrize(
    ("plant", "pointers"),
    [
        (PENDULUM, ["cable_length_m"]),
        (SPRING, ["stiffness_n_m"]),
        (TWO_MODES, [f"modes/0/{FREQUENCY}"]),
        ({"kind": "scheduled", "plant": PENDULUM, **LENGTHS}, ["to"]),
        ({"kind": "scheduled", "plant": MODE, **FREQUENCIES}, ["from"]),
    ],
)
def test_each_kind_of_plant_is_looked_at_where_its_frequency_is_made(
    plant: dict[str, Any], pointers: list[str]
) -> None:
    request = {"plant": plant, "actuator": IDEAL, "firmware": "klipper"}
    read = load("recommendation").request.model_validate_json(json.dumps(request))
    found = [pointer for pointer, usual, _, _ in implausible_values(read) if usual is PRINTED]
    assert found == [f"/plant/{pointer}" for pointer in pointers]


def test_of_a_range_both_ends_are_looked_at_and_not_what_varies() -> None:
    plant = {"kind": "pendulum", "cable_length_m": 8000, "gravity_m_s2": 0.1}
    request = {**CRANE, "shaper": {"kind": "zv"}}
    request["plant"] = {
        "kind": "scheduled", "plant": plant, "over": "cable_length_m", "from": 299, "to": 301,
    }  # fmt: skip
    assert implausible(request) == ["/plant/to 301", "/plant/plant/gravity_m_s2 0.1"]
    request["plant"] = {
        "kind": "scheduled", "plant": SPRING, "over": "stiffness_n_m", "from": 0.01, "to": 0.02,
    }  # fmt: skip
    assert implausible(request) == ["/plant/from 62.8319"]


def test_every_mode_is_looked_at() -> None:
    modes = [{"natural_frequency_hz": 1}, {"natural_frequency_hz": 0.01}]
    request = {**CRANE, "shaper": {"kind": "multi_zv"}, "plant": {"kind": "modes", "modes": modes}}
    assert implausible(request) == ["/plant/modes/1/natural_frequency_rad_s 100"]


def test_a_lag_is_compared_with_the_slowest_mode() -> None:
    for tau, found in ((5.39, 0), (5.41, 1)):
        request = {**CRANE, "plant": MODE, "actuator": {**LAG, "accel_time_constant_s": tau}}
        assert len(implausible(request)) == found


def test_no_drive_is_compared_with_a_plant_that_is_hardly_meant() -> None:
    plant = {**CRANE["plant"], "gravity_m_s2": 9810}
    assert implausible({**CRANE, "plant": plant}) == ["/plant/gravity_m_s2 9810"]


def test_a_thousandth_of_a_value_beyond_is_usual_or_the_unit_is_asked_for() -> None:
    request = {**CRANE, "plant": {"kind": "pendulum", "cable_length_m": 1e6}, "sensitivity": None}
    answer = respond("design", json.dumps({**request, "shaper": {"kind": "zv"}}).encode())
    assert answer.warnings[0].detail.endswith("is it in m?")  # type: ignore[union-attr]


def test_the_page_says_what_is_usual_and_shows_warnings_as_they_are() -> None:
    text = (ROOT / "docs" / "requests.md").read_text().partition("## Values that are hardly")[2]
    text = text.partition("## Refusals")[0]
    rows = re.findall(r"^\| `(.*?)` \| (.*?) \|$", text, flags=re.MULTILINE)
    assert len(rows) == 3
    for given, detail in rows:
        plant = {"kind": "pendulum", **json.loads(f"{{{given}}}")}
        if not any(name.startswith("cable") for name in plant):
            plant["cable_length_m"] = 0.8
        request = {**CRANE, "plant": plant, "shaper": {"kind": "zv"}}
        answer = respond("design", json.dumps(request).encode())
        assert answer.warnings[0].detail == detail  # type: ignore[union-attr]
    for usual in USUAL_RANGES.values():
        if not usual.in_periods:
            assert f"{usual.high:g} {usual.unit}" in text
