"""What steps up and down in turn leave over a band of frequencies."""

from dataclasses import dataclass

from design.formulations.bands import BandExpressions
from design.formulations.lag_parameters import LAG_PARAMETERS
from design.formulations.symbolic import alternating_steps


@dataclass(frozen=True, slots=True, kw_only=True)
class AlternatingBand:
    """What steps up and down in turn leave at any frequency.

    Attributes
    ----------
    impulses
        Number of impulses, odd.
    switched_order
        Order of the lags of a switched actuator, 1 or 2; 0 for superposed steps of any order.
    ramped
        Whether limits make ramps of the steps, each over before the next begins.
    """

    impulses: int
    switched_order: int
    ramped: bool

    def expressions(self) -> BandExpressions:
        """Build the residual's vector of `alternating_steps`.

        Parameters are as there.

        The residual, not only its zeros: in units of the unshaped step at the same frequency.
        """
        import casadi as ca  # noqa: PLC0415

        gaps = ca.SX.sym("gaps", self.impulses - 1)
        lags = ca.SX.sym("lags", LAG_PARAMETERS[self.ramped])
        steps = alternating_steps(ca.vertsplit(gaps), lags, self.switched_order)
        left = steps.vibration
        if self.ramped:  # the last step is up: its ramp comes before the end
            damping_ratio, accel_ramp = lags[0], lags[5]
            left = left.scaled(ca.exp(-damping_ratio * steps.w * accel_ramp))
        return BandExpressions(
            unknowns=gaps,
            parameters=lags,
            ratio=steps.w,
            vibration=ca.vertcat(left.real, left.imag),
        )
