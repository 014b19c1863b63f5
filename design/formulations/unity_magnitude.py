"""Shapers of steps up and down, mostly [1, -1, 1, ...]: their equations.

All is dimensionless: phases are times the plant's natural frequency, lags are scaled alike.
"""

from dataclasses import dataclass

from design.formulations.expressions import Expressions
from design.formulations.lag_parameters import LAG_PARAMETERS
from design.formulations.symbolic import alternating_steps, with_slopes, with_swing


@dataclass(frozen=True, slots=True, kw_only=True)
class UnityMagnitude:
    """Zero vibration of one mode by steps up and down in turn, with its derivatives zero too.

    Attributes
    ----------
    impulses
        Number of impulses, odd.
    derivatives
        How many derivatives of the vibration in the plant's frequency vanish too. Equations match
        unknowns with ``2 * derivatives + 3`` impulses; with more there is a choice.
    switched_order
        Order of the lags of a switched actuator, 1 or 2; 0 for superposed steps of any order.
    ramped
        Whether limits make ramps of the steps, each over before the next begins.
    weighted
        Whether the amplitudes are parameters; +1, -1, +1, ... if not.
    swings
        Whether the payload swings already at the first step.
    """

    impulses: int
    derivatives: int
    switched_order: int = 0
    ramped: bool = False
    weighted: bool = False
    swings: bool = False

    def expressions(self) -> Expressions:
        """Build V = 0 at the plant's pole, and its slope where it counts.

        The slope dV/dw = 0 has the actuator's own slope in it.

        ``V(w) = sum v_i exp(s (t_n - t_i)) / G_accel(s)``, ``s = w (-z + j sqrt(1 - z^2))``: the
        vibration in units of the unshaped step, referred to the last impulse. Where V is zero its
        zeros and those of dV/dw do not depend on either reference.
        Parameters are those of `lag_parameters` (Kim 2011, eqs. 3.44-3.46; 3.47-3.48 replaced by
        the exact derivative), then the amplitudes if weighted, then the four of `with_swing` if it
        swings.
        """
        import casadi as ca  # noqa: PLC0415 - a third of a second that --help must not pay

        gaps = ca.SX.sym("gaps", self.impulses - 1)
        own, weights = LAG_PARAMETERS[self.ramped], self.impulses * self.weighted
        parameters = ca.SX.sym("parameters", own + weights + 4 * self.swings)
        lags, amplitudes, swing = ca.vertsplit(
            parameters, [0, own, own + weights, parameters.numel()]
        )
        each = ca.vertsplit(gaps)
        steps = alternating_steps(each, lags, self.switched_order, ca.vertsplit(amplitudes))
        if self.swings:
            steps = with_swing(steps, each, lags, swing)
        return Expressions(
            unknowns=gaps,
            parameters=parameters,
            objective=ca.sum1(gaps),
            equations=ca.vertcat(*with_slopes(steps, self.derivatives)),
        )


ZERO_VIBRATION = UnityMagnitude(impulses=3, derivatives=0)
ZERO_VIBRATION_DERIVATIVE = UnityMagnitude(impulses=5, derivatives=1)
