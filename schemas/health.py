"""Wire form of what the service says of itself."""

from typing import Annotated, Literal

from pydantic import Field

from schemas.base import Version, Wire


class Live(Wire):
    """Answer of `GET /health/live`."""

    status: Annotated[Literal["live"], Field(description="The process serves.")]


class Ready(Wire):
    """Answer of `GET /health/ready`."""

    status: Annotated[Literal["ready"], Field(description="Designs are answered.")]
    version: Version
