"""Wire form of the catalogue of shapers."""

from typing import Annotated, Any

from pydantic import Field

from schemas.base import Version, Wire


class CatalogueEntry(Wire):
    """One kind of shaper."""

    kind: Annotated[str, Field(description="Name of the kind, for `shaper.kind`.")]
    summary: Annotated[str, Field(description="What the kind does, in one sentence.")]
    source: Annotated[str, Field(description="Publication that the kind comes from.")]
    claims: Annotated[list[str], Field(description="Quantities that its certificate proves.")]
    plants: Annotated[list[str], Field(description="Kinds of plants that it serves.")]
    most_modes: Annotated[
        int, Field(description="Largest number of modes of a plant that it serves.")
    ]
    actuators: Annotated[list[str], Field(description="Kinds of actuators that it serves.")]
    parameters: Annotated[dict[str, Any], Field(description="JSON Schema of the shaper object.")]
    example: Annotated[dict[str, Any], Field(description="A request for POST /v1/designs.")]


class Catalogue(Wire):
    """Answer of `GET /v1/shapers`."""

    shapers: Annotated[list[CatalogueEntry], Field(description="Every kind of shaper.")]
    version: Version
