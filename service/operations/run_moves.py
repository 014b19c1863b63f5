"""Whole moves of a run: designed from rest to rest for the cable as it is then."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from design.analysis.warnings import DesignWarning
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.hoisting import Hoisting
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.spring_mass import SpringMass
from design.moves.hoisting_moves import hoisting_maneuver
from design.moves.maneuvers import Maneuver, maneuver
from design.rig.crane import AxisName
from design.rig.hoists import plant_from
from design.rig.scenario import HoistTo
from design.rig.whole_moves import WholeMove
from schemas.base import name_field
from schemas.run_events import EventIn
from schemas.samples import continuous_options
from schemas.shapers import ShaperIn
from service.operations.maneuver import NO_MOVE_ON_SAMPLES

OneSwing = Mode | Pendulum | SpringMass | Hoisting
"""Plants of one swing at every moment."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveDesigner:
    """What whole moves of a run are designed for; equal ones are designed once.

    Attributes
    ----------
    plant
        What swings before all hoists; None for a hook with a load.
    hoists
        All that is hoisted in the run.
    actuator, speed_m_s
        The drive and full speed [m/s].
    """

    plant: Mode | Pendulum | SpringMass | None
    hoists: Sequence[HoistTo]
    actuator: Actuator
    speed_m_s: float
    _known: dict[object, Maneuver] = field(default_factory=dict, init=False, compare=False)

    def moves_of(
        self, number: int, event: EventIn
    ) -> tuple[list[WholeMove], tuple[DesignWarning, ...]]:
        """Design the whole moves of an event, one an axis.

        Parameters
        ----------
        number, event
            The event, and its place in the list.

        Returns
        -------
        list of WholeMove
            None where the event has no shaper.
        tuple of DesignWarning
            What to know of them, by the event.

        Raises
        ------
        InvalidInputError
            If a value breaks its rule, or a hook with a load swings.
        InfeasibleDesignError
            If no such move was found.
        SolverFailedError
            If no move found was verified.
        """
        moves: list[WholeMove] = []
        warnings: list[DesignWarning] = []
        if event.move is None or event.shaper is None:
            return moves, ()
        distances: tuple[tuple[AxisName, float], ...] = (
            ("x", event.move.x_m),
            ("y", event.move.y_m),
        )
        for axis, distance in distances:
            if distance == 0:
                continue
            found = self._designed(number, axis, event.shaper, event.at_s, distance)
            command = Impulses(
                times_s=found.command.times_s - found.command.times_s[0],
                amplitudes=found.direction * found.command.amplitudes,
            )
            moves.append(WholeMove(event=number, axis=axis, at_s=event.at_s, command=command))
            warnings += [
                replace(one, detail=f"events.{number}, {axis}: {one.detail}")
                for one in found.warnings
            ]
        return moves, tuple(warnings)

    def _designed(
        self, number: int, axis: AxisName, shaper: ShaperIn, at_s: float, distance_m: float
    ) -> Maneuver:
        plant = self._plant_at(at_s)
        with name_field(f"events.{number}.shaper"):
            options = continuous_options(shaper, NO_MOVE_ON_SAMPLES)
        kind = shaper.shaper_kind()
        key = (plant, kind.name, options, distance_m)
        if key in self._known:
            return self._known[key]
        try:
            if isinstance(plant, Hoisting):
                made = hoisting_maneuver(
                    plant,
                    self.actuator,
                    kind,
                    speed_m_s=self.speed_m_s,
                    distance_m=distance_m,
                    options=options,
                )
            else:
                made = maneuver(
                    plant,
                    self.actuator,
                    kind,
                    speed_m_s=self.speed_m_s,
                    distance_m=distance_m,
                    options=options,
                )
        except InvalidInputError as error:
            raise _in_event(error, number, axis) from None
        self._known[key] = made
        return made

    def _plant_at(self, at_s: float) -> OneSwing:
        """Return what swings from a time on; the times of its hoisting count from that time."""
        if self.plant is None:
            raise InvalidInputError(
                "plant.kind",
                "a hook with a load",
                "of one swing for a move with a shaper; of two, give the move without, and shape "
                "it by a delay line",
                code="whole_move_of_two_swings",
            )
        if not isinstance(self.plant, Pendulum):
            return self.plant
        return plant_from(self.plant, self.hoists, at_s)


def _in_event(error: InvalidInputError, number: int, axis: AxisName) -> InvalidInputError:
    """Return an error of a maneuver with the path of its field in a run."""
    if error.path[0] == "distance_m":
        return error.at(("events", str(number), "move", f"{axis}_m"), error.value)
    if error.path[0] == "shaper":
        return error.within(f"events.{number}")
    return error
