"""Emergency stops: the least way until nothing moves, from any state of drive and payload.

The command stays between 0 and full speed in its direction, so nothing reverses. Behind an ideal
drive, or one whose sets are alike, the way and the vibration at the end are linear in the command:
the least way is on where ``1 + Re sum_m c_m exp(-s_m t) < 0`` for some complex c_m and off
elsewhere, so off at once and then, with one mode, at most one pulse a period. Behind a drive whose
sets differ the same pattern is solved with both sets.

Examples
--------
>>> from dataclasses import replace
>>> from design.live.emergency_request import EmergencyRequest
>>> from design.live.machine import LiveKind
>>> from design.live.state import at_rest
>>> from design.model.actuators.ideal import Ideal
>>> from design.model.plants.pendulum import Pendulum
>>> crane = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
>>> driving = replace(at_rest(1, LiveKind()), level=1.0, target=1.0)
>>> stop = emergency_stop(Ideal(), crane.modes, driving, EmergencyRequest())
>>> round(0.2 * stop.way_s, 5), len(stop.plan.times_s)
(0.05981, 3)
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from design.live.emergency_request import EmergencyRequest
from design.live.state import AxisState, Plan
from design.live.stop_case import StopCase
from design.live.stop_newton import EXACT, Stop, refine
from design.live.stop_starts import (
    least_added_way,
    least_swing,
    pulses_by_pulls,
    starting_pulses,
)
from design.model.actuators.rate_limited import Unlimited
from design.model.plants.mode import Mode
from design.types import ComplexArray, FloatArray

MARGINS = (0.003, 0.01, 0.05, 0.3, 1.0)
"""Shares of an unshaped step's swing that are tried above the least of a grid [-]."""

FINER = (4, 16)
"""Times that a grid is finer where no start of the usual one leads to a stop."""

MAX_REPAIRS = 4
"""Times that the pulses of a stop are made anew of what it says of them."""

SMALL_GAP = 5e-5
"""Way that a stop may be above what duality proves before finer grids are tried, as a turn of the
slowest mode [rad]."""

SAME_WAY_S = 1e-12
"""Ways within it are one [s]."""

MOVING = 1e-9
"""Velocity above which a drive moves, as share of full speed [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EmergencyStop:
    """An emergency stop of one axis.

    Attributes
    ----------
    plan
        Its switches; ``fallback`` says why more swings than was asked for.
    end_s
        When no more than `swing_left` swings [s].
    way_s
        What the axis travels until it is at rest, times full speed, signed: from when the drive
        answers on, its coasting counted [s].
    swing_left
        Largest swing in any mode at the end, over that of an unshaped step [-].
    """

    plan: Plan
    end_s: float
    way_s: float
    swing_left: float


def emergency_stop(
    actuator: Unlimited,
    modes: Sequence[Mode],
    axis: AxisState,
    request: EmergencyRequest,
) -> EmergencyStop:
    """Return the stop of least way.

    Parameters
    ----------
    actuator, modes
        The drive, and the modes of the plant as it is now.
    axis
        The axis when the drive first answers: after the dead time, what was sent before made.
    request
        What may be left, and until when.

    Returns
    -------
    EmergencyStop
        If every stop has a larger swing by then, one with about the least, and the plan says so.
    """
    lags = actuator.accel_lag, actuator.decel_lag
    poles = np.array([mode.pole_rad_s for mode in modes])
    end_s = request.within_periods * math.tau / float(np.abs(poles).min())
    lag_rows = np.array([[lag.first_s, lag.second_s2] for lag in lags])
    found = []
    for direction in _directions(axis):
        case = StopCase(
            level=abs(axis.level),
            force=axis.force,
            lag=direction * axis.lag,
            vibration=direction * np.array(axis.vibration, dtype=np.complex128),
            lags=lag_rows,
            poles_rad_s=poles,
            switched=actuator.model == "switched",
            end_s=end_s,
        )
        found.append((stop_case(case, request.swing_left), direction))
    done, direction = min(found, key=lambda one: _badness(one[0]))
    sent_s = axis.time_s - actuator.dead_time_s
    reason = None
    if not done.asked:
        reason = (
            f"within {request.within_periods:g} periods no stop was found with a swing of "
            f"{request.swing_left:g} unshaped steps or less; the swing of this one is "
            f"{done.swing_left:.4g}, about the least"
        )
    plan = Plan(
        times_s=tuple((sent_s + done.stop.times_s).tolist()),
        levels=tuple((direction * done.stop.levels + 0.0).tolist()),
        fallback=reason,
    )
    return EmergencyStop(
        plan=plan,
        end_s=axis.time_s + end_s,
        way_s=direction * done.stop.way_s,
        swing_left=done.swing_left,
    )


def _directions(axis: AxisState) -> tuple[float, ...]:
    """Return the direction of an axis; both where it stands."""
    for value in (axis.level, float(axis.lag[:, 0].sum()), axis.target):
        if abs(value) > MOVING:
            return (math.copysign(1.0, value),)
    return (1.0, -1.0)


def _badness(one: "CaseStop") -> tuple[bool, float, float]:
    """Return what is least for the better of two directions."""
    return not one.asked, 0.0 if one.asked else one.swing_left, abs(one.stop.way_s)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CaseStop:
    """The stop of a case.

    Attributes
    ----------
    stop
        Its switches, what they leave, and the way.
    swing_left
        Largest share of an unshaped step's swing at the end in any mode [-].
    asked
        Whether that is no more than was asked for; else it is about the least that can be.
    """

    stop: Stop
    swing_left: float
    asked: bool


def stop_case(case: StopCase, swing_left: float) -> CaseStop:
    """Return the stop of least way.

    Parameters
    ----------
    case
        State, drive, modes and end.
    swing_left
        As of `EmergencyRequest`.

    Returns
    -------
    CaseStop
        If every stop has a larger swing by then, one with about the least.
    """
    units = np.abs(case.gains[0])
    radii = swing_left * units
    # With sets that differ each of them, and the mean of both, is as good a guess.
    gains = [case.gains.mean(axis=0)]
    if np.any(case.gains[0] != case.gains[1]):
        gains += list(case.gains)
    best = _at_once(case)
    if np.all(np.abs(best.vibration) <= radii + EXACT):
        return _told(case, best, asked=True)
    found = _least_way(case, gains, radii, FINER)
    if found is not None:
        return _told(case, found, asked=True)
    least = least_swing(case, gains[0]).share
    for margin in MARGINS:
        share = max(least, swing_left) + margin
        found = _least_way(case, gains, share * units, ())
        if found is not None:
            return _told(case, found, asked=False)
    return _told(case, best, asked=False)


def _least_way(
    case: StopCase, gains: list[ComplexArray], radii: FloatArray, finer: tuple[int, ...]
) -> Stop | None:
    """Return the least way that is found from starts by several transfer functions."""
    best: Stop | None = None
    feasible = False
    for one, fineness in [*((one, 1) for one in gains), *((gains[0], more) for more in finer)]:
        if fineness > 1 and not feasible:
            break
        pulses = starting_pulses(case, one, radii, fineness)
        if pulses is None:
            continue
        feasible = True
        found = _repaired(case, one, radii, refine(case, pulses, radii))
        if found is not None and (best is None or found.way_s < best.way_s):
            best = found
        if best is None:
            continue
        alike = len(gains) == 1
        if not alike or _gap_s(case, best, radii) * case.slowest_rad_s <= SMALL_GAP:
            break
    return best


def _repaired(
    case: StopCase, gains: ComplexArray, radii: FloatArray, best: Stop | None
) -> Stop | None:
    """Return a stop with the short pulses that a grid has missed."""
    for _ in range(MAX_REPAIRS):
        if best is None:
            break
        found = refine(case, pulses_by_pulls(case, gains, best.pulls), radii)
        if found is None or found.way_s >= best.way_s - SAME_WAY_S:
            break
        best = found
    return best


def _gap_s(case: StopCase, stop: Stop, radii: FloatArray) -> float:
    """Return how much shorter than a stop behind sets that are alike a way might be [s]."""
    off = _at_once(case)
    known = off.way_s + float((np.conj(stop.pulls) * off.vibration).real.sum())
    allowed = float((radii * np.abs(stop.pulls)).sum())
    return stop.way_s - known + allowed - least_added_way(case, case.gains[0], stop.pulls)


def _at_once(case: StopCase) -> Stop:
    off = case.switches_of([])
    left = case.left_by(off.times_s, off.levels)
    return Stop(off.times_s, off.levels, left.vibration, left.way_s, np.zeros_like(left.vibration))


def _told(case: StopCase, stop: Stop, *, asked: bool) -> CaseStop:
    share = float((np.abs(stop.vibration) / np.abs(case.gains[0])).max())
    return CaseStop(stop=stop, swing_left=share, asked=asked)
