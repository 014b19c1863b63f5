"""Where the residual first exceeds a limit, searched outward from the nominal frequency."""

import cmath

import numpy as np

from design.analysis.residual import residual_vectors
from design.analysis.step_contributions import step_contributions
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.types import FloatArray

MAX_RELATIVE_STEP = 0.02
"""The same as a share of the ratio: a tenth of the narrowest peak of an actuator's set [-]."""

MAX_ROOT_STEPS = 100

ROOT_TOLERANCE = 1e-13
"""Change of an edge at which it is found [-]."""

MAX_SCAN_POINTS = 20_000
"""Where the search for an edge gives up: some 400 turns of the last impulse away."""

SCAN_BLOCK = 16
"""Points of the search on either side of 1 that are evaluated at a time."""


def step_outward(start: float, end: float, step: float) -> FloatArray:
    """Return the next ratios of the search for an edge.

    Steps are fine against the turn of the last impulse, and against the ratio itself, on whose
    scale the actuator shapes the curve.

    Parameters
    ----------
    start, end, step
        Ratio that was looked at last; where the search ends, above it or below; longest step [-].

    Returns
    -------
    FloatArray
        At most 16 ratios on the way, the last of all at ``end`` [-]; none from ``end`` on.
    """
    ratios: list[float] = []
    ratio = start
    while len(ratios) < SCAN_BLOCK and ratio != end:
        stride = min(step, MAX_RELATIVE_STEP * ratio)
        ratio = min(ratio + stride, end) if end > start else max(ratio - stride, end)
        ratios.append(ratio)
    return np.array(ratios)


class Excess:
    """Residual less the limit, by frequency ratio: many ratios at once, or one at a time."""

    def __init__(self, impulses: Impulses, mode: Mode, actuator: Actuator, limit: float) -> None:
        self.limit = limit
        self._impulses = impulses
        self._actuator = actuator
        self._pole = mode.pole_rad_s
        self._accel, self._decel = actuator.accel_lag, actuator.decel_lag
        steps = step_contributions(impulses, actuator)
        padded = np.pad(steps.columns, ((0, 0), (0, 4 - steps.columns.shape[1])))
        self.turn_rad = mode.natural_frequency_rad_s * float(steps.until_end_s[0])
        self._steps = list(zip(steps.until_end_s.tolist(), padded.tolist(), strict=True))

    def over(self, ratios: FloatArray) -> FloatArray:
        """Return the excess at many ratios, shape (m,) [-]."""
        return (
            np.abs(residual_vectors(self._impulses, self._pole * ratios, self._actuator))
            - self.limit
        )

    def at(self, ratio: float) -> float:
        """Return the excess at one ratio [-]."""
        if isinstance(self._actuator, RateLimited):
            return float(self.over(np.array([ratio]))[0])
        pole = self._pole * ratio
        slower = self._accel.denominator(pole) / self._decel.denominator(pole)
        vector = 0j
        for until_last, (accel, decel, accel_rate, decel_rate) in self._steps:
            swing = cmath.exp(pole * until_last)
            vector += swing * (accel + pole * accel_rate + slower * (decel + pole * decel_rate))
        return abs(vector) - self.limit


def find_edge(
    excess: Excess, ratios: FloatArray, values: FloatArray, end: float, step: float
) -> tuple[float | None, float]:
    """Return the edge on the way from 1, and how far all is within.

    Each further stretch overlaps by two points, so that a peak at a seam has both its neighbours.

    Parameters
    ----------
    excess, end, step
        Residual less the limit; where the search ends; longest step between ratios [-].
    ratios, values
        The first stretch, the neighbour of 1 ahead of it, and the excess there, shape (m,) [-].

    Returns
    -------
    float or None
        The edge [-]; None where the search ended without one.
    float
        Ratio up to which the residual is within the limit: the edge, or the end [-].
    """
    scanned = 0
    while True:
        above = np.flatnonzero(values[1:] > 0)
        stop = int(above[0]) + 1 if above.size else ratios.size - 1
        for top in _near_misses(values[: stop + 1]):
            ratio = _peak(excess, float(ratios[top - 1]), float(ratios[top + 1]))
            if (ratio - 1) * (end - 1) > 0 and excess.at(ratio) > 0:
                edge = _root(excess, float(ratios[top - 1]), ratio)
                return edge, edge
        if above.size:
            edge = _root(excess, float(ratios[stop - 1]), float(ratios[stop]))
            return edge, edge
        scanned += ratios.size
        if ratios[-1] == end or scanned > MAX_SCAN_POINTS:
            return None, float(ratios[-1])
        further = step_outward(float(ratios[-1]), end, step)
        ratios = np.concatenate((ratios[-2:], further))
        values = np.concatenate((values[-2:], excess.over(further)))


def _near_misses(values: FloatArray) -> list[int]:
    """Find the local maxima within the limit that a finer look might find above it."""
    inner, lower = values[1:-1], np.minimum(values[:-2], values[2:])
    top = (inner >= values[:-2]) & (inner >= values[2:]) & (inner <= 0)
    # A parabola through the three rises above its middle by an eighth of its height at most; the
    # whole height is a wide margin.
    rising = inner + (inner - lower) > 0
    return [int(index) + 1 for index in np.flatnonzero(top & rising)]


def _peak(excess: Excess, left: float, right: float) -> float:
    """Return the place of the maximum between two ratios, by repeated subdivision."""
    for _ in range(12):
        ratios = np.linspace(left, right, 9)
        best = min(max(int(np.argmax(excess.over(ratios))), 1), 7)
        left, right = float(ratios[best - 1]), float(ratios[best + 1])
    return (left + right) / 2


def _root(excess: Excess, inside: float, outside: float) -> float:
    """Return the edge between a ratio within the limit and one beyond it.

    False position with the Illinois correction (Dowell and Jarratt, BIT 11 (1971)):
    `scipy.optimize` has better, and takes longer to import than a whole design takes.
    """
    low, high = excess.at(inside), excess.at(outside)
    last_side = 0
    for _ in range(MAX_ROOT_STEPS):
        ratio = (inside * high - outside * low) / (high - low)
        moved = min(abs(ratio - inside), abs(ratio - outside))
        value = excess.at(ratio)
        if moved <= ROOT_TOLERANCE * ratio or value == 0:
            return ratio
        side = 1 if value > 0 else -1
        if side > 0:
            outside, high = ratio, value
            low = low / 2 if side == last_side else low
        else:
            inside, low = ratio, value
            high = high / 2 if side == last_side else high
        last_side = side
    return inside
