"""What remains of an acceleration at each moment on a cable that is hoisted.

The deflection that remains is linear in the acceleration v' of the trolley: ``V = integral of
kernel(t) v'(t) dt``. The kernel is the solution of the adjoint equation, backward from the end of
the hoisting. Where the length L is linear in time, with c its rate, the phase ``x = 2 sqrt(g L)/c``
of the swing makes that ``x k'' - (1 + 2 z x) k' + (x - 2 z) k = 0`` (undamped: Bessel's equation of
order 1), of which a Taylor series about each step of the phase is exact to rounding.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from design.model.plants.hoisting import Hoisting
from design.types import ComplexArray, FloatArray

ORDER = 28
"""Terms of each series: 1 / 28! and a quarter to the 28th are below rounding."""

MAX_STEP_RAD = 0.75
"""Longest step of the phase [rad]."""

MAX_STEP_SHARE = 0.2
"""Longest step over the distance to where the cable would be of no length, which ends the
series' convergence [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HoistingKernel:
    """The kernel of a course of lengths, referred to the end of its hoisting.

    Attributes
    ----------
    begins_s
        When each of n pieces begins, and the end of the hoisting, shape (n + 1,) [s].
    lengths_m, rates_m_s
        Length at the beginning of each piece and its rate there, shape (n,) [m], [m/s].
    coefficients
        Of the powers of the phase since the beginning, shape (n, ORDER) [-].
    root_gravity
        Square root of the acceleration of free fall [m^0.5/s].
    pole_rad_s
        Of the swing on the last length [rad/s].
    """

    begins_s: FloatArray
    lengths_m: FloatArray
    rates_m_s: FloatArray
    coefficients: ComplexArray
    root_gravity: float
    pole_rad_s: complex

    def at(self, times_s: FloatArray) -> ComplexArray:
        """Return the kernel at times, shape (m,), >= 0 [s].

        It is 1 at the end of the hoisting, and ``exp(-s (t - end))`` after it.
        """
        end_s = self.begins_s[-1]
        values: ComplexArray = np.exp(-self.pole_rad_s * np.maximum(times_s - end_s, 0.0))
        (during,) = np.nonzero(times_s < end_s)
        if during.size:
            own = times_s[during]
            piece = np.maximum(np.searchsorted(self.begins_s, own, side="right") - 1, 0)
            turned = _turns(
                self.root_gravity,
                self.lengths_m[piece],
                self.rates_m_s[piece],
                own - self.begins_s[piece],
            )
            rows = self.coefficients[piece]
            summed = rows[:, -1]
            for power in range(ORDER - 2, -1, -1):
                summed = summed * turned + rows[:, power]
            values[during] = summed
        return values


def hoisting_kernel(plant: Hoisting, ratio: float = 1.0) -> HoistingKernel:
    """Return the kernel of a course of lengths.

    Parameters
    ----------
    plant
        The load and its cable.
    ratio
        All frequencies over their nominal ones, > 0 [-].

    Returns
    -------
    HoistingKernel
        From time 0 to the end of the hoisting in pieces; exact to rounding.
    """
    course, z = plant.cable_length_m, plant.damping_ratio
    root_g = ratio * float(np.sqrt(plant.gravity_m_s2))
    begins, lengths, rates, last_of_line = _pieces(plant, root_g)
    turns = _turns(root_g, lengths, rates, np.diff(begins))
    curvatures = rates / (2 * root_g * np.sqrt(lengths))  # 1 / x
    series = _series(curvatures, z)
    flows = _flows(series, turns)
    pole = root_g / np.sqrt(course.values[-1]) * plant.last.mode.unit_pole
    value, slope_s = 1.0 + 0j, -pole
    coefficients = np.empty((turns.size, ORDER), dtype=np.complex128)
    rate_after = 0.0
    for piece in range(turns.size - 1, -1, -1):
        length_end = lengths[piece] + rates[piece] * (begins[piece + 1] - begins[piece])
        if last_of_line[piece]:  # L (k'_after - k'_before) = (L'_after - L'_before) k
            slope_s -= (rate_after - rates[piece]) * value / length_end
        w_end, w_begin = root_g / np.sqrt(length_end), root_g / np.sqrt(lengths[piece])
        begun = np.linalg.solve(flows[piece], np.array([value, slope_s / w_end]))
        coefficients[piece] = begun @ series[piece]
        value, slope_s, rate_after = begun[0], begun[1] * w_begin, rates[piece]
    return HoistingKernel(
        begins_s=begins,
        lengths_m=lengths,
        rates_m_s=rates,
        coefficients=coefficients,
        root_gravity=root_g,
        pole_rad_s=complex(pole),
    )


def _turns(
    root_gravity: float, lengths_m: FloatArray, rates_m_s: FloatArray, elapsed_s: FloatArray
) -> FloatArray:
    """Return by how much the swing turns in a time on cables of linear length [rad].

    ``2 sqrt(g) (sqrt(L1) - sqrt(L0)) / c``, without its subtraction.
    """
    ends_m = np.maximum(lengths_m + rates_m_s * elapsed_s, 0.0)
    turned: FloatArray = 2 * root_gravity * elapsed_s / (np.sqrt(ends_m) + np.sqrt(lengths_m))
    return turned


def _pieces(
    plant: Hoisting, root_gravity: float
) -> tuple[FloatArray, FloatArray, FloatArray, list[bool]]:
    """Cut the course from time 0 on into steps of the phase that one series serves.

    Returns begins and end, lengths and rates at the begins, and which are the last of a line.
    """
    course = plant.cable_length_m
    points = list(zip(course.times_s, course.values, strict=True))
    if points[0][0] > 0:
        points.insert(0, (0.0, course.values[0]))
    begins, lengths, rates, last = [], [], [], []
    for (t0, l0), (t1, l1) in pairwise(points):
        rate = (l1 - l0) / (t1 - t0)
        phase = 2 * root_gravity * (t1 - t0) / (np.sqrt(l0) + np.sqrt(l1))
        growth = float(np.log(l1 / l0))
        # Steps in proportion to the distance x from where the cable would be of no length.
        farthest = 2 * root_gravity * np.sqrt(max(l0, l1)) / abs(rate) if rate else np.inf
        share = min(MAX_STEP_RAD / farthest, MAX_STEP_SHARE)
        geometric = abs(growth) / 2 / -math.log1p(-share) if growth else 0.0
        count = math.ceil(max(phase / MAX_STEP_RAD, geometric, 1))
        shares = np.arange(count) / count
        if growth:
            shares = np.expm1(growth * shares) / np.expm1(growth)
        begins += (t0 + (t1 - t0) * shares).tolist()
        lengths += (l0 + (l1 - l0) * shares).tolist()
        rates += [rate] * count
        last += [False] * (count - 1) + [True]
    return np.array([*begins, points[-1][0]]), np.array(lengths), np.array(rates), last


def _series(curvatures: FloatArray, damping_ratio: float) -> FloatArray:
    """Return the series of both fundamental solutions about each beginning, (n, 2, ORDER).

    With e = 1 / x of the beginning: ``(1 + e d) k'' - (e + 2 z (1 + e d)) k' + (1 + e d - 2 z e) k
    = 0`` over the phase d since then.
    """
    e, z = curvatures[:, None], damping_ratio
    series = np.zeros((curvatures.size, 2, ORDER))
    series[:, 0, 0] = series[:, 1, 1] = 1.0
    for n in range(ORDER - 2):
        before = series[:, :, n - 1] if n else 0.0
        series[:, :, n + 2] = (
            (n + 1) * (e + 2 * z - e * n) * series[:, :, n + 1]
            + (2 * z * e * n - 1 + 2 * z * e) * series[:, :, n]
            - e * before
        ) / ((n + 2) * (n + 1))
    return series


def _flows(series: FloatArray, turns: FloatArray) -> FloatArray:
    """Return value and slope over the phase at the end of each piece, shape (n, 2, 2)."""
    powers = turns[:, None] ** np.arange(ORDER)
    slopes = np.arange(1, ORDER) * series[:, :, 1:]
    values = (series * powers[:, None, :]).sum(axis=2)
    derived = (slopes * powers[:, None, :-1]).sum(axis=2)
    return np.stack((values, derived), axis=1)
