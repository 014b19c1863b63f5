"""From bytes to a file of one design or one move."""

from collections.abc import Callable
from typing import TypeVar

from pydantic import ValidationError

from design.errors import DesignError
from design.tables.rows import Real
from schemas.base import Wire
from schemas.design_request import DesignRequest
from schemas.maneuvers import ManeuverRequest
from service.operations.design_file import design_file as file_of_design
from service.operations.move_file import move_file as file_of_move
from service.problems import Problem, problem_of_design, problem_of_validation

Request = TypeVar("Request", bound=Wire)


def design_file(body: bytes, format_name: str, real: Real = "LREAL") -> bytes | Problem:
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
    bytes or Problem
        The file, or what is wrong.
    """
    return _file(body, DesignRequest, lambda asked: file_of_design(asked, format_name, real))


def move_file(body: bytes, format_name: str, real: Real = "LREAL") -> bytes | Problem:
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
    bytes or Problem
        The file, or what is wrong.
    """
    return _file(body, ManeuverRequest, lambda asked: file_of_move(asked, format_name, real))


def _file(
    body: bytes, model: type[Request], written: Callable[[Request], bytes]
) -> bytes | Problem:
    try:
        request = model.model_validate_json(body)
    except ValidationError as error:
        return problem_of_validation(error, body, model)
    try:
        return written(request)
    except DesignError as error:
        return problem_of_design(error, body)


FILES: dict[str, Callable[[bytes, str, Real], bytes | Problem]] = {
    "design": design_file,
    "maneuver": move_file,
}
"""What writes the answer of an operation as a file."""
