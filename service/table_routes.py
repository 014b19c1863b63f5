"""HTTP routes of table jobs."""

import asyncio
import re
from collections.abc import AsyncIterator
from typing import Any

from fastapi import APIRouter, Request
from sqlalchemy.exc import DBAPIError
from starlette.responses import FileResponse, Response, StreamingResponse
from starlette.types import Receive, Scope, Send

from design.errors import DesignError
from design.export.registry import EXPORTS
from schemas.tables import TableJob, TableJobs
from service.bodies import BodyError, problem_response, read_body
from service.jobs.plan import Plan, planned, told
from service.jobs.records import Job
from service.jobs.results import require_taken
from service.jobs.service import JobService
from service.middleware import ERRORS
from service.pool import TaskError, WorkerPool
from service.problems import (
    CONFLICT,
    INTERNAL,
    NOT_FOUND,
    OVERLOADED,
    RANGE_NOT_SATISFIABLE,
    Problem,
    problem_of_design,
)
from service.settings import Settings

JSON = ("application/json",)
MOST_LISTED = 100
EVENT_EVERY_S = 0.5
"""Between two looks at a job that is watched [s]."""

RANGE = re.compile(r"bytes=(\d*)-(\d*)\Z")

PROBLEM = {
    "content": {
        "application/problem+json": {"schema": {"$ref": "#/components/schemas/ProblemDocument"}}
    }
}


def _problems(*codes: int) -> dict[int | str, dict[str, Any]]:
    texts = {
        400: "Not JSON",
        404: "No such table",
        409: "Not in this state",
        413: "Too large",
        415: "Not declared as JSON",
        416: "No such range",
        422: "A field breaks its rule",
        503: "Overloaded, or the job store does not answer",
    }
    return {code: {"description": texts[code], **PROBLEM} for code in codes}


router = APIRouter()


def _jobs(request: Request) -> JobService:
    jobs: JobService | None = request.app.state.jobs
    if jobs is None:
        raise _ProblemError(Problem(OVERLOADED, "this process has no job store"))
    return jobs


class _ProblemError(Exception):
    """A problem on the way to an answer."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem.detail)
        self.problem = problem


async def _asked(call: Any, *arguments: Any) -> Any:  # noqa: ANN401
    """Ask the store, in a thread: it may wait for the database."""
    try:
        return await asyncio.to_thread(call, *arguments)
    except DBAPIError as error:
        ERRORS.error("the job store does not answer: %s", error.orig)
        raise _ProblemError(Problem(OVERLOADED, "the job store does not answer")) from None


async def _found(request: Request, job_id: str) -> Job:
    job: Job | None = await _asked(_jobs(request).store.job, job_id)
    if job is None:
        raise _ProblemError(Problem(NOT_FOUND, f"there is no table job {job_id[:64]!r}"))
    return job


def _refused(request: Request, problem: Problem) -> Response:
    return problem_response(problem, request.state.request_id)


def _answered(job: TableJob, status: int = 200) -> Response:
    return Response(job.model_dump_json(), status_code=status, media_type="application/json")


@router.post(
    "/v1/tables",
    status_code=202,
    response_model=TableJob,
    responses=_problems(400, 413, 415, 422, 503),
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {
                "application/json": {"schema": {"$ref": "#/components/schemas/TableRequest"}}
            },
        }
    },
    summary="Begin a table of designs over axes or a list",
)
async def begin(request: Request) -> Response:
    """Answer with the job's size and, in `Location`, where its state is."""
    settings: Settings = request.app.state.settings
    pool: WorkerPool = request.app.state.pool
    try:
        jobs = _jobs(request)
        body = await read_body(request, limit_bytes=settings.max_table_bytes, media_types=JSON)
        plan: Plan | Problem = await pool.run(planned, body)
        if isinstance(plan, Problem):
            return _refused(request, plan)
        await _asked(jobs.store.add, plan.job)
        job = await _found(request, plan.job.id)
    except (BodyError, TaskError, _ProblemError) as error:
        return _refused(request, error.problem)
    response = _answered(told(job), 202)
    response.headers["location"] = f"/v1/tables/{job.id}"
    return response


@router.get(
    "/v1/tables", response_model=TableJobs, responses=_problems(503), summary="The newest tables"
)
async def listed(request: Request) -> Response:
    """Answer with the newest jobs, newest first."""
    try:
        found: list[Job] = await _asked(_jobs(request).store.jobs, MOST_LISTED)
    except _ProblemError as error:
        return _refused(request, error.problem)
    tables = TableJobs(tables=[told(job) for job in found])
    return Response(tables.model_dump_json(), media_type="application/json")


@router.get(
    "/v1/tables/{id}",
    response_model=TableJob,
    responses=_problems(404, 503),
    summary="State and progress of a table",
)
async def state(request: Request, id: str) -> Response:
    """Answer with the state, rows done, rate and time left."""
    try:
        return _answered(told(await _found(request, id)))
    except _ProblemError as error:
        return _refused(request, error.problem)


@router.delete(
    "/v1/tables/{id}",
    response_model=TableJob,
    responses=_problems(404, 409, 503),
    summary="Cancel a table",
)
async def cancel(request: Request, id: str) -> Response:
    """Cancel a job and drop its rows; once more changes nothing, an ended one is a conflict."""
    try:
        await _found(request, id)
        cancelled: bool = await _asked(_jobs(request).store.cancel, id)
        job = await _found(request, id)
    except _ProblemError as error:
        return _refused(request, error.problem)
    if not cancelled:
        problem = Problem(CONFLICT, f"the table is {job.state}: there is nothing to cancel")
        return _refused(request, problem)
    return _answered(told(job))


@router.get(
    "/v1/tables/{id}/events",
    response_class=Response,
    responses={
        **_problems(404, 503),
        200: {
            "description": "An event a change, until the end",
            "content": {"text/event-stream": {}},
        },
    },
    summary="Progress of a table as server-sent events",
)
async def events(request: Request, id: str) -> Response:
    """Send the state whenever it changes, until the job has ended."""
    try:
        first = await _found(request, id)
    except _ProblemError as error:
        return _refused(request, error.problem)
    return StreamingResponse(
        _events(request, first),
        media_type="text/event-stream",
        headers={"cache-control": "no-store"},
    )


async def _events(request: Request, job: Job) -> AsyncIterator[str]:
    sent = ""
    while True:
        data = told(job).model_dump_json()
        if data != sent:
            yield f"event: {job.state if job.ended else 'progress'}\ndata: {data}\n\n"
            sent = data
        if job.ended or request.app.state.stopping():
            return
        await asyncio.sleep(EVENT_EVERY_S)
        try:
            job = await _found(request, job.id)
        except _ProblemError:
            continue  # the store does not answer just now


@router.get(
    "/v1/tables/{id}/result",
    response_class=Response,
    responses={
        **_problems(404, 409, 416, 422, 503),
        200: {
            "description": "The file",
            "content": {export.media_type: {} for export in EXPORTS.values()},
        },
        206: {"description": "A part of the file"},
        304: {"description": "The client has it"},
    },
    summary="The file of a table, in any format",
)
async def result(request: Request, id: str, format: str = "csv") -> Response:
    """Answer with the file; takes Range, If-Range and If-None-Match."""
    try:
        job = await _found(request, id)
        if job.state != "done":
            problem = Problem(CONFLICT, f"the table is {job.state}: it has no result yet")
            if job.ended:
                problem = Problem(CONFLICT, f"the table is {job.state}: it has no result")
            return _refused(request, problem)
        try:
            made_of = await _asked(_jobs(request).store.made_of, id)
            await asyncio.to_thread(require_taken, made_of, format)
        except DesignError as error:
            return _refused(request, problem_of_design(error))
        tag = f'"{job.sha256[:32]}-{job.version}-{format}"'
        if tag in _tags(request.headers.get("if-none-match", "")):
            return Response(status_code=304, headers={"etag": tag})
        try:
            path = await _jobs(request).file_of(job, format)
        except DesignError as error:
            # What a format finds in the rows, as a damping ratio that a firmware does not take.
            return _refused(request, problem_of_design(error))
        except OSError as error:
            problem = Problem(INTERNAL, f"the file could not be made: {error.strerror}")
            return _refused(request, problem)
    except _ProblemError as error:
        return _refused(request, error.problem)
    size = path.stat().st_size
    headers = {"etag": tag}
    export = EXPORTS[format]
    wanted = RANGE.match(request.headers.get("range", ""))
    if wanted is not None and wanted[1] and int(wanted[1]) >= size:
        current = request.headers.get("if-range", tag) == tag
        if current:
            problem = Problem(RANGE_NOT_SATISFIABLE, f"the file has {size} bytes")
            refused = _refused(request, problem)
            refused.headers["content-range"] = f"bytes */{size}"
            return refused
    return _File(
        path,
        headers=headers,
        media_type=export.media_type,
        filename=f"table-{job.id[:8]}{export.suffix}",
    )


def _tags(header: str) -> set[str]:
    """Return the entity tags that a header lists; weak ones count here (RFC 9110, 13.1.2)."""
    return {tag.strip().removeprefix("W/") for tag in header.split(",")}


class _File(FileResponse):
    """A file, whose range is ignored if it cannot be read, as RFC 9110 (14.2) has it."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send it."""
        headers = [
            (name, value)
            for name, value in scope["headers"]
            if name != b"range" or _sound(value.decode("latin-1"))
        ]
        await super().__call__({**scope, "headers": headers}, receive, send)


def _sound(header: str) -> bool:
    wanted = RANGE.match(header)
    if wanted is None:
        return False
    first, last = wanted.groups()
    return (bool(first) or last.strip("0") != "") and not (
        first and last and int(first) > int(last)
    )
