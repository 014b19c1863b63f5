"""The documentation that the service serves: what routes say of themselves, and Swagger UI."""

from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.docs import get_swagger_ui_html
from pydantic import BaseModel
from starlette.responses import Response
from starlette.staticfiles import StaticFiles

from schemas.problems import ProblemDocument

Json = dict[str, Any]

ASSETS = "/assets/swagger-ui"
SCHEMAS = "#/components/schemas/{model}"

_TEXTS = {
    400: "Not JSON",
    404: "No such table",
    408: "The body did not arrive in time",
    409: "Not in this state",
    413: "Too large",
    415: "Not declared as JSON",
    416: "No such range",
    504: "Time limit",
}

OPERATION_TEXTS = _TEXTS | {
    422: "A field breaks its rule, or no such shaper was found",
    500: "Nothing verified was found, or the service failed",
    503: "Overloaded, or no worker is ready",
}
"""What a status says of a request that one operation answers."""

BATCH_TEXTS = _TEXTS | {
    400: "No line",
    413: "Too many lines or bytes",
    415: "Not declared as JSON Lines",
    500: "The service failed",
}
"""What a status says of a whole batch; what befalls a line is said there."""

TABLE_TEXTS = _TEXTS | {
    422: "A field or a header breaks its rule",
    500: "The service failed",
    503: "Overloaded, or the job store does not answer",
}
"""What a status says of a request about tables."""


def reference_to(model: type[BaseModel]) -> Json:
    """Return where `finish_document` puts a model."""
    return {"$ref": SCHEMAS.format(model=model.__name__)}


_HEADERS: dict[int, Json] = {
    416: {
        "headers": {
            "Content-Range": {
                "description": "How long the file is.",
                "schema": {"type": "string"},
            }
        }
    },
    503: {
        "headers": {
            "Retry-After": {
                "description": "When to ask again [s].",
                "schema": {"type": "integer", "minimum": 1},
            }
        }
    },
}


def problems(texts: Mapping[int, str], *codes: int) -> dict[int | str, Json]:
    """Return the documented responses of a route that are problem documents.

    Parameters
    ----------
    texts
        What each status says: `OPERATION_TEXTS`, `BATCH_TEXTS` or `TABLE_TEXTS`.
    codes
        The statuses that the route answers with.

    Returns
    -------
    dict of int or str to dict
        A response of OpenAPI by status.
    """
    content = {"application/problem+json": {"schema": reference_to(ProblemDocument)}}
    return {
        code: {"description": texts[code], "content": content, **_HEADERS.get(code, {})}
        for code in codes
    }


def body_of(model: type[BaseModel], media_type: str) -> Json:
    """Return the documented body of a route that does not read it itself.

    Parameters
    ----------
    model
        Model of the body, which a worker reads.
    media_type
        Its ``content-type``.

    Returns
    -------
    dict
        A request body of OpenAPI, by a reference that `finish_document` fulfils.
    """
    return {"required": True, "content": {media_type: {"schema": reference_to(model)}}}


def lines_of(media_types: Sequence[str], *models: type[BaseModel]) -> Json:
    """Return the documented content that is JSON Lines.

    Parameters
    ----------
    media_types
        Its ``content-type``, in any of several ways.
    models
        Models of a line: it is of one of them.

    Returns
    -------
    dict
        A media type of OpenAPI by name. OpenAPI 3.1 has no word for lines: they are a string.
    """
    names = " or a ".join(model.__name__ for model in models)
    lines = {"oneOf": [reference_to(model) for model in models]}
    schema = {
        "type": "string",
        "pattern": "[^\\r\\n]",  # one line at least
        "description": f"Each line is a {names}.",
        "x-lines": lines,
    }
    return {media_type: {"schema": schema} for media_type in media_types}


def serve_docs(app: FastAPI) -> None:
    """Serve Swagger UI from its package: the machine may be offline.

    Raises
    ------
    RuntimeError
        If the package is not installed.
    """
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
