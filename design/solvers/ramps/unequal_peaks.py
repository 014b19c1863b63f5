"""What commands behind two lags leave over a band, and where that peaks.

With ``F(q) = exp(s T) V(s)``, s the pole at the ratio q, V what is left and T the end::

    dF/dq = ds/dq (T F + exp(s T) V'(s))
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from design.solvers.convex_band.peaks import SCAN_TURN_RAD
from design.solvers.ramps.unequal_course import TwoLags, UnequalCourse
from design.types import BoolArray, ComplexArray, FloatArray

BESIDE = 1e-5
"""Distance of two ratios over which a derivative is a quotient [-]."""

SAME_PEAK = 0.01
"""Share of the pitch of the search within which two peaks are one [-]."""

PEAK_STEPS = 4
"""Newton's steps to a peak from the highest of three neighbours."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Left:
    """The residual of a command at some ratios.

    Attributes
    ----------
    vectors
        F, shape (k,) [-].
    slopes
        Its derivative in the ratio, shape (k,) [-].
    changes, slope_changes
        Their derivatives in each switch after the first, shape (k, n - 1) [1/rad].
    """

    vectors: ComplexArray
    slopes: ComplexArray
    changes: ComplexArray
    slope_changes: ComplexArray

    @property
    def logarithms(self) -> FloatArray:
        """Return ln |F|, shape (k,)."""
        with np.errstate(divide="ignore"):
            return np.log(np.abs(self.vectors))

    @property
    def growths(self) -> FloatArray:
        """Return its derivative in the ratio, shape (k,)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return (self.slopes / self.vectors).real

    @property
    def moves(self) -> FloatArray:
        """Return its derivatives in the switches, shape (k, n - 1)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return (self.changes / self.vectors[:, None]).real


class BandOfTwoLags:
    """The residual over a band, of any command.

    Parameters
    ----------
    lags_at
        What is left at some ratios, of some orders.
    unit_pole
        The mode's pole over its natural frequency [-].
    band
        Lowest and highest ratio [-].
    """

    def __init__(
        self,
        lags_at: Callable[[FloatArray, FloatArray], TwoLags],
        unit_pole: complex,
        band: tuple[float, float],
    ) -> None:
        self.lower, self.upper = band
        self._lags_at, self._unit_pole = lags_at, unit_pole

    def lags(self, ratios: FloatArray) -> TwoLags:
        """Return what is left at some ratios, as functionals of a command."""
        return self._lags_at(ratios, np.zeros(ratios.size))

    def left(self, switches: FloatArray, arrived: BoolArray, ratios: FloatArray) -> Left:
        """Return the residual of a command, with its derivatives.

        Parameters
        ----------
        switches, arrived
            As of `TwoLags.of`.
        ratios
            Shape (k,) [-].

        Returns
        -------
        Left
            At these ratios.
        """
        count = ratios.size
        lags = self._lags_at(np.tile(ratios, 2), np.repeat([0.0, 1.0], count))
        course, poles = lags.of(switches, arrived), lags.poles[:count]
        # Of exp(s T) V and exp(s T) V', each with its derivatives in the switches.
        turned = np.tile(np.exp(poles * course.end), 2)
        parts = turned * course.values
        later = np.multiply.outer(np.tile(poles, 2) * parts, course.end_changes[-1])
        changes = (turned[:, None] * course.changes + later)[:, 1:]
        (vectors, rates), (moved, rates_moved) = np.split(parts, 2), np.split(changes, 2)
        ends, unit = course.end_changes[-1, 1:], self._unit_pole
        return Left(
            vectors=vectors,
            slopes=unit * (course.end * vectors + rates),
            changes=moved,
            slope_changes=unit
            * (course.end * moved + np.multiply.outer(vectors, ends) + rates_moved),
        )

    def peaks(self, course: UnequalCourse) -> tuple[FloatArray, FloatArray]:
        """Return the local maxima of the residual, edges included.

        Parameters
        ----------
        course
            Of a command.

        Returns
        -------
        tuple of FloatArray
            Their ratios, ascending, and the logarithms of the residual, shape (k,) each [-].
        """
        lower, upper = self.lower, self.upper
        count = 9 + math.ceil((upper - lower) * course.end / SCAN_TURN_RAD)
        grid = np.linspace(lower, upper, count)
        lags = self.lags(grid)
        vectors = lags.of(course.switches, course.arrived).values
        values = np.abs(vectors) * np.exp(lags.poles.real * course.end)
        padded = np.pad(values, 1, constant_values=-math.inf)
        tops = np.flatnonzero((values >= padded[:-2]) & (values >= padded[2:]))
        pitch = float(grid[1] - grid[0])
        # A peak may lie between an edge and its neighbour: it does if the residual rises inward.
        edges, inward = np.array([lower, upper]), np.array([1.0, -1.0])
        rising = self.left(course.switches, course.arrived, edges).growths * inward > 0
        inner = tops[(tops > 0) & (tops < count - 1)]
        starts = np.append(grid[inner], (edges + inward * pitch / 2)[rising])
        found = np.sort(self.refined(course, starts, PEAK_STEPS, pitch))
        apart = np.diff(np.clip(found, lower, upper), prepend=lower - pitch) > SAME_PEAK * pitch
        ratios = np.unique(np.concatenate((found[apart], edges)))
        return ratios, self.left(course.switches, course.arrived, ratios).logarithms

    def refined(
        self, course: UnequalCourse, ratios: FloatArray, steps: int, farthest: float
    ) -> FloatArray:
        """Return peaks near some ratios, by Newton's method.

        Parameters
        ----------
        course
            Of a command.
        ratios
            Near the peaks, shape (k,) [-].
        steps
            How many.
        farthest
            Length of a step at most [-].

        Returns
        -------
        FloatArray
            Within the band; one on an edge stays there, shape (k,) [-].
        """
        moving = (ratios > self.lower) & (ratios < self.upper)
        for _ in range(steps if moving.any() else 0):
            pairs = np.concatenate((ratios, ratios + BESIDE))
            here, beside = np.split(self.left(course.switches, course.arrived, pairs).growths, 2)
            bends = (beside - here) / BESIDE
            falling = moving & (bends < 0)
            step = np.where(falling, -here / np.where(falling, bends, 1.0), 0.0)
            ratios = np.clip(ratios + np.clip(step, -farthest, farthest), self.lower, self.upper)
        return ratios
