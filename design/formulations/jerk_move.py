"""What limits to the jerk make of a move: its highest level, and the pulses of a short one."""

import math

from design.model.actuators.rate_limited import RateLimited
from design.model.jerk_ramps import jerk_limited_pieces
from design.types import FloatArray

HALVINGS = 100
"""Halvings after which a bracket is rounding."""


def whole_ramp_rad(straight_rad: float, jerk: float | None) -> float:
    """Return how long a ramp from rest at 0 to rest at 1 takes.

    Parameters
    ----------
    straight_rad
        The same at its steepest slope throughout [rad].
    jerk
        Largest rate of the slope; None is no limit [1/rad^2].

    Returns
    -------
    float
        From rest to rest [rad].
    """
    if jerk is None:
        return straight_rad
    if 1 / straight_rad**2 < jerk:
        return straight_rad + 1 / (straight_rad * jerk)
    return 2 / math.sqrt(jerk)


def highest_level(travel_rad: float, straight_rad: tuple[float, float], jerk: float) -> float:
    """Return the highest level from which a move may brake at once.

    Parameters
    ----------
    travel_rad
        Its travel over full speed [rad].
    straight_rad
        How long ramps up and down take at their steepest slopes throughout [rad].
    jerk
        Largest rate of the slope [1/rad^2].

    Returns
    -------
    float
        At most 1: the level of full speed [-].
    """

    def travelled(level: float) -> float:
        # Over a lower level all is as if limits were higher.
        ramps = [whole_ramp_rad(level * one, jerk / level) for one in straight_rad]
        return level * sum(ramps) / 2

    if travelled(1.0) <= travel_rad:
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if travelled(middle) < travel_rad else (low, middle)
    return high


def smooth_pulses(
    begins_rad: FloatArray, travels_rad: FloatArray, straight_rad: tuple[float, float], jerk: float
) -> tuple[list[float], list[float]] | None:
    """Return when pulses of given travels are switched, and when each is over.

    Parameters
    ----------
    begins_rad, travels_rad
        When each begins, and its travel, shape (n,) [rad].
    straight_rad, jerk
        As of `highest_level`.

    Returns
    -------
    tuple of lists, or None
        Switches up and down in turn, and ends [rad]; None where a pulse would reach full speed.
    """
    drive = RateLimited(
        accel_limit_m_s2=1 / straight_rad[0],
        decel_limit_m_s2=1 / straight_rad[1],
        speed_m_s=1.0,
        jerk_limit_m_s3=jerk,
    )

    def pulse(width: float) -> tuple[float, float]:
        pieces = jerk_limited_pieces([0.0, width], [1.0, 0.0], drive, jerk)
        area = -sum(
            change * (start + duration * (1 / 2 + bend / 6))
            for start, duration, change, _, bend in pieces
        )
        return area, pieces[-1][0] + pieces[-1][1]

    switches: list[float] = []
    ends: list[float] = []
    whole = whole_ramp_rad(straight_rad[0], jerk)
    for begin, travel in zip(begins_rad.tolist(), travels_rad.tolist(), strict=True):
        low, high = 0.0, whole
        if pulse(whole)[0] < travel:
            return None
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if pulse(middle)[0] < travel else (low, middle)
        switches += [begin, begin + high]
        ends.append(begin + pulse(high)[1])
    return switches, ends
