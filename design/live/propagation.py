"""An axis carried through time and through the switches of its plan, in closed form."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from design.live.kernel import FIRST, SECOND, SWITCHED, lag_flow, set_of, switch, wait
from design.live.machine import IDEAL_ROW
from design.live.state import AxisState
from design.types import FloatArray


class Rows(NamedTuple):
    """A machine as the kernel knows it: its drive, its modes behind it and behind none."""

    drive: FloatArray
    modes: FloatArray
    ideal_modes: FloatArray
    dead_time_s: float


def carry(rows: Rows, axis: AxisState, until_s: float, *, through: bool = True) -> AxisState:
    """Return an axis at a later time, all due switches made.

    Parameters
    ----------
    rows
        The machine.
    axis
        The axis.
    until_s
        Then, not before the axis's time [s].
    through
        Whether a switch that is due just then is made.

    Returns
    -------
    AxisState
        With the rest of its plan.
    """
    made = 0
    for number, time_s in enumerate(axis.plan.times_s):
        acts_s = time_s + rows.dead_time_s
        if acts_s > until_s or (acts_s == until_s and not through):
            break
        axis = _switched(rows, _waited(rows, axis, acts_s), axis.plan.levels[number])
        made = number + 1
    axis = _waited(rows, axis, until_s)
    if not made:
        return axis
    plan = axis.plan
    left = replace(plan, times_s=plan.times_s[made:], levels=plan.levels[made:])
    return replace(axis, plan=left)


def _waited(rows: Rows, axis: AxisState, until_s: float) -> AxisState:
    """Return an axis at a later time before which nothing switches."""
    elapsed = until_s - axis.time_s
    if elapsed <= 0.0:
        return axis
    lag, rings, ideal = axis.lag.copy(), axis.rings.copy(), axis.ideal_rings.copy()
    wait(rows.drive, rows.modes, elapsed, axis.force, lag[0], rings)
    wait(IDEAL_ROW, rows.ideal_modes, elapsed, axis.force, np.zeros(2), ideal)
    if rows.drive[SWITCHED] == 0.0:
        for force in (0, 1):
            flow = lag_flow(rows.drive[FIRST + force], rows.drive[SECOND + force], elapsed)
            lag[force] = np.array(flow).reshape(2, 2) @ lag[force]
    return replace(axis, time_s=until_s, lag=lag, rings=rings, ideal_rings=ideal)


def _switched(rows: Rows, axis: AxisState, level: float) -> AxisState:
    """Return an axis just after a switch to a level."""
    change = level - axis.level
    if change == 0.0:
        return axis
    force = set_of(axis.level, level, axis.force)
    lag, rings, ideal = axis.lag.copy(), axis.rings.copy(), axis.ideal_rings.copy()
    of = 0 if rows.drive[SWITCHED] else force
    switch(rows.drive, rows.modes, change, axis.force, force, lag[of], rings)
    switch(IDEAL_ROW, rows.ideal_modes, change, axis.force, force, np.zeros(2), ideal)
    return replace(axis, level=level, force=force, lag=lag, rings=rings, ideal_rings=ideal)
