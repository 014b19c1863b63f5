"""The one place that wires the parts of the service."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from http import HTTPStatus
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from fastapi import FastAPI, Request
from fastapi.openapi.docs import get_swagger_ui_html
from pydantic.json_schema import models_json_schema
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.staticfiles import StaticFiles

from schemas.problems import ProblemDocument
from schemas.tables import TableRequest
from service.catalogue import shaper_catalogue
from service.dispatch import OPERATIONS
from service.http.bodies import problem_response
from service.http.middleware import RequestMiddleware
from service.http.routes import router
from service.http.table_routes import router as table_router
from service.jobs.service import JobService
from service.problems import METHOD_NOT_ALLOWED, NOT_FOUND, Problem, ProblemKind
from service.settings import Settings
from service.version import version
from service.workers.memory import settle
from service.workers.pool import WorkerPool

ASSETS = "/assets/swagger-ui"
SCHEMAS = "#/components/schemas/{model}"


def create_app(settings: Settings, jobs: JobService | None = None) -> FastAPI:
    """Build the service; its workers start and end with the application's lifespan."""

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        pool = WorkerPool(
            workers=settings.workers,
            time_limit_s=settings.time_limit_s,
            max_pending=settings.max_pending,
            memory_bytes=settings.worker_memory_bytes,
        )
        app.state.pool = pool
        # Neither is made while others wait.
        app.state.catalogue = shaper_catalogue().model_dump_json().encode()
        app.openapi()
        if jobs is not None:
            jobs.start()
        settle()
        yield
        if jobs is not None:
            await asyncio.to_thread(jobs.close)
        await pool.close()

    app = FastAPI(
        title="shapersmith",
        version=version(),
        description="Input shapers for flexible machines whose actuators are not ideal.",
        lifespan=lifespan,
        docs_url=None,
        redoc_url=None,
    )
    app.state.settings = settings
    app.state.jobs = jobs
    app.state.stopping = lambda: False  # the server tells: streams must not hold it up
    if jobs is not None:
        jobs.stopping = lambda: app.state.stopping()
    app.include_router(router)
    app.include_router(table_router)
    app.add_exception_handler(HTTPException, _http_problem)
    app.add_middleware(RequestMiddleware)
    _serve_docs(app)
    _document_bodies(app)
    return app


async def _http_problem(request: Request, error: Exception) -> Response:
    """Answer what the framework itself refuses, as 404 and 405, by a problem document."""
    status = error.status_code if isinstance(error, HTTPException) else 0
    known: dict[int, tuple[ProblemKind, str]] = {
        404: (NOT_FOUND, f"there is no {request.url.path}"),
        405: (METHOD_NOT_ALLOWED, f"{request.url.path} does not take {request.method}"),
    }
    refused = ProblemKind("refused", HTTPStatus(status or 500), 1, "The request was refused")
    kind, detail = known.get(status, (refused, str(error)))
    response = problem_response(Problem(kind, detail), request.state.request_id)
    if isinstance(error, HTTPException) and error.headers:
        response.headers.update(error.headers)
    return response


def _serve_docs(app: FastAPI) -> None:
    """Serve Swagger UI from its package: the machine may be offline."""
    spec = find_spec("fastapi_offline")
    if spec is None or spec.origin is None:
        raise RuntimeError("the package fastapi-offline, which holds Swagger UI, is not installed")
    app.mount(ASSETS, StaticFiles(directory=Path(spec.origin).parent / "static"))

    @app.get("/docs", include_in_schema=False)
    async def docs() -> Response:
        return get_swagger_ui_html(
            openapi_url="/openapi.json",
            title="shapersmith",
            swagger_js_url=f"{ASSETS}/swagger-ui-bundle.js",
            swagger_css_url=f"{ASSETS}/swagger-ui.css",
            swagger_favicon_url=f"{ASSETS}/favicon.png",
        )


def _document_bodies(app: FastAPI) -> None:
    """Add the request models to the schema: bodies are validated in the workers, not by routes."""
    generated = app.openapi

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            schema = generated()
            requests = [*(case.request for case in OPERATIONS.values()), TableRequest]
            models = [(request, "validation") for request in requests]
            _, definitions = models_json_schema(
                [*models, (ProblemDocument, "serialization")],  # type: ignore[list-item]
                ref_template=SCHEMAS,
            )
            schemas = schema.setdefault("components", {}).setdefault("schemas", {})
            for name, definition in definitions["$defs"].items():
                schemas.setdefault(name, definition)
            app.openapi_schema = schema
        return app.openapi_schema

    app.openapi = openapi  # type: ignore[method-assign]
