"""A value that is hardly meant is answered, with field, value and what may be meant."""

import copy
import json
import re
from pathlib import Path
from typing import Any

import pytest

from schemas.usual_ranges import USUAL_RANGES
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

SLIPS: list[tuple[dict[str, Any], str, str, str]] = [
    ({"plant": {**PENDULUM, "cable_length_m": 800}}, "cable_length_m", "800 m", "0.8 m"),
    ({"plant": {**PENDULUM, "cable_length_m": 0.0008}}, "cable_length_m", "0.0008 m", "0.8 m"),
    ({"plant": {**PENDULUM, "gravity_m_s2": 9810}}, "gravity_m_s2", "9810 m/s^2", "9.81 m"),
    ({"plant": {**MODE, "period_s": 1800}}, FREQUENCY, "1800 s", "1.8 s"),
    ({"plant": {**MODE, "period_s": 5e-4}, "actuator": IDEAL}, FREQUENCY, "0.0005 s", "0.5 s"),
    ({"plant": {**SPRING, "stiffness_n_m": 1e-5}}, "stiffness_n_m", "1986.92 s", "1.98692 s"),
    ({"actuator": {**LAG, "accel_time_constant_s": 10}}, "accel_time_constant_s", "10 s", "0.01 s"),
    ({"actuator": {**LAG, "decel_time_constant_s": 20}}, "decel_time_constant_s", "20 s", "0.02 s"),
    (
        {"actuator": {**CRANE["actuator"], "accel": {"period_s": 100, "damping_ratio": 0.8}}},
        f"accel/{FREQUENCY}",
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


def test_speeds_are_looked_at_beside_plant_and_drive() -> None:
    request = {**REQUESTS["maneuver"], "speed_m_s": 200}
    assert implausible(request, "maneuver") == ["/speed_m_s 200"]


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
