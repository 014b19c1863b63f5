"""HTTP route of batches: JSON Lines in and out."""

from fastapi import APIRouter, Request
from starlette.responses import Response

from schemas.design_request import DesignRequest
from schemas.designs import DesignResponse
from schemas.problems import ProblemDocument
from service.dispatch import Answer
from service.http.batches import Batch
from service.http.bodies import client_of, read_body, while_connected
from service.http.openapi import BATCH_TEXTS, lines_of, problems
from service.problems import NOT_JSON, TOO_LARGE, Problem, ProblemError
from service.settings import Settings
from service.workers.protocol import Pool

JSON_LINES = (
    "application/jsonl",
    "application/x-ndjson",
    "application/x-jsonlines",
    "application/json",
)

router = APIRouter(tags=["designs"])


@router.post(
    "/v1/designs/batch",
    response_class=Response,
    operation_id="design_batch",
    responses={
        **problems(BATCH_TEXTS, 400, 408, 413, 415, 500),
        200: {
            "description": "One answer or problem for each line, in order",
            "content": lines_of(JSON_LINES[:1], DesignResponse, ProblemDocument),
        },
    },
    openapi_extra={
        "requestBody": {"required": True, "content": lines_of(JSON_LINES[:-1], DesignRequest)}
    },
    summary="Design up to 1,000 shapers, JSON Lines in and out",
)
async def designs_batch(request: Request) -> Response:
    """Answer each line as `POST /v1/designs` would, with the status of a problem in its line."""
    settings: Settings = request.app.state.settings
    pool: Pool = request.app.state.pool
    body = await read_body(request, limit_bytes=settings.max_batch_bytes, media_types=JSON_LINES)
    lines = body.rstrip(b"\r\n").split(b"\n")
    if lines == [b""]:
        raise ProblemError(Problem(NOT_JSON, "the batch is empty"))
    if len(lines) > settings.max_batch_lines:
        detail = f"a batch must be at most {settings.max_batch_lines} lines, got {len(lines)}"
        raise ProblemError(Problem(TOO_LARGE, detail))
    batch = Batch(pool, lines, client=client_of(request), limit_s=settings.batch_limit_s)
    answers = await while_connected(request, batch.answers())
    told = [_line(done, request.state.request_id) for done in answers]
    return Response(b"\n".join(told) + b"\n", media_type=JSON_LINES[0])


def _line(answer: Answer, request_id: str | None) -> bytes:
    """Return an answer as one line of a batch.

    Parameters
    ----------
    answer
        The response of an operation, or a problem.
    request_id
        Id of the request, which a problem document repeats; None for none.

    Returns
    -------
    bytes
        JSON without the end of the line.
    """
    if isinstance(answer.outcome, Problem):
        return answer.outcome.document(request_id).model_dump_json().encode()
    return answer.outcome
