"""The OpenAPI document: what the framework says of the routes, made fit for client generators."""

import json
from collections.abc import Iterable
from typing import Any

from fastapi import FastAPI
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from schemas.problems import ProblemDocument
from service.http.examples import EXAMPLES
from service.http.openapi import SCHEMAS, Json

DESCRIPTION = """\
Bodies and answers are JSON in SI units. The unit is the end of a field's name, as in `_s`, `_m` \
and `_rad_s`. A ratio has none. Requests may give a field in another unit by the end of its name: \
`_mm`, `_ms`, `_hz`, `_deg`. `period_s` stands for `natural_frequency_rad_s`, `log_decrement` for \
`damping_ratio`.

Each refusal is a problem document (RFC 9457) of media type `application/problem+json`. Its \
`errors` name each field at fault by a JSON pointer. A path that no route has is answered with \
404, and a method that a path does not take with 405.

Each answer has an `X-Request-Id`: the one of the request, or a new one.
"""

TAGS = [
    {"name": "designs", "description": "Shapers: designed, fitted, recommended and listed."},
    {"name": "moves", "description": "Whole moves, and the response to any command."},
    {"name": "analysis", "description": "What given impulses or shapers do on other plants."},
    {"name": "tables", "description": "Jobs that compute many designs, and their files."},
    {"name": "schemas", "description": "JSON Schemas of all bodies, for editors and programs."},
    {"name": "health", "description": "Whether the service answers."},
]
"""Groups of routes, in the order in which they are shown."""

REQUEST_ID = {
    "X-Request-Id": {
        "description": "Id of the request: its own, where it has one of up to 64 letters, digits, "
        "dots, hyphens and underscores.",
        "schema": {"type": "string"},
    }
}

FROM_FRAMEWORK = ("HTTPValidationError", "ValidationError")
"""Models of refusals that the framework would write; no route reads its parameters so."""


def finish_document(app: FastAPI, models: Iterable[type[BaseModel]]) -> None:
    """Have an app serve a whole document.

    Parameters
    ----------
    app
        The application; its document is made once, when it is first asked for.
    models
        The models of bodies, to which routes refer by `body_of`.
    """
    generated = app.openapi
    bodies = list(models)

    def openapi() -> Json:
        if app.openapi_schema is None:
            document = generated()
            _add_models(document, bodies)
            for operation in operations_of(document).values():
                _finish_operation(operation)
            for schema in document["components"]["schemas"].values():
                _finish_schema(schema, document)
            app.openapi_schema = document
        return app.openapi_schema

    app.openapi = openapi  # type: ignore[method-assign]


def operations_of(document: Json) -> dict[tuple[str, str], Json]:
    """Return the operations of a document by method, in capitals, and path."""
    return {
        (method.upper(), path): operation
        for path, item in document["paths"].items()
        for method, operation in item.items()
    }


def _add_models(document: Json, bodies: Iterable[type[BaseModel]]) -> None:
    """Add the models that no route of the framework's reads or writes, and drop its own."""
    _, definitions = models_json_schema(
        [*((model, "validation") for model in bodies), (ProblemDocument, "serialization")],
        ref_template=SCHEMAS,
    )
    schemas = document.setdefault("components", {}).setdefault("schemas", {})
    for name, definition in definitions["$defs"].items():
        schemas.setdefault(name, definition)
    for name in FROM_FRAMEWORK:
        schemas.pop(name, None)


def _finish_operation(operation: Json) -> None:
    """Drop the framework's refusal, name the request's id, add the examples of the body."""
    answers = operation["responses"]
    for status in [status for status, answer in answers.items() if _is_from_framework(answer)]:
        del answers[status]
    for answer in answers.values():
        answer["headers"] = {**answer.get("headers", {}), **REQUEST_ID}
    examples = EXAMPLES.get(operation["operationId"])
    if examples is not None:
        for content in operation["requestBody"]["content"].values():
            content["examples"] = {
                name: {"summary": example.summary, "value": example.value}
                for name, example in examples.items()
            }


def _is_from_framework(answer: Json) -> bool:
    return f'"{SCHEMAS.format(model=FROM_FRAMEWORK[0])}"' in json.dumps(answer)


def _finish_schema(schema: Json, document: Json) -> None:
    """Say defaults that are no plain value, and the names of kinds, in words.

    Client generators drop a route whose schema has an object as a default. What stands in its place
    is for people: the service fills it in.
    """
    for field in schema.get("properties", {}).values():
        default = field.get("default")
        if isinstance(default, dict | list):
            del field["default"]
            field["description"] = f"{_described(field, document)} {_words_of(default)}"
        elif "const" in field:
            field.setdefault("description", f"Always {field['const']}.")


def _described(field: Json, document: Json) -> str:
    """Return the description of a field, else that of the model that it is."""
    name = field.get("$ref", "").rpartition("/")[2]
    model: Json = document["components"]["schemas"].get(name, {})
    return str(field.get("description", model.get("description", "")))


def _words_of(default: Any) -> str:  # noqa: ANN401 - any JSON
    return f"{json.dumps(default)} if not given." if default else "Empty if there are none."
