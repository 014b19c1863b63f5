"""Humps of one height behind limits to acceleration, over every course of the reference."""

from dataclasses import dataclass

import numpy as np

from design.claims import ZERO_LIMITS, Promise, within
from design.formulations.gaps import PERIOD_RAD
from design.formulations.jerk_move import whole_ramp_rad
from design.formulations.ramped import RampedProblem, reference_limits
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.mode import Mode
from design.types import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RampedHumpsProblem:
    """The fastest course with zeros so far apart that the humps between have one height.

    One hump is at the nominal frequency, two are on either side of a zero there.

    Attributes
    ----------
    unit_pole
        The mode's pole over its natural frequency [-].
    zeros
        Frequency ratios near the zeros below and above the nominal frequency [-].
    humps
        Number of humps, 1 or 2.
    tolerance
        Their height [-].
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
    zeros: tuple[float, float]
    humps: int
    tolerance: float
    ramps_rad: tuple[float, float]
    natural_frequency_rad_s: float
    horizon_rad: float
    designed_for: RateLimited
    jerk: float | None = None

    @property
    def claims(self) -> tuple[Promise, ...]:
        """The nominal residual, and the tolerance over the widest band."""
        nominal = self.tolerance if self.humps == 1 else ZERO_LIMITS["residual"]
        return (Promise(quantity="residual", limit=nominal), within(self.tolerance, band=None))

    def with_zeros(
        self, below: float, above: float, switches: tuple[FloatArray, ...]
    ) -> RampedProblem:
        """Return the problem of the fastest course with given zeros.

        Parameters
        ----------
        below, above
            Frequency ratios of the outer zeros [-].
        switches
            Switches to begin with, shape (n,) each [rad].

        Returns
        -------
        RampedProblem
            In phases of the mode.
        """
        ratios = [below, above] if self.humps == 1 else [below, 1.0, above]
        return RampedProblem(
            unit_poles=self.unit_pole * np.array(ratios),
            orders=np.zeros(len(ratios)),
            targets=np.zeros(len(ratios), dtype=np.complex128),
            ramps_rad=self.ramps_rad,
            last=1.0,
            natural_frequency_rad_s=self.natural_frequency_rad_s,
            horizon_rad=self.horizon_rad,
            earliest_rad=max(whole_ramp_rad(self.ramps_rad[0], self.jerk), PERIOD_RAD / 2),
            farthest_rad=self.horizon_rad + PERIOD_RAD,
            designed_for=self.designed_for,
            seeds=switches,
            seed_name="humps",
            jerk=self.jerk,
        )


def ramped_humps_problem(
    mode: Mode,
    actuator: RateLimited,
    *,
    zeros: tuple[float, float],
    humps: int,
    tolerance: float,
    max_duration_periods: float,
) -> RampedHumpsProblem:
    """Formulate the fastest shaper with humps behind limits.

    Parameters
    ----------
    mode, actuator
        The plant's mode, and its limits; one lag follows them.
    zeros
        Outer zeros of the shaper without limits, ratios of the frequency [-].
    humps, tolerance
        Number of humps, 1 or 2, and their height [-].
    max_duration_periods
        Latest end in undamped periods of the mode, without a ramp up and a ramp down [-].

    Returns
    -------
    RampedHumpsProblem
        In phases of the mode.
    """
    w = mode.natural_frequency_rad_s
    rise, fall = (w * ramp_s for ramp_s in actuator.unit_ramps_s)
    steep, jerk = reference_limits(actuator, w)
    return RampedHumpsProblem(
        unit_pole=mode.pole_rad_s / w,
        zeros=zeros,
        humps=humps,
        tolerance=tolerance,
        ramps_rad=steep,
        natural_frequency_rad_s=w,
        horizon_rad=max_duration_periods * PERIOD_RAD + rise + fall,
        designed_for=actuator,
        jerk=jerk,
    )
