"""Humps of one height behind limits to acceleration that two different lags follow."""

from dataclasses import dataclass

from design.claims import Promise
from design.formulations.ramped_humps import RampedHumpsProblem
from design.formulations.unequal_band import residuals_behind_two_lags
from design.formulations.unequal_ramps import UnequalRampsProblem
from design.model.actuators.rate_limited import RateLimited
from design.types import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UnequalHumpsProblem:
    """The command with humps of one height behind limits and two lags.

    Attributes
    ----------
    alike
        The same with one lag for both directions.
    designed_for
        The limits, and the lags.
    """

    alike: RampedHumpsProblem
    designed_for: RateLimited

    @property
    def claims(self) -> tuple[Promise, ...]:
        """The nominal residual, and the tolerance over the widest band."""
        return self.alike.claims

    def at(self, ratios: FloatArray, orders: FloatArray) -> UnequalRampsProblem:
        """Return the problem whose functionals are the residuals at some ratios.

        Parameters
        ----------
        ratios, orders
            As of `residuals_behind_two_lags`.

        Returns
        -------
        UnequalRampsProblem
            In phases of the nominal mode; its targets are not to be met.
        """
        return residuals_behind_two_lags(self.alike, self.designed_for, ratios, orders)
