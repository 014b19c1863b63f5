"""What a run does: directions, presses, moves, hoists, and played courses, as commands."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.commands import command_of_velocities, convolve, pulse
from design.model.impulses import Impulses
from design.response.closed_form import travel
from design.rig.crane import MAX_CABLE_M, AxisName, require_cable
from design.types import FloatArray

MAX_GAP = 3.0
"""Times that a played course may be longer without a sample than it usually is [-]."""

SAME_TIME_S = 1e-9
"""Within it two events are at one time: rounding of the sum of two times [s]."""

MAX_SHORTENINGS = 60
"""Steps in which the pulse of a move is found: one is enough where no ramps meet."""

EXACT_TRAVEL = 1e-13
"""Share of a distance to which a move is made [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """A level of an axis from a time on.

    Attributes
    ----------
    event
        Which event of the run it belongs to.
    axis
        Which axis.
    at_s
        From when on [s].
    level
        Share of full speed, signed [-].
    for_s
        How long; None until the next event of this axis [s].
    """

    event: int
    axis: AxisName
    at_s: float
    level: float
    for_s: float | None = None

    @property
    def end_s(self) -> float:
        """When it ends by itself; infinite if it does not [s]."""
        return np.inf if self.for_s is None else self.at_s + self.for_s


@dataclass(frozen=True, slots=True, kw_only=True)
class HoistTo:
    """A length of the cable, evenly hoisted to.

    Attributes
    ----------
    event
        Which event of the run it is.
    at_s, over_s
        When it begins, and how long it takes [s].
    cable_length_m
        From the trolley to the hook at its end [m].
    """

    event: int
    at_s: float
    over_s: float
    cable_length_m: float

    def __post_init__(self) -> None:
        require_cable(self.cable_length_m, MAX_CABLE_M)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Played:
    """A course of velocity or position that a controller has recorded or computed.

    Attributes
    ----------
    times_s
        Ascending, shape (n,), n >= 2 [s].
    velocity_m_s
        Velocity of the command, each held until the next time, shape (n,) [m/s].
    """

    times_s: FloatArray
    velocity_m_s: FloatArray

    def __post_init__(self) -> None:
        require_no_gap(self.times_s)


def played_positions(times_s: FloatArray, position_m: FloatArray) -> Played:
    """Return the course that goes evenly from position to position.

    Parameters
    ----------
    times_s
        Ascending, shape (n,), n >= 2 [s].
    position_m
        Where the command is then, shape (n,) [m].

    Returns
    -------
    Played
        Its velocity; 0 from the last time on.

    Raises
    ------
    InvalidInputError
        If times do not ascend or have a gap.
    """
    require_no_gap(times_s)
    velocity = np.append(np.diff(position_m) / np.diff(times_s), 0.0)
    return Played(times_s=times_s, velocity_m_s=velocity)


def require_no_gap(times_s: FloatArray) -> None:
    """Check that times ascend, and that none are missing.

    Parameters
    ----------
    times_s
        Shape (n,) [s].

    Raises
    ------
    InvalidInputError
        If there are fewer than two, one is not after the one before, or a step is three times as
        long as the median one.
    """
    if times_s.size < 2:  # noqa: PLR2004 - a step has two ends
        raise InvalidInputError(
            "times_s", f"{times_s.size} times", "at least two times", code="too_few_samples"
        )
    steps = np.diff(times_s)
    if not np.all(steps > 0):
        at = int(np.argmin(steps > 0))
        raise InvalidInputError(
            "times_s",
            f"{times_s[at + 1]:.9g} after {times_s[at]:.9g} s",
            "ascending",
            code="times_not_ascending",
        )
    usual = float(np.median(steps))
    widest = int(np.argmax(steps))
    if steps[widest] > MAX_GAP * usual:
        raise InvalidInputError(
            "times_s",
            f"nothing from {times_s[widest]:.9g} to {times_s[widest + 1]:.9g} s",
            f"without a gap: steps are {usual:.6g} s",
            code="gap_in_times",
        )


def pulse_of_distance(
    distance_m: float, speed_m_s: float, actuator: Actuator, shaper: Impulses | None
) -> float:
    """Return how long full speed is commanded to travel a distance.

    Parameters
    ----------
    distance_m, speed_m_s
        How far, and full speed, both > 0 [m], [m/s].
    actuator
        The drive.
    shaper
        What the command is convolved with; None if nothing shapes it.

    Returns
    -------
    float
        The time from the start to the stop [s].

    Raises
    ------
    InvalidInputError
        If the drive coasts farther after the shortest pulse.
    """
    length = distance_m / speed_m_s
    for _ in range(MAX_SHORTENINGS):
        if length <= 0:
            break
        command = pulse(length)
        shaped = command if shaper is None else convolve(command, shaper)
        off = travel(shaped, actuator) - distance_m / speed_m_s
        if abs(off) <= EXACT_TRAVEL * (1 + distance_m / speed_m_s):
            return length
        length -= off
    raise InvalidInputError(
        "distance_m",
        distance_m,
        "more than the drive travels from a start to a stop at once",
        code="distance_too_short_to_press",
    )


def steps_of(drives: Sequence[Drive], axis: AxisName) -> tuple[FloatArray, FloatArray]:
    """Return when the level of an axis changes, and to what.

    Parameters
    ----------
    drives
        Of any axes, in any order.
    axis
        Which is asked for.

    Returns
    -------
    tuple of FloatArray
        Times, ascending, and levels, shapes (n,) [s], [-].

    Raises
    ------
    InvalidInputError
        If buttons contradict each other: an axis is given two levels at once.
    """
    ours = sorted((one for one in drives if one.axis == axis), key=lambda one: one.at_s)
    times: list[float] = []
    levels: list[float] = []
    for number, one in enumerate(ours):
        for before in ours[:number]:
            together = abs(before.at_s - one.at_s) <= SAME_TIME_S
            held = before.for_s is not None and one.at_s < before.end_s - SAME_TIME_S
            if (together or held) and (before.level != one.level or before.end_s != one.end_s):
                raise InvalidInputError(
                    ("events", str(one.event), "direction", axis),
                    f"{one.level:g} beside {before.level:g} of events.{before.event}",
                    f"the only command of {axis} at {one.at_s:.6g} s",
                    code="contradictory_buttons",
                )
        if times and one.at_s <= times[-1] + SAME_TIME_S and levels[-1] == 0.0:
            times.pop(), levels.pop()
        times.append(one.at_s)
        levels.append(one.level)
        if one.for_s is not None:
            times.append(one.end_s)
            levels.append(0.0)
    return np.array(times), np.array(levels)


def raise_beside_events(axis: AxisName) -> NoReturn:
    """Raise that a course and events both drive an axis.

    Raises
    ------
    InvalidInputError
        Always.
    """
    raise InvalidInputError(
        ("played", axis),
        "a course",
        f"left out where events drive {axis}",
        code="played_beside_events",
    )


def command_of(
    drives: Sequence[Drive],
    played: Played | None,
    axis: AxisName,
    speed_m_s: float,
    shape: Callable[[Impulses], Impulses],
) -> Impulses | None:
    """Return the command of an axis.

    Parameters
    ----------
    drives
        The events, of any axes.
    played
        A course of this axis in place of events.
    axis
        Which.
    speed_m_s
        Full speed [m/s].
    shape
        What becomes of the command before the drive gets it.

    Returns
    -------
    Impulses or None
        None if the axis is never moved.

    Raises
    ------
    InvalidInputError
        If buttons contradict each other, or a course and events both drive the axis.
    """
    times, levels = steps_of(drives, axis)
    if played is not None:
        if times.size:
            raise_beside_events(axis)
        times, levels = played.times_s, played.velocity_m_s / speed_m_s
    if not np.any(levels):
        return None
    return shape(command_of_velocities(times, levels))
