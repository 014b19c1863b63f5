"""Steps up and down in turn that leave nothing in any of several modes: their equations.

All is dimensionless: phases are times the lowest natural frequency, in which lags are scaled too.
"""

from dataclasses import dataclass, replace

import numpy as np

from design.claims import Promise, zeros
from design.formulations.equations import GapProblem
from design.formulations.expressions import Expressions
from design.formulations.gaps import MIN_GAP_RAD, PERIOD_RAD
from design.formulations.lag_parameters import switched_order
from design.formulations.ramped import EARLIEST_PERIODS, RampedProblem
from design.formulations.symbolic import Complex, SymbolicSet, exponential
from design.formulations.unity_magnitude_problem import alternating
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.types import Symbolic

LAGS = 4
"""Parameters of the drive: ``first, second`` of either set, accel before decel."""

SHORT_RAMP_RAD = 0.2
"""Ramps that stand for the steps of an ideal drive, in phases of the fastest mode: Newton's method
leads from them to steps, and a linear program still resolves them [rad]."""

OF_A_MODE = 2
"""Parameters of a mode: its natural frequency over the lowest, and its damping ratio."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepsForModes:
    """Zero vibration of several modes by steps up and down in turn, with slopes zero too or not.

    Attributes
    ----------
    impulses
        Number of impulses, odd.
    modes
        Number of modes.
    slopes
        Whether the derivative of each vibration in that mode's frequency vanishes too.
    switched_order
        Order of the lags of a switched actuator, 1 or 2; 0 for superposed steps of any order.
    """

    impulses: int
    modes: int
    slopes: bool
    switched_order: int

    def expressions(self) -> Expressions:
        """Build V = 0 at the pole of each mode, and its slope where it counts.

        ``V(s) = sum v_i exp(s (t_n - t_i)) / G_accel(s)`` is in units of the unshaped step. The
        slope dV/d ln w is along ``s = w (-z + j sqrt(1 - z^2))``, the actuator's own included: of
        zeros it depends neither on the reference in time nor on that unit.
        Parameters are the four of the lags, then those of each mode.
        """
        import casadi as ca  # noqa: PLC0415 - a third of a second that --help must not pay

        gaps = ca.SX.sym("gaps", self.impulses - 1)
        parameters = ca.SX.sym("parameters", LAGS + OF_A_MODE * self.modes)
        lags, of_modes = ca.vertsplit(parameters, [0, LAGS, parameters.numel()])
        states = self._states(ca.vertsplit(gaps), ca.vertsplit(lags))
        equations = []
        for number in range(self.modes):
            ratio, z = ca.vertsplit(of_modes[OF_A_MODE * number : OF_A_MODE * (number + 1)])
            w = ca.SX.sym("w")
            pole = Complex(-z * w, w * ca.sqrt(1 - z * z))
            left = _vibration(ca.vertsplit(gaps), ca.vertsplit(lags), states, pole)
            vibration = ca.vertcat(left.real, left.imag)
            equations.append(ca.substitute(vibration, w, ratio))
            if self.slopes:
                slope = w * ca.jacobian(vibration, w)
                equations.append(ca.substitute(slope, w, ratio))
        return Expressions(
            unknowns=gaps,
            parameters=parameters,
            objective=ca.sum1(gaps),
            equations=ca.cse(ca.vertcat(*equations)),
        )

    def _states(
        self, gaps: list[Symbolic], lags: list[Symbolic]
    ) -> list[tuple[Symbolic, Symbolic]]:
        """Return error and rate of a switched actuator at each step but the first; else none."""
        import casadi as ca  # noqa: PLC0415

        states = []
        sets = [SymbolicSet(*lags[:2]), SymbolicSet(*lags[2:])]
        error, rate = ca.SX(0), ca.SX(0)
        if self.switched_order:
            for index, gap in enumerate(gaps):
                taken = 2 * (index % 2) - 1  # the step changes the reference, not the velocity
                error, rate = sets[index % 2].free_motion(
                    gap, error + taken, rate, self.switched_order
                )
                states.append((error, rate))
        return states


def _vibration(
    gaps: list[Symbolic],
    lags: list[Symbolic],
    states: list[tuple[Symbolic, Symbolic]],
    pole: Complex,
) -> Complex:
    """Return the vibration at one pole over the unshaped step, at the last step.

    A superposed step adds ``A_i G_i(s)``. Where the sets are switched, the state adds what it would
    leave under the new set less what it would have left under the old, as in
    `design.formulations.symbolic.alternating_steps`.
    """
    import casadi as ca  # noqa: PLC0415

    sets = [SymbolicSet(*lags[:2]), SymbolicSet(*lags[2:])]
    one = Complex(ca.SX(1), ca.SX(0))
    gains = [one, sets[0].denominator(pole) / sets[1].denominator(pole)]
    left = one
    for index, gap in enumerate(gaps, start=1):
        left = left * exponential(pole.scaled(gap))
        now, before = index % 2, (index - 1) % 2
        left = left + gains[now].scaled(1 - 2 * now)
        if states:
            left = left + gains[now] * sets[now].ringing(*states[index - 1], pole)
            left = left - gains[before] * sets[before].ringing(*states[index - 1], pole)
    return left


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StepsProblem:
    """The fastest steps up and down in turn that leave nothing in any of several modes.

    Attributes
    ----------
    gaps
        The problem in the gaps between the steps, as many equations as gaps.
    superposed
        The same gaps for superposed steps, whose solutions are near those of a switched drive; the
        problem itself where its steps are superposed.
    claims
        Residuals and slopes, mode by mode; none where residuals alone are zero.
    ideal
        The fastest course behind an ideal drive whose steps are short ramps: its optimum is found
        by a linear program, and has as many steps where no much faster mode asks for more.
    """

    gaps: GapProblem
    superposed: GapProblem
    claims: tuple[Promise, ...]
    ideal: RampedProblem

    @property
    def designed_for(self) -> Actuator:
        """The actuator of the claims."""
        return self.gaps.designed_for


def steps_problem(
    modes: tuple[Mode, ...],
    actuator: Actuator,
    *,
    slopes: bool,
    shortest_gap_s: float,
    max_duration_periods: float,
) -> StepsProblem:
    """Formulate 2n + 1 steps for n modes, or 4n + 1 where slopes vanish too.

    Parameters
    ----------
    modes, actuator
        The modes of the plant; a drive without limits.
    slopes
        Whether dV/d ln w is zero too in each mode.
    shortest_gap_s
        No step is nearer to the one before; 0 for what only keeps the order [s].
    max_duration_periods
        Longest duration in undamped periods of the slowest mode [-].

    Returns
    -------
    StepsProblem
        In phases of the slowest mode.
    """
    w = min(mode.natural_frequency_rad_s for mode in modes)
    lags = [actuator.accel_lag, actuator.decel_lag]
    scaled = [part for lag in lags for part in (w * lag.first_s, w * w * lag.second_s2)]
    of_modes = [(mode.natural_frequency_rad_s / w, mode.damping_ratio) for mode in modes]
    impulses = 2 * len(modes) * (1 + slopes) + 1
    shortest = max(w * shortest_gap_s, MIN_GAP_RAD)
    gaps = GapProblem(
        model=StepsForModes(
            impulses=impulses,
            modes=len(modes),
            slopes=slopes,
            switched_order=switched_order(actuator),
        ),
        parameters=np.array([*scaled, *(part for one in of_modes for part in one)]),
        amplitudes=alternating(impulses),
        natural_frequency_rad_s=w,
        shortest_gaps_rad=np.full(impulses - 1, shortest),
        horizon_rad=max_duration_periods * PERIOD_RAD,
        seeds=(),
        designed_for=actuator,
    )
    added = StepsForModes(impulses=impulses, modes=len(modes), slopes=slopes, switched_order=0)
    return StepsProblem(
        gaps=gaps,
        superposed=replace(gaps, model=added),
        claims=promises_of(len(modes), slopes=slopes),
        ideal=_ideal(modes, gaps, slopes=slopes),
    )


def _ideal(modes: tuple[Mode, ...], gaps: GapProblem, *, slopes: bool) -> RampedProblem:
    w = gaps.natural_frequency_rad_s
    poles = [mode.pole_rad_s / w for mode in modes for _ in range(1 + slopes)]
    ramp_rad = SHORT_RAMP_RAD * w / max(mode.natural_frequency_rad_s for mode in modes)
    return RampedProblem(
        unit_poles=np.array(poles, dtype=np.complex128),
        orders=np.array([float(order) for _ in modes for order in range(1 + slopes)]),
        targets=np.zeros(len(poles), dtype=np.complex128),
        ramps_rad=(ramp_rad, ramp_rad),
        last=1.0,
        natural_frequency_rad_s=w,
        horizon_rad=gaps.horizon_rad,
        earliest_rad=PERIOD_RAD * EARLIEST_PERIODS[slopes],
        designed_for=Ideal(),
    )


def promises_of(modes: int, *, slopes: bool) -> tuple[Promise, ...]:
    """Return the promises of zero residual and slope in each mode.

    Parameters
    ----------
    modes, slopes
        Number of modes, and whether slopes are zero too.

    Returns
    -------
    tuple of Promise
        Mode by mode; none without slopes, where the claims of the kind say all.
    """
    kept = zeros(("residual", "slope")) if slopes else ()
    return tuple(replace(promise, mode=number) for number in range(modes) for promise in kept)
