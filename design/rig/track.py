"""What is seen of the machine at a list of times."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from design.rig.crane import Crane
from design.rig.march import MOTION, ROPE
from design.rig.swing import LOWER, LOWER_RATE, UPPER, UPPER_RATE, WORK
from design.types import FloatArray


@dataclass(frozen=True, eq=False)
class Track:
    """The motion of the machine at n times; columns of two are x and y, of three x, y and z.

    Attributes
    ----------
    crane
        What moved.
    times_s
        Shape (n,) [s].
    rows
        What the compiled march saw, shape (n, ROW_SIZE).
    """

    crane: Crane
    times_s: FloatArray
    rows: FloatArray

    @property
    def position_m(self) -> FloatArray:
        """Of the trolley, shape (n, 2) [m]."""
        return self.rows[:, [MOTION, MOTION + 4]]

    @property
    def velocity_m_s(self) -> FloatArray:
        """Of the trolley, shape (n, 2) [m/s]."""
        return self.rows[:, [MOTION + 1, MOTION + 5]]

    @property
    def acceleration_m_s2(self) -> FloatArray:
        """Of the trolley, shape (n, 2) [m/s^2]; 0 where its velocity jumps."""
        return self.rows[:, [MOTION + 2, MOTION + 6]]

    @property
    def reference_m_s(self) -> FloatArray:
        """Of the drives at the last corner before, shape (n, 2) [m/s]."""
        return self.rows[:, [MOTION + 3, MOTION + 7]]

    @property
    def cable_length_m(self) -> FloatArray:
        """From the trolley to the hook, shape (n,) [m]."""
        return self.rows[:, ROPE]

    @property
    def hoist_m_s(self) -> FloatArray:
        """Rate of that length, shape (n,) [m/s]."""
        return self.rows[:, ROPE + 1]

    @property
    def tension_n(self) -> FloatArray:
        """Of the cable, shape (n,); negative where it would have to push [N]."""
        return self.rows[:, ROPE + 2] * self.crane.hook_mass_kg

    @cached_property
    def hook_m(self) -> FloatArray:
        """Of the hook against the trolley, shape (n, 3) [m]."""
        hook: FloatArray = self.cable_length_m[:, None] * self.rows[:, UPPER : UPPER + 3]
        return hook

    @cached_property
    def load_m(self) -> FloatArray:
        """Of what hangs lowest against the trolley, shape (n, 3) [m]."""
        if self.crane.load is None:
            return self.hook_m
        lower: FloatArray = self.crane.load.length_m * self.rows[:, LOWER : LOWER + 3]
        return self.hook_m + lower

    @property
    def angle_rad(self) -> FloatArray:
        """Of the cable from the vertical in x and y, shape (n, 2) [rad].

        Positive where the hook is ahead of the trolley.
        """
        upper = self.rows[:, UPPER : UPPER + 3]
        if self.crane.model == "linear":
            return upper[:, :2]
        angles: FloatArray = np.arctan2(upper[:, :2], -upper[:, 2:])
        return angles

    @cached_property
    def hook_rate_m_s(self) -> FloatArray:
        """Velocity of the hook against the trolley, shape (n, 3) [m/s]."""
        rate: FloatArray = self.cable_length_m[:, None] * self.rows[:, UPPER_RATE : UPPER_RATE + 3]
        return rate + self.hoist_m_s[:, None] * self.rows[:, UPPER : UPPER + 3]

    @cached_property
    def load_rate_m_s(self) -> FloatArray:
        """Velocity of what hangs lowest against the trolley, shape (n, 3) [m/s]."""
        if self.crane.load is None:
            return self.hook_rate_m_s
        lower: FloatArray = self.crane.load.length_m * self.rows[:, LOWER_RATE : LOWER_RATE + 3]
        return self.hook_rate_m_s + lower

    @property
    def swing_energy_j(self) -> FloatArray:
        """Energy seen from the trolley, above that at rest, (n,) [J].

        An undamped swing under a trolley that goes evenly keeps it; the amplitude of a small swing
        goes with its root. Damped, the velocity counts as that of ``exp(z w t)`` times the swing,
        and the stiffness less accordingly: so of the linear model it falls by ``exp(-2 z w t)``,
        without a wave.
        """
        crane, gravity = self.crane, self.crane.gravity_m_s2
        decay = crane.decays_s(self.cable_length_m)[:, None]
        lift = self._lift_m(UPPER, self.cable_length_m)
        parts = [(crane.hook_mass_kg, lift, self.hook_m)]
        rates = [self.hook_rate_m_s]
        if crane.load is not None:
            lift = lift + self._lift_m(LOWER, crane.load.length_m)
            parts.append((crane.load.mass_kg, lift, self.load_m))
            rates.append(self.load_rate_m_s)
        total: FloatArray = np.zeros(self.times_s.size)
        for (mass, height, place), rate in zip(parts, rates, strict=True):
            moved, beside = rate.copy(), place.copy()
            beside[:, 2] = 0.0
            if crane.model == "linear":
                moved[:, 2] = 0.0
            squares = ((moved + decay * beside) ** 2 - (decay * beside) ** 2).sum(axis=1)
            total = total + mass * (gravity * height + squares / 2)
        return total

    def _lift_m(self, vector: int, length_m: FloatArray | float) -> FloatArray:
        """Return how far the lower end of a cable is above hanging, shape (n,) [m]."""
        x, y, z = self.rows[:, vector : vector + 3].T
        if self.crane.model == "linear":
            raised: FloatArray = length_m * (x**2 + y**2) / 2
        else:
            # 1 + z of a unit vector, without the digits that it would lose.
            raised = length_m * (x**2 + y**2) / (1 - z)
        return raised

    @property
    def energy_j(self) -> FloatArray:
        """Kinetic and potential energy of all that hangs, (n,) [J].

        The velocities are those that somebody at rest sees. Heights count from the trolley.
        """
        crane, trolley = self.crane, np.pad(self.velocity_m_s, ((0, 0), (0, 1)))
        parts = [(crane.hook_mass_kg, self.hook_m, self.hook_rate_m_s)]
        if crane.load is not None:
            parts.append((crane.load.mass_kg, self.load_m, self.load_rate_m_s))
        total: FloatArray = np.zeros(self.times_s.size)
        for mass, place, rate in parts:
            speeds = ((rate + trolley) ** 2).sum(axis=1)
            total = total + mass * (crane.gravity_m_s2 * place[:, 2] + speeds / 2)
        return total

    @property
    def work_j(self) -> FloatArray:
        """Work of trolley, hoist and drag since the start, (n,) [J]."""
        return self.rows[:, WORK] * self.crane.hook_mass_kg
