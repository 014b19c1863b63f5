"""From bytes to a file of one design."""

from pydantic import ValidationError

from design.errors import DesignError
from schemas.design_request import DesignRequest
from service.operations.design_file import design_file as file_of
from service.problems import Problem, problem_of_design, problem_of_validation


def design_file(body: bytes, format_name: str) -> bytes | Problem:
    """Validate a request for a design and return its shaper as a file.

    Parameters
    ----------
    body
        The request as JSON.
    format_name
        Name of a format that a single design can be written in.

    Returns
    -------
    bytes or Problem
        The file, or what is wrong.
    """
    try:
        request = DesignRequest.model_validate_json(body)
    except ValidationError as error:
        return problem_of_validation(error, body, DesignRequest)
    try:
        return file_of(request, format_name)
    except DesignError as error:
        return problem_of_design(error, body)
