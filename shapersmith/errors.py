"""Errors of the Python interface: what HTTP answers as a problem document.

ShapersmithError
├── InvalidInputError      a value breaks its rule; `errors` names each field
├── InfeasibleDesignError  no such shaper was found
├── SolverFailedError      a solver gave up, or its answer did not verify
├── TimeLimitError         the work ran past its time
└── ServiceError           the service is overloaded, refuses the request, or has a fault
    └── UnreachableError   it gave no answer at all
"""

from http import HTTPStatus
from typing import NoReturn

from schemas.problems import FieldFault, ProblemDocument
from schemas.trace import TraceStepOut
from service.problems import (
    INFEASIBLE,
    INVALID,
    NOT_JSON,
    SOLVER_FAILED,
    TIME_LIMIT,
    ProblemKind,
)


class ShapersmithError(Exception):
    """Base of all errors that shapersmith raises on purpose.

    Parameters
    ----------
    document
        The problem document, as HTTP has it.

    Attributes
    ----------
    document
        The same.
    """

    def __init__(self, document: ProblemDocument) -> None:
        super().__init__(document)  # what pickle calls it with in another process
        self.document = document

    def __str__(self) -> str:
        return self.document.detail

    @property
    def code(self) -> str:
        """Name of the fault, which does not change with the words of `detail`."""
        return self.document.code

    @property
    def detail(self) -> str:
        """What is wrong, in words."""
        return self.document.detail

    @property
    def errors(self) -> tuple[FieldFault, ...]:
        """The fields at fault, each with its JSON pointer, its code and its rule."""
        return self.document.errors

    @property
    def trace(self) -> list[TraceStepOut]:
        """Steps of the search that ended with it; empty where it was not watched."""
        return self.document.trace or []


class InvalidInputError(ShapersmithError):
    """A value breaks its rule."""


class InfeasibleDesignError(ShapersmithError):
    """No such shaper was found; the message says how far was searched."""


class SolverFailedError(ShapersmithError):
    """A solver gave up, or its answer did not verify."""


class TimeLimitError(ShapersmithError):
    """The work ran past its time."""


class ServiceError(ShapersmithError):
    """The service is overloaded, refuses the request, or has a fault."""


class UnreachableError(ServiceError):
    """The service gave no answer."""


UNREACHABLE = ProblemKind(
    "unreachable", HTTPStatus.SERVICE_UNAVAILABLE, 1, "The service does not answer"
)
STRANGE_ANSWER = ProblemKind(
    "strange-answer", HTTPStatus.BAD_GATEWAY, 1, "The answer cannot be read"
)

CLASS_OF: dict[str, type[ShapersmithError]] = {
    INVALID.name: InvalidInputError,
    NOT_JSON.name: InvalidInputError,
    INFEASIBLE.name: InfeasibleDesignError,
    SOLVER_FAILED.name: SolverFailedError,
    TIME_LIMIT.name: TimeLimitError,
    UNREACHABLE.name: UnreachableError,
}
"""Classes by the name of the problem; any other is a `ServiceError`."""


def raise_problem(document: ProblemDocument) -> NoReturn:
    """Raise the error that a problem document stands for."""
    error = CLASS_OF.get(document.type.removeprefix("urn:shapersmith:"), ServiceError)(document)
    raise error from None
