"""The one table from errors to problem documents, for HTTP and the command line alike."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from design.errors import (
    DesignError,
    InfeasibleDesignError,
    InvalidInputError,
    SolverFailedError,
    TimeLimitError,
    path_of,
)
from design.trace import TraceStep
from schemas.pointers import json_pointer
from schemas.pointers import path_of as path_of_pointer
from schemas.problems import FieldFault, ProblemDocument
from schemas.trace import TraceStepOut
from service.belonging import owner_of_request
from service.design_words import refusal_of_design
from service.given_names import as_given, pointer, without_made_modes
from service.plain_words import echo, refusal
from service.repeated_names import RepeatedNameError
from service.suggestions import listed
from service.unreadable_json import why_unreadable


@dataclass(frozen=True, slots=True)
class ProblemKind:
    """A kind of problem: its name on the wire, HTTP status, exit status and title."""

    name: str
    http: HTTPStatus
    exit_status: int
    title: str

    @property
    def code(self) -> str:
        """Its name in the style of codes, for a problem without a nearer one."""
        return self.name.replace("-", "_")


NOT_JSON = ProblemKind("not-json", HTTPStatus.BAD_REQUEST, 2, "The body is not JSON")
INVALID = ProblemKind(
    "invalid-input", HTTPStatus.UNPROCESSABLE_ENTITY, 2, "A field breaks its rule"
)
INFEASIBLE = ProblemKind(
    "infeasible", HTTPStatus.UNPROCESSABLE_ENTITY, 3, "No such shaper was found"
)
SOLVER_FAILED = ProblemKind(
    "solver-failed", HTTPStatus.INTERNAL_SERVER_ERROR, 4, "The solver gave up"
)
TIME_LIMIT = ProblemKind(
    "time-limit", HTTPStatus.GATEWAY_TIMEOUT, 4, "The work ran past its time limit"
)
INTERNAL = ProblemKind(
    "internal", HTTPStatus.INTERNAL_SERVER_ERROR, 1, "A fault of the service itself"
)
OVERLOADED = ProblemKind("overloaded", HTTPStatus.SERVICE_UNAVAILABLE, 1, "No worker is free")
TOO_LARGE = ProblemKind(
    "too-large", HTTPStatus.REQUEST_ENTITY_TOO_LARGE, 2, "The body is too large"
)
REQUEST_TIMEOUT = ProblemKind(
    "request-timeout", HTTPStatus.REQUEST_TIMEOUT, 1, "The body did not arrive in time"
)
FORBIDDEN = ProblemKind("forbidden", HTTPStatus.FORBIDDEN, 1, "Not allowed from there")
NOT_FOUND = ProblemKind("not-found", HTTPStatus.NOT_FOUND, 1, "Not found")
CONFLICT = ProblemKind("conflict", HTTPStatus.CONFLICT, 1, "Not possible in this state")
RANGE_NOT_SATISFIABLE = ProblemKind(
    "range-not-satisfiable", HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE, 1, "No such range"
)
METHOD_NOT_ALLOWED = ProblemKind(
    "method-not-allowed", HTTPStatus.METHOD_NOT_ALLOWED, 1, "The route has no such method"
)
UNSUPPORTED_MEDIA_TYPE = ProblemKind(
    "unsupported-media-type", HTTPStatus.UNSUPPORTED_MEDIA_TYPE, 1, "The body must be JSON"
)

KIND_OF: dict[type[DesignError], ProblemKind] = {
    InvalidInputError: INVALID,
    InfeasibleDesignError: INFEASIBLE,
    SolverFailedError: SOLVER_FAILED,
    TimeLimitError: TIME_LIMIT,
}
"""Every error of the mathematics and its problem; a test proves the table whole."""

ECHO = "default_factory_not_called"
"""Type of what is no fault: a default that depends on fields of which one is at fault."""

MAX_FAULTS = 20
"""Faults of a request that an answer lists."""

CODE_OF_TYPE = {
    "union_tag_invalid": "unknown_kind",
    "union_tag_not_found": "no_kind",
    "literal_error": "not_one_of",
    "enum": "not_one_of",
    "finite_number": "not_finite",
    "greater_than": "out_of_range",
    "greater_than_equal": "out_of_range",
    "less_than": "out_of_range",
    "less_than_equal": "out_of_range",
    "int_parsing_size": "out_of_range",
    "string_too_short": "too_short",
    "string_too_long": "too_long",
    "string_pattern_mismatch": "wrong_form",
    "int_from_float": "not_whole",
    "bool_type": "wrong_type",
    "int_type": "wrong_type",
    "float_type": "wrong_type",
    "string_type": "wrong_type",
    "list_type": "wrong_type",
    "tuple_type": "wrong_type",
    "dict_type": "wrong_type",
    "model_type": "wrong_type",
    "model_attributes_type": "wrong_type",
}
"""Codes of what the wire models refuse, by pydantic's type of fault: those that would be several
for one meaning. Any other, as ``missing`` and ``extra_forbidden``, is its own code."""

MAX_POINTER_CHARACTERS = 300
"""Characters of a pointer that an answer repeats."""


@dataclass(frozen=True, slots=True)
class Problem:
    """One error, ready to be reported.

    Attributes
    ----------
    kind
        Its row of the table.
    detail
        What is wrong, in words.
    errors
        The fields at fault.
    code
        What is wrong, as a name, where it says more than the kind.
    retry_after_s
        When it may be over, of what passes [s].
    trace
        Steps of the search that ended with it, where it was watched.
    """

    kind: ProblemKind
    detail: str
    errors: tuple[FieldFault, ...] = ()
    code: str | None = None
    retry_after_s: int = 1
    trace: tuple[TraceStep, ...] = ()

    @property
    def headers(self) -> dict[str, str]:
        """Headers of its answer over HTTP: when to ask again, of what passes.

        A problem may come from a worker, whose kinds are equal to these and not the same.
        """
        return {"retry-after": str(self.retry_after_s)} if self.kind == OVERLOADED else {}

    def document(self, request_id: str | None = None) -> ProblemDocument:
        """Return the problem document."""
        return ProblemDocument(
            type=f"urn:shapersmith:{self.kind.name}",
            title=self.kind.title,
            status=self.kind.http.value,
            code=self.code or self.kind.code,
            detail=self.detail,
            errors=self.errors,
            request_id=request_id,
            trace=[TraceStepOut.from_design(step) for step in self.trace] or None,
        )


class ProblemError(Exception):
    """A problem on the way to an answer, raised where it is known and answered in one place.

    Parameters
    ----------
    problem
        What is wrong.
    headers
        Headers that the answer over HTTP has.

    Attributes
    ----------
    problem, headers
        The same.
    """

    def __init__(self, problem: Problem, headers: Mapping[str, str] | None = None) -> None:
        super().__init__(problem.detail)
        self.problem = problem
        self.headers = headers or {}


def invalid_fields(detail: str, faults: tuple[FieldFault, ...]) -> Problem:
    """Return the problem of fields that break their rules.

    Parameters
    ----------
    detail
        All of it in words.
    faults
        The fields.

    Returns
    -------
    Problem
        Of the code of the faults, where they have one in common.
    """
    codes = {fault.code for fault in faults}
    return Problem(INVALID, detail, faults, code=codes.pop() if len(codes) == 1 else None)


def problem_of_design(error: DesignError, body: bytes | str = b"null") -> Problem:
    """Translate an error of the mathematics.

    Parameters
    ----------
    error
        The error.
    body
        The request as JSON, whose fields may be in other units than those of the mathematics.

    Returns
    -------
    Problem
        With the fields at fault as the request names them.
    """
    if isinstance(error, InvalidInputError) and " " in error.name:
        # No field of the request: what a format finds in a row, made by the request as a whole.
        told = f"{error.name}: must be {error.rule}, got {echo(error.value)}"
        return invalid_fields(told, (FieldFault(pointer="", code=error.code, detail=told),))
    if isinstance(error, InvalidInputError):
        request = json.loads(body)
        error = without_made_modes(error, request)
        path = as_given(error.path, request)
        told = refusal_of_design(error, path, request)
        fault = FieldFault(pointer=_shorten(json_pointer(path)), code=error.code, detail=told)
        return invalid_fields(_sentence(fault), (fault,))
    faults: tuple[FieldFault, ...] = ()
    if isinstance(error, InfeasibleDesignError):
        faults = tuple(
            FieldFault(pointer=json_pointer(path_of(name)), code=error.code, detail=detail)
            for name, detail in error.faults
        )
    return Problem(KIND_OF[type(error)], str(error), faults, code=error.code, trace=error.trace)


THE_FIELDS = "; the fields are "
"""Begins the list of what is expected at a place."""


def problem_of_validation(
    error: ValidationError,
    body: bytes | str,
    model: Any,  # noqa: ANN401
) -> Problem:
    """Translate what the wire models refused.

    Parameters
    ----------
    error
        The error of the model.
    body
        The text that the model was given.
    model
        The model, or a union of models.

    Returns
    -------
    Problem
        That the text is no JSON, or a fault for each field, `MAX_FAULTS` at most.
    """
    faults = [fault for fault in error.errors(include_url=False) if fault["type"] != ECHO]
    if faults[0]["type"] == "json_invalid":
        return Problem(NOT_JSON, why_unreadable(body, faults[0]["msg"]))
    parsed = json.loads(body)
    named = tuple(
        _fault(fault, pointer(fault["loc"], parsed), model, parsed) for fault in faults[:MAX_FAULTS]
    )
    strangers = [one.pointer for one in named if one.code == "extra_forbidden"]
    if strangers and (owner := owner_of_request(model, parsed)):
        are = "is" if len(strangers) == 1 else "are"
        told = f"this is a request of {owner}; {listed(strangers, 'and')}: {are} no field here"
        return invalid_fields(told, named)
    told = _once("; ".join(map(_sentence, named)))
    if len(faults) > MAX_FAULTS:
        told += f"; and {len(faults) - MAX_FAULTS} more"
    return invalid_fields(told, named)


def problem_of_repetition(error: RepeatedNameError) -> Problem:
    """Translate that a name stands twice in an object.

    Only one of the two values would be kept.
    """
    fault = FieldFault(
        pointer=_shorten(error.pointer), code="name_repeated", detail="must be given once"
    )
    return invalid_fields(_sentence(fault), (fault,))


def _fault(
    fault: ErrorDetails,
    where: str,
    model: Any,  # noqa: ANN401
    request: Any,  # noqa: ANN401
) -> FieldFault:
    names = [name for name in path_of_pointer(where) if not name.isdecimal()]
    return FieldFault(
        pointer=_shorten(where),
        code=CODE_OF_TYPE.get(fault["type"], fault["type"]),
        detail=refusal(fault, model, names[-1] if names else "", request),
    )


def _once(told: str) -> str:
    """Return a text in which each list of fields stands once, where it is needed first."""
    first, *others = re.split(f"(?={THE_FIELDS})", told)
    lists: set[str] = set()
    kept = [first]
    for part in others:
        listed_here, mark, rest = part.removeprefix(THE_FIELDS).partition(";")
        kept.append(mark + rest if listed_here in lists else part)
        lists.add(listed_here)
    return "".join(kept)


def _sentence(fault: FieldFault) -> str:
    return f"{fault.pointer or 'the body'}: {fault.detail}"


def _shorten(text: str) -> str:
    most = MAX_POINTER_CHARACTERS
    return text if len(text) <= most else f"{text[: most - 3]}..."
