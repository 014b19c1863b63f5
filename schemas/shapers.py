"""Wire form of the shapers, made from the registry: a new kind needs no line here."""

import dataclasses
import functools
import operator
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, create_model

from design.shapers.kind import ShaperKind
from design.shapers.registry import SHAPERS
from schemas.shaper_request import ShaperRequest


def shaper_model(kind: ShaperKind) -> type[ShaperRequest]:
    """Return the wire model of one kind."""
    fields: dict[str, Any] = {"kind": (Literal[kind.name], ...)}
    for option in dataclasses.fields(kind.options):
        fields[option.name] = (option.type, Field(default=option.default, **option.metadata))
    name = "".join(part.title() for part in kind.name.split("_"))
    return create_model(f"{name}In", __base__=ShaperRequest, __doc__=kind.summary, **fields)


MODELS: dict[str, type[ShaperRequest]] = {
    name: shaper_model(kind) for name, kind in SHAPERS.items()
}

if TYPE_CHECKING:
    ShaperIn = ShaperRequest
else:
    ShaperIn = Annotated[
        functools.reduce(operator.or_, MODELS.values()),
        Field(discriminator="kind", description="Kind of shaper, with its parameters."),
    ]
