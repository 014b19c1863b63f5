"""A field at a wrong place is answered with a place that takes it, or with what else has it."""

import copy
import json
import re
from itertools import product
from typing import Any

import pytest
from pydantic import ValidationError

from schemas.base import wire_names
from schemas.fields_at import also_called, expected_at
from schemas.requests import requests
from schemas.tables import TableRequest
from service.belonging import models_at, owner_of_request, places_of
from service.catalogue import EXAMPLE_ACTUATORS
from service.dispatch import respond
from service.number_texts import number_meant
from service.operations.table import TABLE, load
from service.problems import Problem
from service.suggestions import kinds_meant
from tests.conftest import CRANE
from tests.service.test_plain_words import places, with_value
from tests.shapersmith.requests import REQUESTS

LAG = {"kind": "first_order", "accel_time_constant_s": 0.1, "decel_time_constant_s": 0.05}
BARE = {**CRANE, "actuator": LAG, "shaper": {"kind": "zv"}}
DRIVEN = {"plant": CRANE["plant"], "actuator": LAG}

NAMES = (
    *("speed_m_s", "speed_mm_s", "tolerance", "dead_time_ms", "damping_ratio", "points", "degree"),
    *("impulses", "natural_frequency_hz", "half_width", "pulse_s", "sample_time_s", "kind"),
)


def refused(operation: str, request: Any) -> Problem:
    problem = respond(operation, json.dumps(request).encode())
    assert isinstance(problem, Problem)
    return problem


@pytest.mark.parametrize("operation", TABLE)
def test_a_suggested_place_takes_the_field(operation: str) -> None:
    request: dict[str, Any] = {**REQUESTS[operation], "actuator": LAG}
    objects = [(), *(path for path in places(request) if isinstance(at(request, path), dict))]
    for path, name in product(objects, NAMES):
        problem = respond_to_fields(operation, json.loads(with_value(request, (*path, name), 1)))
        for fault in problem.errors if problem else ():
            meant = re.search(r"did you mean (/.*)\?", fault.detail)
            for place in re.split(", | or ", meant[1]) if meant else ():
                moved = with_value(with_objects(request, place), steps(place), 1)
                after = respond_to_fields(operation, json.loads(moved))
                assert not [
                    one for one in (after.errors if after else ()) if one.code == "extra_forbidden"
                ], (fault, place)


def at(here: Any, path: tuple[int | str, ...]) -> Any:
    for step in path:
        here = here[step]
    return here


def steps(place: str) -> tuple[int | str, ...]:
    return tuple(int(one) if one.isdecimal() else one for one in place[1:].split("/"))


def with_objects(request: Any, place: str) -> Any:
    """Return the request with an object where the place is in one that it has not."""
    changed = copy.deepcopy(request)
    first, *rest = steps(place)
    return changed if not rest or isinstance(changed.get(first), dict) else {**changed, first: {}}


def respond_to_fields(operation: str, request: Any) -> Problem | None:
    """Return what is wrong with the fields of a request; nothing is computed."""
    try:
        load(operation).request.model_validate_json(json.dumps(request))
    except ValidationError:
        return refused(operation, request)
    return None


@pytest.mark.parametrize(
    ("request_", "told"),
    [
        ({**BARE, "speed_m_s": 0.5}, "speed_m_s belongs to maneuver, simulate, run or map"),
        ({**BARE, "speed_mm_s": 500}, "speed_mm_s belongs to maneuver, simulate, run or map"),
        ({**BARE, "half_width": 0.1}, "half_width belongs to recommend"),
        (
            {**BARE, "actuator": {**LAG, "speed_m_s": 1}},
            "belongs to the kind rate_limited, or to man",
        ),
        (
            {**BARE, "plant": {**CRANE["plant"], "stiffness_n_m": 1}},
            "belongs to the kind spring_mass; ",
        ),
        (
            {**BARE, "shaper": {"kind": "zv", "tolerance": 0.1}},
            "the kind ei, two_hump_ei, three_hump_ei or others",
        ),
    ],
)
def test_what_no_object_of_a_request_takes_is_answered_with_what_does(
    request_: dict[str, Any], told: str
) -> None:
    (fault,) = refused("design", request_).errors
    assert fault.code == "extra_forbidden"
    assert told in fault.detail
    assert "did you mean" not in fault.detail


@pytest.mark.parametrize(("given", "asked"), [*product(REQUESTS, REQUESTS)])
def test_a_request_of_another_operation_is_called_one(given: str, asked: str) -> None:
    model = load(asked).request
    owner = owner_of_request(model, REQUESTS[given])
    if REQUESTS[given].keys() <= wire_names(model):
        assert owner == ""
        return
    assert TABLE[given].command in owner.replace(" or ", ", ").split(", ")
    problem = refused(asked, REQUESTS[given])
    assert problem.detail.startswith(f"this is a request of {owner}; ")
    assert all(command in requests() for command in owner.replace(" or ", ", ").split(", "))


def test_a_design_whose_every_field_is_known_or_is_a_slip_is_no_other_request() -> None:
    model = load("design").request
    sound: list[Any] = [BARE, {**BARE, "speed_m_s": 1}, {**BARE, "colour": 1}, [], None, 3]
    for request in sound:
        assert owner_of_request(model, request) == ""
    assert owner_of_request(model, {"design": BARE, "axes": []}) == "table"


@pytest.mark.parametrize("part", ["plant", "actuator"])
def test_a_kind_is_known_by_what_people_call_it(part: str) -> None:
    kinds = also_called(expected_at(load("design").request, (part,)))
    assert len(kinds) >= 4
    names = [name for also in kinds.values() for name in also]
    assert len(names) == len(set(names))
    for kind, also in kinds.items():
        for name in also:
            assert kinds_meant(name.replace("_", " ").capitalize(), kinds) == [kind]
            (fault,) = refused("design", {**BARE, part: {"kind": name}}).errors
            assert f"got {name!r}; did you mean {kind}? The kinds are" in fault.detail


def test_the_requests_by_command_are_those_of_the_operations() -> None:
    models = {row.command: load(name).request for name, row in TABLE.items()}
    assert requests() == {**models, "table": TableRequest}


@pytest.mark.parametrize("actuator", EXAMPLE_ACTUATORS.values(), ids=lambda one: str(one["kind"]))
def test_a_plant_and_an_actuator_that_are_swapped_are_called_so(actuator: dict[str, Any]) -> None:
    first, second = refused(
        "design", {**BARE, "plant": actuator, "actuator": CRANE["plant"]}
    ).errors
    assert (first.pointer, first.code) == ("/plant", "unknown_kind")
    assert "; plant and actuator are swapped; " in first.detail
    assert "; actuator and plant are swapped; " in second.detail
    (fault,) = refused("design", {**BARE, "plant": actuator}).errors
    assert f"; {actuator['kind']} is a kind of actuator; " in fault.detail


def test_a_shaper_in_the_place_of_an_actuator_is_called_one() -> None:
    (fault,) = refused(
        "design", {**DRIVEN, "actuator": {"kind": "ei"}, "shaper": BARE["shaper"]}
    ).errors
    assert "; ei is a kind of shaper; " in fault.detail


@pytest.mark.parametrize("name", ["cable_length_m", "cable_length_mm", "damping_ratio"])
def test_a_name_in_place_of_a_pointer_is_answered_with_the_pointer(name: str) -> None:
    ends = {"from": 0.5, "to": 1.0}
    fit = {"over": name, **ends, "degree": 1}
    (fault,) = refused("fit", {**BARE, "fit": fit}).errors
    assert fault.pointer == "/fit/over"
    assert fault.detail.endswith(f"got {name!r}; did you mean /plant/{name}?")
    (fault,) = refused("map", {**BARE, "x": {"field": name, **ends}}).errors
    assert (fault.pointer, fault.code) == ("/x/field", "wrong_form")
    assert fault.detail == (
        f"must begin with /plant/, /actuator/ or /move/, got {name!r}; did you mean /plant/{name}?"
    )
    plant = {"kind": "scheduled", "plant": CRANE["plant"], "over": f"/plant/{name}", **ends}
    (fault,) = refused("design", {**BARE, "plant": plant}).errors
    if name != "damping_ratio":  # which is not scheduled
        assert fault.detail.endswith(f"got '/plant/{name}'; did you mean {name}?")


def test_a_long_list_or_text_costs_a_refusal_no_time(monkeypatch: pytest.MonkeyPatch) -> None:
    looked_at: list[Any] = []

    def models_of(model: Any, where: Any) -> Any:
        looked_at.append(where)
        return models_at(model, where)

    monkeypatch.setattr("service.belonging.models_at", models_of)
    modes = [{"period_s": 1.0}] * 20_000
    places_of(
        "colour", load("design").request, {**BARE, "plant": {"kind": "modes", "modes": modes}}
    )
    assert 0 < len(looked_at) < 100
    assert number_meant("1" + " " * 1_000_000 + "x", "period_s", "natural_frequency_rad_s") == ""


def test_more_strangers_than_are_listed_are_refused_as_they_are() -> None:
    strangers = {f"x{number}": 1 for number in range(40)}
    problem = refused("design", {**strangers, **BARE, "speed_m_s": 1, "distance_m": 3})
    assert problem.detail.endswith("; and 22 more")
    twice = {"plant": {"kind": "pendulum", "cable_length_m": 1, "cable_length_mm": 1}}
    assert refused("design", {**BARE, **twice, "half_width": 0.1}).errors
