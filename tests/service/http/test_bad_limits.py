"""Limits to acceleration that break a rule, on every route that takes an actuator."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from service.jobs.memory import MemoryJobs
from tests.service.http.changed_request import JSON
from tests.service.http.in_process import InProcess

CRANE: dict[str, Any] = {"kind": "pendulum", "cable_length_m": 9, "gravity_m_s2": 9.81}
LIMITS: dict[str, Any] = {
    "kind": "rate_limited",
    "accel_limit_m_s2": 0.3,
    "decel_limit_m_s2": 0.4,
    "speed_m_s": 1.0,
}
SHAPER = {"kind": "numzv"}
LENGTHS = {"field": "/plant/cable_length_m", "from": 8, "to": 9, "points": 3}

ROUTES: dict[str, dict[str, Any]] = {
    "/v1/designs": {"shaper": SHAPER},
    "/v1/designs/batch": {"shaper": SHAPER},
    "/v1/sensitivity": {"impulses": {"times_s": [0], "amplitudes": [1]}},
    "/v1/maneuvers": {"shaper": SHAPER, "speed_m_s": 1.0, "distance_m": 12},
    "/v1/simulations": {"command": {"kind": "step"}, "speed_m_s": 1.0},
    "/v1/maps": {"shaper": SHAPER, "x": LENGTHS},
    "/v1/recommendations": {},
    "/v1/fits": {
        "shaper": SHAPER,
        "fit": {"over": "/plant/cable_length_m", "from": 8, "to": 9, "degree": 2},
    },
    "/v1/tables": {},
}
"""What each route takes beside plant and actuator."""

SLOW_RULE = "at least 0.05539 m/s^2"
"""Three periods to full speed: 1 m/s over 3 * 2 pi sqrt(9 / 9.81) s."""


def body_of(route: str, actuator: dict[str, Any]) -> dict[str, Any]:
    """Return a request that is in order but for its actuator."""
    if route == "/v1/tables":
        design = {"plant": CRANE, "actuator": actuator, "shaper": SHAPER}
        return {"design": design, "axes": [LENGTHS], "columns": ["times_s"]}
    return {"plant": CRANE, "actuator": actuator, **ROUTES[route]}


def answer_of(service: InProcess, route: str, body: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    """Return status and answer; of a batch, those of its one line."""
    answer = service.ask("POST", route, json.dumps(body).encode(), headers=JSON)
    told: dict[str, Any] = json.loads(answer.text.splitlines()[0])
    return (told.get("status", 200) if route.endswith("/batch") else answer.status_code), told


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> InProcess:
    folder: Path = tmp_path_factory.mktemp("tables")
    return InProcess(MemoryJobs(folder))


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize("field", ["accel_limit_m_s2", "decel_limit_m_s2", "speed_m_s"])
@pytest.mark.parametrize(
    ("value", "code", "rule"),
    [
        (0, "out_of_range", "greater than 0"),
        (-0.3, "out_of_range", "greater than 0"),
        (math.inf, "not_finite", "finite"),
        (-math.inf, "not_finite", "finite"),
        (math.nan, "not_finite", "finite"),
        (1e13, "out_of_range", "at most 1e+12"),
        (1e-13, "out_of_range", "between 1e-12 and 1e+12"),
    ],
)
def test_a_limit_out_of_range_is_named_with_its_rule_and_value(
    service: InProcess, route: str, field: str, value: float, code: str, rule: str
) -> None:
    status, told = answer_of(service, route, body_of(route, {**LIMITS, field: value}))
    assert (status, told["type"]) == (422, "urn:shapersmith:invalid-input")
    (fault,) = told["errors"]
    assert fault["pointer"].endswith(f"/actuator/{field}")
    assert fault["code"] == code
    assert rule in fault["detail"]
    if math.isfinite(value):
        assert f"{value}" in fault["detail"]


@pytest.mark.parametrize("route", [route for route in ROUTES if route != "/v1/simulations"])
@pytest.mark.parametrize("field", ["accel_limit_m_s2", "decel_limit_m_s2"])
@pytest.mark.parametrize("value", [0.05, 1e-6])
def test_a_ramp_of_more_than_three_periods_is_refused_by_the_limit_that_makes_it(
    service: InProcess, route: str, field: str, value: float
) -> None:
    status, told = answer_of(service, route, body_of(route, {**LIMITS, field: value}))
    if route == "/v1/tables":  # rows are judged one by one
        assert status == 202
        return
    assert status == 422
    (fault,) = told["errors"]
    assert (fault["pointer"], fault["code"]) == (f"/actuator/{field}", "ramp_too_long")
    assert SLOW_RULE in fault["detail"]
    assert f"got {value}" in fault["detail"]


def test_a_ramp_that_does_not_end_in_time_is_played_as_far_as_asked(service: InProcess) -> None:
    request = body_of("/v1/simulations", {**LIMITS, "accel_limit_m_s2": 1e-3})
    status, told = answer_of(service, "/v1/simulations", {**request, "until_s": 10.0})
    assert status == 200
    velocity = told["velocity_m_s"]
    assert velocity[-1] == pytest.approx(1e-2, rel=1e-9)


@pytest.mark.parametrize(
    ("more", "pointer", "code"),
    [
        ({"distance_m": 0}, "/distance_m", "out_of_range"),
        ({"distance_m": 1e-13}, "/distance_m", "out_of_range"),
        ({"distance_m": 1e5}, "/distance_m", "move_too_long"),
        ({"speed_m_s": 0.0}, "/speed_m_s", "speed_not_actuators"),
        ({"speed_m_s": 2.0}, "/speed_m_s", "speed_not_actuators"),
        ({"distance_m": None, "pulse_s": 0}, "/pulse_s", "not_positive"),
        ({"distance_m": None, "pulse_s": -1}, "/pulse_s", "not_positive"),
        ({"pulse_s": 1}, "/pulse_s", "pulse_or_distance"),
    ],
)
def test_a_faulty_move_behind_limits_is_named(
    service: InProcess, more: dict[str, Any], pointer: str, code: str
) -> None:
    request = {**body_of("/v1/maneuvers", LIMITS), **more}
    status, told = answer_of(service, "/v1/maneuvers", request)
    assert status == 422
    assert [(fault["pointer"], fault["code"]) for fault in told["errors"]] == [(pointer, code)]


@pytest.mark.parametrize("kind", ["umzv", "umzvd", "numzv", "numzvd"])
@pytest.mark.parametrize("distance_m", [1e-6, -1e-6, 0.5])
def test_a_move_that_never_reaches_full_speed_is_served(
    service: InProcess, kind: str, distance_m: float
) -> None:
    request = {**body_of("/v1/maneuvers", LIMITS), "distance_m": distance_m}
    status, told = answer_of(service, "/v1/maneuvers", {**request, "shaper": {"kind": kind}})
    assert status == 200
    assert told["certificate"]["verified"]
    assert told["distance_m"] == pytest.approx(distance_m, rel=1e-9)


def test_a_limit_too_far_above_the_other_names_what_can_be_served(service: InProcess) -> None:
    request = body_of("/v1/designs", {**LIMITS, "decel_limit_m_s2": 1e8})
    _, told = answer_of(service, "/v1/designs", request)
    (fault,) = told["errors"]
    assert (fault["pointer"], fault["code"]) == ("/actuator/decel_limit_m_s2", "ramp_too_short")
    assert "at most 1.044e+05 m/s^2" in fault["detail"]
    served = body_of("/v1/designs", {**LIMITS, "decel_limit_m_s2": 1.044e5})
    assert answer_of(service, "/v1/designs", served)[0] == 200
