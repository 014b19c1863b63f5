"""JSON Schema of every request and response, as files and over HTTP the same bytes."""

import json
from functools import cache
from pathlib import Path
from typing import NamedTuple

from pydantic import BaseModel

from schemas.catalogue import Catalogue
from schemas.health import Live, Ready
from schemas.json_schema import Mode, json_schema_of
from schemas.listed_schemas import ListedSchema, ListedSchemas
from schemas.live import LiveMessage
from schemas.problems import ProblemDocument
from schemas.run_events import HappeningIn
from schemas.table_jobs import TableJob, TableJobs
from schemas.tables import TableRequest
from service.files import write_whole
from service.operations.table import TABLE, load
from service.version import version

PATH = "/v1/schemas"

URN = "urn:shapersmith:schema:{name}"
"""Name of a schema in the whole world."""


class _Entry(NamedTuple):
    """One schema: its model, whether that is read or written, and what it is of."""

    model: type[BaseModel]
    mode: Mode
    title: str


OTHERS: dict[str, _Entry] = {
    "table-request": _Entry(
        TableRequest, "validation", "Request of POST /v1/tables and of `shapersmith table`"
    ),
    "table-response": _Entry(TableJob, "serialization", "State of a table job"),
    "tables-response": _Entry(TableJobs, "serialization", "Answer of GET /v1/tables"),
    "shapers-response": _Entry(
        Catalogue, "serialization", "Answer of GET /v1/shapers and of `shapersmith shapers`"
    ),
    "schemas-response": _Entry(ListedSchemas, "serialization", f"Answer of GET {PATH}"),
    "live-response": _Entry(Live, "serialization", "Answer of GET /health/live"),
    "ready-response": _Entry(Ready, "serialization", "Answer of GET /health/ready"),
    "session-event": _Entry(HappeningIn, "validation", "Event of WS /v1/live, which happens now"),
    "session-message": _Entry(LiveMessage, "serialization", "Message that WS /v1/live sends"),
    "problem": _Entry(ProblemDocument, "serialization", "A refusal or an error"),
}
"""Those that are of no operation; a batch has a request and a response of a design a line."""


@cache
def _entries() -> dict[str, _Entry]:
    """Return every schema by its name."""
    found: dict[str, _Entry] = {}
    for name, row in TABLE.items():
        said = f"POST {row.path} and of `shapersmith {row.command}`"
        request, response = load(name).request, load(name).response
        found[f"{row.command}-request"] = _Entry(request, "validation", f"Request of {said}")
        found[f"{row.command}-response"] = _Entry(response, "serialization", f"Answer of {said}")
    return found | OTHERS


def schema_names() -> tuple[str, ...]:
    """Return the names of all schemas."""
    return tuple(_entries())


@cache
def schema_bytes(name: str) -> bytes:
    """Return a schema as a file.

    Parameters
    ----------
    name
        One of `schema_names`.

    Returns
    -------
    bytes
        JSON, indented: people read it too.
    """
    entry = _entries()[name]
    schema = json_schema_of(entry.model, entry.mode, urn=URN.format(name=name), title=entry.title)
    return (json.dumps(schema, indent=2, ensure_ascii=False) + "\n").encode()


def listed_schemas() -> ListedSchemas:
    """Return the list of all schemas."""
    return ListedSchemas(
        schemas=[
            ListedSchema(name=name, title=entry.title, path=f"{PATH}/{name}")
            for name, entry in _entries().items()
        ],
        version=version(),
    )


def write_schemas(folder: Path) -> list[Path]:
    """Write every schema into a folder.

    Parameters
    ----------
    folder
        The folder, which is made if there is none.

    Returns
    -------
    list of Path
        The files, a name of a schema each with ``.json`` at its end.

    Raises
    ------
    OSError
        If a file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    paths = {name: folder / f"{name}.json" for name in schema_names()}
    for name, path in paths.items():
        write_whole(path, schema_bytes(name))
    return list(paths.values())
