"""What all wire models share."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from design.errors import InvalidInputError
from design.model.plants.mode import MAX_DAMPING_RATIO
from design.types import MAX_VALUE


class Wire(BaseModel):
    """A JSON object: unknown fields, NaN, infinity, and numbers in strings or booleans refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    def canonical(self) -> str:
        """Return the canonical JSON: one line, keys sorted, with defaults."""
        told = self.model_dump(mode="json", by_alias=True, exclude_none=True)
        return json.dumps(told, sort_keys=True, separators=(",", ":"))


def _says_nothing(value: object) -> bool:
    return value is None


def leave_out_none(description: str) -> Any:  # noqa: ANN401 - as pydantic's own Field
    """Return the rule of an answer's field that is left out where it is None.

    Whoever reads the answer finds None in its place: an answer is read back as it was.
    """
    return Field(default=None, exclude_if=_says_nothing, description=description)


Positive = Annotated[float, Field(gt=0, le=MAX_VALUE)]
PlantDamping = Annotated[
    float,
    Field(ge=0, le=MAX_DAMPING_RATIO, description="Share of critical damping [-]."),
]


@contextmanager
def name_field(field: str) -> Iterator[None]:
    """Name the field in which a design record finds a fault.

    The name is seen from the request.

    Parameters
    ----------
    field
        Dotted path from the request to the record.

    Raises
    ------
    InvalidInputError
        The fault of the body, its path led on from ``field``.
    """
    try:
        yield
    except InvalidInputError as error:
        raise error.within(field) from None
