"""From bytes to bytes: what a worker does with a request, and the command line by itself."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from pydantic import BaseModel, ValidationError

from design.errors import DesignError
from schemas.base import Wire
from schemas.designs import DesignRequest, DesignResponse
from schemas.fits import FitOut, FitRequest
from schemas.maneuvers import ManeuverRequest, ManeuverResponse
from schemas.maps import MapRequest, MapResponse
from schemas.recommendations import RecommendationRequest, RecommendationResponse
from schemas.sensitivity import SensitivityRequest, SensitivityResponse
from schemas.simulations import SimulationRequest, SimulationResponse
from service import operations
from service.problems import (
    Problem,
    problem_of_design,
    problem_of_repetition,
    problem_of_validation,
)
from service.strict_json import RepeatedNameError, require_names_once

NOTHING: Mapping[str, object] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Operation:
    """A use case that takes a body: one row here is its route and its documentation."""

    path: str
    summary: str
    request: type[Wire]
    response: type[Wire]
    run: Callable[[Any], BaseModel]


OPERATIONS: dict[str, Operation] = {
    "design": Operation(
        "/v1/designs",
        "Design one shaper, prove it, add its sensitivity curve and curve coefficients",
        DesignRequest,
        DesignResponse,
        operations.design_shaper,
    ),
    "sensitivity": Operation(
        "/v1/sensitivity",
        "Sensitivity curve and insensitivity of any impulses",
        SensitivityRequest,
        SensitivityResponse,
        operations.sensitivity_curve,
    ),
    "fit": Operation(
        "/v1/fits",
        "Curve coefficients of a shaper over one field, and what the fitted times leave",
        FitRequest,
        FitOut,
        operations.fit_curves,
    ),
    "maneuver": Operation(
        "/v1/maneuvers",
        "A whole move from rest to rest over an exact distance, proven as a whole",
        ManeuverRequest,
        ManeuverResponse,
        operations.whole_move,
    ),
    "simulation": Operation(
        "/v1/simulations",
        "Response of plant and actuator to a command, shaped or not, exact at each time",
        SimulationRequest,
        SimulationResponse,
        operations.simulate,
    ),
    "map": Operation(
        "/v1/maps",
        "Residual, times or gains of a shaper or a whole move over one or two fields",
        MapRequest,
        MapResponse,
        operations.map_over_fields,
    ),
    "recommendation": Operation(
        "/v1/recommendations",
        "From what is known to the fastest shaper that meets it, with the runners-up and reasons",
        RecommendationRequest,
        RecommendationResponse,
        operations.recommend_shaper,
    ),
}


@dataclass(frozen=True, slots=True)
class Answer:
    """The outcome of one operation: a response or a problem, and how long it took."""

    outcome: bytes | Problem
    seconds: float


def answer(operation: str, body: bytes) -> Answer:
    """Validate a body, run the operation, and return the response as JSON, or the problem."""
    started = time.perf_counter()
    outcome = respond(operation, body)
    if isinstance(outcome, BaseModel):
        encoded: bytes | Problem = outcome.model_dump_json(by_alias=True).encode()
    else:
        encoded = outcome
    return Answer(encoded, time.perf_counter() - started)


def respond(
    operation: str, body: bytes, asked: Mapping[str, object] = NOTHING
) -> BaseModel | Problem:
    """Validate a body and run the operation.

    Parameters
    ----------
    operation
        Its row of `OPERATIONS`.
    body
        The request.
    asked
        Fields of the request that are set once it is read: by options of the command line.
    """
    case = OPERATIONS[operation]
    try:
        request = case.request.model_validate_json(body)
    except ValidationError as error:
        return problem_of_validation(error, body)
    try:
        require_names_once(body)
    except RepeatedNameError as error:
        return problem_of_repetition(error)
    try:
        return case.run(request.model_copy(update=asked) if asked else request)
    except DesignError as error:
        return problem_of_design(error)


def design_file(body: bytes, format_name: str) -> bytes | Problem:
    """Validate a request for a design and return its shaper as a file."""
    try:
        request = DesignRequest.model_validate_json(body)
    except ValidationError as error:
        return problem_of_validation(error, body)
    try:
        return operations.design_file(request, format_name)
    except DesignError as error:
        return problem_of_design(error)


def answer_lines(operation: str, lines: list[bytes]) -> list[Answer]:
    """Answer each line of a part of a batch."""
    return [answer(operation, line) for line in lines]
