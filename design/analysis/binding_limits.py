"""Which limit binds when: why the reference is no faster."""

from dataclasses import dataclass
from typing import Literal

from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.model.ramps import ramped

Limit = Literal["acceleration", "deceleration", "jerk", "speed", "rest"]

FULL = 1e-9
"""How far from rest or full speed a level may be that counts as there, as of a sum of steps [-]."""

MOMENT = 1e-12
"""Share of the whole that is too short to be an interval: two ramps that meet, rounded [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BindingLimit:
    """An interval in which one limit binds the reference.

    Attributes
    ----------
    from_s, to_s
        Its ends, after the first step [s].
    limit
        The limit to acceleration while the magnitude grows, the one to deceleration while it falls;
        the one to jerk while the acceleration changes; full speed, or rest, while it is held there.
    """

    from_s: float
    to_s: float
    limit: Limit


def binding_limits(command: Impulses, actuator: RateLimited) -> tuple[BindingLimit, ...]:
    """Return which limit binds when, up to the end of the last ramp.

    There is none while a command holds the reference between rest and full speed.

    Parameters
    ----------
    command, actuator
        The command, and its limits.

    Returns
    -------
    tuple of BindingLimit
        In order of time; neighbours differ.
    """
    changes = ramped(command, actuator)
    starts = changes.times_s - command.times_s[0]
    ends = starts + changes.ramps_s
    found: list[BindingLimit] = []

    def add(from_s: float, to_s: float, limit: Limit) -> None:
        if to_s - from_s <= MOMENT * float(ends[-1]):
            return
        if found and found[-1].limit == limit and from_s - found[-1].to_s <= MOMENT * ends[-1]:
            from_s = found.pop().from_s
        found.append(BindingLimit(from_s=from_s, to_s=to_s, limit=limit))

    level, before = 0.0, 0.0
    for start, end, change, growing, bend in zip(
        starts.tolist(),
        ends.tolist(),
        changes.changes,
        changes.accelerates,
        changes.bends,
        strict=True,
    ):
        height = abs(level)
        if height <= FULL:
            add(before, start, "rest")
        elif abs(height - 1) <= FULL:
            add(before, start, "speed")
        straight: Limit = "acceleration" if growing else "deceleration"
        add(start, end, straight if bend == 0 else "jerk")
        level, before = level + float(change), end
    return tuple(found)
