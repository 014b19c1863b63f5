"""Minimum time behind limits, those of a reference, with a tolerance over a band.

As in `ramped`, what follows the limits is a common factor: the residual of the course alone is kept
within the tolerance, and the problem is convex in the slope of the reference.
"""

import math
from dataclasses import dataclass

from design.claims import Promise, within
from design.formulations.gaps import PERIOD_RAD
from design.formulations.ramped import reference_limits
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RampedBandProblem:
    """The course of a limited reference that keeps a tolerance over a band and ends first.

    The reference r goes from 0 to 1 and stays between, and
    ``|integral of r'(t) exp(s(q) (T - t)) dt| <= tolerance`` for every ratio q of the band, T its
    end.

    Attributes
    ----------
    unit_pole
        The mode's pole over its natural frequency [-].
    band
        Lowest and highest ratio of the true frequency to the nominal one [-].
    tolerance
        Largest residual over the band [-].
    ramps_rad
        How long the reference takes from 0 to 1 and from 1 to 0, as steep as it may be [rad].
    natural_frequency_rad_s
        It turns phases into times [rad/s].
    horizon_rad
        Latest end [rad].
    designed_for
        The actuator of the claims.
    jerk
        Largest rate of its slope; None is no limit [1/rad^2].
    """

    unit_pole: complex
    band: tuple[float, float]
    tolerance: float
    ramps_rad: tuple[float, float]
    natural_frequency_rad_s: float
    horizon_rad: float
    designed_for: Actuator
    jerk: float | None = None

    @property
    def claims(self) -> tuple[Promise, ...]:
        """The tolerance over the band."""
        return (within(self.tolerance, self.band),)

    @property
    def last(self) -> float:
        """Level of the reference at its end [-]."""
        return 1.0

    @property
    def farthest_rad(self) -> float:
        """Where the search for an end gives up: nowhere, as there is one [rad]."""
        return math.inf


def ramped_band_problem(
    mode: Mode,
    actuator: RateLimited,
    *,
    half_width: float,
    tolerance: float,
    max_duration_periods: float,
) -> RampedBandProblem:
    """Formulate the fastest shaper over a band behind limits.

    Parameters
    ----------
    mode, actuator
        The plant's mode, and its limits; one lag follows them.
    half_width
        The band goes from 1 less this to 1 plus this, ratios of the frequency [-].
    tolerance
        Largest residual over it [-].
    max_duration_periods
        Latest end in undamped periods of the mode, without a ramp up and a ramp down [-].

    Returns
    -------
    RampedBandProblem
        In phases of the mode.
    """
    w = mode.natural_frequency_rad_s
    steep, jerk = reference_limits(actuator, w)
    rise, fall = (w * ramp_s for ramp_s in actuator.unit_ramps_s)
    return RampedBandProblem(
        unit_pole=mode.pole_rad_s / w,
        band=(1 - half_width, 1 + half_width),
        tolerance=tolerance,
        ramps_rad=steep,
        natural_frequency_rad_s=w,
        horizon_rad=max_duration_periods * PERIOD_RAD + rise + fall,
        designed_for=actuator,
        jerk=jerk,
    )
