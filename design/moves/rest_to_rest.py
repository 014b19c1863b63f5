"""Start and stop of a move put together: in turn, or solved as one where they overlap."""

from dataclasses import dataclass, replace

import numpy as np

from design.analysis.ramp_figures import end_of_reference
from design.analysis.swing import swing_over_step
from design.errors import InfeasibleDesignError, SolverFailedError
from design.formulations.behind_limits import move_behind_limits
from design.formulations.equations import GapProblem
from design.formulations.gaps import of_gaps, settling_gaps_rad
from design.formulations.lag_parameters import lag_parameters, switched_order
from design.formulations.ramped_move import ramped_move
from design.formulations.seeds import Seed
from design.formulations.unequal_ramps import unequal_ramps, without_travel
from design.formulations.whole_move import WholeMove, swing_parameters, whole_move_problem
from design.model.actuators.rate_limited import RateLimited, follows_one_lag
from design.model.impulses import Impulses
from design.moves.parts import Parts, overlapping_seeds
from design.response.closed_form import travel
from design.solvers import ipopt
from design.solvers.continuation import Path, follow
from design.solvers.more_steps import nearest_root
from design.solvers.moves import MoveCandidate, move_candidates
from design.solvers.near_root import root
from design.solvers.outcome import Status
from design.solvers.ramps.unequal_course import TwoLags
from design.solvers.ramps.unequal_program import solve_last
from design.solving.solve import solve
from design.types import FloatArray

TRAVEL_TOLERANCE = 1e-14
"""Relative error of the travel at which its iteration ends [-]."""

TRAVEL_ITERATIONS = 8
"""The travel changes by nearly as much as what is asked of it: three do [-]."""

PULSE_ITERATIONS = 60
"""Where a slow actuator barely comes to rest within the pulse, an iteration gains little [-]."""

MAX_TRAVEL_ERROR = 1e-12
"""Relative error of the distance beyond which a move is not returned [-]."""

TIME_ROUNDING = 1e-15
"""Rounding of a step's time, over the duration: a move of 1 um travels no more exactly, and a ramp
that is turned by so much too late rises too high, for the rest of the move [-]."""

MIN_SHARE = 1 / 32
"""Step of the swing's share at which a whole move is no longer followed: IPOPT takes a tenth of a
second to fail [-]."""

MIN_SLOPE = 0.1
"""Change of travel per travel asked below which the secant is not trusted [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WholeCommand:
    """Start and stop of a move, put together.

    Attributes
    ----------
    command
        The whole move, of sum 0.
    joint
        Whether start and stop were solved as one problem.
    lower_bound_s
        No move within the limits of acceleration ends its last ramp as early; None where nothing is
        proven [s].
    start_steps
        How many steps the start has; None where they were solved as one.
    share
        Height of its pulses over that of the parts [-].
    """

    command: Impulses
    joint: bool = False
    lower_bound_s: float | None = None
    start_steps: int | None = None
    share: float = 1.0


def over_pulse(parts: Parts, pulse_s: float) -> WholeCommand:
    """Return the command of a pulse, and whether it was solved as one.

    Parameters
    ----------
    parts
        Start and stop.
    pulse_s
        Pulse, > 0 [s].

    Returns
    -------
    WholeCommand
        The command, and whether start and stop were solved as one problem.

    Raises
    ------
    InfeasibleDesignError
        If the actuator takes all of the pulse off the travel, or no move was found.
    """
    if parts.apart and pulse_s >= parts.shortest_pulse_s:
        command = _with_solved_stop(parts, pulse_s, None)
        if command is not None:
            return WholeCommand(command=command, start_steps=parts.start.times_s.size)
    wanted_s = pulse_s + parts.lead_s()
    if wanted_s <= 0:
        raise InfeasibleDesignError(
            f"a pulse of {pulse_s:g} s goes nowhere: the actuator takes {pulse_s - wanted_s:.4g} s "
            "off its travel",
            code="pulse_goes_nowhere",
        )
    return _as_one(parts, wanted_s, pulse_s)


def over_distance(parts: Parts, wanted_s: float) -> WholeCommand:
    """Return the command that travels a distance, as in `over_pulse`.

    Parameters
    ----------
    parts
        Start and stop.
    wanted_s
        Distance over the speed, > 0 [s].

    Returns
    -------
    WholeCommand
        The command, and whether start and stop were solved as one problem.

    Raises
    ------
    InfeasibleDesignError
        If no move was found.
    """
    pulse_s, apart = apart_over_distance(parts, wanted_s)
    return _as_one(parts, wanted_s, pulse_s) if apart is None else apart


def apart_over_distance(parts: Parts, wanted_s: float) -> tuple[float, WholeCommand | None]:
    """Return the pulse over a distance, and start and stop with it.

    Parameters
    ----------
    parts, wanted_s
        As of `over_distance`.

    Returns
    -------
    tuple of float and WholeCommand or None
        The pulse [s]; None where start and stop overlap with it.
    """
    pulse_s = wanted_s - parts.lead_s()
    if pulse_s >= parts.shortest_pulse_s:
        for _ in range(PULSE_ITERATIONS):
            miss = wanted_s - travel(parts.whole(pulse_s), parts.actuator)
            pulse_s += miss
            if abs(miss) <= TRAVEL_TOLERANCE * wanted_s:
                break
    command = None
    if parts.apart and pulse_s >= parts.shortest_pulse_s:
        command = _with_solved_stop(parts, pulse_s, wanted_s)
    if command is None:
        return pulse_s, None
    return pulse_s, WholeCommand(command=command, start_steps=parts.start.times_s.size)


def faster_as_one(parts: Parts, apart: Impulses) -> WholeCommand | None:
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
    WholeCommand or None
        None where the move solved as one is slower, or was not found.
    """
    pulse_s = float(apart.times_s[parts.start.times_s.size])
    try:
        one = _as_one(parts, travel(apart, parts.actuator), pulse_s)
    except InfeasibleDesignError:  # there is a move all the same
        return None
    ends = [end_of_reference(command, parts.actuator) for command in (one.command, apart)]
    return one if ends[0] < ends[1] else None


def _with_solved_stop(parts: Parts, pulse_s: float, wanted_s: float | None) -> Impulses | None:
    """Return the start as designed, then a stop for the state that it finds.

    None where Newton's method finds no such stop in order: the move must be solved as one.
    """
    command = parts.whole(pulse_s)
    in_turn = parts.designed_for.model == "superposed" or follows_one_lag(parts.designed_for)
    if in_turn and not parts.starts_at_once:
        return command if _travels(parts, command, wanted_s) else None
    if isinstance(parts.designed_for, RateLimited) and not parts.starts_at_once:
        return _with_ramped_stop(parts, parts.designed_for, command, wanted_s)
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
    shortest = settling_gaps_rad(parts.mode, parts.designed_for, parts.steps, settle=parts.settle)
    if gaps.size - given == model.equations:
        gaps[given:] = root(model, gaps[given:], parameters)
    else:
        gaps[given:] = nearest_root(model, gaps[given:], parameters, shortest[given:])
    if not (gaps[given:] >= shortest[given:]).all():  # not a number is not
        return None
    solved = of_gaps(gaps, w, command.amplitudes)
    return solved if parts.verified(solved) and _travels(parts, solved, wanted_s) else None


def _with_ramped_stop(
    parts: Parts, drive: RateLimited, command: Impulses, wanted_s: float | None
) -> Impulses | None:
    """Return the command with its stop solved, as `_with_solved_stop`, whatever ramps turn."""
    w, start = parts.mode.natural_frequency_rad_s, parts.start.times_s.size
    travel_s = travel(command, drive)
    problem = unequal_ramps(
        ramped_move(
            parts.mode,
            drive,
            derivatives=parts.derivatives,
            travel_s=max(travel_s, sum(drive.unit_ramps_s)) if wanted_s is None else wanted_s,
            swing=parts.swing,
        ),
        drive,
    )
    if problem.ceiling > 1:  # it does not reach full speed
        return None
    last = TwoLags(problem if wanted_s is not None else without_travel(problem))
    given = start if wanted_s is not None else start + 1
    shortest: FloatArray = np.zeros(parts.steps - 1)
    if parts.settle:
        shortest = settling_gaps_rad(parts.mode, drive, parts.steps, settle=True)
    switches = solve_last(last, w * command.times_s, given, shortest[given - 1 :])
    if switches is None:
        return None
    solved = Impulses(times_s=switches / w, amplitudes=command.amplitudes)
    return solved if parts.verified(solved) and _travels(parts, solved, wanted_s) else None


def _as_one(parts: Parts, wanted_s: float, pulse_s: float) -> WholeCommand:
    """Return the fastest move found on levels 0 and the peak that travels ``wanted_s``."""
    drive = parts.designed_for
    if isinstance(drive, RateLimited) and parts.peak == 1 and not parts.settle:
        return _behind_limits(parts, drive, wanted_s)
    seeds = overlapping_seeds(parts, pulse_s)
    try:
        command = _travelling(parts, wanted_s, seeds)
    except InfeasibleDesignError as error:
        if parts.swing is None:
            raise
        path = _follow_as_one(parts, wanted_s, seeds)
        if path.complete:
            seeds = (Seed(name="continuation", gaps_rad=path.unknowns),)
            return WholeCommand(command=_travelling(parts, wanted_s, seeds), joint=True)
        size = abs(swing_over_step(parts.swing, parts.mode, parts.designed_for))
        share = path.share if parts.apart else max(path.share, parts.cancelled)
        raise InfeasibleDesignError(
            f"the swing at the first step is {size:.4g} times that of one unshaped step, and no "
            "command within the limits was found that cancels it; followed from rest, at most "
            f"{100 * share:.3g} % of it was cancelled: {error}",
            code="swing_not_cancelled",
        ) from error
    return WholeCommand(command=command, joint=True)


def _behind_limits(parts: Parts, drive: RateLimited, wanted_s: float) -> WholeCommand:
    """Return the fastest course of the reference found that travels ``wanted_s``."""
    problem = move_behind_limits(
        parts.mode,
        drive,
        derivatives=parts.derivatives,
        travel_s=wanted_s,
        swing=parts.swing,
    )
    ramp_s = min(drive.unit_ramps_s)
    for found in solve(problem):
        command = found.impulses
        rounding_s = TIME_ROUNDING * command.duration_s * max(1.0, command.duration_s / ramp_s)
        if parts.verified(command) and _travels(parts, command, wanted_s, rounding_s):
            bound_s = found.solver.lower_bound_s
            return WholeCommand(command=command, joint=True, lower_bound_s=bound_s)
    raise SolverFailedError(
        "no move behind the limits was verified", code="ramped_move_not_verified"
    )


def _follow_as_one(parts: Parts, wanted_s: float, seeds: tuple[Seed, ...]) -> Path:
    """Follow the move of a payload at rest to the swing asked."""
    candidate, _ = _fastest(replace(parts, swing=None), wanted_s, seeds)

    def solve_share(guess: FloatArray, share: float) -> FloatArray | None:
        swing = None if parts.swing is None else parts.swing.scaled(share)
        problem = _problem(replace(parts, swing=swing), wanted_s, (Seed(name="", gaps_rad=guess),))
        end = ipopt.solve(problem, np.maximum(guess, problem.shortest_gaps_rad))
        in_time = end.unknowns.sum() <= problem.horizon_rad
        return end.unknowns if end.status is Status.SOLVE_SUCCEEDED and in_time else None

    return follow(candidate.gaps_rad, solve_share, MIN_SHARE)


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
        if abs(miss_s) <= MAX_TRAVEL_ERROR * wanted_s:
            return command
        slope = (last_miss_s - miss_s) / (target_s - last_s) if target_s != last_s else 1.0
        last_s, last_miss_s = target_s, miss_s
        target_s += miss_s / (slope if slope > MIN_SLOPE else 1.0)
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
        (found, of_gaps(found.gaps_rad, w, parts.peak * found.problem.amplitudes))
        for found in move_candidates(problem, w * usual_s)
    )
    # The candidates never end: they raise.
    return next((found, command) for found, command in commands if parts.verified(command))


def _problem(parts: Parts, travel_s: float, seeds: tuple[Seed, ...]) -> GapProblem:
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


def _travels(
    parts: Parts, command: Impulses, wanted_s: float | None, rounding_s: float = 0.0
) -> bool:
    if wanted_s is None:
        return True
    allowed_s = MAX_TRAVEL_ERROR * wanted_s + rounding_s
    return abs(travel(command, parts.actuator) - wanted_s) <= allowed_s
