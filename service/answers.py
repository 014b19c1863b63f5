"""From bytes to bytes: what a worker does with a request, and the command line by itself."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel, ValidationError

from design.errors import DesignError
from schemas.base import Wire
from schemas.designs import DesignRequest
from schemas.fits import FitRequest
from schemas.maneuvers import ManeuverRequest
from schemas.maps import MapRequest
from schemas.sensitivity import SensitivityRequest
from schemas.simulations import SimulationRequest
from service import operations
from service.problems import Problem, problem_of_design, problem_of_validation


@dataclass(frozen=True, slots=True)
class Operation:
    """A use case that takes a body."""

    request: type[Wire]
    run: Callable[[Any], BaseModel]


OPERATIONS: dict[str, Operation] = {
    "design": Operation(DesignRequest, operations.design_shaper),
    "sensitivity": Operation(SensitivityRequest, operations.sensitivity_curve),
    "fit": Operation(FitRequest, operations.fit_curves),
    "maneuver": Operation(ManeuverRequest, operations.whole_move),
    "map": Operation(MapRequest, operations.residual_over_two_fields),
    "simulation": Operation(SimulationRequest, operations.simulate),
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


def respond(operation: str, body: bytes) -> BaseModel | Problem:
    """Validate a body and run the operation."""
    case = OPERATIONS[operation]
    try:
        request = case.request.model_validate_json(body)
    except ValidationError as error:
        return problem_of_validation(error, body)
    try:
        return case.run(request)
    except DesignError as error:
        return problem_of_design(error)


def answer_lines(operation: str, lines: list[bytes]) -> list[Answer]:
    """Answer each line of a part of a batch."""
    return [answer(operation, line) for line in lines]
