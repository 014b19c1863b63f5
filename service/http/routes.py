"""HTTP routes: each parses, calls one operation, returns."""

from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import APIRouter, Request
from fastapi.routing import APIRoute
from starlette.responses import JSONResponse, Response

from schemas.catalogue import Catalogue
from service.dispatch import OPERATIONS, Answer, answer
from service.http.batches import Batch
from service.http.bodies import (
    BodyError,
    answer_line,
    answer_response,
    client_of,
    problem_response,
    read_body,
    while_connected,
)
from service.operations.table import TABLE
from service.problems import NOT_JSON, OVERLOADED, TOO_LARGE, Problem
from service.settings import Settings
from service.version import version
from service.workers.costs import shape_of
from service.workers.pool import WorkerPool
from service.workers.runs import TaskError

JSON = ("application/json",)
JSON_LINES = (
    "application/jsonl",
    "application/x-ndjson",
    "application/x-jsonlines",
    "application/json",
)

PROBLEMS: dict[int | str, dict[str, Any]] = {
    code: {
        "description": text,
        "content": {
            "application/problem+json": {"schema": {"$ref": "#/components/schemas/ProblemDocument"}}
        },
    }
    for code, text in {
        400: "Not JSON",
        413: "Too large",
        415: "Not declared as JSON",
        422: "A field breaks its rule, or no such shaper was found",
        500: "Nothing verified was found, or the service failed",
        503: "Overloaded",
        504: "Time limit",
    }.items()
}

router = APIRouter()


def _documented(operation: str, media_type: str = JSON[0]) -> dict[str, Any]:
    name = OPERATIONS[operation].request.__name__
    schema = {"$ref": f"#/components/schemas/{name}"}
    return {"requestBody": {"required": True, "content": {media_type: {"schema": schema}}}}


def _settings(request: Request) -> Settings:
    settings: Settings = request.app.state.settings
    return settings


def _pool(request: Request) -> WorkerPool:
    pool: WorkerPool = request.app.state.pool
    return pool


def _answering(operation: str) -> Callable[[Request], Coroutine[Any, Any, Response]]:
    """Return the route of an operation: read the body, have a worker answer it, return."""

    async def answering(request: Request) -> Response:
        request_id: str = request.state.request_id
        try:
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
        except (BodyError, TaskError) as error:
            return problem_response(error.problem, request_id)
        return answer_response(done, request_id)

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
        openapi_extra=_documented(_name),
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
    openapi_extra=_documented("design", JSON_LINES[0]),
    summary="Design up to 1,000 shapers, JSON Lines in and out",
)
async def designs_batch(request: Request) -> Response:
    """Answer each line as `POST /v1/designs` would."""
    request_id: str = request.state.request_id
    settings, pool = _settings(request), _pool(request)
    try:
        body = await read_body(
            request, limit_bytes=settings.max_batch_bytes, media_types=JSON_LINES
        )
    except BodyError as error:
        return problem_response(error.problem, request_id)
    lines = body.rstrip(b"\r\n").split(b"\n")
    if lines == [b""]:
        return problem_response(Problem(NOT_JSON, "the batch is empty"), request_id)
    if len(lines) > settings.max_batch_lines:
        detail = f"a batch must be at most {settings.max_batch_lines} lines, got {len(lines)}"
        return problem_response(Problem(TOO_LARGE, detail), request_id)
    batch = Batch(pool, lines, client=client_of(request), limit_s=settings.batch_limit_s)
    answers = await while_connected(request, batch.answers())
    told = [answer_line(done, request_id) for done in answers]
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
    responses={503: PROBLEMS[503]},
)
async def ready(request: Request) -> Response:
    """Answer 200 while a worker lives whose solvers are built, and the queue has room."""
    if not _pool(request).ready:
        problem = Problem(OVERLOADED, "no worker is ready, or too much work is waiting")
        return problem_response(problem, request.state.request_id)
    return JSONResponse({"status": "ready", "version": version()})
