"""HTTP routes: each parses, calls one operation, returns."""

from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import APIRouter, Request
from fastapi.routing import APIRoute
from starlette.responses import JSONResponse, Response

from schemas.catalogue import Catalogue
from schemas.designs import DesignRequest
from service.dispatch import OPERATIONS, Answer, answer
from service.http.batches import Batch
from service.http.bodies import (
    answer_line,
    answer_response,
    client_of,
    read_body,
    while_connected,
)
from service.http.openapi import OPERATION_TEXTS, body_of, problems
from service.operations.table import TABLE
from service.problems import NOT_JSON, OVERLOADED, TOO_LARGE, Problem, ProblemError
from service.settings import Settings
from service.version import version
from service.workers.costs import shape_of
from service.workers.protocol import Pool

JSON = ("application/json",)
JSON_LINES = (
    "application/jsonl",
    "application/x-ndjson",
    "application/x-jsonlines",
    "application/json",
)

PROBLEMS = problems(OPERATION_TEXTS, 400, 413, 415, 422, 500, 503, 504)

router = APIRouter()


def _settings(request: Request) -> Settings:
    settings: Settings = request.app.state.settings
    return settings


def _pool(request: Request) -> Pool:
    pool: Pool = request.app.state.pool
    return pool


def _answering(operation: str) -> Callable[[Request], Coroutine[Any, Any, Response]]:
    """Return the route of an operation: read the body, have a worker answer it, return."""

    async def answering(request: Request) -> Response:
        body = await read_body(
            request, limit_bytes=_settings(request).max_body_bytes, media_types=JSON
        )
        work = _pool(request).run(
            answer,
            operation,
            body,
            client=client_of(request),
            shape=shape_of(operation, body),
            key=(operation, body),
        )
        done: Answer = await while_connected(request, work)
        return answer_response(done, request.state.request_id)

    return answering


class BareRoute(APIRoute):
    """Documented as any route; its endpoint takes the request itself, and nothing is injected."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Return the endpoint."""
        return self.endpoint


for _name, _row in TABLE.items():
    router.add_api_route(
        _row.path,
        _answering(_name),
        methods=["POST"],
        name=_name,
        response_model=OPERATIONS[_name].response,
        responses=PROBLEMS,
        openapi_extra={"requestBody": body_of(OPERATIONS[_name].request, JSON[0])},
        summary=_row.summary,
        route_class_override=BareRoute,
    )


@router.post(
    "/v1/designs/batch",
    response_class=Response,
    responses={
        **PROBLEMS,
        200: {
            "description": "An answer or a problem a line, in order",
            "content": {"application/jsonl": {}},
        },
    },
    openapi_extra={"requestBody": body_of(DesignRequest, JSON_LINES[0])},
    summary="Design up to 1,000 shapers, JSON Lines in and out",
)
async def designs_batch(request: Request) -> Response:
    """Answer each line as `POST /v1/designs` would."""
    settings = _settings(request)
    body = await read_body(request, limit_bytes=settings.max_batch_bytes, media_types=JSON_LINES)
    lines = body.rstrip(b"\r\n").split(b"\n")
    if lines == [b""]:
        raise ProblemError(Problem(NOT_JSON, "the batch is empty"))
    if len(lines) > settings.max_batch_lines:
        detail = f"a batch must be at most {settings.max_batch_lines} lines, got {len(lines)}"
        raise ProblemError(Problem(TOO_LARGE, detail))
    batch = Batch(_pool(request), lines, client=client_of(request), limit_s=settings.batch_limit_s)
    answers = await while_connected(request, batch.answers())
    told = [answer_line(done, request.state.request_id) for done in answers]
    return Response(b"\n".join(told) + b"\n", media_type=JSON_LINES[0])


@router.get("/v1/shapers", response_model=Catalogue, summary="Every kind of shaper")
async def shapers(request: Request) -> Response:
    """Return the catalogue: parameters, example and source of each kind."""
    return Response(request.app.state.catalogue, media_type="application/json")


@router.get("/health/live", summary="Whether the process serves")
async def live() -> dict[str, str]:
    """Answer as long as the process does."""
    return {"status": "live"}


@router.get(
    "/health/ready",
    summary="Whether designs are answered",
    responses=problems(OPERATION_TEXTS, 503),
)
async def ready(request: Request) -> Response:
    """Answer 200 while a worker lives whose solvers are built, and the queue has room."""
    if not _pool(request).ready:
        problem = Problem(OVERLOADED, "no worker is ready, or too much work is waiting")
        raise ProblemError(problem)
    return JSONResponse({"status": "ready", "version": version()})
