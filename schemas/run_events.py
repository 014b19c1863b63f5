"""Wire form of what happens in a run: events, and played courses."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from design.checks import MAX_VALUE
from design.errors import InvalidInputError
from design.live.emergency_request import EmergencyRequest
from design.rig.scenario import Played, played_positions
from schemas.base import Positive, Wire
from schemas.shapers import ShaperIn
from schemas.simulations import MAX_HISTORY_POINTS

Time = Annotated[float, Field(ge=0, le=MAX_VALUE)]
Level = Annotated[float, Field(ge=-1, le=1)]
Distance = Annotated[float, Field(ge=-MAX_VALUE, le=MAX_VALUE)]
Samples = Annotated[list[float], Field(min_length=2, max_length=MAX_HISTORY_POINTS)]


class DirectionIn(Wire):
    """Levels of the axes, shares of full speed."""

    x: Annotated[Level | None, Field(description="Of x, -1 to 1; as it was if not given [-].")] = (
        None
    )
    y: Annotated[Level | None, Field(description="Of y, -1 to 1; as it was if not given [-].")] = (
        None
    )


class DistancesIn(Wire):
    """Distances to travel at full speed, signed."""

    x_m: Annotated[Distance, Field(description="Along x [m].")] = 0.0
    y_m: Annotated[Distance, Field(description="Along y [m].")] = 0.0


class HappeningIn(Wire):
    """What happens: a direction, a move, a hoist, another shaper, or an emergency stop."""

    direction: Annotated[
        DirectionIn | None, Field(description="The buttons that are pressed from then on.")
    ] = None
    for_s: Annotated[
        Positive | None,
        Field(
            description="With direction: how long they are held; until the next event of the "
            "axis if not given [s]."
        ),
    ] = None
    move: Annotated[
        DistancesIn | None,
        Field(
            description="Exact distances, travelled by pressing as long as they take, or, with "
            "shaper, by whole moves."
        ),
    ] = None
    shaper: Annotated[
        ShaperIn | None,
        Field(
            description="With move: starts and stops designed by this kind, each without "
            "vibration, as POST /v1/maneuvers does; they do not pass the delay line. Alone, in "
            "live mode: the kind by which commands are solved from then on."
        ),
    ] = None
    cable_length_m: Annotated[
        float | None,
        Field(ge=-MAX_VALUE, le=MAX_VALUE, description="Length to hoist or lower to, evenly [m]."),
    ] = None
    over_s: Annotated[
        Positive | None, Field(description="With cable_length_m: how long that takes [s].")
    ] = None
    stop: Annotated[
        Literal["emergency"] | None,
        Field(
            description="In live mode: both axes stop at once, without a reversal, on the "
            "shortest way after which no more than swing_left swings."
        ),
    ] = None
    swing_left: Annotated[
        Distance | None,
        Field(
            description="With stop: what may swing at its end, as a share of an unshaped step's "
            "swing, 0 to below 1; 0 if not given [-]."
        ),
    ] = None
    within_periods: Annotated[
        Distance | None,
        Field(
            description="With stop: how long it may take, in periods of the slowest mode, 0.05 "
            "to 8; 1 if not given [-]."
        ),
    ] = None

    def emergency(self) -> EmergencyRequest | None:
        """Build the design record of an emergency stop.

        Returns
        -------
        EmergencyRequest or None
            None where the event is something else.

        Raises
        ------
        InvalidInputError
            If what may swing, or how long it may take, is out of range.
        """
        if self.stop is None:
            return None
        given = {"swing_left": self.swing_left, "within_periods": self.within_periods}
        return EmergencyRequest(**{name: one for name, one in given.items() if one is not None})

    def require_one(self) -> None:
        """Check that the event is one thing, and has what belongs to that alone.

        Raises
        ------
        InvalidInputError
            If it is not.
        """
        parts = ("direction", "move", "cable_length_m", "stop")
        given = [name for name in parts if getattr(self, name) is not None]
        if self.shaper is not None and self.move is None:
            given.append("shaper")
        if len(given) != 1:
            raise InvalidInputError(
                (),
                " and ".join(given) or "none",
                "an event of direction, move, cable_length_m, stop, or shaper in live mode",
                code="unknown_event",
            )
        # A direction of 0 is a stop, a move of 0 is none.
        pressed = None if self.direction is None else (self.direction.x, self.direction.y)
        moved = None if self.move is None else (self.move.x_m or None, self.move.y_m or None)
        for name, axes in (("direction", pressed), ("move", moved)):
            if axes == (None, None):
                raise InvalidInputError(
                    name,
                    "none",
                    "of x or y, or both: it does nothing otherwise",
                    code="event_of_no_axis",
                )
        for name, owner in (
            ("for_s", "direction"),
            ("over_s", "cable_length_m"),
            ("swing_left", "stop"),
            ("within_periods", "stop"),
        ):
            value = getattr(self, name)
            if value is not None and owner not in given:
                raise InvalidInputError(
                    name,
                    value,
                    f"left out without {owner}",
                    code="part_of_other_event",
                )
        if self.cable_length_m is not None and self.over_s is None:
            raise InvalidInputError(
                "over_s", None, "given with cable_length_m", code="hoist_without_time"
            )


class EventIn(HappeningIn):
    """What happens at a time."""

    at_s: Annotated[Time, Field(description="When [s].")]


class PlayedIn(Wire):
    """A course of one axis: velocities, each held, or positions, evenly between them."""

    times_s: Annotated[Samples, Field(description="Ascending, without a gap [s].")]
    velocity_m_s: Annotated[
        Samples | None, Field(description="Velocity from each time on [m/s].")
    ] = None
    position_m: Annotated[
        Samples | None, Field(description="Position of the command at each time [m].")
    ] = None

    def to_design(self) -> Played:
        """Build the design record.

        Returns
        -------
        Played
            The course.

        Raises
        ------
        InvalidInputError
            If not one of velocities and positions is given, they are not as many as the times, or
            the times do not ascend or have a gap.
        """
        times = np.array(self.times_s)
        values = self.velocity_m_s if self.position_m is None else self.position_m
        if values is None or (self.velocity_m_s is not None and self.position_m is not None):
            raise InvalidInputError(
                "velocity_m_s",
                "neither" if values is None else "both",
                "the velocities, or position_m in place of them",
                code="velocity_or_position",
            )
        if len(values) != times.size:
            raise InvalidInputError(
                "times_s",
                f"{times.size} times for {len(values)} values",
                "as many as the values",
                code="times_unlike_values",
            )
        if self.position_m is not None:
            return played_positions(times, np.array(values))
        return Played(times_s=times, velocity_m_s=np.array(values))


class PlayedAxes(Wire):
    """Courses of the axes, in place of events that drive them."""

    x: Annotated[PlayedIn | None, Field(description="Of x.")] = None
    y: Annotated[PlayedIn | None, Field(description="Of y.")] = None
