"""How early no limited reference meets its targets: a bound, proven between points too.

A reference r starts at 0, has slopes from ``-down`` to ``up`` and levels from 0 to 1. If it meets
``|integral of r' kernel_k - g_k| <= V exp(-Re(s_k) T)`` at T then, whatever the c and the function
N of time::

    P(t) = Re sum conj(c_k) kernel_k(t),    kernel_k(t) = (-t)^o_k exp(-s_k t)
    Re sum conj(c_k) g_k + V sum |c_k| exp(-Re(s_k) T)
      >= integral of r' P = integral of r' (P + N) - integral of r' N
      >= - integral of h(P + N) - N(T) r(T) - fall of N,    h(q) = max(-up q, down q)

since ``integral of r' N = N(T) r(T) - integral of r dN`` and r is between 0 and 1. A duration at
which the right side is larger than the left one is too short. The best N is constant while the
optimum moves and -P while it rests at 0 or 1.
"""

from dataclasses import dataclass

import numpy as np

from design.analysis.pulls import agree, longest_excluded, steepest
from design.types import BoolArray, ComplexArray, FloatArray

CELLS = 256
"""Cells of the whole time at first, beside those that the changes of the slope begin [-]."""

SPLIT = 8
"""Cells that one becomes about which nothing is sure [-]."""

ROUNDS = 3
"""How often cells are split."""

NEARLY_ZERO = 1e-10
"""Share of the largest P that P + N may be beyond 0 within a cell that counts as one-sided [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RampedProof:
    """What excludes limited references that end early.

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
    up, down
        Steepest slopes of the reference [1/rad].
    last
        Its level at the end, 0 or 1 [-].
    rests
        When the optimum arrives at 0 or 1 and when it departs, shape (r, 2) [rad].
    turns
        When its slope changes; cells are cut there, where P + N is near 0, shape (n,) [rad].
    end
        When the optimum ends [rad].
    """

    poles: ComplexArray
    orders: FloatArray
    multipliers: ComplexArray
    targets: ComplexArray
    tolerance: float
    up: float
    down: float
    last: float
    rests: FloatArray
    turns: FloatArray
    end: float

    def _pull(self, times: FloatArray) -> FloatArray:
        """Return P."""
        kernels = np.where(self.orders[:, None] == 1, -times, 1.0)
        pull: FloatArray = (
            self.multipliers.conj() @ (kernels * np.exp(-self.poles[:, None] * times))
        ).real
        return pull

    def _rates(self, times: FloatArray) -> FloatArray:
        """Return the derivative of P."""
        s = self.poles[:, None]
        rates = np.where(self.orders[:, None] == 1, s * times - 1, -s)
        pull: FloatArray = (self.multipliers.conj() @ (rates * np.exp(-s * times))).real
        return pull

    def _areas(self, times: FloatArray) -> FloatArray:
        """Return an antiderivative of P."""
        still = self.poles[:, None] == 0
        s = np.where(still, 1.0, self.poles[:, None])
        first = self.orders[:, None] == 1
        swinging = np.where(first, (times + 1 / s) / s, -1 / s) * np.exp(-s * times)
        areas: FloatArray = (
            self.multipliers.conj()
            @ np.where(still, np.where(first, -times * times / 2, times), swinging)
        ).real
        return areas

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
        even = np.linspace(0, duration, CELLS + 1)
        edges = np.concatenate((even, self.rests.ravel(), self.turns))
        edges = np.unique(edges[edges <= duration])
        for _ in range(ROUNDS):
            unsure = self._costs(edges)[1]
            if not unsure.any():
                break
            parts = np.diff(edges)[unsure, None] / SPLIT * np.arange(1, SPLIT)
            edges = np.union1d(edges, (edges[:-1][unsure, None] + parts).ravel())
        costs, _ = self._costs(edges)
        final, _ = self._constants(np.array([duration]))
        wanted = float((self.multipliers.conj() @ self.targets).real)
        allowed = np.abs(self.multipliers) @ np.exp(-self.poles.real * duration)
        wanted += self.tolerance * float(allowed)
        falls = self._falls_of_levels(duration)
        return -float(costs.sum()) - float(final[0]) * self.last - falls - wanted

    def _costs(self, edges: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Return what each cell adds to the integral of h and to the fall of N, at most.

        The second array says in which cells a finer one may add less.
        """
        starts, ends = edges[:-1], edges[1:]
        widths = ends - starts
        pull, rates = self._pull(edges), self._rates(edges)
        sag = widths**2 / 8 * self._steepest(ends, 2)
        monotone = agree(rates[:-1], rates[1:], widths**2 / 8 * self._steepest(ends, 3))
        constants, resting = self._constants((starts + ends) / 2)
        # While it rests N is -P: it falls as P rises, at most as long as at its steepest.
        whole = widths * (np.maximum(np.abs(rates[:-1]), np.abs(rates[1:])) + 4 * sag / widths)
        rises = np.where(monotone, np.maximum(np.diff(pull), 0.0), whole)
        before, after = pull[:-1] + constants, pull[1:] + constants
        nearly = NEARLY_ZERO * float(np.abs(pull).max())
        sure = agree(before, after, np.where(monotone, -nearly, sag))
        steepest = max(self.up, self.down)
        exact = self._cost(np.diff(self._areas(edges)) + constants * widths)
        chord = widths * (self._cost(before) + self._cost(after)) / 2
        beyond = np.minimum(np.abs(before), np.abs(after))  # 0 but for rounding, where signs differ
        rounding = np.where(before * after < 0, 2 * steepest * widths * beyond, 0.0)
        moving = np.where(sure, exact + rounding, chord + steepest * widths * sag)
        return np.where(resting, rises, moving), np.where(resting, ~monotone, ~sure)

    def _cost(self, q: FloatArray) -> FloatArray:
        cost: FloatArray = np.maximum(-self.up * q, self.down * q)
        return cost

    def _levels(self) -> FloatArray:
        """Return N of each stretch between two rests, shape (r + 1,)."""
        arriving = -self._pull(self.rests[:, 0])
        slope = self.up if self.last == 1 else -self.down
        # At the end P + N is -1 over the slope, as the multipliers are scaled.
        return np.append(arriving, -1 / slope - self._pull(np.array([self.end])))

    def _constants(self, times: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Return N, and whether the optimum rests, at some times."""
        after = np.searchsorted(self.rests[:, 0], times, side="left")
        before_leaving = np.searchsorted(self.rests[:, 1], times, side="left")
        resting = after > before_leaving
        constants = np.where(resting, -self._pull(times), self._levels()[after])
        return constants, resting

    def _falls_of_levels(self, duration: float) -> float:
        """Return by how much N falls in steps: where the optimum ends a rest."""
        left = self.rests[:, 1] < duration
        steps = self._levels()[1:][left] + self._pull(self.rests[left, 1])
        return float(np.maximum(-steps, 0.0).sum())


def excluded_end_rad(proof: RampedProof) -> float:
    """Return a time before which no reference meets its targets.

    Parameters
    ----------
    proof
        The limits, the multipliers, and where the optimum moves and rests.

    Returns
    -------
    float
        At most the optimum's end [rad]; 0 excludes nothing.
    """
    return longest_excluded(proof.surplus, proof.end)
