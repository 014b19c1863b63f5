"""Plans to a level that keep the limit to the deflection, where the fastest does not."""

import math
from dataclasses import replace

from design.live.deflection import limited_plan
from design.live.deflection_peak import peak_deflection
from design.live.machine import LiveMachine
from design.live.state import AxisState, Plan
from design.model.plants.mode import Mode


def limit_deflection(
    machine: LiveMachine,
    modes: tuple[Mode, ...],
    ahead: AxisState,
    target: float,
    free: Plan | None,
) -> Plan | None:
    """Return a plan to a level that keeps the limit to the deflection.

    Parameters
    ----------
    machine, modes
        The machine, and its modes as they are now.
    ahead
        The axis when the drive first answers.
    target
        The level to end at, signed [-].
    free
        The plan without a limit; None where none was found.

    Returns
    -------
    Plan or None
        The free plan where it keeps the limit, or no other comes nearer to it.
    """
    limit = machine.deflection_limit
    if limit is None:
        return free
    peak = math.inf if free is None else _peak(machine, modes, ahead, free)
    if peak <= limit:
        return free
    found = limited_plan(machine.actuator, modes, ahead, target, limit)
    if found is not None and found.peak < peak:
        return found.plan
    if free is None:
        return None
    reason = (
        f"the deflection reaches {peak:.4g} of an unshaped step's, {peak - limit:.2g} above the "
        f"limit of {limit:g}: no command with less was found"
    )
    return replace(free, fallback=reason)


def _peak(machine: LiveMachine, modes: tuple[Mode, ...], ahead: AxisState, plan: Plan) -> float:
    acts = tuple(time_s + machine.actuator.dead_time_s for time_s in plan.times_s)
    return peak_deflection(
        machine.actuator, modes, replace(ahead, plan=replace(plan, times_s=acts))
    )
