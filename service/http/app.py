"""The one place that wires the parts of the service."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import FastAPI

from schemas.tables import TableRequest
from service.catalogue import shaper_catalogue
from service.http import (
    batch_routes,
    live_routes,
    routes,
    schema_routes,
    status_routes,
    table_routes,
)
from service.http.document import DESCRIPTION, TAGS, finish_document
from service.http.handlers import add_handlers
from service.http.middleware import RequestMiddleware
from service.http.openapi import serve_docs
from service.jobs.protocol import Jobs
from service.operations.table import TABLE, load
from service.settings import Settings
from service.version import version
from service.workers.memory import settle
from service.workers.pool import WorkerPool
from service.workers.protocol import Pool


def create_app(
    settings: Settings, *, jobs: Jobs | None = None, pool: Pool | None = None
) -> FastAPI:
    """Build the service.

    Its jobs and its pool start and end with the application's lifespan.

    Parameters
    ----------
    settings
        Limits, and the workers of a pool that is not given.
    jobs
        The table jobs; None in a process that has none.
    pool
        Answers the requests; None for one of worker processes.

    Returns
    -------
    FastAPI
        The application, its routes and its documentation in it.

    Raises
    ------
    RuntimeError
        If the package that holds Swagger UI is not installed.
    """
    if pool is None:
        pool = WorkerPool(
            workers=settings.workers,
            time_limit_s=settings.time_limit_s,
            max_pending=settings.max_pending,
            memory_bytes=settings.worker_memory_bytes,
        )

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        pool.start()
        app.openapi()  # not while others wait
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
        summary="Input shapers for flexible machines whose actuators are not ideal.",
        description=DESCRIPTION,
        openapi_tags=TAGS,
        lifespan=lifespan,
        docs_url=None,
        redoc_url=None,
    )
    app.state.settings = settings
    app.state.jobs = jobs
    app.state.pool = pool
    app.state.catalogue = shaper_catalogue().model_dump_json().encode()
    app.state.live_sessions = set()
    app.state.stopping = lambda: False  # the server says so: streams must not hold it up
    if jobs is not None:
        jobs.stopping = lambda: app.state.stopping()
    for part in (routes, batch_routes, live_routes, status_routes, schema_routes, table_routes):
        app.include_router(part.router)
    add_handlers(app)
    app.add_middleware(RequestMiddleware)
    serve_docs(app)
    finish_document(app, [*(load(name).request for name in TABLE), TableRequest])
    return app
