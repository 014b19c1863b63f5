"""Where an axis comes to its limit switches and to the ends of its stroke: compiled."""

import math

from design.rig.axis import (
    BLOCKED,
    HIGH,
    HIGH_SWITCH,
    LOW,
    LOW_SWITCH,
    TIME,
    axis_motion,
)
from design.tables.compiled import compiled
from design.types import FloatArray

HALVINGS = 60
"""Halvings of a step that find a time in it to rounding."""


@compiled
def time_outside(axis: FloatArray, start_s: float, end_s: float) -> float:
    """Return when an axis first passes its next bound.

    The time is infinite if it does not. The bound is a limit switch, or the end of the stroke where
    its switch is pressed already. A velocity that changes its sign does so once within the time.

    Parameters
    ----------
    axis
        The axis, shape (AXIS_SIZE,).
    start_s, end_s
        Within one segment of it [s].

    Returns
    -------
    float
        The time [s].
    """
    low = axis[LOW] if axis[BLOCKED] < 0.0 else max(axis[LOW], axis[LOW_SWITCH])
    high = axis[HIGH] if axis[BLOCKED] > 0.0 else min(axis[HIGH], axis[HIGH_SWITCH])
    if low == -math.inf and high == math.inf:
        return math.inf
    began = axis[TIME]
    before, after = axis_motion(axis, start_s - began), axis_motion(axis, end_s - began)
    if before[1] * after[1] < 0.0:
        inside, beyond = start_s, end_s
        for _ in range(HALVINGS):
            middle = (inside + beyond) / 2
            if axis_motion(axis, middle - began)[1] * before[1] > 0.0:
                inside = middle
            else:
                beyond = middle
        end_s = beyond
        after = axis_motion(axis, end_s - began)
    if low <= after[0] <= high:
        return math.inf
    inside, beyond = start_s, end_s
    for _ in range(HALVINGS):
        middle = (inside + beyond) / 2
        if low <= axis_motion(axis, middle - began)[0] <= high:
            inside = middle
        else:
            beyond = middle
    return beyond


@compiled
def press_switches(axis: FloatArray, time_s: float) -> bool:
    """Note which limit switch is pressed, and whether the stroke ends.

    Parameters
    ----------
    axis
        The axis, shape (AXIS_SIZE,); changed.
    time_s
        A time of its present segment [s].

    Returns
    -------
    bool
        Whether it is past an end.
    """
    position = axis_motion(axis, max(time_s - axis[TIME], 0.0))[0]
    if position > axis[HIGH_SWITCH]:
        axis[BLOCKED] = 1.0
    elif position < axis[LOW_SWITCH]:
        axis[BLOCKED] = -1.0
    else:
        axis[BLOCKED] = 0.0
    return bool(position < axis[LOW] or position > axis[HIGH])
