"""HTTP routes of the operations: each reads the body, has a worker answer it, returns."""

from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import Response

from service.dispatch import Answer, answer
from service.http.bare_route import BareRoute
from service.http.bodies import answer_response, client_of, read_body, while_connected
from service.http.openapi import OPERATION_TEXTS, body_of, problems
from service.operations.table import TABLE, load
from service.settings import Settings
from service.workers.protocol import Pool
from service.workers.shapes import shape_of

JSON = ("application/json",)
PROBLEMS = problems(OPERATION_TEXTS, 400, 408, 413, 415, 422, 500, 503, 504)

router = APIRouter()


def _answering(operation: str) -> Callable[[Request], Coroutine[Any, Any, Response]]:
    """Return the route of an operation: read the body, have a worker answer it, return."""

    async def answering(request: Request) -> Response:
        settings: Settings = request.app.state.settings
        pool: Pool = request.app.state.pool
        body = await read_body(request, limit_bytes=settings.max_body_bytes, media_types=JSON)
        work = pool.run(
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


for _name, _row in TABLE.items():
    router.add_api_route(
        _row.path,
        _answering(_name),
        methods=["POST"],
        name=_name,
        operation_id=_row.command,
        tags=[_row.tag],
        response_model=load(_name).response,
        responses=PROBLEMS,
        openapi_extra={"requestBody": body_of(load(_name).request, JSON[0])},
        summary=_row.summary,
        description=_row.description,
        route_class_override=BareRoute,
    )
