"""What all wire models share."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Annotated, Any, ClassVar, Generic, Self, TypeVar

from pydantic import BaseModel, ConfigDict, Field, model_validator

from design.checks import MAX_VALUE
from design.errors import InvalidInputError


class Wire(BaseModel):
    """A JSON object: unknown fields, NaN, infinity, and numbers in strings or booleans refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _read_units(cls, given: Any) -> Any:  # noqa: ANN401 - any JSON
        """Read fields that are not in SI units."""
        if isinstance(given, dict) and not given.keys() <= wire_names(cls):
            from schemas.units import in_si  # noqa: PLC0415 - most requests use no other units

            return in_si(given, wire_names(cls))
        return given

    def canonical(self) -> str:
        """Return the canonical JSON: one line, keys sorted, with defaults."""
        told = self.model_dump(mode="json", by_alias=True, exclude_none=True)
        return json.dumps(told, sort_keys=True, separators=(",", ":"))


@cache
def wire_names(model: type[BaseModel]) -> frozenset[str]:
    """Return the names of a model's fields on the wire."""
    return frozenset(field.alias or name for name, field in model.model_fields.items())


Record = TypeVar("Record")


class WireOf(Wire, Generic[Record]):
    """The wire form of a record of the mathematics, whose fields are its own except `kind`."""

    RECORD: ClassVar[type[Any]]  # Class of the record

    def to_design(self) -> Record:
        """Build the design record; a fault has the path of its field."""
        values: dict[str, Any] = {}
        for name in type(self).model_fields:
            value = getattr(self, name)
            if isinstance(value, WireOf):
                with name_field(name):
                    value = value.to_design()
            if name != "kind":
                values[name] = value
        record: Record = self.RECORD(**values)
        return record


class OutOf(Wire, Generic[Record]):
    """A part of an answer: what a record of the mathematics says by the same names."""

    @classmethod
    def from_design(cls, record: Record) -> Self:
        """Wrap the design record."""
        return cls.model_construct(**{name: getattr(record, name) for name in cls.model_fields})


def _says_nothing(value: object) -> bool:
    return value is None


def leave_out_none(description: str) -> Any:  # noqa: ANN401 - as pydantic's own Field
    """Return the rule of an answer's field that is left out where it is None.

    Whoever reads the answer finds None in its place: an answer is read back as it was.
    """
    return Field(default=None, exclude_if=_says_nothing, description=description)


Positive = Annotated[float, Field(gt=0, le=MAX_VALUE)]
Version = Annotated[str, Field(description="Version of shapersmith that answered.")]


@contextmanager
def name_field(field: str) -> Iterator[None]:
    """Name the field in which a design record finds a fault, by its path.

    Raises
    ------
    InvalidInputError
        The fault of the body, its path led on from ``field``.
    """
    try:
        yield
    except InvalidInputError as error:
        raise error.within(field) from None
