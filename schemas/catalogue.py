"""Wire form of the catalogue of shapers."""

from typing import Annotated, Any

from pydantic import Field

from schemas.base import Wire


class CatalogueEntry(Wire):
    """One kind of shaper."""

    kind: str
    summary: str
    source: str
    claims: list[str]
    plants: list[str]
    most_modes: Annotated[
        int, Field(description="Largest number of modes of a plant that it serves.")
    ]
    actuators: list[str]
    parameters: Annotated[dict[str, Any], Field(description="JSON Schema of the shaper object.")]
    example: Annotated[dict[str, Any], Field(description="A request for POST /v1/designs.")]


class Catalogue(Wire):
    """Answer of `GET /v1/shapers`."""

    shapers: list[CatalogueEntry]
    version: str
