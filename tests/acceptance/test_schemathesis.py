"""Requests that Schemathesis makes of the OpenAPI document, right and wrong, are answered by it.

Every check of Schemathesis is on, except that lines may be of any type. The number of requests is
fixed, and they are the same each time.
"""

import itertools
import re
from collections.abc import Iterator
from copy import deepcopy
from typing import Any

import pytest
import schemathesis
from starlette.types import Receive, Scope, Send

from service.http.batch_routes import JSON_LINES
from service.http.examples import EXAMPLES
from service.http.table_answers import ID_FORM
from service.jobs.memory import MemoryJobs
from service.jobs.records import State
from tests.service.http.in_process import InProcess

RANDOM_REQUESTS = 5
"""Of each route, beside some 2,000 that Schemathesis makes of bounds, types and kinds."""

REFUSED_THOUGH_WELL_FORMED = ["422", "416"]
"""What there is no such shaper, table or part of a file for: no schema of fields says that."""

SERVICE = InProcess()


def document() -> dict[str, Any]:
    """Return the document, its events where Schemathesis looks for them."""
    copy: dict[str, Any] = deepcopy(SERVICE.app.openapi())
    events = copy["paths"]["/v1/tables/{id}/events"]["get"]["responses"]["200"]["content"]
    events["text/event-stream"] = {"itemSchema": events["text/event-stream"]["x-events"]}
    return copy


SCHEMA = schemathesis.openapi.from_dict(
    document(),
    config=schemathesis.Config.from_dict({
        "seed": 1,
        "generation": {"max-examples": RANDOM_REQUESTS, "deterministic": True},
        "checks": {
            "positive_data_acceptance": {
                "expected-statuses": ["2xx", "3xx", "404", "409", *REFUSED_THOUGH_WELL_FORMED]
            }
        },
        "operations": [
            {
                # Whatever is no string is one by the time that it is sent.
                "include-operation-id": "design_batch",
                "checks": {"negative_data_rejection": {"enabled": False}},
            }
        ],
    }),
)

ENDED: Iterator[State] = itertools.cycle(("done", "failed", "cancelled"))


async def served(scope: Scope, receive: Receive, send: Send) -> None:
    """Serve the app without its lifespan, whose end closes the pool."""
    if scope["type"] == "http":
        await SERVICE.app(scope, receive, send)
        return
    for _ in range(2):
        kind = (await receive())["type"]
        await send({"type": f"{kind}.complete"})


SCHEMA.app = served


@pytest.fixture(scope="module", autouse=True)
def jobs(tmp_path_factory: pytest.TempPathFactory) -> MemoryJobs:
    """Return a store of tables for all routes."""
    SERVICE.app.state.jobs = MemoryJobs(tmp_path_factory.mktemp("tables"))
    jobs: MemoryJobs = SERVICE.app.state.jobs
    return jobs


def ended_table(jobs: MemoryJobs) -> str:
    """Begin a table and end it; return its id."""
    begun = SERVICE.ask("POST", "/v1/tables", EXAMPLES["create_table"]["list"].value)
    job: str = begun.json()["id"]
    jobs.change(job, next(ENDED))
    jobs.files[job, "csv"] = b"0123456789"
    return job


schemathesis.serializer.alias(list(JSON_LINES[:-1]), "text/plain")


@SCHEMA.parametrize()
def test_what_the_document_allows_is_answered_and_all_else_refused(
    case: schemathesis.Case[Any], jobs: MemoryJobs
) -> None:
    if re.fullmatch(ID_FORM, str(case.path_parameters.get("id", ""))):
        case.path_parameters["id"] = ended_table(jobs)
    case.call_and_validate()
