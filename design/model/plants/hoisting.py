"""A load on a cable that is hoisted or lowered during a move."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NoReturn

from design.checks import MAX_VALUE, require_between, require_scale
from design.errors import InvalidInputError
from design.model.plants.mode import MAX_DAMPING_RATIO, Mode
from design.model.plants.pendulum import STANDARD_GRAVITY_M_S2, Pendulum

MAX_POINTS = 1000
"""Most points of a course of lengths [-]."""

MAX_LENGTH_RATIO = 1000.0
"""Longest over shortest cable of one course: beyond it the equations lose digits [-]."""

MAX_HOISTING_TURN_RAD = 1000 * math.tau
"""Longest course, as the phase of the swing: 1,000 swings, over which the residual keeps 1e-9
[rad]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LengthCourse:
    """A length that is linear in time between points, and held before and after them."""

    times_s: tuple[float, ...]  # Rising, from the first step of the command on, two or more [s]
    values: tuple[float, ...]  # The length at each, > 0 [m]

    def __post_init__(self) -> None:
        object.__setattr__(self, "times_s", tuple(self.times_s))
        object.__setattr__(self, "values", tuple(self.values))
        if not 2 <= len(self.values) <= MAX_POINTS:  # noqa: PLR2004 - a start and an end
            raise InvalidInputError(
                "values",
                f"{len(self.values)} values",
                f"2 to {MAX_POINTS} lengths; a cable that stays is a pendulum",
                code="course_without_change",
            )
        if len(self.times_s) != len(self.values):
            raise InvalidInputError(
                "times_s",
                f"{len(self.times_s)} times",
                f"as many as values, {len(self.values)}",
                code="course_times_unlike_values",
            )
        for number, time_s in enumerate(self.times_s):
            require_between(f"times_s.{number}", time_s, 0.0, MAX_VALUE)
        for number, (earlier_s, later_s) in enumerate(pairwise(self.times_s), start=1):
            if not later_s > earlier_s:
                raise InvalidInputError(
                    f"times_s.{number}",
                    later_s,
                    f"later than the time before it, {earlier_s!r}",
                    code="course_times_not_rising",
                )
        for number, length_m in enumerate(self.values):
            if not length_m > 0:
                raise InvalidInputError(
                    f"values.{number}",
                    length_m,
                    "> 0: no cable is hoisted to or through its suspension",
                    code="hoisted_through_zero",
                )
            require_scale(f"values.{number}", length_m)
        if max(self.values) > MAX_LENGTH_RATIO * min(self.values):
            raise InvalidInputError(
                "values",
                (min(self.values), max(self.values)),
                f"lengths within a factor of {MAX_LENGTH_RATIO:g}",
                code="course_too_wide",
            )

    def at(self, time_s: float) -> float:
        """Return the length at a time [m]."""
        if time_s <= self.times_s[0]:
            return self.values[0]
        points = zip(self.times_s, self.values, strict=True)
        for (t0, l0), (t1, l1) in pairwise(points):
            if time_s < t1:
                return l0 + (l1 - l0) * ((time_s - t0) / (t1 - t0))
        return self.values[-1]


@dataclass(frozen=True, slots=True, kw_only=True)
class Hoisting:
    """A load on a cable of changing length under a trolley, at small angles.

    Its angle obeys ``L x'' + (2 L' + 2 z sqrt(g L)) x' + g x = -v'`` under the acceleration of the
    trolley: the angular momentum of a load on a cable that is wound, with the damping ratio z at
    the frequency of each moment, ``w = sqrt(g / L)``. There is one mode at every moment.
    """

    cable_length_m: LengthCourse  # From the suspension to the centre of the load, over time
    damping_ratio: float = 0.0  # Share of critical damping at each moment, 0 to 0.99 [-]
    gravity_m_s2: float = STANDARD_GRAVITY_M_S2  # Acceleration of free fall, > 0 [m/s^2]

    def __post_init__(self) -> None:
        require_between("damping_ratio", self.damping_ratio, 0.0, MAX_DAMPING_RATIO)
        require_scale("gravity_m_s2", self.gravity_m_s2)
        if self.hoisting_turn_rad > MAX_HOISTING_TURN_RAD:
            raise InvalidInputError(
                "cable_length_m.times_s",
                self.cable_length_m.times_s[-1],
                f"such that the load swings {MAX_HOISTING_TURN_RAD / math.tau:g} times at most "
                f"until then, which it does {self.hoisting_turn_rad / math.tau:.4g} times",
                code="course_too_long",
            )

    def at(self, time_s: float) -> Pendulum:
        """Return the crane whose cable keeps the length of a moment [s]."""
        return Pendulum(
            cable_length_m=self.cable_length_m.at(time_s),
            damping_ratio=self.damping_ratio,
            gravity_m_s2=self.gravity_m_s2,
        )

    @property
    def end_s(self) -> float:
        """When the cable has its last length [s]."""
        return self.cable_length_m.times_s[-1]

    @property
    def last(self) -> Pendulum:
        """The crane when all hoisting is over."""
        return self.at(self.end_s)

    @property
    def shortest(self) -> Pendulum:
        """The crane at its shortest cable."""
        course = self.cable_length_m
        return self.at(course.times_s[course.values.index(min(course.values))])

    @property
    def modes_of_moments(self) -> tuple[Mode, ...]:
        """The swing on each length of the course, for figures about the plant."""
        return tuple(self.at(time_s).mode for time_s in self.cable_length_m.times_s)

    @property
    def hoisting_turn_rad(self) -> float:
        """Turn of the swing from time 0 to the end of the hoisting [rad]."""
        course, root_g = self.cable_length_m, math.sqrt(self.gravity_m_s2)
        turn_rad = course.times_s[0] * root_g / math.sqrt(course.values[0])
        points = zip(course.times_s, course.values, strict=True)
        for (t0, l0), (t1, l1) in pairwise(points):
            turn_rad += 2 * root_g * (t1 - t0) / (math.sqrt(l0) + math.sqrt(l1))
        return turn_rad

    @property
    def mode(self) -> Mode:
        """Raise InvalidInputError: the frequency changes."""
        self._refuse()

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Raise InvalidInputError: the frequency changes."""
        self._refuse()

    def _refuse(self) -> NoReturn:
        raise InvalidInputError(
            "plant.kind",
            "hoisting",
            "a plant that stays as it is: a cable that is hoisted is served in maneuvers, in runs, "
            "and in simulations without a shaper. Give a maneuver, or a pendulum of one length, or "
            "a scheduled one of a range",
            code="plant_that_changes",
        )
