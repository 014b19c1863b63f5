"""On-off force on a free body: levels -1, 0 and 1 in minimum time, or of least force in a time.

The force u moves the body from rest to rest over a way, ``integral u = 0`` and ``integral (T - t) u
= way``, and excites no mode, ``integral u exp(s (T - t)) = 0`` with derivatives by frequency. All
are linear in u, and ``|u| <= 1``: the problem is convex. Its dual has a few unknowns, the weights
of the functions above, and their sum q(t) says when to switch: ``u = sign(q)`` in minimum time, and
``u = sign(q)`` where ``|q| > 1``, else 0, of least force. It is solved by Newton's method; the
times of the switches are then refined until the equations hold to rounding.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from design.model.plants.mode import Mode
from design.solvers.least_squares import least_squares
from design.types import FloatArray

POINTS_PER_PERIOD = 80
"""Points at which q is looked at for its zeros, over the period of the fastest mode [-]."""

MIN_POINTS = 800

MAX_ITERATIONS = 60
"""Of Newton's method for the weights; some ten are usual."""

GRADIENT = 1e-12
"""What the integrals miss, as a share of the time, at which the weights are found [-]."""

NEAR_GRADIENT = 2e-4
"""The same at which rounding may have stopped the search; the times are refined besides [-]."""

MAX_DAMPINGS = 20
"""Of one step of Newton's method."""

CELLS = 400
"""Of the linear program that Newton's method begins with."""

BISECTIONS = 7
"""Of the time, by linear programs: down to a hundredth of the bracket."""

HALVINGS = 60
"""Of an interval with a zero: down to rounding."""

REFINED = 2e-16
"""What of the equations counts as rounding, over their sizes [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ForceTask:
    """What an on-off force has to do.

    Attributes
    ----------
    modes
        That must not be excited.
    way_s2
        Distance times mass over force [s^2].
    derivatives
        How many derivatives by the frequency vanish too, 0 or 1.
    """

    modes: tuple[Mode, ...]
    way_s2: float
    derivatives: int

    @cached_property
    def poles_rad_s(self) -> FloatArray:
        """Pole of each mode, shape (m,)."""
        return np.array([mode.pole_rad_s for mode in self.modes])

    @property
    def fastest_rad_s(self) -> float:
        """Frequency of the fastest mode."""
        return max(mode.natural_frequency_rad_s for mode in self.modes)

    def functions(self, left_s: FloatArray) -> FloatArray:
        """Return the functions that u is integrated with, by the time left.

        Parameters
        ----------
        left_s
            ``T - t``, shape (n,) [s].

        Returns
        -------
        FloatArray
            Shape (k, n): time left [s], 1, then parts of each mode, with time left as w (T - t).
        """
        rows = [left_s, np.ones_like(left_s)]
        for pole in self.poles_rad_s:
            wave = np.exp(pole * left_s)
            for order in range(self.derivatives + 1):
                weighted = (abs(pole) * left_s) ** order * wave
                rows += [weighted.real, weighted.imag]
        return np.array(rows)

    def integrals(self, left_s: FloatArray) -> FloatArray:
        """Return the integrals of `functions` from 0 to each time left, (k, n)."""
        rows = [left_s**2 / 2, left_s]
        for pole in self.poles_rad_s:
            wave = np.exp(pole * left_s)
            rows += _parts(np.expm1(pole * left_s) / pole)
            if self.derivatives:  # of w x exp(s x)
                rows += _parts(abs(pole) * (left_s * wave - np.expm1(pole * left_s) / pole) / pole)
        return np.array(rows)

    @property
    def goal(self) -> FloatArray:
        """What the integrals of u must be, shape (k,)."""
        goal = np.zeros(2 + 2 * len(self.modes) * (1 + self.derivatives))
        goal[0] = self.way_s2
        return goal

    def moments(self, times_s: FloatArray, amplitudes: FloatArray, end_s: float) -> FloatArray:
        """Return the integrals of a force of steps.

        Parameters
        ----------
        times_s, amplitudes
            Steps of the force before the end, shape (n,) [s], [-].
        end_s
            Time T [s].

        Returns
        -------
        FloatArray
            Shape (k,).
        """
        return self.integrals(end_s - times_s) @ amplitudes


def _parts(values: FloatArray) -> list[FloatArray]:
    return [values.real, values.imag]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForceSteps:
    """Steps of a force, the last of which ends the move.

    Attributes
    ----------
    times_s, amplitudes
        Shape (n,), the first at 0 [s], [-].
    weights
        Of the functions of the task in q, shape (k,): by them a bound is proven.
    """

    times_s: FloatArray
    amplitudes: FloatArray
    weights: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Signs:
    """Where q is beyond a threshold: crossings, the force that begins at each, and slopes."""

    times_s: FloatArray  # Shape (n,), rising; the begin is the first if q is beyond there
    levels: FloatArray  # Force from each on, shape (n,)
    slopes: FloatArray  # |q'| at each; infinite at the begin

    def moments(self, task: ForceTask, end_s: float) -> FloatArray:
        """Return the integrals of the force."""
        return task.moments(self.times_s, np.diff(self.levels, prepend=0.0), end_s)


def _signs(task: ForceTask, weights: FloatArray, end_s: float, threshold: float) -> _Signs:
    """Find where q crosses the threshold, either way."""
    count = int(max(MIN_POINTS, POINTS_PER_PERIOD * task.fastest_rad_s * end_s / (2 * np.pi)))
    grid = np.linspace(0.0, end_s, count + 1)

    def value(times_s: FloatArray) -> FloatArray:
        q: FloatArray = weights @ task.functions(end_s - times_s)
        return q

    def level(q: FloatArray) -> FloatArray:
        signs = np.where(q >= 0, 1.0, -1.0)
        return np.where(np.abs(q) > threshold, signs, 0.0) if threshold else signs

    values = value(grid)
    # Beside its nearest approach to the threshold q may cross it twice between two points.
    gaps = np.abs(values) - threshold if threshold else values
    sides = np.abs(gaps)
    near = (sides[1:-1] < sides[:-2]) & (sides[1:-1] < sides[2:])
    near &= (gaps[1:-1] * gaps[:-2] > 0) & (gaps[1:-1] * gaps[2:] > 0)
    (at,) = np.nonzero(near)
    left, here, right = gaps[at], gaps[at + 1], gaps[at + 2]
    vertices = grid[at + 1] + grid[1] / 2 * (left - right) / (left - 2 * here + right)
    grid, own = np.unique(np.concatenate((grid, vertices)), return_index=True)
    levels = level(np.concatenate((values, value(vertices)))[own])
    (changes,) = np.nonzero(np.diff(levels))
    low, high = grid[changes], grid[changes + 1]
    before = levels[changes]
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        same = level(value(middle)) == before
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    step = 1e-6 * end_s / count
    slopes = np.abs(value(high + step) - value(high - step)) / (2 * step)
    times = np.concatenate(([0.0], high))
    return _Signs(
        times,
        np.concatenate((levels[:1], levels[changes + 1])),
        np.concatenate(([np.inf], slopes)),
    )


def _judge(
    task: ForceTask, weights: FloatArray, end_s: float, threshold: float
) -> tuple[float, FloatArray, _Signs]:
    """Return ``integral max(|q| - threshold, 0)``, the integrals of the force, and its switches."""
    signs = _signs(task, weights, end_s, threshold)
    moments = signs.moments(task, end_s)
    lasting = float(np.diff(signs.times_s, append=end_s) @ np.abs(signs.levels))
    return float(weights @ moments) - threshold * lasting, moments, signs


def _dual(
    task: ForceTask, weights: FloatArray, end_s: float, threshold: float
) -> tuple[FloatArray, float, bool]:
    """Minimize ``integral max(|q| - threshold, 0) - weights . goal``, by Newton's method.

    In minimum time the first weight stays as it is. Returns the weights, the integral, and whether
    they are found.
    """
    free = slice(1 if threshold == 0 else 0, None)
    goal = task.goal
    samples = task.functions(np.linspace(0.0, end_s, MIN_POINTS))[free]
    metric = samples @ samples.T * (end_s / MIN_POINTS)
    now, damping = weights.copy(), 1e-12
    beyond, moments, signs = _judge(task, now, end_s, threshold)

    def size(gradient: FloatArray) -> float:
        square = float(gradient @ np.linalg.solve(metric, gradient))
        return float(np.sqrt(max(0.0, square) / end_s))

    for _ in range(MAX_ITERATIONS):
        gradient = (moments - goal)[free]
        if size(gradient) <= GRADIENT:
            return now, beyond, True
        crossings = task.functions(end_s - signs.times_s[1:])[free]
        jumps = np.abs(np.diff(signs.levels)) / np.maximum(signs.slopes[1:], 1e-300)
        hessian = (crossings * jumps) @ crossings.T
        cost = beyond - float(now @ goal)
        for _ in range(MAX_DAMPINGS):
            tried = now.copy()
            tried[free] -= np.linalg.solve(
                hessian + damping * np.abs(hessian).max() / np.abs(metric).max() * metric, gradient
            )
            found = _judge(task, tried, end_s, threshold)
            gains = found[0] - float(tried @ goal) < cost
            if gains or size((found[1] - goal)[free]) < size(gradient) / 2:
                now, (beyond, moments, signs) = tried, found
                damping = max(damping / 100, 1e-15)
                break
            damping *= 30
        else:
            break
    return now, beyond, size((moments - goal)[free]) <= NEAR_GRADIENT


def _on_cells(task: ForceTask, end_s: float, *, least: bool) -> tuple[FloatArray, float] | None:
    """Solve on even cells by linear programming; return the weights and the optimum.

    The optimum is the farthest way of a time or, where it is asked for, the least time under
    force. None if there is no such force on these cells.
    """
    from scipy.optimize import linprog  # noqa: PLC0415 - takes longer to import than a design

    edges = end_s - np.linspace(0.0, end_s, CELLS + 1)
    pieces = -np.diff(task.integrals(edges), axis=1)
    scales = np.abs(pieces).sum(axis=1)
    rows, right = pieces / scales[:, None], task.goal / scales
    if least:  # u = p - n
        cost = np.full(2 * CELLS, end_s / CELLS)
        found = linprog(cost, A_eq=np.hstack((rows, -rows)), b_eq=right, bounds=(0, 1))
    else:
        found = linprog(-rows[0], A_eq=rows[1:], b_eq=right[1:], bounds=(-1, 1))
    if found.status != 0:
        return None
    duals = np.asarray(found.eqlin.marginals)
    if least:
        return duals / scales, float(found.fun)
    # The marginals are of the cost, -way over the scale: q is the way's weight less theirs.
    weights = np.concatenate(([1.0], scales[0] * duals / scales[1:]))
    return weights, float(-found.fun * scales[0])


def least_time(task: ForceTask) -> ForceSteps | None:
    """Return the force that makes the way in minimum time.

    Parameters
    ----------
    task
        What it has to do.

    Returns
    -------
    ForceSteps or None
        On levels -1 and 1; None if the search for the weights ended before.
    """
    low = 2 * float(np.sqrt(task.way_s2))
    high = low + 2 * np.pi * sum(
        (1 + task.derivatives) / mode.natural_frequency_rad_s for mode in task.modes
    )
    for _ in range(BISECTIONS):
        found = _on_cells(task, high, least=False)
        if found is not None and found[1] >= task.way_s2:
            break
        low, high = high, 1.5 * high  # a damped mode may need longer
    else:
        return None
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        now = _on_cells(task, middle, least=False)
        if now is not None and now[1] >= task.way_s2:
            high, found = middle, now
        else:
            low = middle
    weights, end_s = found[0], high
    for _ in range(MAX_ITERATIONS):
        weights, way, done = _dual(task, weights, end_s, 0.0)
        if not done:
            return None
        # The way grows by |q| at the begin.
        begun = abs(float(weights @ task.functions(np.array([end_s]))[:, 0]))
        step = (task.way_s2 - way) / max(begun, 1e-300)
        end_s += float(np.clip(step, -0.1 * end_s, 0.1 * end_s))
        if abs(step) <= 1e-11 * end_s:
            break
    weights, _, _ = _dual(task, weights, end_s, 0.0)
    return _refined(task, weights, end_s, 0.0, free_end=True)


def least_force(task: ForceTask, end_s: float) -> ForceSteps | None:
    """Return the force that makes the way in a time, on as shortly as may be.

    Parameters
    ----------
    task
        What it has to do.
    end_s
        The time, longer than the least [s].

    Returns
    -------
    ForceSteps or None
        On levels -1, 0 and 1; None if the search for the weights ended before.
    """
    found = _on_cells(task, end_s, least=True)
    if found is None:
        return None
    weights, _, done = _dual(task, found[0], end_s, 1.0)
    return _refined(task, weights, end_s, 1.0, free_end=False) if done else None


def _refined(
    task: ForceTask, weights: FloatArray, end_s: float, threshold: float, *, free_end: bool
) -> ForceSteps | None:
    """Bring the times of switches to where the equations hold to rounding, the nearest such."""
    signs = _signs(task, weights, end_s, threshold)
    amplitudes = np.diff(signs.levels, prepend=0.0)
    switched = amplitudes != 0
    times, amplitudes = signs.times_s[switched], amplitudes[switched]
    begins = bool(times.size) and times[0] == 0.0
    for _ in range(MAX_ITERATIONS):
        misses = task.moments(times, amplitudes, end_s) - task.goal
        sizes = np.abs(task.integrals(np.array([end_s]))).max(axis=1) + end_s
        functions = task.functions(end_s - times)
        slopes = -functions * amplitudes
        columns = [slopes[:, 1:] if begins else slopes]
        if free_end:
            columns.append((functions @ amplitudes)[:, None])
        step = least_squares(np.hstack(columns) / sizes[:, None], -misses / sizes, 1e-10)
        head = int(begins)
        moved = times.copy()
        moved[head:] += step[: times.size - head]
        if free_end:
            end_s += float(step[-1])
        if not (moved.size and (np.diff(moved) > 0).all() and moved[0] >= 0 and moved[-1] < end_s):
            return None
        times = moved
        if np.abs(step).max() <= 4 * REFINED * end_s:
            break
    last = -amplitudes.sum()
    if last:
        times, amplitudes = np.append(times, end_s), np.append(amplitudes, last)
    return ForceSteps(times_s=times - times[0], amplitudes=amplitudes, weights=weights)
