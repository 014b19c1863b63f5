"""How early no reference of limited slope and jerk meets its targets: a proven bound.

A reference r starts at rest at 0 and ends at rest, has slopes v from ``-down`` to ``up``, jerks u
of at most J, and levels from 0 to 1. If it meets
``|integral of v kernel_k - g_k| <= V exp(-Re(s_k) T)`` at T, then whatever the c, the function N
and the piecewise smooth y of time, with ``R = P + N - y'`` ::

    P(t) = Re sum conj(c_k) kernel_k(t),    kernel_k(t) = (-t)^o_k exp(-s_k t)
    Re sum conj(c_k) g_k + V sum |c_k| exp(-Re(s_k) T)
      >= integral of v P = integral of v (R + y') - integral of v N
      >= - integral of h(R) - J integral of |y| - sum over jumps of y of h(jump)
         - N(T) r(T) - fall of N,    h(q) = max(-up q, down q)

since ``integral of v y' = - integral of u y - jumps of y times v``, v being 0 at both ends, and
``integral of v N = N(T) r(T) - integral of r dN`` with r between 0 and 1. A duration at which the
right side is larger than the left one is too short. The best y is 0, and R is P + N, while the
optimum's slope is at a limit; elsewhere R is 0. While it rests N is -P.
"""

from dataclasses import dataclass

import numpy as np

from design.analysis.pulls import agree, longest_excluded, steepest
from design.types import BoolArray, ComplexArray, FloatArray

CELLS = 256
"""Cells of the whole time at first, beside those that the events begin [-]."""

SPLIT = 8
"""Cells that one becomes about which nothing is sure [-]."""

ROUNDS = 4
"""How often cells are split."""

NEARLY_ZERO = 1e-10
"""Share of the largest y, or P, beyond 0 within a cell that counts as one-sided [-]."""

JERKS, AT_LIMIT, RESTS = 0, 1, 2
"""What the optimum does between two events."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class JerkProof:
    """What excludes references of limited jerk that end early.

    Attributes
    ----------
    poles, orders
        s and o of the functionals, over a common frequency, shape (m,).
    multipliers
        c, shape (m,).
    targets
        g, shape (m,).
    tolerance
        V of each: 0 where targets are met exactly [-].
    up, down, jerk
        Steepest slopes of the reference and their largest rate [1/rad], [1/rad^2].
    last
        Its level at the end, 0 or 1 [-].
    events
        When the optimum's jerk changes, from 0 to its end, shape (n,) [rad].
    stages
        What it does from one to the next, shape (n - 1,).
    prices
        N from one event to the next, shape (n - 1,); of no meaning at rest.
    final
        y at the end.
    """

    poles: ComplexArray
    orders: FloatArray
    multipliers: ComplexArray
    targets: ComplexArray
    up: float
    down: float
    jerk: float
    last: float
    events: FloatArray
    stages: tuple[int, ...]
    prices: FloatArray
    final: float
    tolerance: float = 0.0

    def _weighted(self, times: FloatArray, integrals: int) -> FloatArray:
        """Return P after so many integrations; -1 is its derivative."""
        still, first = self.poles[:, None] == 0, self.orders[:, None] == 1
        s = np.where(still, 1.0, self.poles[:, None])
        swing = np.exp(-self.poles[:, None] * times) * (-s) ** -float(integrals)
        # The first order is the derivative in s of the zeroth.
        swinging = np.where(first, -(times + integrals / s), 1.0) * swing
        zero = np.zeros_like(times)
        standing = {
            -1: (zero, zero - 1),
            0: (zero + 1, -times),
            1: (times, -(times**2) / 2),
            2: (times**2 / 2, -(times**3) / 6),
        }[integrals]
        kernels = np.where(still, np.where(first, standing[1], standing[0]), swinging)
        weighted: FloatArray = (self.multipliers.conj() @ kernels).real
        return weighted

    def _steepest(self, times: FloatArray, derivative: int) -> FloatArray:
        return steepest(self.poles, self.orders, self.multipliers, times, derivative)

    def surplus(self, duration: float) -> float:
        """Return the right side less the left one, at least.

        Above 0, no reference is as short.

        Parameters
        ----------
        duration
            The duration [rad].

        Returns
        -------
        float
            In the units of the multipliers times the targets.
        """
        end = float(self.events[-1])
        edges = np.concatenate((np.linspace(0, end, CELLS + 1), self.events, [duration]))
        edges = np.unique(np.clip(edges, 0.0, end))
        for _ in range(ROUNDS):
            unsure = self._costs(edges)[1]
            if not unsure.any():
                break
            parts = np.diff(edges)[unsure, None] / SPLIT * np.arange(1, SPLIT)
            edges = np.union1d(edges, (edges[:-1][unsure, None] + parts).ravel())
        costs, _, jumps = self._costs(edges)
        within = edges[:-1] < duration
        wanted = float((self.multipliers.conj() @ self.targets).real)
        allowed = np.abs(self.multipliers) @ np.exp(-self.poles.real * duration)
        wanted += self.tolerance * float(allowed)
        levels, falls = self._levels(duration)
        jumped = self._cost(jumps[within]).sum()
        return -float(costs[within].sum()) - float(jumped) - levels * self.last - falls - wanted

    def _stages(self, edges: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what the optimum does in each cell, and N."""
        # Events are edges themselves: by where a cell starts none is taken for its neighbour.
        which = np.searchsorted(self.events, edges[:-1], side="right") - 1
        which = np.clip(which, 0, len(self.stages) - 1)
        return np.array(self.stages)[which], self.prices[which]

    def _heights(
        self, edges: FloatArray, stages: FloatArray, prices: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return y at both ends of each cell, and by how much it jumps where each begins.

        From the end back: 0 where a stretch at limits of the jerk ends within the course.
        """
        once = self._weighted(edges, 1)
        rises = np.where(stages == JERKS, np.diff(once) + prices * np.diff(edges), 0.0)
        # y at the end of each cell, less that at the end of its stretch.
        total = np.cumsum(rises[::-1])[::-1]
        after = np.append(total[1:], 0.0)
        ends_stretch = (stages == JERKS) & (np.append(stages[1:], JERKS) != JERKS)
        stretch_end = np.flatnonzero(ends_stretch)
        number = np.searchsorted(stretch_end, np.arange(stages.size))
        anchors = np.append(after[stretch_end], self.final)[number]
        after_cells = np.where(stages == JERKS, anchors - after, 0.0)
        before_cells = np.where(stages == JERKS, after_cells - rises, 0.0)
        jumps = before_cells - np.concatenate(([before_cells[0]], after_cells[:-1]))
        return before_cells, after_cells, jumps

    def _costs(self, edges: FloatArray) -> tuple[FloatArray, BoolArray, FloatArray]:
        """Return what each cell costs at most, where a finer one may cost less, and jumps of y.

        Costs are integrals of h(R) and J |y|, and the fall of N at rest.
        """
        stages, prices = self._stages(edges)
        starts, ends = edges[:-1], edges[1:]
        widths = ends - starts
        pull, rates = self._weighted(edges, 0), self._weighted(edges, -1)
        once, twice = self._weighted(edges, 1), self._weighted(edges, 2)
        rate_sag = widths**2 / 8 * self._steepest(ends, 3)
        pull_sag = widths**2 / 8 * self._steepest(ends, 2)
        monotone = agree(rates[:-1], rates[1:], rate_sag)
        # At rest N is -P: it falls as P rises, at most as long as at its steepest.
        whole = widths * np.maximum(np.abs(rates[:-1]), np.abs(rates[1:])) + 4 * pull_sag
        rises = np.where(monotone, np.maximum(np.diff(pull), 0.0), whole)
        # At a limit of the slope R is P + N.
        first, second = pull[:-1] + prices, pull[1:] + prices
        nearly = NEARLY_ZERO * float(np.abs(pull).max())
        one_sided = agree(first, second, np.where(monotone, -nearly, pull_sag))
        exact = self._cost(np.diff(once) + prices * widths)
        exact = exact + 2 * max(self.up, self.down) * widths * _beyond(first, second)
        chord = widths * (self._cost(first) + self._cost(second)) / 2
        sliding = np.where(one_sided, exact, chord + max(self.up, self.down) * widths * pull_sag)
        # At a limit of the jerk y' is P + N.
        before, after, jumps = self._heights(edges, stages, prices)
        turning = widths**2 / 8 * self._steepest(ends, 1)
        strictly = agree(first, second, np.where(monotone, 0.0, pull_sag))
        nearly = NEARLY_ZERO * float(np.abs(before).max())
        steady = agree(before, after, np.where(strictly, -nearly, turning))
        area = before * widths + np.diff(twice) - once[:-1] * widths + prices * widths**2 / 2
        between = widths * ((np.abs(before) + np.abs(after)) / 2 + turning)
        monotonic = np.abs(area) + 2 * widths * _beyond(before, after)
        jerking = self.jerk * np.where(steady, monotonic, between)
        costs = np.choose(stages.astype(int), (jerking, sliding, rises))
        sure = np.choose(stages.astype(int), (steady, one_sided, monotone))
        return costs, ~sure, jumps

    def _cost(self, q: FloatArray) -> FloatArray:
        cost: FloatArray = np.maximum(-self.up * q, self.down * q)
        return cost

    def _levels(self, duration: float) -> tuple[float, float]:
        """Return N at a time, and by how much it falls in steps until then."""
        starts, ends = self.events[:-1], self.events[1:]
        resting = np.array(self.stages) == RESTS
        begins = np.where(resting, -self._weighted(starts, 0), self.prices)
        closes = np.where(resting, -self._weighted(ends, 0), self.prices)
        begun = starts < duration
        steps = (begins[1:] - closes[:-1])[begun[1:]]
        last = int(np.flatnonzero(begun)[-1])
        level = -self._weighted(np.array([duration]), 0)[0] if resting[last] else begins[last]
        return float(level), float(np.maximum(-steps, 0.0).sum())


def _beyond(before: FloatArray, after: FloatArray) -> FloatArray:
    """Return how far what does not change direction is beyond 0 at most: rounding."""
    beyond: FloatArray = np.minimum(np.abs(before), np.abs(after))
    return np.where(before * after < 0, beyond, 0.0)


def excluded_jerky_end_rad(proof: JerkProof) -> float:
    """Return a time before which no reference meets its targets.

    Parameters
    ----------
    proof
        The limits, the multipliers, and what the optimum does when.

    Returns
    -------
    float
        At most the optimum's end [rad]; 0 excludes nothing.
    """
    return longest_excluded(proof.surplus, float(proof.events[-1]))
