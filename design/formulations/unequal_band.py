"""Minimum time behind limits and two different lags, a residual within a tolerance over a band."""

from dataclasses import dataclass

import numpy as np

from design.claims import Promise
from design.formulations.ramped import RampedProblem
from design.formulations.ramped_band import RampedBandProblem
from design.formulations.ramped_humps import RampedHumpsProblem
from design.formulations.unequal_ramps import UnequalRampsProblem, unequal_ramps
from design.model.actuators.rate_limited import RateLimited
from design.types import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UnequalBandProblem:
    """The command that keeps a tolerance over a band behind limits and two lags, and ends first.

    As in `unequal_ramps` the command has as many switches as the fastest behind one lag.

    Attributes
    ----------
    alike
        The same with one lag for both directions.
    designed_for
        The limits, and the lags.
    """

    alike: RampedBandProblem
    designed_for: RateLimited

    @property
    def claims(self) -> tuple[Promise, ...]:
        """The tolerance over the band."""
        return self.alike.claims

    def at(self, ratios: FloatArray, orders: FloatArray) -> UnequalRampsProblem:
        """Return the problem whose functionals are the residuals at some ratios.

        Parameters
        ----------
        ratios
            Frequency ratios, shape (k,) [-].
        orders
            0 for the residual, 1 for its derivative in the pole, shape (k,).

        Returns
        -------
        UnequalRampsProblem
            In phases of the nominal mode; its targets are not to be met.
        """
        return residuals_behind_two_lags(self.alike, self.designed_for, ratios, orders)


def residuals_behind_two_lags(
    alike: RampedBandProblem | RampedHumpsProblem,
    actuator: RateLimited,
    ratios: FloatArray,
    orders: FloatArray,
) -> UnequalRampsProblem:
    """Return a problem whose functionals are the residuals at some ratios.

    Parameters
    ----------
    alike
        What is asked behind one lag.
    actuator
        The limits, and the lags.
    ratios
        Frequency ratios, shape (k,) [-].
    orders
        0 for the residual, 1 for its derivative in the pole, shape (k,).

    Returns
    -------
    UnequalRampsProblem
        In phases of the nominal mode; its targets are not to be met.
    """
    residuals = RampedProblem(
        unit_poles=alike.unit_pole * ratios,
        orders=orders,
        targets=np.zeros(ratios.size, dtype=np.complex128),
        ramps_rad=alike.ramps_rad,
        last=1.0,
        natural_frequency_rad_s=alike.natural_frequency_rad_s,
        horizon_rad=alike.horizon_rad,
        earliest_rad=alike.ramps_rad[0],
        designed_for=actuator,
    )
    return unequal_ramps(residuals, actuator)
