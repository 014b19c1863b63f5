"""A third route: drive and payload as one linear system from event to event, by SciPy's `expm`.

It shares no code with the package but the records that hold parameters. The state is deflection
and its rate, the way travelled, value and rate of the lag of either set, and what each of them
follows with its slope: ``[d, d', p, v0, v0', v1, v1', r0, r1, s0, s1]``, set 0 decelerating. With
``d'' + 2 z w d' + w^2 d = -v'``, all for a speed of 1.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import expm

from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.types import FloatArray
from tests.second_route import denominator, increases, without_limits

SIZE = 11


@dataclass(frozen=True, slots=True)
class Event:
    """A change of what the lags follow: when, of which set, the jump and the slope from then on."""

    time_s: float
    force: int
    jump: float
    slope: float


def events_of(command: Impulses, actuator: Actuator) -> list[Event]:
    """Return what a command makes the lags follow, event by event."""
    rising = increases(command)
    if not isinstance(actuator, RateLimited):
        steps = zip(command.times_s.tolist(), rising, command.amplitudes.tolist(), strict=True)
        return [Event(time, int(up), height, 0.0) for time, up, height in steps]
    rates = [
        limit / actuator.speed_m_s
        for limit in (actuator.decel_limit_m_s2, actuator.accel_limit_m_s2)
    ]
    found: list[Event] = []
    now = level = 0.0
    total = float(np.abs(command.amplitudes).sum())
    ends = [*command.times_s[1:].tolist(), math.inf]
    for start, end, height in zip(
        command.times_s.tolist(), ends, command.amplitudes.tolist(), strict=True
    ):
        level += height
        level = 0.0 if abs(level) < 1e-12 * total else level
        time = start
        while now != level and time < end:
            target = 0.0 if now * level < 0 else level
            force = int(abs(target) > abs(now))
            slope = math.copysign(rates[force], target - now)
            arrives = time + (target - now) / slope
            found.append(Event(time, force, 0.0, slope))
            if arrives > end:
                now, time = now + slope * (end - time), end
            else:
                now, time = target, arrives
                found.append(Event(time, force, 0.0, 0.0))
        if time < end and now == level and found:
            found.append(Event(max(time, start), found[-1].force, 0.0, 0.0))
    return found


def end_s(command: Impulses, actuator: Actuator) -> float:
    """Return when what the lags follow has come to rest [s]."""
    return max(float(command.times_s[-1]), events_of(command, actuator)[-1].time_s)


class Simulation:
    """Drive and payload, moved from event to event."""

    def __init__(self, mode: Mode, actuator: Actuator) -> None:
        self.mode = mode
        self.drive = actuator.then if isinstance(actuator, RateLimited) else actuator
        self.lags = [denominator(self.drive, accel=accel) for accel in (False, True)]
        ideal = isinstance(self.drive, Ideal)
        self.switched = not ideal and self.drive.model == "switched"
        self.state = np.zeros(SIZE)
        self.force = 1
        self.time_s = 0.0
        self._matrices = [self._matrix(force) for force in (0, 1)]

    def _matrix(self, force: int) -> FloatArray:
        w, z = self.mode.natural_frequency_rad_s, self.mode.damping_ratio
        a = np.zeros((SIZE, SIZE))
        a[0, 1] = 1.0
        a[1, 0], a[1, 1] = -w * w, -2 * z * w
        a[7, 9] = a[8, 10] = 1.0
        for index, (first, second) in enumerate(self.lags):
            if self.switched and index != force:
                continue
            value, rate = 3 + 2 * index, 4 + 2 * index
            followed = [7, 8] if self.switched else [7 + index]
            slopes = [9, 10] if self.switched else [9 + index]
            if second > 0:
                a[value, rate] = 1.0
                a[rate, followed] = 1 / second
                a[rate, value], a[rate, rate] = -1 / second, -first / second
            elif first > 0:
                a[value, followed] = 1 / first
                a[value, value] = -1 / first
            else:
                a[value, slopes] = 1.0
            a[1] -= a[value]
            a[2, value] = 1.0
        return a

    def move_to(self, time_s: float) -> None:
        """Move on freely."""
        if time_s > self.time_s:
            flow = expm(self._matrices[self.force] * (time_s - self.time_s))
            self.state = flow @ self.state
            self.time_s = time_s

    def take(self, event: Event) -> None:
        """Move to an event and take it."""
        self.move_to(event.time_s)
        x, force = self.state, event.force
        x[7 + force] += event.jump
        x[9], x[10] = 0.0, 0.0
        x[9 + force] = event.slope
        if self.switched and force != self.force:
            was, now = 3 + 2 * self.force, 3 + 2 * force
            x[now : now + 2] = x[was : was + 2]
            x[was : was + 2] = 0.0
        if self.switched:
            self.force = force
        value = 3 + 2 * force
        if self.lags[force] == (0.0, 0.0):
            reached = x[7] + x[8] if self.switched else x[7 + force]
            x[1] -= reached - x[value]
            x[value], x[value + 1] = reached, 0.0

    @property
    def velocity(self) -> float:
        """Velocity of the drive."""
        return float(self.state[3] + self.state[5])

    @property
    def way_to_rest(self) -> float:
        """How far the lags still go: of ``first v' + second v'' = u - v`` the integral."""
        way = 0.0
        for index, (first, second) in enumerate(self.lags):
            if self.switched and index != self.force:
                continue
            value, rate = self.state[3 + 2 * index], self.state[4 + 2 * index]
            followed = self.state[7] + self.state[8] if self.switched else self.state[7 + index]
            way += first * float(value - followed)
            way += second * float(rate)
        return way

    @property
    def ringing(self) -> complex:
        """The vibration that rings on, as a vector that turns with the pole.

        That of the payload now, and what the lags will add on their way to rest: the component of
        the mode, by its left eigenvector, where all slopes have ended.
        """
        w, z = self.mode.natural_frequency_rad_s, self.mode.damping_ratio
        pole = w * complex(-z, math.sqrt(1 - z * z))
        lags = slice(3, 7)
        matrix = self._matrices[self.force]
        payload = np.array([-pole.conjugate(), 1.0])
        shifted = pole * np.eye(4) - matrix[lags, lags].T
        of_lags = np.linalg.solve(shifted, matrix[:2, lags].T @ payload)
        still = self.state[lags].copy()
        if self.switched:
            still[2 * self.force] -= self.state[7] + self.state[8]
        else:
            still[[0, 2]] -= self.state[7:9]
        return complex(payload @ self.state[:2] + of_lags @ still)


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What a command leaves.

    ``vector`` and ``unit`` are the vibrations of the command and of an unshaped step, seen at the
    first step of each.
    """

    vector: complex
    unit: complex
    residual: float
    travel: float


def outcome(
    command: Impulses,
    mode: Mode,
    actuator: Actuator,
    initial: tuple[float, float] = (0.0, 0.0),
) -> Outcome:
    """Play a command; ``initial`` is the payload's deflection and rate, over the speed."""
    pole = mode.pole_rad_s

    def ringing(
        played: Impulses, behind: Actuator, begun: tuple[float, float]
    ) -> tuple[complex, Simulation]:
        moving = Simulation(mode, behind)
        moving.state[:2] = begun
        moving.time_s = float(played.times_s[0])
        for event in events_of(played, behind):
            moving.take(event)
        moving.move_to(end_s(played, behind))
        return moving.ringing, moving

    left, moved = ringing(command, actuator, initial)
    step = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
    unit, _ = ringing(step, without_limits(actuator), (0.0, 0.0))
    return Outcome(
        vector=complex(
            left * np.exp(-pole * (end_s(command, actuator) - float(command.times_s[0])))
        ),
        unit=unit,
        residual=abs(left) / abs(unit),
        travel=float(moved.state[2]) + moved.way_to_rest,
    )


def slope(
    command: Impulses,
    mode: Mode,
    actuator: Actuator,
    initial: tuple[float, float] = (0.0, 0.0),
    *,
    initial_power: int = 0,
    step: float = 3e-6,
) -> float:
    """Return |dV/d ln w| over the unshaped step, as it has decayed by the end.

    The derivative is a quotient of the fourth order: of long commands, whose phase turns by a
    hundred radians, one of the second order is off by 1e-6. The initial swing goes with the
    frequency to the power ``initial_power``: -2 where it is known by the angle of a pendulum, whose
    length is ``g / w^2``.
    """

    def vector(change: float) -> complex:
        shifted = replace(mode, natural_frequency_rad_s=mode.natural_frequency_rad_s * (1 + change))
        scale = (1 + change) ** initial_power
        begun = (initial[0] * scale, initial[1] * scale)
        return outcome(command, shifted, actuator, begun).vector

    near, far = (vector(k * step) - vector(-k * step) for k in (1, 2))
    unit = abs(outcome(command, mode, actuator).unit)
    lasting = end_s(command, actuator) - float(command.times_s[0])
    decayed = math.exp(mode.pole_rad_s.real * lasting)
    return float(abs(8 * near - far) / (12 * step) * decayed / unit)


def history(
    command: Impulses, mode: Mode, actuator: Actuator, times_s: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return deflection [s, over a speed of 1] and velocity at times, shape (n,) each."""
    moving = Simulation(mode, actuator)
    moving.time_s = min(float(command.times_s[0]), float(times_s.min()))
    pending = events_of(command, actuator)
    found = []
    for time in np.sort(times_s).tolist():
        while pending and pending[0].time_s <= time:
            moving.take(pending.pop(0))
        moving.move_to(time)
        found.append((float(moving.state[0]), moving.velocity))
    deflection, velocity = np.array(found).T
    return deflection, velocity
