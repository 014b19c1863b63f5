"""The machine: a crane behind two drives and a hoist, commanded as it goes."""

import math
from bisect import insort

import numpy as np

from design.checks import MAX_VALUE, require_between, require_scale
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.moves.speed import require_speed
from design.rig.axis import (
    BLOCKED,
    HIGH,
    HIGH_SWITCH,
    LOW,
    LOW_SWITCH,
    POSITION,
    TIME,
    axis_motion,
    drive_row,
)
from design.rig.crane import (
    AXES,
    CABLES,
    AxisName,
    Crane,
    LimitSwitch,
    SlackCable,
    Stroke,
    require_cable,
)
from design.rig.march import (
    HOIST,
    HOIST_SPEED,
    LEAST_TENSION,
    NOW,
    ROPE_RATE,
    ROW_SIZE,
    SLACK_FOR,
    SLACK_SINCE,
    STROKE,
    SWING,
    SWITCH,
    march,
)
from design.rig.plant import LEAST_HEIGHT
from design.rig.swing import LOWER_Z, STATE_SIZE, UPPER_Z
from design.rig.track import Track
from design.types import FloatArray

FIRST_STEP_S = 0.01
"""What the first step is tried with; the error chooses those after it [s]."""

NO_EVENTS = np.empty((0, 4))
"""What happens between most samples of a controller."""

FASTEST_DRIVE_RAD_S = 1e6
"""Fastest lag that steps through time resolve; an ideal one is exact [rad/s]."""


class Machine:
    """A crane behind two drives and a hoist, at rest at time 0.

    Commands are events: each takes effect at its time, those of a drive a dead time later.
    `advance` goes on through them. A drive that is at a limit switch is commanded to stop, and
    takes no command toward that end until it has left the switch.

    Parameters
    ----------
    crane
        What swings, and how far the axes can go.
    drives
        What drives x and y.
    speed_m_s
        Full speed, > 0: what a level of 1 stands for [m/s].

    Attributes
    ----------
    crane
        The same.
    speed_m_s
        The same.
    switches
        The limit switches that were met, in order.

    Raises
    ------
    InvalidInputError
        If the speed is not > 0, above the crane's, or another than a drive's, or a drive has a lag
        that follows within a microsecond.
    """

    def __init__(self, crane: Crane, drives: tuple[Actuator, Actuator], speed_m_s: float) -> None:
        require_scale("speed_m_s", speed_m_s)
        if speed_m_s > crane.max_speed_m_s:
            raise InvalidInputError(
                "speed_m_s",
                speed_m_s,
                f"at most the largest speed of the axes, {crane.max_speed_m_s:g}",
                code="faster_than_axis",
            )
        for drive in drives:
            require_speed(drive, speed_m_s)
            _require_resolved(drive)
        self.crane = crane
        self.speed_m_s = speed_m_s
        self.switches: list[LimitSwitch] = []
        self._delays_s = tuple(drive.dead_time_s for drive in drives)
        self._clock = np.array([0.0, FIRST_STEP_S])
        self._plant = crane.plant_row
        self._state = np.zeros(STATE_SIZE)
        self._state[[UPPER_Z, LOWER_Z]] = -1.0
        self._axes = np.stack([drive_row(drive, speed_m_s) for drive in drives])
        for row, stroke in zip(self._axes, crane.strokes, strict=True):
            _bound(row, stroke)
        self._rope = np.array([0.0, crane.cable_length_m, 0.0, math.inf, crane.cable_length_m])
        self._slack = np.array([[math.inf, 0.0, math.inf]] * 2)
        self._events: list[tuple[float, float, float, float]] = []

    @property
    def now_s(self) -> float:
        """The time [s]."""
        return float(self._clock[NOW])

    @property
    def pressed(self) -> tuple[int, int]:
        """Side of the limit switch that is pressed in x and y: -1, 0 or 1."""
        return int(self._axes[0, BLOCKED]), int(self._axes[1, BLOCKED])

    @property
    def slack(self) -> tuple[SlackCable, ...]:
        """The cables that would have had to push until now, the upper one first.

        The nonlinear model keeps them taut. A velocity that jumps stands for a short ramp, of which
        no tension is known.
        """
        crane = self.crane
        masses = (crane.hook_mass_kg, 0.0 if crane.load is None else crane.load.mass_kg)
        return tuple(
            SlackCable(
                cable=name,
                at_s=float(row[SLACK_SINCE]),
                duration_s=float(row[SLACK_FOR]),
                push_n=float(-row[LEAST_TENSION]) * mass,
            )
            for name, mass, row in zip(CABLES, masses, self._slack, strict=True)
            if row[SLACK_FOR] > 0
        )

    def command(self, axis: AxisName, level: float, at_s: float | None = None) -> None:
        """Command the velocity of an axis.

        Parameters
        ----------
        axis
            Which.
        level
            Share of full speed, signed; more than 1 where the axis can go faster [-].
        at_s
            When, not before now; now if not given [s].

        Raises
        ------
        InvalidInputError
            If the axis is none, the level is more than it can, or the time is past.
        """
        if axis not in AXES:
            raise InvalidInputError("axis", axis, "x or y", code="unknown_axis")
        most = self.crane.max_speed_m_s / self.speed_m_s
        require_between("level", level, -most, most)
        which = AXES.index(axis)
        insort(self._events, (self._time(at_s) + self._delays_s[which], which, level, 0.0), key=_at)

    def withdraw(self, axis: AxisName) -> None:
        """Forget what an axis was commanded for times to come.

        What was sent within the dead time before now is answered.

        Parameters
        ----------
        axis
            Which.
        """
        which = AXES.index(axis)
        sent_s = self.now_s + self._delays_s[which]
        self._events = [one for one in self._events if one[1] != which or one[0] < sent_s]

    def hoist(self, cable_length_m: float, over_s: float, at_s: float | None = None) -> None:
        """Hoist or lower the hook evenly to a length of the cable.

        Parameters
        ----------
        cable_length_m
            From the trolley to the hook at the end [m].
        over_s
            How long it takes, > 0 [s].
        at_s
            When it begins, not before now; now if not given [s].

        Raises
        ------
        InvalidInputError
            If the cable would be hoisted through zero or be too long, or the time is past.
        """
        require_scale("over_s", over_s)
        require_cable(cable_length_m, self.crane.max_cable_length_m)
        event = (self._time(at_s), float(HOIST), cable_length_m, over_s)
        insort(self._events, event, key=_at)

    def advance(self, until_s: float, times_s: FloatArray | None = None) -> Track:
        """Go on to a time.

        Parameters
        ----------
        until_s
            Where to end, not before now [s].
        times_s
            Times to look at, ascending, from now to the end, shape (n,); the end alone if not
            given [s].

        Returns
        -------
        Track
            What is seen at these times, after the commands of each.

        Raises
        ------
        InvalidInputError
            If an axis goes past its stroke, the hoist is faster than it can be, or a cable swings
            more than 60 degrees: what, where and when.
        """
        times = np.array([until_s]) if times_s is None else times_s
        rows = np.empty((times.size, ROW_SIZE))
        self.advance_into(rows, until_s, times)
        return Track(crane=self.crane, times_s=times, rows=rows)

    def advance_into(self, rows: FloatArray, until_s: float, times_s: FloatArray) -> None:
        """Go on to a time, and write what is seen into rows that somebody has.

        Parameters
        ----------
        rows
            Those of a track, shape (n, ROW_SIZE); overwritten.
        until_s
            Where to end, not before now [s].
        times_s
            Times to look at, as of `advance`, shape (n,) [s].

        Raises
        ------
        InvalidInputError
            As `advance` does.
        """
        require_between("until_s", until_s, self.now_s, MAX_VALUE)
        due = 0
        while due < len(self._events) and self._events[due][0] <= until_s:
            due += 1
        events = np.array(self._events[:due]).reshape(-1, 4) if due else NO_EVENTS
        del self._events[:due]
        event = row = 0
        while True:
            ended, axis, event, row = march(
                self._clock,
                self._plant,
                self._state,
                self._axes,
                self._rope,
                self._slack,
                events,
                event,
                times_s,
                rows,
                row,
                until_s,
            )
            if ended != SWITCH:
                break
            at = AXES[axis], self.now_s, float(self._axes[axis, POSITION])
            self.switches.append(LimitSwitch(axis=at[0], at_s=at[1], position_m=at[2]))
        if ended == STROKE:
            self._raise_stroke(AXES[axis], axis)
        if ended == SWING:
            raise InvalidInputError(
                "events",
                f"a larger one at {self.now_s:.6g} s",
                "such that no cable swings more than 60 degrees from the vertical",
                code="swing_over_60_degrees",
            )
        if ended == HOIST_SPEED:
            raise InvalidInputError(
                "events",
                f"{abs(self._rope[ROPE_RATE]):.6g} m/s at {self.now_s:.6g} s",
                f"such that the hoist goes at most {self.crane.max_speed_m_s:g} m/s",
                code="hoist_too_fast",
            )

    def open_bounds(self) -> None:
        """Let axes go past strokes and switches, and cables swing, from now on."""
        self._plant[LEAST_HEIGHT] = -math.inf
        for row in self._axes:
            row[[LOW, LOW_SWITCH]], row[[HIGH, HIGH_SWITCH]] = -math.inf, math.inf

    def _raise_stroke(self, name: AxisName, axis: int) -> None:
        row = self._axes[axis]
        raise InvalidInputError(
            "events",
            f"{name} = {axis_motion(row, self.now_s - row[TIME])[0]:.6g} m at {self.now_s:.6g} s",
            f"such that {name} stays within its stroke, {row[LOW]:.6g} to {row[HIGH]:.6g} m",
            code="stroke_exceeded",
        )

    def _time(self, at_s: float | None) -> float:
        if at_s is None:
            return self.now_s
        require_between("at_s", at_s, self.now_s, MAX_VALUE)
        return at_s


def _at(event: tuple[float, float, float, float]) -> float:
    return event[0]


def _bound(row: FloatArray, stroke: Stroke | None) -> None:
    """Give an axis its stroke."""
    if stroke is None:
        return
    row[POSITION] = stroke.start_m
    row[LOW], row[HIGH] = 0.0, stroke.length_m
    if stroke.switch_m is not None:
        row[LOW_SWITCH], row[HIGH_SWITCH] = stroke.switch_m, stroke.length_m - stroke.switch_m


def _require_resolved(drive: Actuator) -> None:
    for name, lag in (("accel", drive.accel_lag), ("decel", drive.decel_lag)):
        if lag.second_s2 > 0:
            fastest = lag.first_s / lag.second_s2 + lag.corner_rad_s
        else:
            fastest = 1 / lag.first_s if lag.first_s > 0 else 0.0
        if fastest > FASTEST_DRIVE_RAD_S:
            raise InvalidInputError(
                ("actuator", name),
                f"poles up to {fastest:.3g} rad/s",
                f"of poles up to {FASTEST_DRIVE_RAD_S:g} rad/s here, or ideal",
                code="drive_not_resolved",
            )
