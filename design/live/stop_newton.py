"""Newton's method on the times of a stop: the least way under what may swing at its end.

The unknowns are the times of the switches and, where a swing may remain, its phase: at the least
way the vibration lies on the circle of what may remain. The conditions of Lagrange are solved by
steps of which one part meets the equations, and the other goes down within them.
"""

from typing import NamedTuple

import numpy as np

from design.live.stop_case import Pulse, StopCase
from design.types import BoolArray, ComplexArray, FloatArray, IntArray

MAX_ITERATIONS = 20
"""Of Newton's method for one number of pulses: six to ten do."""

MAX_PATTERNS = 8
"""Numbers of pulses that one start goes through: each has a pulse or a gap less."""

EXACT = 1e-12
"""Largest error of a vibration: rounding of some ten terms about 1 [-]."""

SAME_TURN = 1e-9
"""Turn of the quickest mode within which times no longer change [rad]."""

MAX_TURN = 0.4
"""Largest step of a time, as a turn of the slowest mode, and of a phase [rad]."""

CLOSED_TURN = 1e-3
"""Turn of the quickest mode below which a pulse or a gap that still closes is none [rad]."""

SHARE_OF_GAP = 0.9
"""Share of a pulse or gap that one step may take [-]."""

SINGULAR = 1e-9
"""Ratio of singular values of equations that hang together [-]."""

DIFFERENCE = 1e-6
"""Turn of the slowest mode over which a gradient is differenced [rad]."""


BELOW = (1.0, 0.5, 0.07)
"""Shares of what may remain that a start may be below and yet be held by it: all, some, as many as
its polygon is off by [-]."""


class Stop(NamedTuple):
    """A stop.

    Attributes
    ----------
    times_s, levels
        Its switches, shape (k,) each [s], [-].
    vibration
        What is left of each mode at its end, shape (m,) [-].
    way_s
        The way [s].
    pulls
        ``way + Re(conj(pulls) vibration)`` is least at it, shape (m,) [s].
    """

    times_s: FloatArray
    levels: FloatArray
    vibration: ComplexArray
    way_s: float
    pulls: ComplexArray


class _Problem(NamedTuple):
    """One pattern: the times that are free, and the modes whose circle is met."""

    case: StopCase
    levels: FloatArray
    which: IntArray
    own: IntArray
    radii: FloatArray


def refine(case: StopCase, pulses: list[Pulse], radii: FloatArray) -> Stop | None:
    """Return the stop of least way near pulses.

    Parameters
    ----------
    case
        State, drive, modes and end.
    pulses
        Where to start.
    radii
        What may remain of each mode at the end, shape (m,) [-].

    Returns
    -------
    Stop or None
        None where none is near.
    """
    start = case.switches_of(pulses)
    vibration = np.abs(case.left_by(start.times_s, start.levels).vibration)
    best: Stop | None = None
    tried: list[list[bool]] = []
    for below in BELOW:
        own = (radii == 0) | (vibration >= (1 - below) * radii)
        if own.tolist() in tried:
            continue
        tried.append(own.tolist())
        found = _settle(case, pulses, radii, own)
        if found is not None and (best is None or found.way_s < best.way_s):
            best = found
    return best


def _settle(case: StopCase, pulses: list[Pulse], radii: FloatArray, own: BoolArray) -> Stop | None:
    """Return the stop of least way, the circles that hold it changed until they are right."""
    for _ in range(MAX_PATTERNS):
        found = _solve(case, pulses, radii, own)
        if isinstance(found, list):
            pulses = found
        elif found is None:
            return None
        else:
            stop, pulling = found
            over = np.abs(stop.vibration) > radii + EXACT
            if not np.any(over) and np.all(pulling):
                return stop
            # A mode that would rather swing more stays on its circle; another is left inside it.
            if np.array_equal(own, pulling | over):
                return None if np.any(over) else stop
            own = pulling | over
            pulses = case.pulses_of(stop.times_s, stop.levels)
    return None


def _solve(
    case: StopCase, pulses: list[Pulse], radii: FloatArray, active: BoolArray
) -> tuple[Stop, BoolArray] | list[Pulse] | None:
    """Solve one pattern: a stop and which circles hold it, other pulses, or nothing."""
    times, levels, free = case.switches_of(pulses)
    (which,), (own,) = np.nonzero(free), np.nonzero(active)
    problem = _Problem(case, levels, which, own, radii[own])
    (round_,) = np.nonzero(problem.radii > 0)
    if which.size + round_.size < 2 * own.size:
        return None
    angles = np.angle(case.left_by(times, levels).vibration[own])
    pulls: FloatArray | None = None
    for _ in range(MAX_ITERATIONS):
        left = case.left_by(times, levels)
        target = problem.radii * np.exp(1j * angles)
        rows = np.zeros((own.size, which.size + round_.size), dtype=np.complex128)
        rows[:, : which.size] = left.by_times[which][:, own].T
        rows[round_, which.size + np.arange(round_.size)] = -1j * target[round_]
        missing = left.vibration[own] - target
        jacobian = np.concatenate((rows.real, rows.imag))
        slope = np.append(left.way_by_times[which], np.zeros(round_.size))
        outer, sizes, inner = np.linalg.svd(jacobian)
        if own.size and sizes[-1] <= SINGULAR * sizes[0]:
            return None
        inverse = (inner[: sizes.size].T / sizes) @ outer.T
        step = -inverse @ np.concatenate((missing.real, missing.imag))
        along = inner[sizes.size :].T
        if pulls is None:
            pulls = -inverse.T @ slope
        if along.shape[1]:
            curved = _curvature(problem, times, target, round_, pulls)
            bends, axes = np.linalg.eigh(along.T @ curved @ along)
            bends = np.maximum(np.abs(bends), EXACT + DIFFERENCE * np.abs(bends).max())
            downward = axes.T @ along.T @ (slope + curved @ step)
            step = step - along @ (axes @ (downward / bends))
            slope = slope + curved @ step
        pulls = -inverse.T @ slope
        shifts = np.zeros(times.size)
        shifts[which] = step[: which.size]
        share, closing = _share_of_step(case, times, shifts, step[which.size :])
        if closing is not None:
            return _without(case, times, levels, closing)
        times = times + share * shifts
        angles[round_] += share * step[which.size :]
        if share == 1.0 and np.abs(shifts).max(initial=0.0) * case.quickest_rad_s < SAME_TURN:
            break
    left = case.left_by(times, levels)
    each = np.zeros(radii.size, dtype=np.complex128)
    each[own] = pulls[: own.size] + 1j * pulls[own.size :] if pulls is not None else 0
    stop = Stop(times, levels, left.vibration, left.way_s, each)
    largest = EXACT * (1 + float(np.abs(case.vibration).max()))
    if np.any(np.abs(left.vibration)[own] > problem.radii + largest):
        return None
    pulling = active.copy()
    # A circle holds the stop if the way would be less with more swing.
    pulling[own] = (problem.radii == 0) | ((np.conj(each[own]) * left.vibration[own]).real > 0)
    return stop, pulling


def _share_of_step(
    case: StopCase, times_s: FloatArray, shifts_s: FloatArray, turns: FloatArray
) -> tuple[float, int | None]:
    """Return how much of a step is made, and which gap it would close for good."""
    reach = case.slowest_rad_s * float(np.abs(shifts_s).max(initial=0.0))
    reach = max(reach, float(np.abs(turns).max(initial=0.0)))
    share = min(1.0, MAX_TURN / reach) if reach > 0 else 1.0
    gaps = np.diff(times_s, prepend=0.0, append=case.end_s)
    closing = -np.diff(shifts_s, prepend=0.0, append=0.0)
    (narrow,) = np.nonzero(share * closing > SHARE_OF_GAP * gaps)
    if not narrow.size:
        return share, None
    shares = SHARE_OF_GAP * gaps[narrow] / closing[narrow]
    first = int(narrow[shares.argmin()])
    if gaps[first] * case.quickest_rad_s < CLOSED_TURN:
        return share, first
    return float(shares.min()), None


def _without(case: StopCase, times_s: FloatArray, levels: FloatArray, closing: int) -> list[Pulse]:
    """Return the pulses without a pulse or a gap that closes."""
    edges = [0.0, *times_s.tolist(), case.end_s]
    left, right = edges[closing], edges[closing + 1]
    kept: list[Pulse] = []
    for on, off in case.pulses_of(times_s, levels):
        if left <= on and off <= right:
            continue
        begin = 0.0 if closing == 0 and on <= right else on
        end = case.end_s if closing == len(edges) - 2 and off >= left else off
        if kept and kept[-1][1] >= left and begin <= right:
            kept[-1] = (kept[-1][0], end)
        else:
            kept.append((begin, end))
    return kept


def _gradient(problem: _Problem, times_s: FloatArray, pulls: FloatArray) -> FloatArray:
    """Return the gradient of Lagrange's function by the free times."""
    left = problem.case.left_by(times_s, problem.levels)
    rows = left.by_times[problem.which][:, problem.own]
    equations = np.concatenate((rows.real, rows.imag), axis=1)
    found: FloatArray = left.way_by_times[problem.which] + equations @ pulls
    return found


def _curvature(
    problem: _Problem,
    times_s: FloatArray,
    target: ComplexArray,
    round_: IntArray,
    pulls: FloatArray,
) -> FloatArray:
    """Return the second derivatives of Lagrange's function by times, then phases."""
    size, modes = problem.which.size, problem.own.size
    curved = np.zeros((size + round_.size, size + round_.size))
    step = DIFFERENCE / problem.case.slowest_rad_s
    base = _gradient(problem, times_s, pulls)
    for column, switch in enumerate(problem.which.tolist()):
        moved = times_s.copy()
        moved[switch] += step
        curved[column, :size] = (_gradient(problem, moved, pulls) - base) / step
    curved[:size, :size] = (curved[:size, :size] + curved[:size, :size].T) / 2
    on_phases = size + np.arange(round_.size)
    curved[on_phases, on_phases] = (
        pulls[round_] * target[round_].real + pulls[modes + round_] * target[round_].imag
    )
    return curved
