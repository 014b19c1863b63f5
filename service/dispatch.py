"""From bytes to bytes: what a worker does with a request, and the command line by itself."""

import time
from collections.abc import Mapping
from dataclasses import dataclass

from pydantic import BaseModel, ValidationError

from design.errors import DesignError
from service.implausible import implausible_values
from service.operations.table import load
from service.problems import (
    Problem,
    problem_of_design,
    problem_of_repetition,
    problem_of_validation,
)
from service.repeated_names import RepeatedNameError
from service.strict_json import loads


@dataclass(frozen=True, slots=True)
class Answer:
    """The outcome of one operation: a response or a problem, and how long it took."""

    outcome: bytes | Problem
    seconds: float


def answer(operation: str, body: bytes) -> Answer:
    """Answer a request in JSON.

    Parameters
    ----------
    operation, body
        Name of the operation, and the request as JSON.

    Returns
    -------
    Answer
        The response or the problem, and how long it took.
    """
    started = time.perf_counter()
    found = respond(operation, body)
    outcome = found if isinstance(found, Problem) else found.model_dump_json(by_alias=True).encode()
    return Answer(outcome, time.perf_counter() - started)


def respond(
    operation: str, body: bytes, asked: Mapping[str, object] | None = None
) -> BaseModel | Problem:
    """Validate a body and run the operation.

    Parameters
    ----------
    operation, body, asked
        Name of the operation, the request as JSON, and fields that are set once it is read.

    Returns
    -------
    BaseModel or Problem
        The response, or what is wrong.
    """
    case = load(operation)
    try:
        request = case.request.model_validate_json(body)
    except ValidationError as error:
        return problem_of_validation(error, body, case.request)
    try:
        loads(body)  # every name stands once
    except RepeatedNameError as error:
        return problem_of_repetition(error)
    try:
        found = case.run(request.model_copy(update=asked) if asked else request)
        if odd := implausible_values(request):
            from service.implausible_words import with_warnings  # noqa: PLC0415 - few need them

            return with_warnings(found, odd, body)
    except DesignError as error:
        return problem_of_design(error, body)
    return found
