"""The start and the stop that a move is made of."""

import math
from dataclasses import dataclass, replace

import numpy as np

from design.analysis.certificate import certify
from design.claims import Promise
from design.errors import InfeasibleDesignError
from design.formulations.equations import GapProblem
from design.formulations.gaps import settling_gaps_rad
from design.formulations.lag_parameters import lag_parameters, switched_order
from design.formulations.seeds import Seed
from design.formulations.unity_magnitude import UnityMagnitude
from design.formulations.whole_move import swing_parameters
from design.model.actuators.rate_limited import RateLimited, follows_one_lag
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode
from design.response.closed_form import travel
from design.solvers import newton
from design.solvers.continuation import follow
from design.solvers.search import candidates
from design.types import FloatArray

MIN_START_SHARE = 1 / 512
"""The same of a start, which Newton's method follows [-]."""

COMPRESSED = 0.95
"""Share of the pulse into which a compressed start is squeezed [-]."""

REST_TIME_CONSTANTS = 50.0
"""Time constants after which a lag is at rest to rounding: e^-50 [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Parts:
    """Start and stop of a move as designed apart, each from rest, and what binds them.

    Attributes
    ----------
    mode, actuator
        The plant's mode and its drive.
    designed_for
        The actuator of the shaper's claims: an ideal one for shapers that know no actuator.
    claims
        What the whole move must leave zero.
    settle
        Whether each step must settle before the next.
    horizon_rad
        Longest move beyond its travel [rad].
    start, stop
        The parts, the first step of each at 0; the stop's amplitudes begin with -1.
    peak
        Height of the first pulse over the cruise speed [-].
    swing
        What the payload swings already at the first step.
    apart
        Whether the start cancels that swing; if not, it is one for a payload at rest, and the move
        must be solved as one.
    cancelled
        Share of the swing up to which the start could be followed [-].
    no_stop
        Why there is no stop without vibration; empty where there is one.
    """

    mode: Mode
    actuator: Actuator
    designed_for: Actuator
    claims: tuple[Promise, ...]
    settle: bool
    horizon_rad: float
    start: Impulses
    stop: Impulses
    peak: float = 1.0
    swing: FreeSwing | None = None
    apart: bool = True
    cancelled: float = 1.0
    no_stop: str = ""

    @property
    def derivatives(self) -> int:
        """How many derivatives of the vibration vanish too."""
        return int(any(promise.quantity == "slope" for promise in self.claims))

    @property
    def steps(self) -> int:
        """Number of steps of both."""
        return self.start.times_s.size + self.stop.times_s.size

    @property
    def starts_at_once(self) -> bool:
        """Whether the start is one step, which the stop has to cancel."""
        return self.start.times_s.size == 1

    @property
    def shortest_pulse_s(self) -> float:
        """The pulse below which start and stop overlap, or do not settle [s]."""
        gaps = settling_gaps_rad(self.mode, self.designed_for, self.steps, settle=self.settle)
        between = float(gaps[self.start.times_s.size - 1])
        return self.start.duration_s + between / self.mode.natural_frequency_rad_s

    def whole(self, pulse_s: float) -> Impulses:
        """Return both parts as one command; out of range where they overlap.

        Parameters
        ----------
        pulse_s
            Time from the first step of the start to the first of the stop [s].

        Returns
        -------
        Impulses
            Steps in order of time.
        """
        times = np.concatenate((self.start.times_s, pulse_s + self.stop.times_s))
        amplitudes = np.concatenate((self.start.amplitudes, self.stop.amplitudes))
        order = np.argsort(times, kind="stable")
        return Impulses(times_s=times[order], amplitudes=amplitudes[order])

    def verified(self, command: Impulses) -> bool:
        """Return whether every claim is certified for a whole command."""
        return certify(command, self.mode, self.designed_for, self.claims, self.swing).verified

    @property
    def rest_pulse_s(self) -> float:
        """A pulse that lets the actuator rest between start and stop [s]."""
        slowest = max(
            lag.first_s + math.sqrt(lag.second_s2)
            for lag in (self.actuator.accel_lag, self.actuator.decel_lag)
        )
        ramp_s = max(unit_ramps_s(self.actuator))
        return self.start.duration_s + ramp_s + REST_TIME_CONSTANTS * slowest

    def lead_s(self) -> float:
        """Return the travel beyond the pulse over the speed [s].

        The actuator is at rest between start and stop.
        """
        return travel(self.whole(self.rest_pulse_s), self.actuator) - self.rest_pulse_s


def with_swing(parts: Parts, swing: FreeSwing) -> Parts:
    """Return the parts with a start that cancels a swing too.

    The start is followed from a payload at rest to the swing asked; where that path ends, every
    branch is searched.

    Parameters
    ----------
    parts
        Start and stop for a payload at rest.
    swing
        What the payload swings at the first step.

    Returns
    -------
    Parts
        For the swing; without such a start ``apart`` is False: start and stop are solved as one.
    """
    if parts.starts_at_once:
        return replace(parts, swing=swing)
    drive = parts.designed_for
    if follows_one_lag(drive) and drive.jerk_limit_m_s3 is not None:
        # Whole moves are solved as one for any swing; starts alone are not.
        return replace(parts, swing=swing, apart=False)
    mode, count = parts.mode, parts.start.times_s.size
    w = mode.natural_frequency_rad_s
    weights = parts.start.amplitudes if parts.peak != 1 else np.zeros(0)
    fixed = [*lag_parameters(mode, parts.designed_for), *weights]
    shortest = settling_gaps_rad(mode, parts.designed_for, count, settle=parts.settle)
    model = UnityMagnitude(
        impulses=count,
        derivatives=parts.derivatives,
        switched_order=switched_order(parts.designed_for),
        ramped=isinstance(parts.designed_for, RateLimited),
        weighted=weights.size > 0,
        swings=True,
    )

    def parameters(share: float) -> FloatArray:
        return np.array([*fixed, *swing_parameters(mode, swing.scaled(share))])

    def root(guess: FloatArray, share: float) -> FloatArray | None:
        end = newton.roots(model, guess[None], parameters(share))
        ordered = (end.unknowns[0] >= shortest).all()
        return end.unknowns[0] if end.converged[0] and ordered else None

    path = follow(w * np.diff(parts.start.times_s), root, MIN_START_SHARE)
    problem = GapProblem(
        model=model,
        parameters=parameters(1.0),
        amplitudes=parts.start.amplitudes,
        natural_frequency_rad_s=w,
        shortest_gaps_rad=shortest,
        horizon_rad=parts.horizon_rad / 2,
        seeds=(Seed(name="continuation", gaps_rad=path.unknowns),) if path.complete else (),
        designed_for=parts.designed_for,
    )
    swinging = replace(parts, swing=swing)
    try:
        for found in candidates(problem):
            if swinging.verified(found.impulses):
                return replace(swinging, start=found.impulses)
    except InfeasibleDesignError:  # the stop may do what the start cannot
        pass
    return replace(swinging, apart=False, cancelled=path.share)


def mirrored_stop(start: Impulses) -> Impulses:
    """Return the stop that mirrors a start: its gaps in reverse order.

    It stops a symmetric actuator without vibration, an asymmetric one not (Kim 2011, 3.56-3.59:
    t7 = t6 + t5 - t4, ...). `maneuver` solves the stop instead.

    Parameters
    ----------
    start
        The start.

    Returns
    -------
    Impulses
        The first step at 0, the amplitudes negated and in reverse order.
    """
    return Impulses(
        times_s=(start.times_s[-1] - start.times_s)[::-1], amplitudes=-start.amplitudes[::-1]
    )


def overlapping_seeds(parts: Parts, pulse_s: float) -> tuple[Seed, ...]:
    """Return start and stop merged, and both squeezed into the pulse.

    Parameters
    ----------
    parts, pulse_s
        Start and stop; time from the first step of the one to that of the other [s].

    Returns
    -------
    tuple of Seed
        Gaps between all steps [rad].
    """
    pulse_s = max(pulse_s, 0.0)
    squeeze = min(1.0, COMPRESSED * pulse_s / max(parts.start.duration_s, parts.stop.duration_s))
    squeezed = np.concatenate((
        squeeze * parts.start.times_s,
        pulse_s + squeeze * parts.stop.times_s,
    ))
    w = parts.mode.natural_frequency_rad_s
    return (
        Seed(name="merged", gaps_rad=w * np.diff(parts.whole(pulse_s).times_s)),
        Seed(name="squeezed", gaps_rad=w * np.diff(squeezed)),
    )
