"""HTTP routes that ask no worker: the catalogue, and whether the service serves."""

from fastapi import APIRouter, Request
from starlette.responses import JSONResponse, Response

from schemas.catalogue import Catalogue
from service.http.openapi import OPERATION_TEXTS, problems
from service.problems import OVERLOADED, Problem, ProblemError
from service.version import version
from service.workers.protocol import Pool

router = APIRouter()


@router.get("/v1/shapers", response_model=Catalogue, summary="Every kind of shaper")
async def shapers(request: Request) -> Response:
    """Return the catalogue: parameters, example and source of each kind."""
    return Response(request.app.state.catalogue, media_type="application/json")


@router.get("/health/live", summary="Whether the process serves")
async def live() -> dict[str, str]:
    """Answer 200 as long as the process serves."""
    return {"status": "live"}


@router.get(
    "/health/ready",
    summary="Whether designs are answered",
    responses=problems(OPERATION_TEXTS, 503),
)
async def ready(request: Request) -> Response:
    """Answer 200 while the queue has room and a worker lives whose solvers are built."""
    pool: Pool = request.app.state.pool
    if not pool.ready:
        problem = Problem(OVERLOADED, "no worker is ready, or too much work is waiting")
        raise ProblemError(problem)
    return JSONResponse({"status": "ready", "version": version()})
