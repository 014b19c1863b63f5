"""Minimum time behind limits to acceleration that two different lags follow.

What is left is no longer linear in the slope of the reference: rising, it is answered by one set,
falling, by the other, and a switched drive passes its state on. The course is one of so many
switches as the problem says; without that, ever shorter dips would mix the sets at will.
"""

from dataclasses import dataclass, replace

import numpy as np

from design.claims import Promise
from design.formulations.ramped import RampedProblem
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.types import ComplexArray, FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UnequalRampsProblem:
    """The command whose reference meets its targets behind two lags and ends first.

    Attributes
    ----------
    alike
        The same with one lag for both directions. Its targets, over the accelerating set, and its
        horizon hold here too; each of its functionals with a pole is over that set.
    first_rad, second_rad2
        Coefficients of the lags, accelerating before decelerating, shape (2,) each [rad],
        [rad^2].
    switched
        Whether one state passes from set to set, or each ramp is answered by its own.
    ceiling
        Full speed. The other takes as 1 the highest that a short move reaches behind one lag, and
        behind two it may be higher [-].
    designed_for
        The actuator of the claims.
    claims
        None: zeros, as the kind says.
    """

    alike: RampedProblem
    first_rad: FloatArray
    second_rad2: FloatArray
    switched: bool
    ceiling: float
    designed_for: Actuator
    claims: tuple[Promise, ...] = ()

    @property
    def natural_frequency_rad_s(self) -> float:
        """The frequency that turns phases into times [rad/s]."""
        return self.alike.natural_frequency_rad_s

    @property
    def gains(self) -> ComplexArray:
        """Gain of either set, then its derivative in s, shape (2, 2, m).

        The first axis is that of derivatives. Both are over the gain of the accelerating set; not
        those at a pole of 0, where the gain is 1 and its derivative the delay of the set.
        """
        s = self.alike.unit_poles
        first, second = self.first_rad[:, None], self.second_rad2[:, None]
        below, rates = 1 + s * (first + s * second), first + 2 * s * second
        over = np.where(s == 0, 1.0, below[0])
        over_rates = np.where(s == 0, 0.0, rates[0])
        return np.stack((over / below, (over_rates * below - over * rates) / below**2))


def unequal_ramps(alike: RampedProblem, actuator: RateLimited) -> UnequalRampsProblem:
    """Formulate a shaper or a move behind limits that two lags follow.

    Parameters
    ----------
    alike
        The same with one lag for both directions.
    actuator
        The limits, and what follows them.

    Returns
    -------
    UnequalRampsProblem
        In the phases of the other.
    """
    w = alike.natural_frequency_rad_s
    lags = (actuator.accel_lag, actuator.decel_lag)
    return UnequalRampsProblem(
        alike=alike,
        first_rad=np.array([w * lag.first_s for lag in lags]),
        second_rad2=np.array([w * w * lag.second_s2 for lag in lags]),
        switched=actuator.model == "switched",
        ceiling=w * actuator.straight_ramps_s[0] / alike.ramps_rad[0],
        designed_for=actuator,
    )


def without_travel(problem: UnequalRampsProblem) -> UnequalRampsProblem:
    """Return a move whose distance is open."""
    alike, swings = problem.alike, problem.alike.unit_poles != 0
    reduced = replace(
        alike,
        unit_poles=alike.unit_poles[swings],
        orders=alike.orders[swings],
        targets=alike.targets[swings],
    )
    return replace(problem, alike=reduced)
