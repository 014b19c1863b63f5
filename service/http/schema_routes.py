"""HTTP routes of the JSON Schemas."""

import hashlib
from typing import Annotated

from fastapi import APIRouter, Path, Request
from starlette.responses import Response

from schemas.json_schema import DIALECT
from schemas.listed_schemas import ListedSchemas
from service.http.entity_tags import held_tags
from service.http.openapi import OPERATION_TEXTS, Json, problems
from service.http.table_answers import IF_NONE_MATCH
from service.problems import NOT_FOUND, Problem, ProblemError
from service.wire_schemas import PATH, URN, listed_schemas, schema_bytes, schema_names

MEDIA_TYPE = "application/schema+json"

TEXTS = OPERATION_TEXTS | {404: "No such schema"}

EXAMPLE = "design-request"

_ETAG = {"ETag": {"description": "Changes with the schema.", "schema": {"type": "string"}}}

FILES: dict[int | str, Json] = {
    200: {
        "description": "The schema, draft 2020-12",
        "headers": _ETAG,
        "content": {
            MEDIA_TYPE: {
                "schema": {"type": "object"},
                "example": {"$schema": DIALECT, "$id": URN.format(name=EXAMPLE), "type": "object"},
            }
        },
    },
    304: {"description": "The client has the schema already", "headers": _ETAG},
}

router = APIRouter(tags=["schemas"])


@router.get(
    PATH,
    response_model=ListedSchemas,
    operation_id="list_schemas",
    responses=problems(TEXTS, 500),
    summary="JSON Schemas of every request and response",
)
async def list_schemas() -> Response:
    """Answer with the names of the schemas and where each is."""
    return Response(listed_schemas().model_dump_json(), media_type="application/json")


@router.get(
    PATH + "/{name}",
    response_class=Response,
    operation_id="get_schema",
    responses={**problems(TEXTS, 404, 500), **FILES},
    openapi_extra={"parameters": [IF_NONE_MATCH]},
    summary="One JSON Schema",
)
async def schema(
    request: Request,
    name: Annotated[
        str,
        Path(
            description="Name of the schema.",
            examples=[EXAMPLE],
            json_schema_extra={"enum": list(schema_names())},  # no Literal: another is a 404
        ),
    ],
) -> Response:
    """Answer with the bytes that `shapersmith schemas` writes; takes If-None-Match."""
    if name not in schema_names():
        detail = f"there is no schema {name[:64]!r}: GET {PATH} lists their names"
        raise ProblemError(Problem(NOT_FOUND, detail))
    content = schema_bytes(name)
    tag = f'"{hashlib.sha256(content).hexdigest()[:32]}"'
    if held_tags(request) & {tag, "*"}:
        return Response(status_code=304, headers={"etag": tag})
    return Response(content, media_type=MEDIA_TYPE, headers={"etag": tag})
