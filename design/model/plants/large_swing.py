"""A load on a cable that swings far: the crane of one full speed."""

import math
from dataclasses import dataclass

from design.checks import require_scale
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.plants.pendulum import Pendulum

MAX_SWING_RAD = math.pi / 3
"""Largest angle of the cable from the vertical: beyond it a crane is out of control [rad]."""

TIME_CONSTANTS = 34.0
"""Of the slowest mode of a drive, after which it is at rest: e^-34, less than 1e-14 [-]."""

MAX_DECAY = 8.0
"""Decay over which a swing is followed back: rounding of 1e-16 becomes 3e-13, and that of a slope
5e-10 [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LargeSwing:
    """A load whose swing is as large as a full speed makes it.

    The angle x of the cable obeys ``L x'' + 2 z w L x' + g sin x = -a cos x``, with a the
    trolley's acceleration and ``w^2 = g / L``.
    """

    crane: Pendulum  # The load on its cable
    speed_m_s: float  # Full speed, > 0: what a command of 1 stands for [m/s]

    def __post_init__(self) -> None:
        require_scale("speed_m_s", self.speed_m_s)

    @property
    def small_angle_rad(self) -> float:
        """Angle after a sudden step of full speed, by the linear plant [rad]."""
        return self.speed_m_s / math.sqrt(self.crane.gravity_m_s2 * self.crane.cable_length_m)

    def settled_s(self, actuator: Actuator, ratio: float = 1.0) -> float:
        """Return how long after its last step a drive is at rest.

        What remains of a swing is seen at this moment: afterwards it is free.

        Parameters
        ----------
        actuator
            A drive without limits to the acceleration.
        ratio
            Largest frequency over the nominal one that is asked for [-].

        Returns
        -------
        float
            0 of an ideal drive [s].

        Raises
        ------
        InvalidInputError
            If the load forgets the swing before that.
        """
        settled_s = self._settled_s(actuator)
        most = self.most_ratio(actuator)
        if ratio > most:
            damping = self.crane.damping_ratio
            highest = math.floor(1e4 * damping * most / ratio) / 1e4
            raise InvalidInputError(
                "plant.damping_ratio",
                damping,
                f"at most {highest:g} behind a drive that comes to rest {settled_s:.4g} s after "
                "its last step: by then a large swing has died away",
                code="swing_dies_before_drive",
            )
        return settled_s

    def most_ratio(self, actuator: Actuator) -> float:
        """Return the largest frequency ratio at which no swing is forgotten [-].

        Before the drive is at rest; infinite of a load or a drive that allows any.
        """
        mode = self.crane.mode
        decay = mode.damping_ratio * mode.natural_frequency_rad_s * self._settled_s(actuator)
        return MAX_DECAY / decay if decay > 0 else math.inf

    def _settled_s(self, actuator: Actuator) -> float:
        constants = [0.0]
        for lag in (actuator.accel_lag, actuator.decel_lag):
            if lag.second_s2 == 0.0:
                constants.append(lag.first_s)
                continue
            corner = lag.corner_rad_s
            damping = lag.first_s * corner / 2
            root = math.sqrt(max(damping**2 - 1, 0.0))
            constants.append((damping + root if damping > 1 else 1 / damping) / corner)
        return TIME_CONSTANTS * max(constants)


@dataclass(frozen=True, slots=True, kw_only=True)
class SwingFigures:
    """What is known of a shaper for large swings."""

    swing: LargeSwing  # The load, and the full speed at which the shaper is exact
    largest_rad: float  # Largest angle of the cable from the vertical on the way [rad]
