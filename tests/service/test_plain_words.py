"""Refusals are in plain words, whatever field of whatever request is at fault."""

import copy
import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import pytest
from pydantic_core.core_schema import ErrorType

from schemas.designs import DesignResponse
from schemas.units import other_names
from service.catalogue import EXAMPLE_ACTUATORS, shaper_catalogue
from service.dispatch import respond
from service.jobs.plan import plan_table
from service.operations.table import load
from service.plain_words import RULES
from service.problems import CODE_OF_TYPE, Problem
from service.suggestions import FOREIGN_UNITS, meaning_of_field
from tests.conftest import CRANE

ROOT = Path(__file__).parents[2]

JARGON = ("Input should", "inputs are", "Field required", "Unable to", "input tag", "Value error")

NONSENSE: tuple[Any, ...] = (
    None,
    True,
    -1e300,
    1e300,
    10**400,
    0.5,
    "x",
    "0,8",
    [],
    [[]],
    {},
    {"kind": "x"},
)

AXIS = {"field": "/plant/cable_length_m", "from": 0.5, "to": 1.0, "points": 2}
IMPULSES = {"times_s": [0, 1], "amplitudes": [0.5, 0.5]}
PLANT = {"plant": CRANE["plant"], "actuator": CRANE["actuator"]}
FIT = {"over": "/plant/cable_length_m", "from": 0.7, "to": 0.8, "degree": 2}

REQUESTS: list[tuple[str, dict[str, Any]]] = [
    ("design", {**CRANE, "fit": FIT, "sensitivity": {"points": 3}}),
    ("design", {**CRANE, "plant": {"kind": "modes", "modes": [{"period_s": 1.0}]}}),
    *(("design", {**CRANE, "actuator": actuator}) for actuator in EXAMPLE_ACTUATORS.values()),
    ("sensitivity", {**PLANT, "impulses": IMPULSES}),
    ("fit", {**CRANE, "fit": FIT}),
    ("maneuver", {**CRANE, "speed_m_s": 0.2, "pulse_s": 3, "initial": {"angle_rad": 0.1}}),
    ("simulation", {**PLANT, "command": {"kind": "impulses", "impulses": IMPULSES}}),
    ("map", {**PLANT, "shaper": {"kind": "zv"}, "x": AXIS, "move": {"pulse_s": 1}}),
    ("recommendation", {**PLANT, "damping": {"from": 0, "to": 0.1}}),
]


def places(here: Any, path: tuple[int | str, ...] = ()) -> Iterator[tuple[int | str, ...]]:
    """Yield the paths of all values in a request, its own but not."""
    inner = here.items() if isinstance(here, dict) else enumerate(here)
    for name, value in inner:
        yield (*path, name)
        if isinstance(value, dict | list):
            yield from places(value, (*path, name))


def with_value(request: Any, path: tuple[int | str, ...], value: Any) -> bytes:
    changed = copy.deepcopy(request)
    here = changed
    for step in path[:-1]:
        here = here[step]
    here[path[-1]] = value
    return json.dumps(changed).encode()


def refused(operation: str, body: bytes) -> Problem:
    problem = respond(operation, body)
    assert isinstance(problem, Problem)
    return problem


@pytest.mark.parametrize(("operation", "request_"), REQUESTS)
def test_no_refusal_is_in_the_words_of_a_library(
    operation: str, request_: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    # What is taken is not computed: only what is refused matters here.
    monkeypatch.setattr("service.dispatch.load", _without_work)
    count = 0
    for path in places(request_):
        for value in NONSENSE:
            problem = respond(operation, with_value(request_, path, value))
            if isinstance(problem, Problem):
                count += 1
                assert not [word for word in JARGON if word in problem.detail], problem.detail
                assert problem.errors
    assert count > 30


def _without_work(name: str) -> Any:
    return replace(load(name), run=lambda request: request)


def test_every_rule_is_of_a_fault_that_pydantic_has_and_has_a_code() -> None:
    assert set(RULES) <= set(get_args(ErrorType))
    assert set(RULES) - CODE_OF_TYPE.keys() == {
        *("too_short", "too_long"),  # codes themselves
        *("float_parsing", "int_parsing", "bool_parsing"),  # of settings, which are texts
    }


def test_an_unknown_kind_is_answered_with_every_kind() -> None:
    problem = refused("design", with_value(CRANE, ("shaper", "kind"), "numzdv"))
    detail = problem.errors[0].detail
    assert all(entry.kind in detail for entry in shaper_catalogue().shapers)
    assert "got 'numzdv'; did you mean numzv, numzvd or" in detail
    problem = refused("design", with_value(CRANE, ("plant",), {}))
    assert problem.errors[0].detail == (
        "must have a kind: mode, modes, pendulum, double_pendulum, spring_mass, scheduled, "
        "hoisting or free_body"
    )


@pytest.mark.parametrize(
    ("name", "told"),
    [
        (
            "cable_length_cm",
            "give cable_length_m, 100 times smaller, or cable_length_mm, 10 times larger",
        ),
        ("cable_length_metres", "give cable_length_m, the same number, or"),
        ("cable_length", "did you mean cable_length_m or cable_length_mm?"),
        ("cable_lenght_m", "did you mean cable_length_m"),
        ("damping_ratio_percent", "give damping_ratio, 100 times smaller"),
        ("gravity_g", "give gravity_m_s2, 9.80665 times larger"),
        ("natural_frequency_hz", "the fields are kind, cable_length_m"),  # of another kind of plant
        ("colour", "the fields are kind, cable_length_m, damping_ratio, gravity_m_s2"),
    ],
)
def test_an_unknown_field_is_answered_with_what_may_be_meant(name: str, told: str) -> None:
    (fault,) = refused("design", with_value(CRANE, ("plant", name), 1)).errors
    assert (fault.pointer, fault.code) == (f"/plant/{name}", "extra_forbidden")
    assert told in fault.detail


@pytest.mark.parametrize(
    ("path", "told"),
    [
        (("damping_ratio",), "did you mean /plant/damping_ratio?"),
        (("cable_length_mm",), "did you mean /plant/cable_length_mm?"),
        (("sample_time_s",), "did you mean /shaper/sample_time_s?"),
        (("plant", "dead_time_ms"), "did you mean /actuator/dead_time_ms?"),
        (("plant", "points"), "did you mean /sensitivity/points or /drive/points?"),
    ],
)
def test_a_field_of_another_object_is_answered_with_its_place(
    path: tuple[str, ...], told: str
) -> None:
    (fault,) = refused("design", with_value(CRANE, path, 1)).errors
    assert fault.detail == f"is no field here; {told}"


@pytest.mark.parametrize("unit", FOREIGN_UNITS, ids=lambda unit: f"{unit.end}{unit.si_end}")
def test_a_unit_that_is_not_read_is_answered_with_its_factor(unit: Any) -> None:
    field = f"quantity{unit.si_end}"
    told = meaning_of_field(f"quantity{unit.end}", ["kind", field])
    assert told.startswith(f"give {field}, ")
    factor = float(told.split(", ")[1].split(" ")[0].replace("the", "1"))
    assert min(unit.in_si, 1 / unit.in_si) == pytest.approx(1 / factor, rel=1e-5)


def test_a_missing_field_is_answered_with_its_names() -> None:
    (fault,) = refused("design", with_value(CRANE, ("plant",), {"kind": "mode"})).errors
    names = other_names("natural_frequency_rad_s")
    assert fault.pointer == "/plant/natural_frequency_rad_s"
    assert all(name in fault.detail for name in names)


@pytest.mark.parametrize(
    ("plant", "pointer", "told"),
    [
        (
            {"kind": "pendulum", "cable_length_mm": -800},
            "/plant/cable_length_mm",
            "must be greater than 0, got -0.8, read as cable_length_m",
        ),
        (
            {"kind": "modes", "modes": [{"natural_frequency_hz": 1, "log_decrement": "x"}]},
            "/plant/modes/0/log_decrement",
            "must be a number, got 'x'",
        ),
        (
            {"kind": "mode", "natural_frequency_hz": 1e-30},
            "/plant/natural_frequency_hz",
            "in SI units (natural_frequency_rad_s)",
        ),
    ],
)
def test_a_fault_is_pointed_at_by_the_name_that_was_given(
    plant: dict[str, Any], pointer: str, told: str
) -> None:
    (fault,) = refused("design", with_value(CRANE, ("plant",), plant)).errors
    assert fault.pointer == pointer
    assert told in fault.detail


def test_a_fault_in_a_list_is_pointed_at_by_the_name_that_was_given() -> None:
    for times, told in (([0, "x"], "must be a number"), ([0, -1], "must be")):
        impulses = {"times_ms": times, "amplitudes": [1, 1]}
        (fault,) = refused(
            "sensitivity", json.dumps({**PLANT, "impulses": impulses}).encode()
        ).errors
        assert fault.pointer == "/impulses/times_ms/1"
        assert told in fault.detail


@pytest.mark.parametrize(
    ("value", "told"),
    [
        ("0.8", "must be a number, got '0.8'; give 0.8, without quotes"),
        ("0,8", "must be a number, got '0,8'; give 0.8, with a point"),
        ("short", "must be a number, got 'short'"),
        (None, "must be a number, got null"),
        (True, "must be a number, got true"),
        (-1, "must be greater than 0, got -1"),
    ],
)
def test_a_refusal_says_rule_value_and_what_is_meant(value: Any, told: str) -> None:
    body = with_value(CRANE, ("plant", "cable_length_m"), value)
    assert refused("design", body).detail == f"/plant/cable_length_m: {told}"


def test_the_document_shows_answers_as_they_are() -> None:
    text = (ROOT / "docs" / "requests.md").read_text().partition("## Refusals")[2]
    rows = re.findall(r"^\| `(.*?)` \| (.*?)(?: \(.*\))? \|$", text, flags=re.MULTILINE)
    assert len(rows) >= 5
    for given, told in rows:
        name, _, value = given.replace('"', "", 2).partition(": ")
        request = copy.deepcopy(CRANE)
        inner = request["shaper" if name == "kind" else "plant"]
        if name.endswith("_mm"):
            del inner["cable_length_m"]
        inner[name] = json.loads(value) if value else 1
        (fault,) = refused("design", json.dumps(request).encode()).errors
        assert fault.detail.startswith(told)


CENTIMETRES = "give cable_length_m, 100 times smaller, or cable_length_mm, 10 times larger"


@pytest.mark.parametrize(
    ("operation", "changed", "pointer"),
    [
        ("fit", {"fit": {**FIT, "over": "/plant/cable_length_cm"}}, "/fit/over"),
        ("map", {"x": {**AXIS, "field": "/plant/cable_length_cm"}}, "/x/field"),
        (
            "design",
            {
                "plant": {
                    "kind": "scheduled",
                    "plant": CRANE["plant"],
                    "over": "cable_length_cm",
                    "from": 50,
                    "to": 100,
                }
            },
            "/plant/over",
        ),
    ],
)
def test_a_chosen_field_in_a_unit_that_is_not_read_is_answered_with_its_factor(
    operation: str, changed: dict[str, Any], pointer: str
) -> None:
    (fault,) = refused(operation, json.dumps({**CRANE, **changed}).encode()).errors
    assert fault.pointer == pointer
    assert fault.detail.endswith(f"; {CENTIMETRES}")


def test_an_axis_of_a_table_is_answered_as_other_fields_are() -> None:
    design = {name: CRANE[name] for name in ("plant", "actuator", "shaper")}
    axis = {"field": "/plant/cable_lenght_m", "values": [1.0]}
    problem = plan_table(json.dumps({"design": design, "axes": [axis]}).encode())
    assert isinstance(problem, Problem)
    assert "did you mean cable_length_m or cable_length_mm?" in problem.detail


def test_what_is_expected_stands_once_where_many_fields_are_unknown() -> None:
    answer = respond("design", json.dumps(CRANE).encode())
    assert isinstance(answer, DesignResponse)
    problem = refused("sensitivity", answer.model_dump_json().encode())
    assert problem.detail.count("the fields are") == 1
    assert len(problem.detail) < 800
    strangers = [one for one in problem.errors if one.code == "extra_forbidden"]
    assert len(strangers) > 5
    assert all("is no field here" in one.detail for one in strangers)
    # Each place has a list that is its own.
    two = json.loads(with_value(CRANE, ("plant", "colour"), 1))
    assert (
        refused("design", with_value(two, ("actuator", "colour"), 1)).detail.count("the fields are")
        == 2
    )
