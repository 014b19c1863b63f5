"""Proof that no shaper is as short as a given duration, whatever its impulses: no solver in here.

A shaper of duration D within the tolerance V over bands of poles has, for any poles ``s_k`` of
them and any complex ``y_k``::

    sum_i A_i p(u_i) = Re sum_k y_k F(s_k) <= V sum_k |y_k|,    p(u) = Re sum_k y_k exp(s_k u)

where u runs back from the last impulse. If every command of the class has a larger left side over
all of [0, D], none keeps the bands. p is bounded between points by its derivatives, over intervals
that are halved until the bound is tight: the proof holds for all times, not for those of a grid.
"""

import math

import numpy as np

from design.types import ComplexArray, FloatArray

MAX_HALVINGS = 40
"""An interval halved as often is 1e-12 of its width; a proof that needs more is none."""

MAX_INTERVALS = 20_000
"""Intervals open at a time: proofs that hold by a margin stay far below."""

FIRST_INTERVALS_PER_RADIAN = 16

ROUNDING = 1e-13
"""Relative error of a sum of exponentials, as a share of ``sum |y_k|`` [-]."""


def excludes(
    unit_poles: ComplexArray,
    vectors: ComplexArray,
    duration_rad: float,
    tolerance: float,
    levels: tuple[float, float] | None,
) -> bool:
    """Return whether p proves that no shaper so short is in tolerance.

    The proof is for every duration up to ``duration_rad``.

    Parameters
    ----------
    unit_poles
        ``s_k``, within the bands, not to the right of the imaginary axis, shape (k,) [-].
    vectors
        ``y_k``, shape (k,), complex.
    duration_rad
        D [rad].
    tolerance
        V [-].
    levels
        Lowest and highest level of the command, at most 0 and at least 1; None for positive
        amplitudes.

    Returns
    -------
    bool
        False is no proof of the contrary: bounds may have been too loose.
    """
    p = _Polynomial(unit_poles, vectors)
    largest = tolerance * p.size + ROUNDING * p.size
    if levels is None:
        return _stays_above(p, duration_rad, largest)
    # Of amplitudes -dC(u), with the command C after u back from the end: by parts,
    # p(0) + integral of p' C, least where C is lowest while p rises and highest while it falls.
    rise, fall = _rise_and_fall(p, duration_rad)
    lowest, highest = levels
    return float(p.at(np.zeros(1))[0]) + lowest * rise - highest * fall > largest


class _Polynomial:
    """p and its derivatives; bounds of the size of p and of its second and third derivative.

    Every term decays with u, so that the bounds hold from u = 0 on.
    """

    def __init__(self, poles: ComplexArray, vectors: ComplexArray) -> None:
        self._poles = poles
        self._vectors = vectors
        self.size = float(np.abs(vectors).sum())
        self.bend = float((np.abs(vectors) * np.abs(poles) ** 2).sum())
        self.twist = float((np.abs(vectors) * np.abs(poles) ** 3).sum())

    def at(self, u: FloatArray, derivative: int = 0) -> FloatArray:
        vectors = self._vectors * self._poles**derivative
        value: FloatArray = (np.exp(np.multiply.outer(u, self._poles)) @ vectors).real
        return value


def _first_intervals(duration_rad: float) -> tuple[FloatArray, float]:
    """Middles and half width of the intervals to begin with."""
    count = 1 + math.ceil(FIRST_INTERVALS_PER_RADIAN * duration_rad)
    half = duration_rad / count / 2
    return half * (2 * np.arange(count) + 1), half


def _stays_above(p: _Polynomial, duration_rad: float, level: float) -> bool:
    middles, half = _first_intervals(duration_rad)
    for _ in range(MAX_HALVINGS):
        values = p.at(middles)
        lowest = values - half * np.abs(p.at(middles, 1)) - half * half / 2 * p.bend
        if values.min() <= level:
            return False
        middles = middles[lowest <= level]
        if middles.size == 0:
            return True
        if middles.size > MAX_INTERVALS:
            return False
        half /= 2
        middles = np.concatenate((middles - half, middles + half))
    return False


def _rise_and_fall(p: _Polynomial, duration_rad: float) -> tuple[float, float]:
    """Return upper bounds of how much p rises, and falls, in all over [0, D]."""
    middles, half = _first_intervals(duration_rad)
    rise = fall = 0.0
    for _ in range(MAX_HALVINGS):
        slope = np.abs(p.at(middles, 1))
        # Near a slope's zero the curvature itself may be small: its bound alone would not do.
        change = half * np.abs(p.at(middles, 2)) + half * half / 2 * p.twist
        monotone = slope > change
        steepest = slope + change
        sure = middles[monotone]
        gained = p.at(sure + half) - p.at(sure - half)
        rise += float(np.maximum(gained, 0).sum())
        fall += float(np.maximum(-gained, 0).sum())
        middles = middles[~monotone]
        # What is left over may rise or fall by its steepest slope all along.
        open_yet = float((2 * half * steepest[~monotone]).sum())
        if open_yet <= ROUNDING * p.size or middles.size > MAX_INTERVALS:
            break
        half /= 2
        middles = np.concatenate((middles - half, middles + half))
    slack = open_yet + ROUNDING * p.size
    return rise + slack, fall + slack
