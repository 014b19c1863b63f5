"""How the residual vibration grows with an error in the plant's frequency."""

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from design.analysis.residual import (
    evenly_spaced_vectors,
    residual_vectors,
    step_contributions,
)
from design.errors import InvalidInputError, SolverFailedError
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import LARGEST_DAMPING_RATIO, Mode
from design.types import FloatArray, require_between

MOST_POINTS = 20_001
"""Longest curve, a bound on the work of one request."""

RATIO_BOUNDS = (1e-6, 1e6)
"""Frequency ratios of a curve [-]."""

EDGE_MARGIN = 1e-9
"""Relative margin of the tolerance: a shaper designed to touch it at the nominal must not fail."""

SCAN_STEP_PHASE = 2 * math.pi / 48
"""How far the last impulse's phase may turn between two points of the search for an edge [rad]."""

LONGEST_RELATIVE_STEP = 0.02
"""The same as a share of the ratio: a tenth of the narrowest peak of an actuator's set [-]."""

MOST_ROOT_STEPS = 100
ROOT_TOLERANCE = 1e-13
"""Change of an edge at which it is found [-]."""

MOST_SCAN_POINTS = 20_000
"""Where the search for an edge gives up: some 400 turns of the last impulse away."""

LONGEST_TURN_RAD = 1e6
"""Longest command, as a turn of the plant's phase [rad]."""

SCAN_BLOCK = 16
"""Points of the search on either side of 1 that are evaluated at a time."""

WIDEST_RATIOS = (1e-3, 100.0)
"""How far an edge is looked for; none is told of an interval that reaches further [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingRange:
    """Which damping ratios the plant may have.

    Attributes
    ----------
    start, stop
        Least and largest, ``0 <= start < stop <= 0.99`` [-].
    points
        Number of points, 2 to 20,001.
    """

    start: float
    stop: float
    points: int = 101

    def __post_init__(self) -> None:
        require_between("damping.from", self.start, 0.0, LARGEST_DAMPING_RATIO)
        require_between("damping.to", self.stop, 0.0, LARGEST_DAMPING_RATIO)
        if self.stop <= self.start:
            raise InvalidInputError("damping.to", self.stop, f"greater than from, {self.start!r}")
        require_between("damping.points", self.points, 2, MOST_POINTS)


@dataclass(frozen=True, slots=True, kw_only=True)
class SensitivityRange:
    """What part of the curve is wanted.

    Attributes
    ----------
    from_ratio, to_ratio
        First and last frequency ratio, ``0 < from < to`` [-].
    points
        Number of points, 2 to 20,001.
    tolerance
        Residual at which the insensitivity is told, 0 to 1, both excluded [-].
    damping
        Range of a curve over the damping ratio; None for no such curve.
    """

    from_ratio: float = 0.5
    to_ratio: float = 1.5
    points: int = 201
    tolerance: float = 0.05
    damping: DampingRange | None = None

    def __post_init__(self) -> None:
        require_between("from_ratio", self.from_ratio, *RATIO_BOUNDS)
        require_between("to_ratio", self.to_ratio, *RATIO_BOUNDS)
        if self.to_ratio <= self.from_ratio:
            raise InvalidInputError(
                "to_ratio", self.to_ratio, f"greater than from_ratio, {self.from_ratio!r}"
            )
        require_between("points", self.points, 2, MOST_POINTS)
        if not 0 < self.tolerance < 1:
            raise InvalidInputError("tolerance", self.tolerance, "between 0 and 1, both excluded")


@dataclass(frozen=True, slots=True, kw_only=True)
class Insensitivity:
    """The interval of frequency ratios around 1 on which the residual is within a tolerance.

    Attributes
    ----------
    tolerance
        The tolerance [-].
    lower_ratio, upper_ratio
        Edges of the connected interval that contains 1 [-]; None where the residual is within the
        tolerance as far as was searched.
    searched_from_ratio, searched_to_ratio
        Between them the residual is within the tolerance: the edges, or where the search for one
        ended without [-].
    """

    tolerance: float
    lower_ratio: float | None
    upper_ratio: float | None
    searched_from_ratio: float
    searched_to_ratio: float

    @property
    def width(self) -> float | None:
        """Upper less lower edge; None where there is not either [-]."""
        if self.lower_ratio is None or self.upper_ratio is None:
            return None
        return self.upper_ratio - self.lower_ratio

    @property
    def half_width(self) -> float:
        """Half width of the widest interval centred at 1 that is known to be within [-]."""
        return min(1 - self.searched_from_ratio, self.searched_to_ratio - 1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sensitivity:
    """A sensitivity curve.

    Attributes
    ----------
    frequency_ratios
        True over nominal frequency, shape (m,) [-].
    residuals
        Residual vibration there, shape (m,) [-].
    tolerance
        Tolerance of the insensitivity [-].
    insensitivity
        None where the nominal itself is above the tolerance.
    damping
        Damping ratios and the residuals there, shape (k,) each [-]; None where not asked for.
    """

    frequency_ratios: FloatArray
    residuals: FloatArray
    tolerance: float
    insensitivity: Insensitivity | None
    damping: tuple[FloatArray, FloatArray] | None = None


def sensitivity(
    impulses: Impulses, mode: Mode, actuator: Actuator, wanted: SensitivityRange
) -> Sensitivity:
    """Return the sensitivity curve of any impulses, with their insensitivity.

    Parameters
    ----------
    impulses
        A shaper or a whole command.
    mode, actuator
        The nominal mode and its actuator.
    wanted
        Range, points and tolerance.
    """
    pole = mode.pole_rad_s
    vectors = evenly_spaced_vectors(
        impulses, pole * wanted.from_ratio, pole * wanted.to_ratio, wanted.points, actuator
    )
    residuals = np.abs(vectors)
    if not np.isfinite(residuals).all():
        raise SolverFailedError("the sensitivity curve leaves the range of numbers")
    return Sensitivity(
        frequency_ratios=np.linspace(wanted.from_ratio, wanted.to_ratio, wanted.points),
        residuals=residuals,
        tolerance=wanted.tolerance,
        insensitivity=insensitivity(impulses, mode, actuator, wanted.tolerance),
        damping=None
        if wanted.damping is None
        else _over_damping(impulses, mode, actuator, wanted.damping),
    )


def _over_damping(
    impulses: Impulses, mode: Mode, actuator: Actuator, wanted: DampingRange
) -> tuple[FloatArray, FloatArray]:
    """Return damping ratios and what is left there at the mode's own natural frequency."""
    ratios = np.linspace(wanted.start, wanted.stop, wanted.points)
    poles = mode.natural_frequency_rad_s * (-ratios + 1j * np.sqrt(1 - ratios**2))
    return ratios, np.abs(residual_vectors(impulses, poles, actuator))


def worst_of(curves: Sequence[Sensitivity]) -> Sensitivity:
    """Return what is left at most in any of several modes whose frequencies change alike.

    The insensitivity is the interval common to all modes; None where one has none.
    """
    damped = [curve.damping for curve in curves if curve.damping is not None]
    over_damping = None
    if damped:
        over_damping = damped[0][0], np.max([residuals for _, residuals in damped], axis=0)
    return Sensitivity(
        frequency_ratios=curves[0].frequency_ratios,
        residuals=np.max([curve.residuals for curve in curves], axis=0),
        tolerance=curves[0].tolerance,
        insensitivity=common_interval([curve.insensitivity for curve in curves]),
        damping=over_damping,
    )


def common_interval(intervals: Sequence[Insensitivity | None]) -> Insensitivity | None:
    """Return the interval common to several modes at one tolerance; None where one has none."""
    known = [interval for interval in intervals if interval is not None]
    if len(known) < len(intervals):
        return None
    first = max(known, key=lambda interval: interval.searched_from_ratio)
    last = min(known, key=lambda interval: interval.searched_to_ratio)
    return Insensitivity(
        tolerance=first.tolerance,
        lower_ratio=first.lower_ratio,
        upper_ratio=last.upper_ratio,
        searched_from_ratio=first.searched_from_ratio,
        searched_to_ratio=last.searched_to_ratio,
    )


def insensitivity(
    impulses: Impulses, mode: Mode, actuator: Actuator, tolerance: float
) -> Insensitivity | None:
    """Return the connected interval around 1 on which the residual is within the tolerance.

    Either edge is bracketed by a scan outward from 1, fine against the turn of the last impulse
    and with its near-misses looked at again, and then root-found, unless it is proven that there is
    none. The scan does not depend on any
    plotted grid; it ends at `WIDEST_RATIOS`, or after `MOST_SCAN_POINTS`, and says where it ended
    without an edge.

    Returns
    -------
    Insensitivity or None
        None where the residual at 1 is above the tolerance.
    """
    turn = mode.natural_frequency_rad_s * impulses.duration_s
    if turn > LONGEST_TURN_RAD:
        raise InvalidInputError(
            "impulses.times_s",
            f"{turn:.3g} rad of the plant's swing in all",
            f"at most {LONGEST_TURN_RAD:g} rad, beyond which phases lose their digits",
        )
    if _never_above(impulses, actuator, tolerance):
        return Insensitivity(
            tolerance=tolerance,
            lower_ratio=None,
            upper_ratio=None,
            searched_from_ratio=WIDEST_RATIOS[0],
            searched_to_ratio=WIDEST_RATIOS[1],
        )
    excess = _Excess(impulses, mode, actuator, tolerance * (1 + EDGE_MARGIN))
    if excess.at(1.0) > 0:
        return None
    step = SCAN_STEP_PHASE / turn if turn > 0 else math.inf
    # The first stretch on both sides at once: it nearly always holds both edges.
    below, above = (_outward(1.0, end, step) for end in WIDEST_RATIOS)
    near = np.concatenate((below[::-1], [1.0], above))
    values = excess.over(near)
    middle = below.size
    lower, lowest = _edge(
        excess, near[middle + 1 :: -1], values[middle + 1 :: -1], WIDEST_RATIOS[0], step
    )
    upper, highest = _edge(excess, near[middle - 1 :], values[middle - 1 :], WIDEST_RATIOS[1], step)
    return Insensitivity(
        tolerance=tolerance,
        lower_ratio=lower,
        upper_ratio=upper,
        searched_from_ratio=lowest,
        searched_to_ratio=highest,
    )


def _never_above(impulses: Impulses, actuator: Actuator, tolerance: float) -> bool:
    """Whether the residual is proven to be within the tolerance at every frequency.

    Steps that all go through the same lag leave no more than the sum of their sizes.
    """
    alike = bool(impulses.accelerates.all()) or actuator.accel_lag == actuator.decel_lag
    same_lag = alike and not isinstance(actuator, RateLimited)
    return same_lag and float(np.abs(impulses.amplitudes).sum()) <= tolerance


def _outward(start: float, end: float, step: float) -> FloatArray:
    """Return the next ratios of the search from one on, the last of all at ``end``.

    Steps are fine against the turn of the last impulse, and against the ratio itself, on whose
    scale the actuator shapes the curve.
    """
    ratios: list[float] = []
    ratio = start
    while len(ratios) < SCAN_BLOCK and ratio != end:
        stride = min(step, LONGEST_RELATIVE_STEP * ratio)
        ratio = min(ratio + stride, end) if end > start else max(ratio - stride, end)
        ratios.append(ratio)
    return np.array(ratios)


class _Excess:
    """Residual less the limit, by frequency ratio: many ratios at once, or one at a time."""

    def __init__(self, impulses: Impulses, mode: Mode, actuator: Actuator, limit: float) -> None:
        self.limit = limit
        self._impulses = impulses
        self._actuator = actuator
        self._pole = mode.pole_rad_s
        self._accel, self._decel = actuator.accel_lag, actuator.decel_lag
        steps = step_contributions(impulses, actuator)
        padded = np.pad(steps.columns, ((0, 0), (0, 4 - steps.columns.shape[1])))
        self._steps = list(zip(steps.until_last_s.tolist(), padded.tolist(), strict=True))

    def over(self, ratios: FloatArray) -> FloatArray:
        return (
            np.abs(residual_vectors(self._impulses, self._pole * ratios, self._actuator))
            - self.limit
        )

    def at(self, ratio: float) -> float:
        if isinstance(self._actuator, RateLimited):
            return float(self.over(np.array([ratio]))[0])
        pole = self._pole * ratio
        slower = self._accel.denominator(pole) / self._decel.denominator(pole)
        vector = 0j
        for until_last, (accel, decel, accel_rate, decel_rate) in self._steps:
            swing = cmath.exp(pole * until_last)
            vector += swing * (accel + pole * accel_rate + slower * (decel + pole * decel_rate))
        return abs(vector) - self.limit


def _edge(
    excess: _Excess, ratios: FloatArray, values: FloatArray, end: float, step: float
) -> tuple[float | None, float]:
    """Return the edge on the way from 1 to ``end``, if there is one, and how far all is within.

    ``ratios`` are the first stretch, with the neighbour of 1 on the other side ahead of it, and
    ``values`` what the residual there has over the limit. Each further stretch overlaps by two
    points, so that a peak at a seam has both its neighbours.
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
        if ratios[-1] == end or scanned > MOST_SCAN_POINTS:
            return None, float(ratios[-1])
        further = _outward(float(ratios[-1]), end, step)
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


def _peak(excess: _Excess, left: float, right: float) -> float:
    """Return the place of the maximum between two ratios, by repeated subdivision."""
    for _ in range(12):
        ratios = np.linspace(left, right, 9)
        best = min(max(int(np.argmax(excess.over(ratios))), 1), 7)
        left, right = float(ratios[best - 1]), float(ratios[best + 1])
    return (left + right) / 2


def _root(excess: _Excess, inside: float, outside: float) -> float:
    """Return the edge between a ratio within the limit and one beyond it.

    False position with the Illinois correction (Dowell and Jarratt, BIT 11 (1971)):
    `scipy.optimize` has better, and takes longer to import than a whole design takes.
    """
    low, high = excess.at(inside), excess.at(outside)
    last_side = 0
    for _ in range(MOST_ROOT_STEPS):
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
