"""The function P of time that excludes short commands, of one plant: see `search`."""

import math

import numpy as np

from design.checks import MAX_VALUE
from design.types import ComplexArray, FloatArray

PERIOD_RAD = 2 * math.pi

ZERO = 1e-12
"""Largest vibration that counts as none, over the unshaped step [-]."""

POINTS_PER_TURN = 24
"""Points of a search for zeros, to a period of the fastest mode [-]."""

MAX_DECAY = 600.0
"""Decay of the fastest decaying mode over the longest duration: its exponential is a number [-]."""

MAX_TURNS = 40.0
"""Longest duration that is searched, in periods of the slowest mode and one mode [-]."""


class DualFunction:
    """``P(t) = Re sum_k conj(c_k) exp(-s_k t)`` of the modes of one plant, for any c.

    Parameters
    ----------
    poles
        Poles of the modes over the lowest natural frequency, shape (m,) [-].
    positive
        Whether amplitudes are positive; else the command is anywhere from 0 to 1.
    """

    def __init__(self, poles: ComplexArray, *, positive: bool) -> None:
        self.poles = poles
        self.positive = positive
        self.fastest = float(np.abs(poles).max())
        decay = max(float(np.abs(poles.real).max()), MAX_DECAY / MAX_VALUE)
        self.horizon_rad = min(MAX_TURNS * PERIOD_RAD * poles.size, MAX_DECAY / decay)
        slowest = float(np.abs(poles).min())
        # A shaper of the slowest mode alone takes half a period, a third where steps go both ways.
        self.first_bound_rad = 0.99 * PERIOD_RAD / slowest / (2 if positive else 3)

    def swings(self, times: FloatArray, order: int = 0) -> ComplexArray:
        """Return ``exp(-s t)`` of every mode, or a derivative in time.

        Parameters
        ----------
        times
            Phases of the lowest natural frequency, shape (n,) [rad].
        order
            Order of the derivative; 0 for ``exp(-s t)`` itself.

        Returns
        -------
        ComplexArray
            Values by mode and time, shape (m, n) [-].
        """
        s = self.poles[:, None]
        found: ComplexArray = (-s) ** order * np.exp(-s * times)
        return found

    def pull(self, vectors: ComplexArray, times: FloatArray, order: int = 0) -> FloatArray:
        """Return P or a derivative of it.

        Parameters
        ----------
        vectors
            c, shape (m,) [-].
        times
            Phases of the lowest natural frequency, shape (n,) [rad].
        order
            Order of the derivative; 0 for P itself.

        Returns
        -------
        FloatArray
            Values at the times, shape (n,) [-].
        """
        found: FloatArray = (vectors.conj() @ self.swings(times, order)).real
        return found

    def zeros(self, vectors: ComplexArray, until: float, order: int) -> FloatArray:
        """Return where a derivative of P changes its sign.

        A grid shows the changes and bisection refines them: two changes within one cell of the grid
        are not seen.

        Parameters
        ----------
        vectors
            c, shape (m,) [-].
        until
            Where the search ends [rad].
        order
            Order of the derivative; 0 for P itself.

        Returns
        -------
        FloatArray
            Phases in ascending order, shape (k,) [rad].
        """
        points = max(64, int(POINTS_PER_TURN * self.fastest * until / PERIOD_RAD))
        times = np.linspace(0, until, points)
        values = self.pull(vectors, times, order)
        left = np.flatnonzero(values[:-1] * values[1:] < 0)
        low, high = times[left], times[left + 1]
        rising = values[left] < 0
        for _ in range(50):  # halves the step to its last digit
            middle = (low + high) / 2
            before = (self.pull(vectors, middle, order) < 0) == rising
            low, high = np.where(before, middle, low), np.where(before, high, middle)
        return (low + high) / 2

    def bound_rad(self, vectors: ComplexArray) -> float:
        """Return the duration that c excludes [rad].

        0 excludes nothing. The bound is as good as the search for zeros, which looks on a grid.
        """
        if self.pull(vectors, np.zeros(1))[0] <= 0:
            return 0.0
        until = 4 * self.first_bound_rad
        while True:
            found = self._bound_until(vectors, until)
            if found < until or until > self.horizon_rad:
                return found
            until *= 2

    def _bound_until(self, vectors: ComplexArray, until: float) -> float:
        turning = np.concatenate(([0.0], self.zeros(vectors, until, 1), [until]))
        heights = self.pull(vectors, turning)
        if self.positive:
            low = np.flatnonzero(heights <= 0)
            if not low.size:
                return until
            last, level = int(low[0]) - 1, 0.0
        else:
            falls = np.cumsum(np.maximum(heights[:-1] - heights[1:], 0))
            last = int(np.searchsorted(falls, heights[0]))
            if last == falls.size:
                return until
            level = float(heights[last + 1] + falls[last] - heights[0])
        low_end, high_end = float(turning[last]), float(turning[last + 1])
        for _ in range(60):
            middle = (low_end + high_end) / 2
            if self.pull(vectors, np.array([middle]))[0] > level:
                low_end = middle
            else:
                high_end = middle
        return low_end
