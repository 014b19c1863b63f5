"""HTTP routes that ask no worker: the catalogue, and whether the service serves."""

from fastapi import APIRouter, Request
from starlette.responses import RedirectResponse, Response

from schemas.catalogue import Catalogue
from schemas.health import Live, Ready
from service.http.openapi import OPERATION_TEXTS, problems
from service.problems import OVERLOADED, Problem, ProblemError
from service.version import version
from service.workers.protocol import Pool

router = APIRouter()


@router.get("/", include_in_schema=False)
async def root() -> Response:
    """Lead to the documentation."""
    return RedirectResponse("/docs")


@router.get(
    "/v1/shapers",
    operation_id="list_shapers",
    tags=["designs"],
    response_model=Catalogue,
    responses=problems(OPERATION_TEXTS, 500),
    summary="Every kind of shaper",
)
async def shapers(request: Request) -> Response:
    """Return the catalogue: parameters, example and source of each kind."""
    return Response(request.app.state.catalogue, media_type="application/json")


@router.get(
    "/health/live",
    operation_id="get_liveness",
    tags=["health"],
    responses=problems(OPERATION_TEXTS, 500),
    summary="Whether the process serves",
)
async def live() -> Live:
    """Answer 200 as long as the process serves."""
    return Live(status="live")


@router.get(
    "/health/ready",
    operation_id="get_readiness",
    tags=["health"],
    responses=problems(OPERATION_TEXTS, 500, 503),
    summary="Whether designs are answered",
)
async def ready(request: Request) -> Ready:
    """Answer 200 while the queue has room and a worker lives whose solvers are built."""
    pool: Pool = request.app.state.pool
    if not pool.ready:
        problem = Problem(OVERLOADED, "the service is starting, or too much work is waiting")
        raise ProblemError(problem)
    return Ready(status="ready", version=version())
