"""Start and stop of a move put together: in turn, or solved as one where they overlap."""

import math
from dataclasses import dataclass, replace

import numpy as np

from design.analysis.certificate import certify
from design.analysis.residual import swing_over_step
from design.claims import Promise
from design.errors import InfeasibleDesignError
from design.formulations.equations import Problem, Seed
from design.formulations.unity_magnitude import (
    UnityMagnitude,
    lag_parameters,
    settling_gaps_rad,
    swing_parameters,
    switched_order,
)
from design.formulations.whole_move import WholeMove, whole_move_problem
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode
from design.response.closed_form import travel
from design.solvers import ipopt, newton
from design.solvers.continuation import Path, followed
from design.solvers.moves import MoveCandidate, move_candidates
from design.solvers.outcome import Status
from design.solvers.search import candidates
from design.types import FloatArray

REST_TIME_CONSTANTS = 50.0
"""Time constants after which a lag is at rest to rounding: e^-50 [-]."""

TRAVEL_TOLERANCE = 1e-14
"""Relative error of the travel at which its iteration ends [-]."""

TRAVEL_ITERATIONS = 8
"""The travel changes by nearly as much as what is asked of it: three do [-]."""

PULSE_ITERATIONS = 60
"""Where a slow actuator barely comes to rest within the pulse, an iteration gains little [-]."""

LARGEST_TRAVEL_ERROR = 1e-12
"""Relative error of the distance beyond which a move is not returned [-]."""

COMPRESSED = 0.95
"""Share of the pulse into which a compressed start is squeezed [-]."""

SHORTEST_SHARE = 1 / 32
"""Step of the swing's share at which a whole move is no longer followed: IPOPT takes a tenth of a
second to fail [-]."""

SHORTEST_START_SHARE = 1 / 512
"""The same of a start, which Newton's method follows [-]."""

SMALLEST_SLOPE = 0.1
"""Change of travel per travel asked below which the secant is not trusted [-]."""


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

    @property
    def derivatives(self) -> int:
        """How many derivatives of the vibration vanish too."""
        return int(any(promise.quantity == "slope" for promise in self.claims))

    @property
    def steps(self) -> int:
        """Number of steps of both."""
        return self.start.times_s.size + self.stop.times_s.size

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

    path = followed(w * np.diff(parts.start.times_s), root, SHORTEST_START_SHARE)
    problem = Problem(
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
            start = _command(found.gaps_rad, problem.amplitudes, w)
            if swinging.verified(start):
                return replace(swinging, start=start)
    except InfeasibleDesignError:  # the stop may do what the start cannot
        pass
    return replace(swinging, apart=False, cancelled=path.share)


def over_pulse(parts: Parts, pulse_s: float) -> tuple[Impulses, bool]:
    """Return the command of a pulse, and whether it was solved as one.

    Parameters
    ----------
    parts
        Start and stop.
    pulse_s
        Pulse, > 0 [s].

    Returns
    -------
    Impulses
        The whole move, of sum 0.
    bool
        True if start and stop were solved as one problem.

    Raises
    ------
    InfeasibleDesignError
        If the actuator takes all of the pulse off the travel, or no move was found.
    """
    if parts.apart and pulse_s >= parts.shortest_pulse_s:
        command = _with_solved_stop(parts, pulse_s, None)
        if command is not None:
            return command, False
    wanted_s = pulse_s + parts.lead_s()
    if wanted_s <= 0:
        raise InfeasibleDesignError(
            f"a pulse of {pulse_s:g} s goes nowhere: the actuator takes {pulse_s - wanted_s:.4g} s "
            "off its travel",
            code="pulse_goes_nowhere",
        )
    return _as_one(parts, wanted_s, pulse_s), True


def over_distance(parts: Parts, wanted_s: float) -> tuple[Impulses, bool]:
    """Return the command that travels a distance, as in `over_pulse`.

    Parameters
    ----------
    parts
        Start and stop.
    wanted_s
        Distance over the speed, > 0 [s].

    Returns
    -------
    Impulses
        The whole move, of sum 0.
    bool
        True if start and stop were solved as one problem.

    Raises
    ------
    InfeasibleDesignError
        If no move was found.
    """
    pulse_s = wanted_s - parts.lead_s()
    if pulse_s >= parts.shortest_pulse_s:
        for _ in range(PULSE_ITERATIONS):
            miss = wanted_s - travel(parts.whole(pulse_s), parts.actuator)
            pulse_s += miss
            if abs(miss) <= TRAVEL_TOLERANCE * wanted_s:
                break
    if parts.apart and pulse_s >= parts.shortest_pulse_s:
        command = _with_solved_stop(parts, pulse_s, wanted_s)
        if command is not None:
            return command, False
    return _as_one(parts, wanted_s, pulse_s), True


def faster_as_one(parts: Parts, apart: Impulses) -> Impulses | None:
    """Return the move solved as one if it is faster than its parts apart.

    Both travel as far.

    Parameters
    ----------
    parts
        Start and stop.
    apart
        The move of both, solved apart.

    Returns
    -------
    Impulses or None
        None where the move solved as one is slower, or was not found.
    """
    pulse_s = float(apart.times_s[parts.start.times_s.size])
    try:
        one = _as_one(parts, travel(apart, parts.actuator), pulse_s)
    except InfeasibleDesignError:  # there is a move all the same
        return None
    return one if one.duration_s < apart.duration_s else None


def _with_solved_stop(parts: Parts, pulse_s: float, wanted_s: float | None) -> Impulses | None:
    """Return the start as designed, then a stop for the state that it finds.

    None where Newton's method finds no such stop in order: the move must be solved as one.
    """
    command = parts.whole(pulse_s)
    if parts.designed_for.model == "superposed":
        return command if _travels(parts, command, wanted_s) else None
    # With a travel to meet, the gap between start and stop is unknown too.
    given = parts.start.times_s.size - (wanted_s is not None)
    w = parts.mode.natural_frequency_rad_s
    gaps = w * np.diff(command.times_s)
    model = WholeMove(
        steps=parts.steps,
        derivatives=parts.derivatives,
        switched_order=switched_order(parts.designed_for),
        given=given,
        travels=wanted_s is not None,
        ramped=isinstance(parts.designed_for, RateLimited),
        weighted=parts.peak != 1,
        swings=parts.swing is not None,
    )
    parameters = np.array([
        *lag_parameters(parts.mode, parts.designed_for),
        *(command.amplitudes if parts.peak != 1 else ()),
        *swing_parameters(parts.mode, parts.swing),
        w * (wanted_s or 1.0),
        *gaps[:given],
    ])
    gaps[given:] = newton.root(model, gaps[given:], parameters)
    shortest = settling_gaps_rad(parts.mode, parts.designed_for, parts.steps, settle=parts.settle)
    if not (gaps[given:] >= shortest[given:]).all():  # not a number is not
        return None
    solved = _command(gaps, command.amplitudes, w)
    return solved if parts.verified(solved) and _travels(parts, solved, wanted_s) else None


def _as_one(parts: Parts, wanted_s: float, pulse_s: float) -> Impulses:
    """Return the fastest move found on levels 0 and the peak that travels ``wanted_s``."""
    seeds = _overlapping_seeds(parts, pulse_s)
    try:
        return _travelling(parts, wanted_s, seeds)
    except InfeasibleDesignError as error:
        if parts.swing is None:
            raise
        path = _followed_as_one(parts, wanted_s, seeds)
        if path.complete:
            return _travelling(
                parts, wanted_s, (Seed(name="continuation", gaps_rad=path.unknowns),)
            )
        size = abs(swing_over_step(parts.swing, parts.mode, parts.designed_for))
        share = path.share if parts.apart else max(path.share, parts.cancelled)
        raise InfeasibleDesignError(
            f"the swing at the first step is {size:.4g} times that of one unshaped step, and no "
            "command within the limits was found that cancels it; followed from none, "
            f"{100 * share:.3g} % of it was cancelled at most: {error}",
            code="swing_not_cancelled",
        ) from error


def _followed_as_one(parts: Parts, wanted_s: float, seeds: tuple[Seed, ...]) -> Path:
    """Follow the move of a payload at rest to the swing asked."""
    candidate, _ = _fastest(replace(parts, swing=None), wanted_s, seeds)

    def solved(guess: FloatArray, share: float) -> FloatArray | None:
        swing = None if parts.swing is None else parts.swing.scaled(share)
        problem = _problem(replace(parts, swing=swing), wanted_s, (Seed(name="", gaps_rad=guess),))
        end = ipopt.solve(problem, np.maximum(guess, problem.shortest_gaps_rad))
        in_time = end.unknowns.sum() <= problem.horizon_rad
        return end.unknowns if end.status is Status.SOLVE_SUCCEEDED and in_time else None

    return followed(candidate.gaps_rad, solved, SHORTEST_SHARE)


def _travelling(parts: Parts, wanted_s: float, seeds: tuple[Seed, ...]) -> Impulses:
    """Return the fastest move found on levels 0 and the peak that travels ``wanted_s``.

    A shaper that knows no actuator is solved with ideal lags, while the distance is met with the
    actuator given: the travel asked of the ideal one is corrected until it is (secant method).

    Raises
    ------
    InfeasibleDesignError
        If the travel does not converge, or no such move is found.
    """
    target_s, last_s, last_miss_s = wanted_s, 0.0, wanted_s
    for _ in range(TRAVEL_ITERATIONS):
        candidate, command = _fastest(parts, target_s, seeds)
        miss_s = wanted_s - travel(command, parts.actuator)
        if abs(miss_s) <= LARGEST_TRAVEL_ERROR * wanted_s:
            return command
        slope = (last_miss_s - miss_s) / (target_s - last_s) if target_s != last_s else 1.0
        last_s, last_miss_s = target_s, miss_s
        target_s += miss_s / (slope if slope > SMALLEST_SLOPE else 1.0)
        if target_s <= 0:
            break
        seeds = (Seed(name="last", gaps_rad=candidate.gaps_rad),)
    raise InfeasibleDesignError(
        f"no move on levels 0 and 1 was found whose travel is {wanted_s:.6g} s times its speed "
        "behind the actuator given",
        code="no_move_of_travel",
    )


def _fastest(
    parts: Parts, travel_s: float, seeds: tuple[Seed, ...]
) -> tuple[MoveCandidate, Impulses]:
    """Return the first verified candidate, of a usual duration if there is one.

    The usual: start, stop and twice the travel.
    """
    w = parts.mode.natural_frequency_rad_s
    problem = _problem(parts, travel_s, seeds)
    usual_s = parts.start.duration_s + float(parts.stop.times_s[-1])
    usual_s += 2 * travel_s / min(parts.peak, 1.0)
    commands = (
        (found, _command(found.gaps_rad, parts.peak * found.problem.amplitudes, w))
        for found in move_candidates(problem, w * usual_s)
    )
    # The candidates never end: they raise.
    return next((found, command) for found, command in commands if parts.verified(command))


def _problem(parts: Parts, travel_s: float, seeds: tuple[Seed, ...]) -> Problem:
    """Formulate the move as one; on levels 0 and the peak, all is in units of the peak."""
    return whole_move_problem(
        parts.mode,
        parts.designed_for,
        steps=seeds[0].gaps_rad.size + 1,
        derivatives=parts.derivatives,
        travel_s=travel_s / parts.peak,
        settle=parts.settle,
        horizon_rad=parts.horizon_rad
        + parts.mode.natural_frequency_rad_s * travel_s / min(parts.peak, 1.0),
        seeds=seeds,
        swing=None if parts.swing is None else parts.swing.scaled(1 / parts.peak),
    )


def _overlapping_seeds(parts: Parts, pulse_s: float) -> tuple[Seed, ...]:
    """Start and stop merged in order of time; both squeezed into the pulse."""
    pulse_s = max(pulse_s, 0.0)
    squeeze = min(1.0, COMPRESSED * pulse_s / parts.start.duration_s)
    squeezed = np.concatenate((
        squeeze * parts.start.times_s,
        pulse_s + squeeze * parts.stop.times_s,
    ))
    w = parts.mode.natural_frequency_rad_s
    return (
        Seed(name="merged", gaps_rad=w * np.diff(parts.whole(pulse_s).times_s)),
        Seed(name="squeezed", gaps_rad=w * np.diff(squeezed)),
    )


def _command(gaps_rad: FloatArray, amplitudes: FloatArray, w: float) -> Impulses:
    return Impulses(times_s=np.concatenate(([0.0], np.cumsum(gaps_rad))) / w, amplitudes=amplitudes)


def _travels(parts: Parts, command: Impulses, wanted_s: float | None) -> bool:
    if wanted_s is None:
        return True
    return abs(travel(command, parts.actuator) - wanted_s) <= LARGEST_TRAVEL_ERROR * wanted_s
