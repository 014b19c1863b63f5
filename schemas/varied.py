"""A field that is varied, and its values, in any unit that the field may be given in."""

from collections.abc import Iterator
from typing import Any, Self

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from design.fields import space_evenly
from schemas.base import Wire
from schemas.pointers import path_of
from schemas.units import Reading, reading_of

MAX_SPACED_POINTS = 100_000
"""Points of an axis that is evenly spaced in what is no multiple of its field, as a period: each
becomes a value of the specification."""


class Varied(Wire):
    """A field by its name or pointer, ``over`` or ``field``, and ``from``, ``to`` or ``values``."""

    @model_validator(mode="after")
    def in_si(self) -> Self:
        """Return the same in SI units, a rising range where the given one falls."""
        named = "over" if "over" in type(self).model_fields else "field"
        path, slash, name = getattr(self, named).rpartition("/")
        reading = reading_of(name)
        if reading is None:
            return self
        return self.model_copy(
            update={named: path + slash + reading.name, **self._in_si_values(reading)}
        )

    def _in_si_values(self, reading: Reading) -> dict[str, Any]:
        fields = type(self).model_fields
        told: dict[str, Any] = {
            name: getattr(self, name) for name in ("from_", "to", "values") if name in fields
        }
        ends = told["from_"], told["to"]
        points: Any = getattr(self, "points", None)
        spacing: Any = getattr(self, "spacing", None)
        if not reading.even and None not in (*ends, points) and _rises(*ends, spacing):
            if points > MAX_SPACED_POINTS:
                raise PydanticCustomError(
                    "less_than_equal",
                    "an axis over a period or a decrement has {most} points at most",
                    {"most": MAX_SPACED_POINTS},
                )
            values = reading.convert(space_evenly(*ends, points, spacing).tolist())
            usual = fields["points"].default
            return {"from_": None, "to": None, "points": usual, "values": sorted(values)}
        read: dict[str, Any] = {name: reading.convert(value) for name, value in told.items()}
        if None not in ends and (ends[0] < ends[1]) != (read["from_"] < read["to"]):
            read["from_"], read["to"] = read["to"], read["from_"]
        return read


class VariedInRequest(Varied):
    """A field of a request by its pointer, and its range or values."""

    def numbers(self, pointer: str) -> Iterator[tuple[str, str, float]]:
        """Yield the ends of the range, or the least and the largest value.

        Parameters
        ----------
        pointer
            Of this object.

        Yields
        ------
        tuple of str, str and float
            Pointer, part of the request and field that it is a value of, and value.
        """
        named = "over" if "over" in type(self).model_fields else "field"
        path = path_of(getattr(self, named))
        name = f"{path[0]}/{path[-1]}"
        values: list[float] = getattr(self, "values", None) or []
        ends = (min(values), max(values)) if values else ()
        for end in dict.fromkeys(map(values.index, ends)):
            yield f"{pointer}/values/{end}", name, values[end]
        for field, alias in (("from_", "from"), ("to", "to")):
            value = getattr(self, field)
            if value is not None:
                yield f"{pointer}/{alias}", name, value


def _rises(start: float, stop: float, spacing: str) -> bool:
    """Return whether values can be spaced; what is wrong with others is said later."""
    return stop > start and (start > 0 or spacing != "geometric")
