"""Wire form of maps."""

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from design.errors import InvalidInputError
from design.maps import Axis, ResidualMap
from design.types import FloatArray
from schemas.actuators import ActuatorIn
from schemas.base import Wire
from schemas.impulses import ImpulsesWire
from schemas.plants import PlantIn
from schemas.shapers import ShaperIn

MOST_POINTS = 2000


class AxisIn(Wire):
    """One field and its values: ``from``, ``to`` and ``points``, or ``values``."""

    field: Annotated[
        str, Field(pattern="^/(plant|actuator)/", description="JSON pointer of a number.")
    ]
    from_: Annotated[float | None, Field(alias="from")] = None
    to: float | None = None
    points: Annotated[int, Field(ge=2, le=MOST_POINTS)] = 51
    spacing: Literal["linear", "geometric"] = "linear"
    values: Annotated[list[float] | None, Field(min_length=1, max_length=MOST_POINTS)] = None

    def to_design(self) -> Axis:
        """Build the design record."""
        path = tuple(self.field.removeprefix("/").split("/"))
        return Axis(path=path, values=self._values())

    def _values(self) -> FloatArray:
        if self.values is not None:
            if self.from_ is not None or self.to is not None:
                raise InvalidInputError("values", "values and a range", "given alone")
            return np.array(self.values)
        if self.from_ is None or self.to is None:
            raise InvalidInputError(
                "from", None, "given together with to, or values in their place"
            )
        if not self.to > self.from_:
            raise InvalidInputError("to", self.to, f"greater than from, {self.from_!r}")
        if self.spacing == "linear":
            return np.linspace(self.from_, self.to, self.points)
        if self.from_ <= 0:
            raise InvalidInputError("from", self.from_, "> 0 for geometric spacing")
        return np.geomspace(self.from_, self.to, self.points)


class MapRequest(Wire):
    """Body of `POST /v1/maps`."""

    plant: PlantIn
    actuator: ActuatorIn
    shaper: ShaperIn | None = None
    impulses: Annotated[
        ImpulsesWire | None, Field(description="In place of shaper: a command that is held.")
    ] = None
    design: Annotated[
        Literal["once", "each"],
        Field(description="once: for plant and actuator as given; each: anew in every cell."),
    ] = "once"
    x: AxisIn
    y: AxisIn


class AxisOut(Wire):
    """One axis of a map."""

    field: str
    values: list[float]


class MapResponse(Wire):
    """Answer of `POST /v1/maps`."""

    x: AxisOut
    y: AxisOut
    residual: Annotated[
        list[list[float | None]],
        Field(description="A row for each value of y; null where a cell has no such shaper [-]."),
    ]

    @classmethod
    def from_design(cls, request: MapRequest, x: Axis, y: Axis, found: ResidualMap) -> Self:
        """Wrap the design records."""
        rows = [
            [None if np.isnan(value) else value for value in row]
            for row in found.residuals.tolist()
        ]
        return cls(
            x=AxisOut(field=request.x.field, values=x.values.tolist()),
            y=AxisOut(field=request.y.field, values=y.values.tolist()),
            residual=rows,
        )
