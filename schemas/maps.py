"""Wire form of maps."""

from collections.abc import Iterable
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field

from design.analysis.warnings import DesignWarning
from design.errors import InvalidInputError
from design.fields import Axis, space_evenly
from design.maps.map_case import Map, MapCase, Move, Quantity, Recipe
from design.model.actuators.model import Model
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.registry import Plant
from design.types import FloatArray
from schemas.actuators import ActuatorIn
from schemas.base import Positive, Wire, name_field
from schemas.impulses import ImpulsesWire
from schemas.plants import PlantIn
from schemas.pointers import path_of
from schemas.samples import continuous_options
from schemas.shapers import ShaperIn
from schemas.varied import VariedInRequest
from schemas.warnings import WarningOut, Warnings

MAX_MAP_AXIS_POINTS = 2000


NOT_ON_SAMPLES = (
    "a map holds one sampled shaper; it searches none in every cell and no move; take a table, "
    "whose rows are designs on samples, or a maneuver with sample_time_s"
)
"""Why a shaper that is designed in every cell, or for a move, takes no sample time."""


class AxisIn(VariedInRequest):
    """One field and its values: ``from``, ``to`` and ``points``, or ``values``."""

    field: Annotated[
        str,
        Field(
            pattern="^/(plant|actuator|move)/",
            description="JSON pointer of the number that the axis varies.",
        ),
    ]
    from_: Annotated[
        float | None, Field(alias="from", description="First value, in the field's unit.")
    ] = None
    to: Annotated[float | None, Field(description="Last value, in the field's unit.")] = None
    points: Annotated[int, Field(ge=2, le=MAX_MAP_AXIS_POINTS, description="Number of values.")] = (
        51
    )
    spacing: Annotated[
        Literal["linear", "geometric"], Field(description="How the values are spaced.")
    ] = "linear"
    values: Annotated[
        list[float] | None,
        Field(
            min_length=1,
            max_length=MAX_MAP_AXIS_POINTS,
            description="Values in place of from, to and points.",
        ),
    ] = None

    def to_design(self) -> Axis:
        """Build the design record."""
        return Axis(path=path_of(self.field), values=self._values())

    def _values(self) -> FloatArray:
        if self.values is not None:
            if self.from_ is not None or self.to is not None:
                raise InvalidInputError(
                    "values", "values and a range", "given alone", code="values_and_range"
                )
            return np.array(self.values)
        if self.from_ is None or self.to is None:
            raise InvalidInputError(
                "from",
                None,
                "given together with to, or values in their place",
                code="range_half_said",
            )
        return space_evenly(self.from_, self.to, self.points, self.spacing)


class MoveIn(Wire):
    """The move that the shaper starts and stops."""

    pulse_s: Annotated[
        Positive,
        Field(description="Time from the first step of the start to that of the stop [s]."),
    ]
    stop: Annotated[
        Literal["solved", "mirrored"],
        Field(description="mirrored: the gaps of the start in reverse order."),
    ] = "solved"


class MapRequest(Wire):
    """Body of `POST /v1/maps`."""

    plant: PlantIn
    actuator: ActuatorIn
    shaper: Annotated[
        ShaperIn | None,
        Field(description="Shaper that is mapped; null beside impulses and for gains."),
    ] = None
    impulses: Annotated[
        ImpulsesWire | None,
        Field(description="In place of shaper: a command that is held in every cell."),
    ] = None
    move: Annotated[
        MoveIn | None,
        Field(
            description="Map the whole move that the shaper starts and stops; null for one command."
        ),
    ] = None
    quantity: Annotated[
        Quantity,
        Field(
            description="deflection_m: the residual at the payload, with speed_m_s. times_s, "
            "duration_s, branch (n, m and the sign of the closed form): of a shaper designed in "
            "every cell. alpha, beta_rad: magnitude and lag of G_decel/G_accel, without a shaper."
        ),
    ] = "residual"
    speed_m_s: Annotated[
        Positive | None, Field(description="Full speed, for deflection_m [m/s].")
    ] = None
    design: Annotated[
        Literal["once", "each"],
        Field(
            description="once: designed for plant and actuator as given; each: designed anew "
            "in every cell."
        ),
    ] = "once"
    designed_for: Annotated[
        Model | None,
        Field(
            description="Model of the actuator that the shaper is designed for, if not that "
            "of the actuator given."
        ),
    ] = None
    x: Annotated[AxisIn, Field(description="First axis.")]
    y: Annotated[
        AxisIn | None,
        Field(description="Second axis; where it is left out, the map is a curve over x."),
    ] = None

    @property
    def holds_one_shaper(self) -> bool:
        """Whether one shaper, without a move, is held for the plant as given.

        The actuator is as given too.
        """
        return self.design == "once" and self.move is None and self.designed_for is None

    def to_design(self, plant: Plant, actuator: Actuator, held: Impulses | None) -> MapCase:
        """Build the design record.

        Parameters
        ----------
        plant, actuator
            Those of the request, as records.
        held
            A shaper on samples, in place of the one that the request would design; else None.

        Returns
        -------
        MapCase
            What is mapped.

        Raises
        ------
        InvalidInputError
            If a parameter of the shaper breaks its rule.
        """
        move = self.move
        return MapCase(
            plant=plant,
            actuator=actuator,
            shaper=self._shaper() if held is None else held,
            move=None if move is None else Move(pulse_s=move.pulse_s, stop=move.stop),
            quantity=self.quantity,
            speed_m_s=self.speed_m_s,
        )

    def _shaper(self) -> Impulses | Recipe | None:
        if self.impulses is not None:
            for name in ("shaper", "designed_for"):
                if getattr(self, name) is not None:
                    raise InvalidInputError(
                        name, "given", "left out beside impulses", code="option_beside_impulses"
                    )
            if self.design == "each":
                raise InvalidInputError(
                    "design", "each", "once: impulses are held", code="design_per_cell_of_impulses"
                )
            with name_field("impulses"):
                return self.impulses.to_design()
        if self.shaper is None:
            return None
        with name_field("shaper"):
            options = continuous_options(self.shaper, NOT_ON_SAMPLES)
        return Recipe(
            kind=self.shaper.shaper_kind(),
            options=options,
            each=self.design == "each",
            designed_for=self.designed_for,
        )


class AxisOut(Wire):
    """One axis of a map."""

    field: Annotated[str, Field(description="JSON pointer of the field.")]
    values: Annotated[list[float], Field(description="Values of the field, in its unit.")]


Number = float | None
Row = list[Number]
Numbers = list[list[float] | None]


class MapResponse(Wire):
    """Answer of `POST /v1/maps`: the quantity asked for, the others null.

    A row for each value of y; without y, the row alone. A cell is null where there is no such
    shaper or move.
    """

    quantity: Annotated[Quantity, Field(description="Quantity that was asked for.")]
    x: Annotated[AxisOut, Field(description="First axis.")]
    y: Annotated[AxisOut | None, Field(description="Second axis; null for a curve.")]
    residual: Annotated[
        list[Row] | Row | None, Field(description="Share of an unshaped step [-].")
    ] = None
    deflection_m: Annotated[
        list[Row] | Row | None, Field(description="Amplitude of the residual at the payload [m].")
    ] = None
    duration_s: Annotated[
        list[Row] | Row | None, Field(description="Duration of the shaper [s].")
    ] = None
    alpha: Annotated[
        list[Row] | Row | None, Field(description="Magnitude of G_decel/G_accel [-].")
    ] = None
    beta_rad: Annotated[
        list[Row] | Row | None, Field(description="Lag of G_decel/G_accel [rad].")
    ] = None
    times_s: Annotated[
        list[Numbers] | Numbers | None, Field(description="A list of times in each cell [s].")
    ] = None
    branch: Annotated[
        list[Numbers] | Numbers | None, Field(description="n, m and sign in each cell.")
    ] = None

    warnings: Warnings

    @classmethod
    def from_design(
        cls,
        request: MapRequest,
        x: Axis,
        y: Axis | None,
        found: Map,
        warnings: Iterable[DesignWarning],
    ) -> Self:
        """Wrap the design records.

        Parameters
        ----------
        request
            What was asked.
        x, y
            The axes; None for y of a curve.
        found
            The map, of shape (len(y), len(x), k).
        warnings
            What to know of it.

        Returns
        -------
        Self
            Not a number becomes null; a curve is one list, without rows.
        """
        several = found.quantity in {"times_s", "branch"}
        rows = [
            [_list_finite(cell) if several else _number(cell[0]) for cell in row]
            for row in found.values.tolist()
        ]
        told: dict[str, Any] = {found.quantity: rows if y is not None else rows[0]}
        return cls(
            quantity=found.quantity,
            x=AxisOut(field=request.x.field, values=x.values.tolist()),
            y=None
            if request.y is None or y is None
            else AxisOut(field=request.y.field, values=y.values.tolist()),
            warnings=[WarningOut.from_design(one) for one in warnings],
            **told,
        )


def _number(value: float) -> float | None:
    return None if np.isnan(value) else value


def _list_finite(cell: list[float]) -> list[float] | None:
    return [value for value in cell if not np.isnan(value)] or None
