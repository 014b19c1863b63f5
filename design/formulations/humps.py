"""Extra-insensitive shapers: the equations of a curve of zeros and equal humps, solved.

Residual over frequency ratio r, damping ratio fixed, has zeros, and between them humps that all
peak at the tolerance. Zeros and peaks lie where they lie: their ratios are unknown as well, except
the middle one, which is at 1. Unknowns and equations are then as many::

    R(r) = sum A_i exp(r s (t_n - t_i)),    s = -z + j sqrt(1 - z^2)
    R = 0 at each zero,    |R| = V and d|R|/dr = 0 at each peak,    sum A_i = 1

Times are phases, ``w t``. An actuator's G is left out: common to positive shapers, 1 if ideal.
"""

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from design.errors import InfeasibleDesignError
from design.types import FloatArray

NEWTON_STEPS = 25
"""More than that Newton's method does not take where it converges at all."""

CONVERGED = 1e-12
"""Step, in radians, ratios and amplitudes, after which the next is rounding."""

MAX_STEP = 1.0
"""A step longer than that has left the neighbourhood of the solution."""

MIN_SHARE = 1e-3
"""Shortest step on the way from the undamped shaper, over that way [-]."""

Ends = tuple[float, float]
"""Damping ratio and height of the humps [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Humps:
    """A shaper and the zeros and peaks of its curve.

    Attributes
    ----------
    amplitudes, phases_rad
        Impulses, shape (n,): the phases begin at 0.
    zeros, peaks
        Frequency ratios, shape (n - 1,) and (n - 2,) for positive amplitudes [-].
    unity
        Whether the amplitudes are given; if not they are unknown and sum to 1.
    """

    amplitudes: FloatArray
    phases_rad: FloatArray
    zeros: FloatArray
    peaks: FloatArray
    unity: bool = False


@functools.lru_cache(maxsize=4096)
def follow_from_undamped(seed: str, damping_ratio: float, tolerance: float) -> Humps:
    """Return the shaper of a damped mode, followed from the undamped one.

    Parameters
    ----------
    seed
        Name of its kind, as in `UNDAMPED`.
    damping_ratio
        Of the mode [-].
    tolerance
        Height of the humps [-].

    Returns
    -------
    Humps
        Of the damped mode, in phases of its undamped frequency.

    Raises
    ------
    InfeasibleDesignError
        If there is none: above some damping two of its zeros have become one, or an amplitude is no
        longer positive.
    """
    start, of_start = UNDAMPED[seed](tolerance)

    def follow(found: Humps, first: float, last: float, on: Callable[[float], Ends]) -> Humps:
        """Go from ``first`` to ``last`` in steps that are halved where one fails."""
        reached, share = 0.0, 1.0
        while reached < 1:
            wanted = min(1.0, reached + share)
            nearer = solve_humps(found, *on(first + wanted * (last - first)))
            if nearer is not None and _is_in_order(nearer):
                found, reached = nearer, wanted
                continue
            share /= 2
            if share < MIN_SHARE:
                damping, height = on(first + reached * (last - first))
                raise InfeasibleDesignError(
                    f"no {seed} with humps of {tolerance:g} was found at a damping ratio of "
                    f"{damping_ratio:g}: followed from the undamped shaper, its zeros or "
                    f"impulses meet at a damping ratio of {damping:.3g} with humps of "
                    f"{height:.3g}",
                    code="humps_meet",
                )
        return found

    undamped = follow(
        start, math.log(of_start), math.log(tolerance), lambda height: (0.0, math.exp(height))
    )
    return follow(undamped, 0.0, damping_ratio, lambda damping: (damping, tolerance))


def _is_in_order(humps: Humps) -> bool:
    signs = humps.unity or bool((humps.amplitudes > 0).all())
    between = np.empty(humps.zeros.size + humps.peaks.size)
    between[0::2], between[1::2] = humps.zeros, humps.peaks
    return signs and all(bool((np.diff(row) > 0).all()) for row in (humps.phases_rad, between))


def solve_humps(start: Humps, damping_ratio: float, tolerance: float) -> Humps | None:
    """Return the solution next to a start by Newton's method.

    Parameters
    ----------
    start
        Shaper, zeros and peaks of a mode nearby.
    damping_ratio
        Of the mode [-].
    tolerance
        Height of the humps [-].

    Returns
    -------
    Humps or None
        None where it finds none.
    """
    pole = complex(-damping_ratio, math.sqrt(1 - damping_ratio**2))
    n, zeros = start.amplitudes.size, start.zeros.size
    parts = (start.amplitudes, start.phases_rad, start.zeros, start.peaks)
    ends = np.cumsum([part.size for part in parts])
    unknown = np.ones(ends[-1], dtype=np.bool_)
    unknown[: n + 1] = not start.unity
    unknown[n] = False  # the first phase is 0
    # Of zeros and peaks in turn the middle one stays at 1.
    middle = (zeros + start.peaks.size) // 2
    unknown[ends[1] + middle // 2 if middle % 2 == 0 else ends[2] + middle // 2] = False
    columns = np.flatnonzero(unknown)
    values = np.concatenate(parts)
    for _ in range(NEWTON_STEPS):
        equations, slopes = _equations(values, pole, tolerance, n, zeros, unity=start.unity)
        try:
            step = np.linalg.solve(slopes[:, columns], -equations)
        except np.linalg.LinAlgError:
            return None
        length = float(np.abs(step).max())
        if not length <= MAX_STEP:  # not a number is not
            return None
        values[columns] += step
        if length <= CONVERGED:
            split = np.split(values, ends[:-1])
            return replace(
                start, amplitudes=split[0], phases_rad=split[1], zeros=split[2], peaks=split[3]
            )
    return None


def _equations(
    values: FloatArray, pole: complex, tolerance: float, n: int, zeros: int, *, unity: bool
) -> tuple[FloatArray, FloatArray]:
    """Return the equations and their derivatives by all of amplitudes, phases, zeros, peaks."""
    amplitudes, phases, ratios = values[:n], values[n : 2 * n], values[2 * n :]
    turns = pole * (phases[-1] - phases)
    swings = np.exp(np.outer(ratios, turns))
    weighted = swings * amplitudes
    moved = weighted * turns
    left, slope, bend = weighted.sum(axis=1), moved.sum(axis=1), (moved * turns).sum(axis=1)
    # By amplitudes, by phases (the last of which moves all others), by the row's own ratio.
    by = np.zeros((ratios.size, values.size), dtype=np.complex128)
    by_slope = np.zeros_like(by)
    by[:, :n], by_slope[:, :n] = swings, swings * turns
    at_phase = -pole * ratios[:, None] * weighted
    at_phase_slope = -pole * (weighted + ratios[:, None] * moved)
    for table, columns in ((by, at_phase), (by_slope, at_phase_slope)):
        columns[:, -1] = -columns[:, :-1].sum(axis=1)
        table[:, n : 2 * n] = columns
    own = np.arange(ratios.size)
    by[own, 2 * n + own], by_slope[own, 2 * n + own] = slope, bend
    peak, at_peak = left[zeros:], slope[zeros:]
    turned = np.conj(peak)[:, None]
    rows = [
        by[:zeros].real,
        by[:zeros].imag,
        (turned * by[zeros:]).real / tolerance,
        (turned * by_slope[zeros:] + np.conj(at_peak)[:, None] * by[zeros:]).real / tolerance,
    ]
    equations = [
        left[:zeros].real,
        left[:zeros].imag,
        (np.abs(peak) ** 2 / tolerance - tolerance) / 2,
        (np.conj(peak) * at_peak).real / tolerance,
    ]
    if not unity:
        total = np.zeros((1, values.size))
        total[0, :n] = 1.0
        rows.append(total)
        equations.append(np.array([amplitudes.sum() - 1]))
    return np.concatenate(equations), np.concatenate(rows)


def _half_period(amplitudes: list[float], zeros: list[float], peaks: list[float]) -> Humps:
    return Humps(
        amplitudes=np.array(amplitudes),
        phases_rad=math.pi * np.arange(len(amplitudes)),
        zeros=np.array(zeros),
        peaks=np.array(peaks),
    )


def one_hump(tolerance: float) -> Humps:
    """Return the undamped EI shaper, in closed form [1]_.

    Parameters
    ----------
    tolerance
        Height of the hump [-].

    Returns
    -------
    Humps
        Three impulses, two zeros, a peak.

    References
    ----------
    .. [1] W. Singhose, W. Seering, N. Singer, "Residual vibration reduction using vector diagrams
       to generate shaped inputs", J. Mech. Des. 116 (1994).
    """
    outer, middle = (1 + tolerance) / 4, (1 - tolerance) / 2
    zero = math.acos(-middle / (2 * outer)) / math.pi
    return _half_period([outer, middle, outer], [zero, 2 - zero], [1.0])


def two_humps(tolerance: float) -> Humps:
    """Return the undamped two-hump EI shaper, in closed form [1]_.

    Parameters
    ----------
    tolerance
        Height of the humps [-].

    Returns
    -------
    Humps
        Four impulses.

    References
    ----------
    .. [1] W. Singhose, L. Porter, T. Tuttle, N. Singer, "Vibration reduction using multi-hump input
       shapers", J. Dyn. Sys., Meas., Control 119 (1997).
    """
    square = tolerance * tolerance
    x = math.cbrt(square * (math.sqrt(1 - square) + 1))
    outer = (3 * x * x + 2 * x + 3 * square) / (16 * x)
    inner = 0.5 - outer
    # 2 c (inner - 3 outer + 4 outer c^2), c the cosine of half the turn between two impulses.
    part = (3 * outer - inner) / (4 * outer)
    zero, peak = (2 / math.pi * math.asin(math.sqrt(part / over)) for over in (1, 3))
    return _half_period(
        [outer, inner, inner, outer], [1 - zero, 1.0, 1 + zero], [1 - peak, 1 + peak]
    )


def three_humps(tolerance: float) -> Humps:
    """Return the undamped three-hump EI shaper, in closed form.

    The source is that of `two_humps`.
    """
    outer = (1 + 3 * tolerance + 2 * math.sqrt(2 * tolerance * (tolerance + 1))) / 16
    inner = (1 - tolerance) / 4
    middle = 1 - 2 * (outer + inner)
    # middle - 2 outer + 2 inner c + 4 outer c^2, c the cosine of the turn between two impulses.
    root = math.sqrt(inner**2 - 4 * outer * (middle - 2 * outer))
    first, second = (math.acos((-inner + sign * root) / (4 * outer)) / math.pi for sign in (1, -1))
    peak = math.acos(-inner / (4 * outer)) / math.pi
    return _half_period(
        [outer, inner, middle, inner, outer],
        [first, second, 2 - second, 2 - first],
        [peak, 1.0, 2 - peak],
    )


UNITY_TOLERANCE = 0.05
"""Height of the humps of the shapers of unity magnitude from which others are followed [-]."""


def _unity(periods: list[float], zeros: list[float], peaks: list[float]) -> Humps:
    return Humps(
        amplitudes=np.where(np.arange(len(periods)) % 2 == 0, 1.0, -1.0),
        phases_rad=2 * math.pi * np.array(periods),
        zeros=np.array(zeros),
        peaks=np.array(peaks),
        unity=True,
    )


UNITY_ONE_HUMP = _unity([0, 0.09408, 0.36837, 0.64266, 0.73673], [0.87037, 1.12276], [1.0])
UNITY_TWO_HUMPS = _unity(
    [0, 0.05996, 0.40099, 0.59323, 0.78546, 1.12649, 1.18645],
    [0.70318, 1.0, 1.26911],
    [0.83556, 1.15593],
)
"""Solutions to five digits: the fastest of 3,000 starts around the zero-vibration shapers."""


UNDAMPED: dict[str, Callable[[float], tuple[Humps, float]]] = {
    "ei": lambda tolerance: (one_hump(tolerance), tolerance),
    "two_hump_ei": lambda tolerance: (two_humps(tolerance), tolerance),
    "three_hump_ei": lambda tolerance: (three_humps(tolerance), tolerance),
    "um_ei": lambda _: (UNITY_ONE_HUMP, UNITY_TOLERANCE),
    "um_2ei": lambda _: (UNITY_TWO_HUMPS, UNITY_TOLERANCE),
}
"""By kind, an undamped shaper near the one asked, and the height of its humps."""
