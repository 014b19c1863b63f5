"""Every answer can be read back by its own model, and says then what it said."""

import json
from typing import Any, get_args

import httpx
import pytest
from pydantic import BaseModel

from design.maps.map_case import Quantity
from schemas.catalogue import Catalogue
from schemas.problems import ProblemDocument
from schemas.table_jobs import TableJob, TableJobs
from service.catalogue import TWO_MODES, shaper_catalogue
from service.dispatch import respond
from service.operations.table import TABLE, load
from service.problems import Problem
from tests.conftest import CRANE
from tests.shapersmith.requests import REQUESTS as REQUESTS_OF_CALLS

MODE = {"kind": "mode", "natural_frequency_rad_s": 6.0, "damping_ratio": 0.05}
IDEAL = {"kind": "ideal"}
RANGE = {
    "kind": "scheduled",
    "plant": CRANE["plant"],
    "over": "cable_length_m",
    "from": 0.7,
    "to": 0.9,
}
FIT = {"over": "/plant/cable_length_m", "from": 0.7, "to": 0.9, "degree": 3}
DAMPING = {"damping": {"from": 0.0, "to": 0.1, "points": 5}}
STEPS = {"times_s": [0.0, 0.9], "amplitudes": [0.5, 0.5]}
LENGTHS = {"field": "/plant/cable_length_m", "values": [0.7, 0.8]}
MOVE = {**CRANE, "speed_m_s": 0.2, "distance_m": 0.42}
PLAYED = {"plant": CRANE["plant"], "actuator": CRANE["actuator"], "points": 5}

REQUESTS: list[tuple[str, str, dict[str, Any]]] = [
    *(("design", entry.kind, entry.example) for entry in shaper_catalogue().shapers),
    ("design", "no curve", {**CRANE, "sensitivity": None}),
    ("design", "damping", {**CRANE, "sensitivity": DAMPING}),
    ("design", "fit", {**CRANE, "fit": FIT}),
    ("design", "for an ideal drive", {**CRANE, "shaper": {"kind": "umzvd"}}),
    ("design", "scheduled", {**CRANE, "plant": RANGE, "shaper": {"kind": "ei", "tolerance": 0.1}}),
    ("design", "samples", {**CRANE, "shaper": {"kind": "numzv", "sample_time_s": 0.01}}),
    (
        "design",
        "positive on samples",
        {"plant": MODE, "actuator": IDEAL, "shaper": {"kind": "zvd", "sample_time_s": 0.01}},
    ),
    ("sensitivity", "one mode", {**PLAYED, "impulses": STEPS, "points": 9, **DAMPING}),
    (
        "sensitivity",
        "modes",
        {"plant": TWO_MODES, "actuator": IDEAL, "impulses": STEPS, "points": 9},
    ),
    ("fit", "degree", {**CRANE, "fit": FIT}),
    ("fit", "max_residual", {**CRANE, "fit": {**FIT, "degree": None, "max_residual": 1e-3}}),
    ("maneuver", "distance", MOVE),
    ("maneuver", "program", {**MOVE, "sample_time_s": 0.01}),
    ("maneuver", "initial", {**MOVE, "initial": {"angle_rad": 0.001, "angle_rate_rad_s": 0.002}}),
    ("simulation", "step", {**PLAYED, "command": {"kind": "step"}}),
    (
        "simulation",
        "shaped",
        {**PLAYED, "command": {"kind": "pulse", "pulse_s": 2.0}, "shaper": CRANE["shaper"]},
    ),
    ("simulation", "no angle", {**PLAYED, "plant": MODE, "command": {"kind": "step"}}),
    ("run", "events", REQUESTS_OF_CALLS["run"]),
    ("run", "no event", {**PLAYED, "plant": MODE, "speed_m_s": 0.2}),
    *(
        (
            "map",
            quantity,
            {
                **{key: CRANE[key] for key in ("plant", "actuator")},
                **({} if quantity in {"alpha", "beta_rad"} else {"shaper": {"kind": "numzv"}}),
                **({"speed_m_s": 0.2} if quantity == "deflection_m" else {}),
                **({"design": "each"} if quantity in {"times_s", "duration_s", "branch"} else {}),
                "quantity": quantity,
                "x": LENGTHS,
            },
        )
        for quantity in get_args(Quantity)
    ),
    (
        "map",
        "two axes",
        {**CRANE, "x": LENGTHS, "y": {"field": "/plant/damping_ratio", "values": [0.0, 0.1]}},
    ),
    (
        "recommendation",
        "samples",
        {"plant": MODE, "actuator": IDEAL, "half_width": 0.1, "sample_time_s": 0.01},
    ),
    (
        "recommendation",
        "behind a drive",
        {"plant": CRANE["plant"], "actuator": CRANE["actuator"], "sign": "positive"},
    ),
]


def require_round_trip(answer: BaseModel) -> None:
    read = type(answer).model_validate_json(answer.model_dump_json(by_alias=True))
    assert read == answer
    assert read.model_dump_json(by_alias=True) == answer.model_dump_json(by_alias=True)


@pytest.mark.parametrize(
    ("operation", "request_"),
    [
        pytest.param(operation, body, id=f"{operation}: {name}")
        for operation, name, body in REQUESTS
    ],
)
def test_an_answer_is_read_back_as_it_was(operation: str, request_: dict[str, Any]) -> None:
    answer = respond(operation, json.dumps(request_).encode())
    assert not isinstance(answer, Problem), answer
    assert isinstance(answer, load(operation).response)
    require_round_trip(answer)


def test_every_operation_and_every_quantity_of_a_map_is_read_back() -> None:
    assert {operation for operation, *_ in REQUESTS} == set(TABLE)
    assert set(get_args(Quantity)) <= {
        name for operation, name, _ in REQUESTS if operation == "map"
    }


def test_the_catalogue_is_read_back(client: httpx.Client) -> None:
    require_round_trip(shaper_catalogue())
    require_round_trip(Catalogue.model_validate_json(client.get("/v1/shapers").content))


@pytest.mark.parametrize(
    ("operation", "body"), [("design", b"{"), ("design", b"{}"), ("fit", b'{"x": NaN}')]
)
def test_a_problem_is_read_back(operation: str, body: bytes) -> None:
    problem = respond(operation, body)
    assert isinstance(problem, Problem)
    require_round_trip(problem.document())
    require_round_trip(problem.document("id-1"))


def test_problems_and_the_states_of_tables_are_read_back_from_the_service(
    client: httpx.Client,
) -> None:
    refused = client.post("/v1/designs", json={})
    assert ProblemDocument.model_validate_json(refused.content).status == refused.status_code
    table = {"design": CRANE, "axes": [LENGTHS]}
    begun = client.post("/v1/tables", json=table)
    job = TableJob.model_validate_json(begun.content)
    require_round_trip(job)
    require_round_trip(TableJob.model_validate_json(client.get(f"/v1/tables/{job.id}").content))
    jobs = TableJobs.model_validate_json(client.get("/v1/tables").content)
    assert job.id in {one.id for one in jobs.tables}
    require_round_trip(jobs)
