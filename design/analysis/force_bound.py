"""What no on-off force on a free body goes below, by weights of what it is integrated with.

Let q be the time left x, times its weight, plus any constant and any multiples of ``x^n exp(s x)``
in the modes. A force u from rest to rest that excites no mode has ``integral q u = weight times
way``, and at most ``integral |q|`` if ``|u| <= 1``. So no time is enough up to which ``integral
|q|`` is less; and the time under force is at least ``weight times way - integral max(|q| - 1, 0)``.
Every q proves a bound; how it was found does not matter.
"""

import itertools
from collections.abc import Callable

import numpy as np
from numpy.polynomial.legendre import leggauss

from design.model.plants.mode import Mode
from design.types import FloatArray

NODES, WEIGHTS = leggauss(16)

PANELS_PER_PERIOD = 8
"""Panels over a period of the fastest mode: Gauss and Legendre is exact to rounding on each [-]."""

POINTS = 17
"""At which q is looked at on a panel."""

ROUNDING = 1e-12
"""Share that is taken off a bound for the rounding of its integral [-]."""


def least_duration_s(modes: tuple[Mode, ...], weights: FloatArray, way_s2: float) -> float:
    """Return a time in which no force makes the way.

    Parameters
    ----------
    modes
        That must not be excited.
    weights
        Of the time left, of 1, and of real and imaginary part of each mode's ``(w x)^n exp(s x)``,
        n from 0 on; shape (k,), the first > 0.
    way_s2
        Distance times mass over force [s^2].

    Returns
    -------
    float
        Every force from rest to rest that excites no mode takes longer [s].
    """
    from scipy.optimize import brentq  # noqa: PLC0415 - takes longer to import than a design

    q = _sum(modes, weights)
    goal = float(weights[0]) * way_s2
    edge, reached, step = 0.0, 0.0, _panel_s(modes, way_s2)
    while True:
        more = _integral_beyond(q, edge, edge + step, 0.0)
        if reached + more >= goal:
            break
        edge, reached = edge + step, reached + more

    def lacks(end_s: float) -> float:
        return reached + _integral_beyond(q, edge, end_s, 0.0) - goal

    end_s = float(brentq(lacks, edge, edge + step, xtol=1e-15 * (edge + step), rtol=1e-15))
    return end_s * (1 - ROUNDING)


def least_burn_s(
    modes: tuple[Mode, ...], weights: FloatArray, way_s2: float, duration_s: float
) -> float:
    """Return a time that the force is on at least, of a move of a duration.

    Parameters
    ----------
    modes, weights, way_s2
        As of `least_duration_s`.
    duration_s
        Of the move [s].

    Returns
    -------
    float
        Every such force is on for longer [s].
    """
    q = _sum(modes, weights)
    panels = int(np.ceil(duration_s / _panel_s(modes, way_s2)))
    edges = np.linspace(0.0, duration_s, panels + 1).tolist()
    beyond = sum(_integral_beyond(q, low, high, 1.0) for low, high in itertools.pairwise(edges))
    goal = float(weights[0]) * way_s2
    return max(0.0, goal - beyond - ROUNDING * (goal + beyond))


def _panel_s(modes: tuple[Mode, ...], way_s2: float) -> float:
    fastest = min(mode.period_s for mode in modes)
    return float(min(fastest / PANELS_PER_PERIOD, np.sqrt(way_s2) / PANELS_PER_PERIOD))


def _sum(modes: tuple[Mode, ...], weights: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Return q as a function of the time left."""
    first, constant, *others = weights.tolist()
    orders = len(others) // (2 * len(modes))

    def q(left_s: FloatArray) -> FloatArray:
        summed = first * left_s + constant
        rest = iter(others)
        for mode in modes:
            pole, w = mode.pole_rad_s, mode.natural_frequency_rad_s
            decay = np.exp(pole.real * left_s)
            waves = decay * np.cos(pole.imag * left_s), decay * np.sin(pole.imag * left_s)
            for order in range(orders):
                for wave in waves:
                    summed = summed + next(rest) * (w * left_s) ** order * wave
        total: FloatArray = summed
        return total

    return q


def _integral_beyond(
    q: Callable[[FloatArray], FloatArray], low_s: float, high_s: float, threshold: float
) -> float:
    """Integrate ``max(|q| - threshold, 0)`` over a panel, split where q crosses the threshold."""
    from scipy.optimize import brentq, minimize_scalar  # noqa: PLC0415

    edges = [low_s]
    for level in sorted({threshold, -threshold}):

        def above(time_s: float, at: float = level) -> float:
            return float(q(np.array(time_s))) - at

        def apart(time_s: float, above: Callable[[float], float] = above) -> float:
            return abs(above(time_s))

        grid = np.linspace(low_s, high_s, POINTS)
        gaps = q(grid) - level
        # Where q only comes near, between two points, it may cross twice.
        sides = np.abs(gaps)
        (near,) = np.nonzero((sides[1:-1] <= sides[:-2]) & (sides[1:-1] <= sides[2:]))
        nearest = [
            minimize_scalar(
                apart,
                bounds=(grid[one], grid[one + 2]),
                method="bounded",
                options={"xatol": 1e-9 * (high_s - low_s)},
            ).x
            for one in near.tolist()
        ]
        points = sorted({*grid.tolist(), *map(float, nearest)})
        edges += [
            float(brentq(above, one, other, xtol=1e-16, rtol=1e-15))
            for one, other in itertools.pairwise(points)
            if above(one) * above(other) < 0
        ]
    edges = [*sorted(edges), high_s]
    summed = 0.0
    for begin, end in itertools.pairwise(edges):
        nodes = (begin + end) / 2 + (end - begin) / 2 * NODES
        summed += (end - begin) / 2 * float(WEIGHTS @ np.maximum(np.abs(q(nodes)) - threshold, 0))
    return summed
