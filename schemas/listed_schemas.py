"""Wire form of the list of JSON Schemas."""

from typing import Annotated

from pydantic import Field

from schemas.base import Version, Wire


class ListedSchema(Wire):
    """One JSON Schema."""

    name: Annotated[str, Field(description="Name of the schema, for `GET /v1/schemas/{name}`.")]
    title: Annotated[str, Field(description="What the schema is of, in words.")]
    path: Annotated[str, Field(description="Path that answers with the schema.")]


class ListedSchemas(Wire):
    """Answer of `GET /v1/schemas`."""

    schemas: Annotated[
        list[ListedSchema], Field(description="Schema of every request and response.")
    ]
    version: Version
