"""What drives the plant: actuators whose acceleration and deceleration may differ."""

import math
from dataclasses import dataclass, field
from typing import Literal, overload

import numpy as np
from numpy.polynomial.legendre import leggauss

from design.errors import InvalidInputError
from design.types import (
    LARGEST,
    SMALLEST,
    ComplexArray,
    FloatArray,
    require_between,
    require_scale,
)

Model = Literal["superposed", "switched"]
"""How the two sets share the actuator.

``superposed``: each step excites a response of its own, by its own set (Kim 2011, 3.23-3.26).
``switched``: one actuator, whose state carries over; the set in force is that of the latest change
of the command's magnitude (Kim 2011, 4.2-4.8 and 4.23-4.28).
"""

SMALLEST_DAMPING_RATIO = 0.1
LARGEST_DAMPING_RATIO = 5.0

GENTLE_RAMP = 0.1
"""Turn of a lag's fastest mode over a ramp up to which four Gauss nodes are exact [rad].

Their error is ``turn^8 / 2e9``; the closed form of longer ramps loses a digit to subtraction.
"""

CRITICAL_PHASE = 1e-6
"""Below it, sin(x)/x and cos(x) are 1 to 1e-12: the lag counts as critically damped [rad]."""

GAUSS = tuple((part + 1) / 2 if which == 0 else part / 2 for which, part in enumerate(leggauss(4)))
"""Nodes and weights of Gauss and Legendre on [0, 1] [-]."""

SETTLED_SHARE = 0.8
"""Share of a step after which a step counts as settled (Kim 2011, eq. 3.40) [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Lag:
    """Unit-gain lag of order two or less, ``G(p) = 1 / (1 + first p + second p^2)``.

    Attributes
    ----------
    first_s
        Coefficient of p, >= 0 [s].
    second_s2
        Coefficient of p^2, >= 0 [s^2]; 0 makes it first order, both 0 ideal.
    """

    first_s: float = 0.0
    second_s2: float = 0.0

    @overload
    def denominator(self, pole_rad_s: complex) -> complex: ...
    @overload
    def denominator(self, pole_rad_s: ComplexArray) -> ComplexArray: ...
    def denominator(self, pole_rad_s: complex | ComplexArray) -> complex | ComplexArray:
        """Return ``1 / G`` at one pole or at many [-]."""
        return 1 + pole_rad_s * (self.first_s + pole_rad_s * self.second_s2)

    def settling_time_s(self, share: float = SETTLED_SHARE) -> float:
        """Return the last time at which the step response is outside ``1 ± (1 - share)`` [s].

        Exact: by the exponential for a first-order lag, by bisection between the last extremum
        outside the band and the next for an oscillating one, by bisection for a slow one.
        """
        band = 1 - share
        if self.second_s2 == 0.0:
            return -self.first_s * math.log(band)
        frequency = 1 / math.sqrt(self.second_s2)
        damping = self.first_s * frequency / 2
        if damping < 1:
            # Extrema of the error are at k half periods, exp(-z w t) high.
            half_period = math.pi / (frequency * math.sqrt(1 - damping**2))
            extrema = math.ceil(-math.log(band) / (damping * frequency * half_period)) - 1
            low, high = extrema * half_period, (extrema + 1) * half_period
        else:
            low, high = 0.0, 1 / frequency
            while abs(self.step_error(high)) > band:
                low, high = high, 2 * high
        while high - low > 1e-12 * high:
            middle = (low + high) / 2
            if abs(self.step_error(middle)) > band:
                low = middle
            else:
                high = middle
        return high

    def step_error(self, time_s: float) -> float:
        """Return ``1 - v(t)`` of the unit step response at ``time_s >= 0`` [-]."""
        if self.second_s2 == 0.0:
            return math.exp(-time_s / self.first_s) if self.first_s > 0 else 0.0
        frequency = 1 / math.sqrt(self.second_s2)
        damping = self.first_s * frequency / 2
        phase = frequency * time_s
        root = math.sqrt(abs(damping**2 - 1))
        if root * phase < CRITICAL_PHASE:
            return math.exp(-damping * phase) * (1 + damping * phase)
        if damping < 1:
            wave = math.cos(root * phase) + damping / root * math.sin(root * phase)
            return math.exp(-damping * phase) * wave
        slow, fast = 1 / (damping + root), damping + root
        return (fast * math.exp(-slow * phase) - slow * math.exp(-fast * phase)) / (fast - slow)

    @property
    def corner_rad_s(self) -> float:
        """Undamped frequency of a second-order lag; 0 for the others [rad/s]."""
        return self.second_s2**-0.5 if self.second_s2 > 0 else 0.0


def free_motions(first_s: FloatArray, second_s2: FloatArray, elapsed_s: FloatArray) -> FloatArray:
    """Return how the errors of lags move freely, over times or each over its own, in closed form.

    The state is ``[v - u, v' / corner]``, with ``corner`` of `Lag.corner_rad_s`; a first-order lag
    uses the first entry only, an ideal one is at rest at once.

    Parameters
    ----------
    first_s, second_s2
        Coefficients of the lags [s], [s^2].
    elapsed_s
        Times since a moment, >= 0; its shape and those of the lags broadcast to (...) [s].

    Returns
    -------
    FloatArray
        Matrices from the state at that moment to the state at each time, shape (..., 2, 2) [-].
    """
    second_order = second_s2 > 0
    corner = np.where(second_order, second_s2, 1.0) ** -0.5
    damping = np.where(second_order, first_s * corner / 2, 1.0)
    phase = corner * elapsed_s
    root = np.sqrt(np.abs(damping**2 - 1))
    turn = root * phase
    decay = np.exp(-np.minimum(damping, 1.0) * phase)
    slow = np.exp(-phase / (np.maximum(damping, 1.0) + root))
    # expm1 keeps the digits of two poles that nearly coincide.
    apart = np.where(root == 0, phase, -np.expm1(-2 * turn) / np.where(root == 0, 1.0, 2 * root))
    even = np.where(damping < 1, decay * np.cos(turn), slow * (1 + np.exp(-2 * turn)) / 2)
    odd = np.where(damping < 1, decay * phase * np.sinc(turn / np.pi), slow * apart)
    constant = np.where(first_s > 0, first_s, 1.0)
    alone = np.where(first_s > 0, np.exp(-elapsed_s / constant), 0.0)
    motion = np.zeros((*even.shape, 2, 2))
    motion[..., 0, 0] = np.where(second_order, even + damping * odd, alone)
    motion[..., 0, 1] = np.where(second_order, odd, 0.0)
    motion[..., 1, 0] = np.where(second_order, -odd, 0.0)
    motion[..., 1, 1] = np.where(second_order, even - damping * odd, 0.0)
    return motion


def ramp_responses(first_s: FloatArray, second_s2: FloatArray, ramps_s: FloatArray) -> FloatArray:
    """Return the errors of lags at the end of ramps of their input, each from 1 below to 0.

    The mean of the free motion of a unit error over the ramp: 1 and 0 for a step.

    Parameters
    ----------
    first_s, second_s2
        Coefficients of the lags [s], [s^2].
    ramps_s
        Durations of the ramps, >= 0; its shape and those of the lags broadcast to (...) [s].

    Returns
    -------
    FloatArray
        Of the state ``[error, rate]``, shape (..., 2) [-], [1/s]; 0 for an ideal lag.
    """
    corner = np.where(second_s2 > 0, np.where(second_s2 > 0, second_s2, 1.0) ** -0.5, 0.0)
    slowness = np.where(second_s2 > 0, second_s2, first_s)
    fastest = np.where(second_s2 > 0, first_s, 1.0) / np.where(slowness > 0, slowness, 1.0) + corner
    gentle = fastest * ramps_s <= GENTLE_RAMP
    mean = np.zeros((*gentle.shape, 2))
    for node, weight in zip(*GAUSS, strict=True):
        motion = free_motions(first_s, second_s2, node * ramps_s)
        mean[..., 0] += weight * motion[..., 0, 0]
        mean[..., 1] += weight * corner * motion[..., 1, 0]
    # e + first e' + second e'' = 0, integrated over the ramp.
    last = free_motions(first_s, second_s2, ramps_s)
    lost = 1 - last[..., 0, 0]
    long = np.where(gentle, 1.0, ramps_s)
    closed = np.stack(
        ((first_s * lost - second_s2 * corner * last[..., 1, 0]) / long, -lost / long), axis=-1
    )
    closed[..., 1] *= second_s2 > 0
    return np.where(gentle[..., None], mean, closed)


IDEAL_LAG = Lag()


@dataclass(frozen=True, slots=True, kw_only=True)
class Ideal:
    """An actuator that follows its command at once."""

    model: Model = field(default="superposed", init=False)
    dead_time_s: float = field(default=0.0, init=False)

    @property
    def kind(self) -> str:
        """Its ``kind`` on the wire."""
        return "ideal"

    @property
    def accel_lag(self) -> Lag:
        """Response to a step that increases the magnitude of the command."""
        return IDEAL_LAG

    @property
    def decel_lag(self) -> Lag:
        """Response to a step that decreases the magnitude of the command."""
        return IDEAL_LAG

    @property
    def corner_frequencies_rad_s(self) -> dict[str, float]:
        """Corner frequency of each set that has one [rad/s]."""
        return {}


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstOrder:
    """First-order lag with a time constant for either direction (Kim 2011, 3.5-3.13).

    Attributes
    ----------
    accel_time_constant_s, decel_time_constant_s
        Time constants, >= 0 [s]; 0 is a set that follows at once.
    model
        How the two sets share the actuator.
    dead_time_s
        Delay of all that it does, >= 0 [s]; it shifts the response and changes no residual.
    """

    accel_time_constant_s: float
    decel_time_constant_s: float
    model: Model = "superposed"
    dead_time_s: float = 0.0

    def __post_init__(self) -> None:
        for name in ("accel_time_constant_s", "decel_time_constant_s"):
            value = getattr(self, name)
            if not (value == 0 or SMALLEST <= value <= LARGEST):
                rule = f"0, or between {SMALLEST:g} and {LARGEST:g}"
                raise InvalidInputError(name, value, rule)
        require_between("dead_time_s", self.dead_time_s, 0.0, LARGEST)

    @property
    def kind(self) -> str:
        """Its ``kind`` on the wire."""
        return "first_order"

    @property
    def accel_lag(self) -> Lag:
        """Response to a step that increases the magnitude of the command."""
        return Lag(first_s=self.accel_time_constant_s)

    @property
    def decel_lag(self) -> Lag:
        """Response to a step that decreases the magnitude of the command."""
        return Lag(first_s=self.decel_time_constant_s)

    @property
    def corner_frequencies_rad_s(self) -> dict[str, float]:
        """Corner frequency of each set that has one [rad/s]."""
        constants = {"accel": self.accel_time_constant_s, "decel": self.decel_time_constant_s}
        return {name: 1 / value for name, value in constants.items() if value > 0}


@dataclass(frozen=True, slots=True, kw_only=True)
class SecondOrderSet:
    """One direction of a second-order actuator.

    Attributes
    ----------
    natural_frequency_rad_s
        Undamped natural frequency, > 0 [rad/s].
    damping_ratio
        Share of critical damping, 0.1 to 5 [-].
    """

    natural_frequency_rad_s: float
    damping_ratio: float

    def __post_init__(self) -> None:
        require_scale("natural_frequency_rad_s", self.natural_frequency_rad_s)
        require_between(
            "damping_ratio", self.damping_ratio, SMALLEST_DAMPING_RATIO, LARGEST_DAMPING_RATIO
        )

    @property
    def lag(self) -> Lag:
        """The set as a lag."""
        return Lag(
            first_s=2 * self.damping_ratio / self.natural_frequency_rad_s,
            second_s2=self.natural_frequency_rad_s**-2,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class SecondOrder:
    """Second-order actuator with a set of parameters for either direction (Kim 2011, 3.14-3.26).

    Attributes
    ----------
    accel, decel
        Parameters for steps that increase and decrease the magnitude of the command.
    model
        How the two sets share the actuator.
    dead_time_s
        Delay of all that it does, >= 0 [s]; it shifts the response and changes no residual.
    """

    accel: SecondOrderSet
    decel: SecondOrderSet
    model: Model = "superposed"
    dead_time_s: float = 0.0

    def __post_init__(self) -> None:
        require_between("dead_time_s", self.dead_time_s, 0.0, LARGEST)

    @property
    def kind(self) -> str:
        """Its ``kind`` on the wire."""
        return "second_order"

    @property
    def accel_lag(self) -> Lag:
        """Response to a step that increases the magnitude of the command."""
        return self.accel.lag

    @property
    def decel_lag(self) -> Lag:
        """Response to a step that decreases the magnitude of the command."""
        return self.decel.lag

    @property
    def corner_frequencies_rad_s(self) -> dict[str, float]:
        """Corner frequency of each set that has one [rad/s]."""
        return {
            "accel": self.accel.natural_frequency_rad_s,
            "decel": self.decel.natural_frequency_rad_s,
        }


Unlimited = Ideal | FirstOrder | SecondOrder


@dataclass(frozen=True, slots=True, kw_only=True)
class RateLimited:
    """A limit to acceleration and one to deceleration, and what follows the limited command.

    The command's steps become ramps, steep as the limits allow: the first while the reference's
    magnitude grows, the second while it falls. A command that changes before its ramp is over
    turns the ramp; one that reverses passes zero.

    Attributes
    ----------
    accel_limit_m_s2, decel_limit_m_s2
        Largest rates of the reference, > 0 [m/s^2].
    speed_m_s
        Full speed: what a command of 1 stands for, > 0 [m/s].
    then
        What follows the ramps; its sets are those of the reference's latest change.
    dead_time_s
        Delay of all that it does, >= 0 [s]; it shifts the response and changes no residual.
    """

    accel_limit_m_s2: float
    decel_limit_m_s2: float
    speed_m_s: float
    then: Unlimited = field(default_factory=Ideal)
    dead_time_s: float = 0.0

    def __post_init__(self) -> None:
        for name in ("accel_limit_m_s2", "decel_limit_m_s2", "speed_m_s"):
            require_scale(name, getattr(self, name))
        require_between("dead_time_s", self.dead_time_s, 0.0, LARGEST)
        if self.then.dead_time_s != 0:
            raise InvalidInputError(
                "then.dead_time_s", self.then.dead_time_s, "0: dead_time_s beside it is the delay"
            )

    @property
    def kind(self) -> str:
        """Its ``kind`` on the wire."""
        return "rate_limited"

    @property
    def model(self) -> Model:
        """How the two sets of what follows share the actuator."""
        return self.then.model

    @property
    def accel_lag(self) -> Lag:
        """Response to a reference whose magnitude grows."""
        return self.then.accel_lag

    @property
    def decel_lag(self) -> Lag:
        """Response to a reference whose magnitude falls."""
        return self.then.decel_lag

    @property
    def unit_ramps_s(self) -> tuple[float, float]:
        """Time to full speed and from it [s]."""
        return self.speed_m_s / self.accel_limit_m_s2, self.speed_m_s / self.decel_limit_m_s2

    @property
    def corner_frequencies_rad_s(self) -> dict[str, float]:
        """Corner frequency of each set that has one [rad/s]."""
        return self.then.corner_frequencies_rad_s


Actuator = Unlimited | RateLimited


def unit_ramps_s(actuator: Actuator) -> tuple[float, float]:
    """Return the time that the reference takes to full speed and from it; 0 without limits [s]."""
    return actuator.unit_ramps_s if isinstance(actuator, RateLimited) else (0.0, 0.0)


def require_speed(actuator: Actuator, speed_m_s: float) -> None:
    """Raise InvalidInputError if the limits of a rate-limited actuator are for another speed."""
    if isinstance(actuator, RateLimited) and abs(speed_m_s) != actuator.speed_m_s:
        raise InvalidInputError(
            "speed_m_s", speed_m_s, f"the actuator's own speed_m_s, {actuator.speed_m_s!r}"
        )
