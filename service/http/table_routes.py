"""HTTP routes of table jobs."""

import re
from collections.abc import AsyncIterator, Iterable
from pathlib import Path
from typing import Annotated

from fastapi import APIRouter, Depends, Query, Request
from fastapi.sse import EventSourceResponse, ServerSentEvent
from starlette.responses import Response

from design.errors import InvalidInputError
from design.export.formats import FORMATS
from schemas.problems import FieldFault
from schemas.table_jobs import TableJob, TableJobs
from schemas.tables import TableRequest
from schemas.warnings import WarningOut
from service.http.bodies import client_of, read_body, while_connected
from service.http.byte_ranges import file_response
from service.http.entity_tags import held_tags
from service.http.openapi import TABLE_TEXTS, body_of, problems
from service.http.table_answers import (
    BEGUN,
    EVENTS,
    FILE_HEADERS,
    FILES,
    KEY,
    KEY_HEADER,
    JobId,
)
from service.jobs.adding import KeyReusedError
from service.jobs.plan import Plan, plan_table, wire_job
from service.jobs.protocol import Jobs
from service.jobs.records import Job
from service.jobs.results import export_of
from service.problems import (
    CONFLICT,
    NOT_FOUND,
    OVERLOADED,
    Problem,
    ProblemError,
    invalid_fields,
    problem_of_design,
)
from service.settings import Settings
from service.version import version
from service.workers.protocol import Pool
from service.workers.shapes import shape_of

JSON = ("application/json",)
MAX_LISTED_JOBS = 100

ID = re.compile(r"[0-9a-f]{32}\Z")

KEY_FORM = re.compile(r"[ -~]{1,255}\Z")

router = APIRouter(tags=["tables"])


def _jobs(request: Request) -> Jobs:
    jobs: Jobs | None = request.app.state.jobs
    if jobs is None:
        raise ProblemError(Problem(OVERLOADED, "this process has no job store"))
    return jobs


def _pool(request: Request) -> Pool:
    pool: Pool = request.app.state.pool
    return pool


def _missing(job_id: str) -> ProblemError:
    return ProblemError(Problem(NOT_FOUND, f"there is no table job {job_id[:64]!r}"))


async def _find_job(request: Request, job_id: str) -> Job:
    jobs = _jobs(request)
    job = await jobs.find(job_id) if ID.match(job_id) else None
    if job is None:
        raise _missing(job_id)
    return job


def _answer(job: Job, status: int = 200, warnings: Iterable[WarningOut] = ()) -> Response:
    told = wire_job(job, warnings).model_dump_json()
    return Response(told, status_code=status, media_type="application/json")


@router.post(
    "/v1/tables",
    status_code=202,
    response_model=TableJob,
    operation_id="create_table",
    responses={**problems(TABLE_TEXTS, 400, 408, 413, 415, 422, 500, 503, 504), **BEGUN},
    openapi_extra={"parameters": [KEY], "requestBody": body_of(TableRequest, JSON[0])},
    summary="Begin a table of designs over axes or a list",
)
async def begin(request: Request) -> Response:
    """Answer with the job's size and, in `Location`, the address of its state."""
    settings: Settings = request.app.state.settings
    jobs = _jobs(request)
    key = _key_of(request)
    body = await read_body(request, limit_bytes=settings.max_table_bytes, media_types=JSON)
    work = _pool(request).run(
        plan_table, body, client=client_of(request), shape=shape_of("planned", body)
    )
    plan: Plan | Problem = await while_connected(request, work)
    if isinstance(plan, Problem):
        raise ProblemError(plan)
    try:
        job_id = await jobs.add(plan.job, key)
    except KeyReusedError:
        raise _refuse_key(
            "not be one that began a table of another specification", code="key_reused"
        ) from None
    response = _answer(await _find_job(request, job_id), 202, plan.warnings)
    response.headers["location"] = f"/v1/tables/{job_id}"
    return response


def _key_of(request: Request) -> str | None:
    keys = request.headers.getlist(KEY_HEADER)
    if not keys:
        return None
    if len(keys) > 1 or not KEY_FORM.match(keys[0]):
        raise _refuse_key(
            "be given once, as 1 to 255 printable ASCII characters", code="unreadable_key"
        )
    return keys[0]


def _refuse_key(rule: str, code: str) -> ProblemError:
    detail = f"the header {KEY_HEADER} must {rule}"
    fault = FieldFault(pointer="", code=code, detail=detail)
    return ProblemError(invalid_fields(detail, (fault,)))


@router.get(
    "/v1/tables",
    response_model=TableJobs,
    operation_id="list_tables",
    responses=problems(TABLE_TEXTS, 500, 503),
    summary="The newest tables",
)
async def list_tables(request: Request) -> Response:
    """Answer with the newest jobs, newest first."""
    jobs = _jobs(request)
    found = await jobs.newest(MAX_LISTED_JOBS)
    tables = TableJobs(tables=[wire_job(job) for job in found])
    return Response(tables.model_dump_json(), media_type="application/json")


@router.get(
    "/v1/tables/{id}",
    response_model=TableJob,
    operation_id="get_table",
    responses=problems(TABLE_TEXTS, 404, 500, 503),
    summary="State and progress of a table",
)
async def state(request: Request, id: JobId) -> Response:
    """Answer with the state, rows done, rate and time left."""
    return _answer(await _find_job(request, id))


@router.delete(
    "/v1/tables/{id}",
    response_model=TableJob,
    operation_id="delete_table",
    responses=problems(TABLE_TEXTS, 404, 409, 500, 503),
    summary="Cancel a table, or delete one that has ended",
)
async def delete(request: Request, id: JobId) -> Response:
    """Cancel an unfinished job, or delete one that has ended, with its rows and files.

    The state changes at once; rows and files are erased thereafter. The answer is the state of the
    job; that of a deleted job is its last.
    """  # noqa: DOC501 - on the wire
    jobs = _jobs(request)
    job = await _find_job(request, id)
    if not job.ended:
        if await jobs.cancel(id):
            return _answer(await _find_job(request, id))
        raise ProblemError(
            Problem(CONFLICT, "the table has ended meanwhile: the same request again deletes it")
        )
    if not await jobs.delete(id):
        now = await _find_job(request, id)
        raise ProblemError(
            Problem(CONFLICT, f"the table is {now.state} by now: the same request again cancels it")
        )
    return _answer(job)


@router.post(
    "/v1/tables/{id}/resume",
    status_code=202,
    response_model=TableJob,
    operation_id="resume_table",
    responses=problems(TABLE_TEXTS, 404, 409, 500, 503),
    summary="Go on with a table that has failed",
)
async def resume(request: Request, id: JobId) -> Response:
    """Compute what failed once more; the rows that are done are kept."""
    jobs = _jobs(request)
    job = await _find_job(request, id)
    if not job.sound:
        raise ProblemError(Problem(CONFLICT, f"the table cannot go on: {job.reason}"))
    resumed = job.state == "failed" and await jobs.resume(id)
    job = await _find_job(request, id)
    if resumed:
        return _answer(job, 202)
    if job.state != "failed":
        problem = Problem(CONFLICT, f"the table is {job.state}: only a failed one is resumed")
        raise ProblemError(problem)
    problem = Problem(
        CONFLICT,
        f"the table was begun by version {job.version}, this is {version()}: begin it anew, or "
        "resume it with the version that began it",
    )
    raise ProblemError(problem)


async def _watched_job(request: Request, id: JobId) -> Job:
    """Return the job of a path: it is found before the stream begins."""
    return await _find_job(request, id)


@router.get(
    "/v1/tables/{id}/events",
    response_class=EventSourceResponse,
    operation_id="watch_table",
    responses={**problems(TABLE_TEXTS, 404, 500, 503), **EVENTS},
    summary="Progress of a table as server-sent events",
)
async def events(
    request: Request, job: Annotated[Job, Depends(_watched_job)]
) -> AsyncIterator[ServerSentEvent]:
    """Send the state whenever it changes, until the job has ended."""
    async for name, data in _jobs(request).events(job):
        yield ServerSentEvent(event=name, raw_data=data)


@router.get(
    "/v1/tables/{id}/result",
    response_class=Response,
    operation_id="get_table_result",
    responses={**problems(TABLE_TEXTS, 404, 409, 413, 416, 422, 500, 503, 504), **FILES},
    openapi_extra={"parameters": FILE_HEADERS},
    summary="The file of a table, in any format",
)
async def result(
    request: Request,
    id: JobId,
    format: Annotated[
        str, Query(description="Format of the file.", json_schema_extra={"enum": list(FORMATS)})
    ] = "csv",
) -> Response:
    """Answer with the file; takes Range, If-Range and If-None-Match."""
    jobs = _jobs(request)
    job = await _find_job(request, id)
    if job.state != "done":
        yet = "" if job.ended else " yet"
        raise ProblemError(Problem(CONFLICT, f"the table is {job.state}: it has no result{yet}"))
    try:
        export = export_of(format)
    except InvalidInputError as error:
        raise ProblemError(problem_of_design(error)) from None
    tag = f'"{job.sha256[:32]}-{job.version}-{format}"'
    held = held_tags(request)
    if tag in held:
        return Response(status_code=304, headers={"etag": tag})
    path = jobs.path_of(id, format)
    if not path.is_file():
        await _make_file(request, job, format, path)
    if "*" in held:
        return Response(status_code=304, headers={"etag": tag})
    name = f"table-{id[:8]}{export.suffix}"
    headers = {
        "etag": tag,
        "content-type": export.media_type,
        "content-disposition": f'attachment; filename="{name}"',
    }
    try:
        return file_response(path, request.headers, headers)
    except FileNotFoundError:
        raise _missing(id) from None  # deleted meanwhile


async def _make_file(request: Request, job: Job, name: str, path: Path) -> None:
    """Have a worker make a file, once for all who ask for it, as long as one of them waits."""
    settings: Settings = request.app.state.settings
    work = _pool(request).run(
        _jobs(request).writing_of(job.id, name),
        client=client_of(request),
        kind="background",
        shape=(name, job.rows.bit_length()),
        key=path,
        limit_s=settings.export_limit_s,
    )
    problem: Problem | None = await while_connected(request, work)
    if problem is not None:
        raise ProblemError(problem)
