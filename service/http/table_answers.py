"""What the routes of tables say of their headers, events and files."""

from typing import Annotated, Any

from fastapi import Path

from design.export.kind import Export
from design.export.registry import EXPORTS
from schemas.table_jobs import TableJob
from service.http.openapi import Json, reference_to

KEY_HEADER = "Idempotency-Key"

ID_FORM = "^[0-9a-f]{32}$"

JobId = Annotated[
    str,
    Path(
        description="Id of the table job.",
        examples=["0123456789abcdef0123456789abcdef"],
        json_schema_extra={"pattern": ID_FORM},  # not `pattern`: another id is a 404
    ),
]


def _header(name: str, description: str, **schema: Any) -> Json:  # noqa: ANN401 - JSON Schema
    """Return an optional header of a request."""
    return {
        "name": name,
        "in": "header",
        "required": False,
        "description": description,
        "schema": {"type": "string", **schema},
    }


def _headers(**descriptions: str) -> Json:
    """Return headers of an answer; an underscore stands for a hyphen."""
    return {
        name.replace("_", "-"): {"description": text, "schema": {"type": "string"}}
        for name, text in descriptions.items()
    }


KEY = _header(
    KEY_HEADER,
    "Any text that names this request. A request that is sent again with it begins no second "
    "table: its answer is the first one.",
    minLength=1,
    maxLength=255,
    pattern="^[ -~]+$",
)

BEGUN: dict[int | str, Json] = {
    202: {
        "description": "The job waits for a process that computes it",
        "headers": _headers(Location="Address of the job's state."),
    }
}

EVENT = {
    "type": "object",
    "properties": {
        "event": {"enum": ["progress", "done", "failed", "cancelled", "gone"]},
        "data": {
            "type": "string",
            "contentMediaType": "application/json",
            "contentSchema": reference_to(TableJob),
        },
    },
    "required": ["event", "data"],
}
"""One event, parsed. OpenAPI 3.1 has no place for it: there a stream is a string."""

EVENTS: dict[int | str, Json] = {
    200: {
        "description": "An event `progress` for each change, then one with the name of the "
        "last state; `gone` where the table was deleted. Each has the job as its data. "
        "Where nothing changes for 15 s a comment is sent, so that no proxy ends the stream.",
        "headers": _headers(
            Cache_Control="no-cache: events are not kept.",
            X_Accel_Buffering="no: a proxy passes each event on at once.",
        ),
        "content": {
            "text/event-stream": {
                "schema": {"type": "string"},
                "x-events": EVENT,
                "example": 'event: progress\ndata: {"id": "0123456789abcdef0123456789abcdef", ...}'
                "\n\n",
            }
        },
    }
}


def _content(export: Export, *, part: bool = False) -> tuple[str, Json]:
    """Return the media type of a format, without parameters, and what a client reads of it."""
    media_type = export.media_type.partition(";")[0]
    if media_type == "application/json":
        return media_type, {} if part else {"schema": {"type": "object"}}  # a part is no JSON
    if media_type.startswith("text/"):
        return media_type, {"schema": {"type": "string"}}
    return media_type, {"schema": {"type": "string", "format": "binary"}}


_ETAG = _headers(ETag="Changes with the file.")

_FILE_HEADERS = _ETAG | _headers(
    Content_Disposition="Name of the file.", Accept_Ranges="bytes: parts may be asked for."
)

FILES: dict[int | str, Json] = {
    200: {
        "description": "The file",
        "headers": _FILE_HEADERS,
        "content": dict(map(_content, EXPORTS.values())),
    },
    206: {
        "description": "The part of the file that the header Range asks for",
        "headers": _FILE_HEADERS | _headers(Content_Range="Which part it is."),
        "content": dict(_content(export, part=True) for export in EXPORTS.values()),
    },
    304: {"description": "The client has the file already", "headers": _ETAG},
}

IF_NONE_MATCH = _header(
    "If-None-Match", "Entity tags of files that the client has: 304 if one is current."
)

FILE_HEADERS = [
    _header("Range", "Part of the file that is wanted, such as bytes=0-1023."),
    _header("If-Range", "Entity tag: a part is sent only of that file, else the whole."),
    IF_NONE_MATCH,
]
"""Of a request for a file. What is no range is ignored."""
