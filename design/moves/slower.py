"""A move too short for its steps at full speed, made at a lower one."""

from dataclasses import replace

from design.errors import DesignError
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.registry import Plant
from design.moves.designed_parts import designed_parts
from design.moves.parts import Parts
from design.moves.rest_to_rest import WholeCommand, apart_over_distance
from design.response.closed_form import travel
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.solvers.budget import Budget

ROOM = 0.98
"""Share of the speed at which start and stop just fit that is tried first [-]."""

SLOWER = 0.7
"""Each speed that is tried over the one before [-]."""

SPEEDS = 4

LOWEST = 0.01
"""Share of the speed below which a move is not the one that was asked for [-]."""


def slower(
    parts: Parts, wanted_s: float, plant: Plant, kind: ShaperKind, options: ShaperOptions
) -> WholeCommand | None:
    """Return a move at a speed at which start and stop do not overlap.

    The highest of those tried is taken. At a lower speed the same distance takes longer, and each
    step has its time to settle. The command is in proportion to the speed; only the ramps of limits
    are not, which are shorter.

    Parameters
    ----------
    parts
        Start and stop at full speed, of a payload at rest.
    wanted_s
        Distance over the full speed, > 0 [s].
    plant, kind, options
        What start and stop are designed for and by.

    Returns
    -------
    WholeCommand or None
        On levels 0 and the lower speed; None where none was found.
    """
    if parts.peak != 1 or parts.swing is not None or not parts.apart:
        return None
    shortest_s = travel(parts.whole(parts.shortest_pulse_s), parts.actuator)
    share = ROOM * wanted_s / shortest_s if shortest_s > 0 else 0.0
    budget = Budget()
    for _ in range(SPEEDS):
        if not LOWEST <= share <= ROOM:
            break
        try:
            slow = _at(parts, share, plant, kind, options, budget)
        except DesignError:  # there are others
            slow = None
        _, found = (0.0, None) if slow is None else apart_over_distance(slow, wanted_s / share)
        if found is not None:
            steps = replace(found.command, amplitudes=share * found.command.amplitudes)
            return replace(found, command=steps, share=share)
        share *= SLOWER
    return None


def _at(
    parts: Parts,
    share: float,
    plant: Plant,
    kind: ShaperKind,
    options: ShaperOptions,
    budget: Budget,
) -> Parts:
    """Return start and stop at a share of the speed, each over that speed."""
    drive = parts.actuator
    if not isinstance(drive, RateLimited):
        return parts
    jerk = drive.jerk_limit_m_s3
    slower_drive = replace(
        drive,
        accel_limit_m_s2=drive.accel_limit_m_s2 / share,
        decel_limit_m_s2=drive.decel_limit_m_s2 / share,
        jerk_limit_m_s3=None if jerk is None else jerk / share,
    )
    return designed_parts(plant, slower_drive, kind, options, budget)
