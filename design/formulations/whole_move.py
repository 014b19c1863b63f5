"""Whole moves from rest to rest on levels 0 and 1: start and stop in one set of equations."""

import math
from dataclasses import dataclass

import numpy as np

from design.formulations.equations import GapProblem
from design.formulations.expressions import Expressions
from design.formulations.gaps import PERIOD_RAD, settling_gaps_rad
from design.formulations.lag_parameters import LAG_PARAMETERS, lag_parameters, switched_order
from design.formulations.seeds import Seed
from design.formulations.symbolic import alternating_steps, with_slopes, with_swing
from design.formulations.unity_magnitude_problem import alternating
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode
from design.types import FloatArray

TRAIN_PERIODS = (1.0, 0.6, 1.4)
"""Lengths of the pulse trains that a short move may start from, in undamped periods [-]."""

MAX_TRAIN_SHARE = 0.9
"""Largest share of a pulse train in which it is on [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WholeMove:
    """Zero vibration of one mode after steps +1, -1, ..., -1, some of whose gaps may be given.

    Attributes
    ----------
    steps
        Number of steps, even: the command ends at 0.
    derivatives
        How many derivatives of the vibration in the plant's frequency vanish too.
    switched_order
        Order of the lags of a switched actuator, 1 or 2; 0 for superposed steps of any order.
    given
        How many gaps, from the first on, are parameters and not unknowns.
    travels
        Whether the travel is an equation too.
    ramped
        Whether limits make ramps of the steps, each over before the next begins.
    weighted
        Whether the amplitudes are parameters; +1, -1, ..., -1 if not.
    swings
        Whether the payload swings already at the first step.
    """

    steps: int
    derivatives: int
    switched_order: int
    given: int = 0
    travels: bool = True
    ramped: bool = False
    weighted: bool = False
    swings: bool = False

    @property
    def equations(self) -> int:
        """How many equations it has."""
        return 2 * (1 + self.derivatives) + self.travels

    def expressions(self) -> Expressions:
        """Build V = 0, its derivatives, and the travel over that wanted, less 1.

        Parameters are those of `UnityMagnitude`, the travel wanted times the plant's frequency
        (unused if it is no equation), then the gaps that are given [rad].
        """
        import casadi as ca  # noqa: PLC0415 - a third of a second that --help must not pay

        gaps = ca.SX.sym("gaps", self.steps - 1 - self.given)
        own = LAG_PARAMETERS[self.ramped]
        ends = np.cumsum([0, own, self.steps * self.weighted, 4 * self.swings, 1, self.given])
        parameters = ca.SX.sym("parameters", int(ends[-1]))
        lags, amplitudes, swing, wanted, given = ca.vertsplit(parameters, ends.tolist())
        each = [*ca.vertsplit(given), *ca.vertsplit(gaps)]
        steps = alternating_steps(each, lags, self.switched_order, ca.vertsplit(amplitudes))
        if self.swings:
            steps = with_swing(steps, each, lags, swing)
        equations = with_slopes(steps, self.derivatives)
        if self.travels:
            equations.append(steps.travel / wanted - 1)
        return Expressions(
            unknowns=gaps,
            parameters=parameters,
            objective=ca.sum1(gaps),
            equations=ca.vertcat(*equations),
        )


def whole_move_problem(
    mode: Mode,
    actuator: Actuator,
    *,
    steps: int,
    derivatives: int,
    travel_s: float,
    settle: bool,
    horizon_rad: float,
    seeds: tuple[Seed, ...],
    swing: FreeSwing | None = None,
) -> GapProblem:
    """Formulate the fastest move over a given travel, every gap unknown.

    Parameters
    ----------
    mode, actuator
        The plant's mode and its drive.
    steps, derivatives
        As in `WholeMove`.
    travel_s
        Distance over speed, > 0 [s].
    settle
        Whether each step must settle to 80 % before the next.
    horizon_rad
        Longest duration [rad].
    seeds
        Starts, each with ``steps - 1`` gaps.
    swing
        What the payload swings already at the first step.

    Returns
    -------
    GapProblem
        In the gaps between all steps.
    """
    w = mode.natural_frequency_rad_s
    return GapProblem(
        model=WholeMove(
            steps=steps,
            derivatives=derivatives,
            switched_order=switched_order(actuator),
            ramped=isinstance(actuator, RateLimited),
            swings=swing is not None,
        ),
        parameters=np.array([
            *lag_parameters(mode, actuator),
            *swing_parameters(mode, swing),
            w * travel_s,
        ]),
        amplitudes=alternating(steps),
        natural_frequency_rad_s=w,
        shortest_gaps_rad=settling_gaps_rad(mode, actuator, steps, settle=settle),
        horizon_rad=horizon_rad,
        seeds=seeds,
        designed_for=actuator,
    )


def pulse_trains(problem: GapProblem) -> list[FloatArray]:
    """Return starts for a short move: evenly spaced pulses.

    A pulse much shorter than the period is an impulse to the mode: binomial widths make it the ZV
    or ZVD shaper of positive impulses, which needs half a period from one to the next.

    Parameters
    ----------
    problem
        The move, of n steps.

    Returns
    -------
    list of FloatArray
        Gaps, shape (n - 1,) each [rad].
    """
    pulses = problem.amplitudes.size // 2
    _, first_accel, _, first_decel, *_, travel = problem.parameters.tolist()
    # Each pulse travels its width less the lag of its rise, plus that of its fall.
    on = max(travel + pulses * (first_accel - first_decel), travel / 2)
    trains: list[FloatArray] = []
    for periods in TRAIN_PERIODS:
        spacing = periods * PERIOD_RAD / max(pulses - 1, 1)
        for weights in (
            [math.comb(pulses - 1, index) for index in range(pulses)],
            [1] * pulses,
        ):
            widths = on * np.array(weights) / sum(weights)
            apart = max(spacing, float(widths.max()) / MAX_TRAIN_SHARE)
            gaps = np.empty(2 * pulses - 1)
            gaps[0::2] = widths
            gaps[1::2] = apart - (widths[:-1] + widths[1:]) / 2
            trains.append(gaps)
    return trains


def swing_parameters(mode: Mode, swing: FreeSwing | None) -> FloatArray:
    """Return the four parameters of `with_swing`, or none.

    Parameters
    ----------
    mode
        The plant's mode.
    swing
        What the payload swings at the first step.

    Returns
    -------
    FloatArray
        Shape (4,), or (0,) without a swing.
    """
    if swing is None:
        return np.zeros(0)
    w = mode.natural_frequency_rad_s
    return np.array([
        w * swing.deflection_s, swing.rate, swing.frequency_power, w * swing.delay_s
    ])  # fmt: skip
