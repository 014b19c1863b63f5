"""What routes answer is what the OpenAPI document says, and all that it says is answered.

Each route is provoked in every way that there is; each answer is held against the document.
"""

import asyncio
from collections.abc import AsyncIterator
from http import HTTPStatus
from pathlib import Path
from typing import Any, get_args

import httpx
import jsonschema_rs
import pytest

from design.export.registry import EXPORTS
from service.http import bodies
from service.http.document import operations_of
from service.http.examples import EXAMPLES
from service.jobs.memory import MemoryJobs
from service.jobs.records import State
from service.problems import INVALID, OVERLOADED, TIME_LIMIT, TOO_LARGE, Problem
from tests.service.http.in_process import InProcess

ID = 32 * "0"

DOCUMENT: dict[str, Any] = InProcess().app.openapi()

OPERATIONS = operations_of(DOCUMENT)

ROUTES = sorted(OPERATIONS)

WITH_BODY = [route for route in ROUTES if "requestBody" in OPERATIONS[route]]

OF_JOB = [route for route in ROUTES if "{id}" in route[1]]

FILES = ("GET", "/v1/tables/{id}/result")

SCHEMAS = ("GET", "/v1/schemas/{name}")

SCHEMA = "design-request"

BUSY = (
    Problem(OVERLOADED, "all are busy", retry_after_s=3),
    Problem(TIME_LIMIT, "it takes too long"),
)


class Provoked:
    """Services that are asked in every way, a table in their store, and the statuses so far."""

    def __init__(self, jobs: MemoryJobs) -> None:
        self.jobs = jobs
        self.id = ID  # of the newest table
        self.seen: set[str] = set()

    def ask(self, route: tuple[str, str], body: object = None, **more: Any) -> httpx.Response:
        """Ask a route of a new service, about the newest table."""
        settings = more.pop("settings", {})
        full = more.pop("full", None)
        query = more.pop("query", "")
        jobs = more.pop("jobs", self.jobs)
        service = InProcess(jobs, **settings)
        service.pool.full = full
        path = route[1].format(id=more.pop("id", self.id), name=more.pop("name", SCHEMA)) + query
        answer = service.ask(route[0], path, body, **more)
        self.seen.add(str(answer.status_code))
        require_documented(route, answer)
        return answer

    def table(self, state: State = "waiting") -> str:
        """Begin a table and bring it to a state; return its id."""
        begun = InProcess(self.jobs).ask("POST", "/v1/tables", example_of(("POST", "/v1/tables")))
        self.id = begun.json()["id"]
        self.jobs.change(self.id, state)
        return self.id


def require_documented(route: tuple[str, str], answer: httpx.Response) -> None:
    """Hold an answer against what the document says of its route."""
    responses = OPERATIONS[route]["responses"]
    assert str(answer.status_code) in responses, (route, answer.status_code, answer.text)
    documented = responses[str(answer.status_code)]
    named = {name.lower() for name in documented["headers"]}
    assert "x-request-id" in answer.headers.keys() & named
    for name in ("etag", "location", "retry-after", "content-range", "content-disposition"):
        assert (name in answer.headers) == (name in named), (route, answer.status_code, name)
    content = documented.get("content", {})
    if not answer.content and not content:
        return
    media_type = answer.headers["content-type"].partition(";")[0]
    assert media_type in content, (route, answer.status_code, media_type)
    if media_type.endswith("json") and answer.status_code != HTTPStatus.PARTIAL_CONTENT:
        schema = {**content[media_type]["schema"], "components": DOCUMENT["components"]}
        jsonschema_rs.validator_for(schema).validate(answer.json())


@pytest.fixture
def provoked(tmp_path: Path) -> Provoked:
    return Provoked(MemoryJobs(tmp_path))


def example_of(route: tuple[str, str]) -> Any:
    """Return a body that the route takes."""
    first = next(iter(EXAMPLES[OPERATIONS[route]["operationId"]].values())).value
    return first.encode() if isinstance(first, str) else first


def never() -> AsyncIterator[bytes]:
    async def waiting() -> AsyncIterator[bytes]:
        await asyncio.Event().wait()
        yield b"{}"

    return waiting()


async def too_late(_: str) -> bool:
    return False


def failing(*_: Any, **__: Any) -> Any:
    raise ZeroDivisionError


def provoke_bodies(provoked: Provoked, route: tuple[str, str]) -> None:
    """Send what is right, and every sort of body that is wrong."""
    media_type = next(iter(OPERATIONS[route]["requestBody"]["content"]))
    typed = {"content-type": media_type}
    provoked.ask(route, example_of(route), headers=typed)
    for wrong in (b"", b"{", b"\xff", b"[]", b'{"plant": NaN}', b'{"a": 1, "a": 2}', b"{}"):
        provoked.ask(route, wrong, headers=typed)
    provoked.ask(route, b"{}", headers={"content-type": "text/csv"})
    small = {"max_body_bytes": 1, "max_batch_bytes": 1, "max_table_bytes": 1}
    provoked.ask(route, b"{}", headers=typed, settings=small)
    provoked.ask(route, b"{}\n{}", headers=typed, settings={"max_batch_lines": 1})
    for full in BUSY:
        provoked.ask(route, example_of(route), headers=typed, full=full)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bodies, "BODY_WAIT_S", 0.0)
        provoked.ask(route, never(), headers=typed)


def provoke_states(provoked: Provoked, route: tuple[str, str]) -> None:
    """Ask about a table in every state, and about none."""
    provoked.ask(route, id=ID)
    provoked.ask(route, id="none")
    for state in get_args(State):
        if route[1].endswith("events") and state in {"waiting", "running"}:
            continue  # would not end
        provoked.table(state)
        provoked.ask(route)
    provoked.table("done")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(provoked.jobs, "delete", too_late)
        provoked.ask(route)


def provoke_files(provoked: Provoked) -> None:
    """Ask for the file of a table whole, in part, again, and where it cannot be made."""
    for name in EXPORTS:
        job = provoked.table("done")
        query = f"?format={name}"
        provoked.jobs.files[job, name] = b"{}"
        whole = provoked.ask(FILES, query=query)
        for headers in (
            {"range": "bytes=1-"},
            {"range": "bytes=9-"},
            {"range": "lines=1"},
            {"if-none-match": whole.headers["etag"]},
            {"if-none-match": "*"},
        ):
            provoked.ask(FILES, query=query, headers=headers)
    provoked.ask(FILES, query="?format=xls")
    job = provoked.table("done")
    for problem in (Problem(INVALID, "a row"), Problem(TOO_LARGE, "memory"), *BUSY):
        provoked.jobs.files[job, "csv"] = problem
        provoked.ask(FILES)


def provoke_faults(provoked: Provoked, route: tuple[str, str], patch: pytest.MonkeyPatch) -> None:
    """Ask where no store answers, where there is none, no worker is free, and all fails."""
    provoked.table("done")
    body = example_of(route) if route in WITH_BODY else None
    typed = (
        {"content-type": next(iter(OPERATIONS[route]["requestBody"]["content"]))} if body else {}
    )
    provoked.ask(route, body, headers=typed, full=BUSY[0])
    if route[1].startswith("/v1/tables"):
        provoked.ask(route, body, headers=typed, jobs=None)
        provoked.jobs.silence = "it sleeps"
        provoked.ask(route, body, headers=typed)
        provoked.jobs.silence = ""
    patch.setattr("fastapi.routing.APIRoute.handle", failing)
    provoked.ask(route, body, headers=typed)


@pytest.mark.parametrize("route", ROUTES, ids=" ".join)
def test_a_route_answers_what_is_documented_and_all_of_it(
    provoked: Provoked, route: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    if route in WITH_BODY:
        provoke_bodies(provoked, route)
    elif route in OF_JOB:
        provoke_states(provoked, route)
    else:
        whole = provoked.ask(route)
    if route == SCHEMAS:
        provoked.ask(route, name="none")
        provoked.ask(route, headers={"if-none-match": whole.headers["etag"]})
    if route == FILES:
        provoke_files(provoked)
    provoke_faults(provoked, route, monkeypatch)
    assert provoked.seen == set(OPERATIONS[route]["responses"])
