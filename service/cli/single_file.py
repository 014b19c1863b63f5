"""From bytes to a file of one design, one move or one machine."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from pydantic import ValidationError

from design.errors import DesignError
from design.tables.rows import Real
from schemas.base import Wire
from schemas.design_request import DesignRequest
from schemas.maneuvers import ManeuverRequest
from schemas.runs import RunRequest
from schemas.warnings import WarningOut
from service.implausible import implausible_values
from service.implausible_words import warnings_of
from service.operations.design_file import design_file as file_of_design
from service.operations.live_file import live_file as file_of_machine
from service.operations.move_file import move_file as file_of_move
from service.problems import (
    Problem,
    problem_of_design,
    problem_of_repetition,
    problem_of_validation,
)
from service.repeated_names import RepeatedNameError
from service.strict_json import loads

Request = TypeVar("Request", bound=Wire)


@dataclass(frozen=True, slots=True)
class Written:
    """A file, and what is hardly meant in the request for it."""

    content: bytes
    warnings: tuple[WarningOut, ...]


def design_file(body: bytes, format_name: str, real: Real = "LREAL") -> Written | Problem:
    """Validate a request for a design and return its shaper as a file.

    Parameters
    ----------
    body
        The request as JSON.
    format_name
        Name of a format that a single design can be written in.
    real
        Type of numbers in Structured Text.

    Returns
    -------
    Written or Problem
        The file, or what is wrong.
    """
    return _file(body, DesignRequest, lambda asked: file_of_design(asked, format_name, real))


def move_file(body: bytes, format_name: str, real: Real = "LREAL") -> Written | Problem:
    """Validate a request for a move and return it as a file.

    Parameters
    ----------
    body
        The request as JSON.
    format_name
        Name of a format that plays moves.
    real
        Type of numbers in Structured Text.

    Returns
    -------
    Written or Problem
        The file, or what is wrong.
    """
    return _file(body, ManeuverRequest, lambda asked: file_of_move(asked, format_name, real))


def live_file(body: bytes, format_name: str, real: Real = "LREAL") -> Written | Problem:
    """Validate a request for a run and return its machine as a file.

    Parameters
    ----------
    body
        The request as JSON.
    format_name
        Name of a format that holds blocks.
    real
        Type of numbers in Structured Text.

    Returns
    -------
    Written or Problem
        The file, or what is wrong.
    """
    return _file(body, RunRequest, lambda asked: file_of_machine(asked, format_name, real))


def _file(
    body: bytes, model: type[Request], written: Callable[[Request], bytes]
) -> Written | Problem:
    try:
        request = model.model_validate_json(body)
    except ValidationError as error:
        return problem_of_validation(error, body, model)
    try:
        loads(body)  # every name stands once
    except RepeatedNameError as error:
        return problem_of_repetition(error)
    try:
        content = written(request)
    except DesignError as error:
        return problem_of_design(error, body)
    return Written(content, tuple(warnings_of(implausible_values(request), body)))


FILES: dict[str, Callable[[bytes, str, Real], Written | Problem]] = {
    "design": design_file,
    "maneuver": move_file,
    "run": live_file,
}
"""What writes the answer of an operation as a file."""
