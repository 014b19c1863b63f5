"""Wire form of errors: problem documents (RFC 9457)."""

from typing import Annotated

from pydantic import Field, Strict

from schemas.base import Wire, leave_out_none
from schemas.trace import TraceStepOut


class FieldFault(Wire):
    """One field that breaks its rule."""

    pointer: Annotated[str, Field(description="JSON pointer of the field in the request.")]
    code: Annotated[
        str,
        Field(description="Rule that the field breaks, as a name such as out_of_range or missing."),
    ]
    detail: Annotated[str, Field(description="Rule of the field and the value given, in words.")]


class ProblemDocument(Wire):
    """An error, as `application/problem+json`."""

    type: Annotated[str, Field(description="urn:shapersmith: and the name of the problem.")]
    title: Annotated[str, Field(description="Name of the problem in words.")]
    status: Annotated[int, Field(description="HTTP status.")]
    code: Annotated[
        str,
        Field(
            description="Name of the fault, which does not change with the words of detail: the "
            "code that all errors have in common, otherwise the name of the "
            "problem."
        ),
    ]
    detail: Annotated[str, Field(description="What went wrong, in words with figures.")]
    errors: Annotated[
        tuple[FieldFault, ...],
        Strict(strict=False),
        Field(description="Fields that break their rules, 20 at most."),
    ] = ()
    request_id: Annotated[
        str | None, Field(description="Id of the request, as in the header X-Request-Id.")
    ] = None
    trace: Annotated[
        list[TraceStepOut] | None,
        leave_out_none("Steps of the search, where a design asked for them; otherwise left out."),
    ]
