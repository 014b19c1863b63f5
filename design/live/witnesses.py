"""The second opinion on an axis, behind its drive and behind an ideal one."""

from dataclasses import dataclass
from typing import NamedTuple

from design.live.hoist import Hoist
from design.live.hoist_witness import carry_hoisted_witness
from design.live.machine import LiveMachine
from design.live.state import Plan
from design.live.witness import Route, Witness, route_of
from design.model.actuators.ideal import Ideal
from design.model.plants.mode import Mode


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Witnesses:
    """The second opinion on an axis: behind the drive, and behind an ideal one."""

    given: Witness
    ideal: Witness


class Routes(NamedTuple):
    """Matrices of the modes behind the drive, and behind an ideal one."""

    given: Route
    ideal: Route


def routes_of(machine: LiveMachine, modes: tuple[Mode, ...]) -> Routes:
    """Return the matrices of a machine.

    Parameters
    ----------
    machine, modes
        The machine, and its modes as they are now.

    Returns
    -------
    Routes
        Of both drives.
    """
    return Routes(route_of(machine.actuator, modes), route_of(Ideal(), modes))


def carry_witnesses(
    machine: LiveMachine,
    routes: Routes,
    witnesses: Witnesses,
    plan: Plan,
    until_s: float,
    hoist: Hoist | None = None,
) -> Witnesses:
    """Return the witnesses of an axis after a plan, at a later time.

    Parameters
    ----------
    machine, routes
        The machine, and its matrices.
    witnesses
        The axis now.
    plan
        Its switches until then.
    until_s
        Then [s].
    hoist
        The latest hoist, if there was any.

    Returns
    -------
    Witnesses
        Just after a switch at that time.
    """
    acts = [time_s + machine.actuator.dead_time_s for time_s in plan.times_s]

    def after(route: Route, witness: Witness) -> Witness:
        return carry_hoisted_witness(route, hoist, witness, acts, plan.levels, until_s)

    return Witnesses(
        given=after(routes.given, witnesses.given), ideal=after(routes.ideal, witnesses.ideal)
    )
