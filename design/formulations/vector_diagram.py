"""The vector diagram of three steps: where an undamped mode makes it close, in closed form."""

import cmath
import math

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.gaps import PERIOD_RAD
from design.formulations.seeds import Seed
from design.types import FloatArray

MAX_ALPHA = 2
"""Two unit vectors reach no further [-]."""


def undamped_seeds(
    ratio: complex, shortest: FloatArray, horizon_rad: float, amplitudes: FloatArray
) -> tuple[Seed, ...]:
    """Return the times of the undamped triangle as a seed, where it closes.

    Without a seed all branches are searched.

    Parameters
    ----------
    ratio, shortest, horizon_rad, amplitudes
        As of `undamped_times_rad`.

    Returns
    -------
    tuple of Seed
        At most one.
    """
    try:
        times = undamped_times_rad(ratio, shortest, horizon_rad, amplitudes)
    except InfeasibleDesignError:  # says nothing of the damped or switched equations
        return ()
    return (Seed(name="undamped_triangle", gaps_rad=np.diff(times)),)


def undamped_times_rad(
    ratio: complex,
    shortest: FloatArray,
    horizon_rad: float,
    amplitudes: FloatArray | None = None,
) -> FloatArray:
    """Return the fastest three-impulse times of an undamped mode.

    The three vectors ``1, -alpha exp(-j (t2 + beta)), exp(-j t3)`` close when::

        t2 = ±acos(alpha / 2) - beta + 2 pi n,    t3 = ±2 acos(alpha / 2) + 2 pi m

    (Kim 2011, eqs. 3.34-3.35, whose ± is +). Of amplitudes ``a, -b, c`` the triangle has the sides
    ``a, b alpha, c``, and by the law of cosines::

        t2 = ±acos((a^2 + (b alpha)^2 - c^2) / (2 a b alpha)) - beta + 2 pi n
        t3 = ±acos(((b alpha)^2 - a^2 - c^2) / (2 a c)) + 2 pi m

    (Kim 2011, appendix B, eqs. 1, 2, 4, 5). Of both signs and all whole n and m, the fastest whose
    gaps are at least ``shortest``.

    Parameters
    ----------
    ratio
        ``alpha exp(-j beta)``, see `decel_over_accel` [-].
    shortest
        Shortest gaps, shape (2,) [rad].
    horizon_rad
        Longest duration [rad].
    amplitudes
        Heights a, -b, c, shape (3,); 1, -1, 1 if not given [-].

    Returns
    -------
    FloatArray
        Times from 0, shape (3,) [rad].

    Raises
    ------
    InfeasibleDesignError
        If no triangle closes: of unit impulses where alpha > 2; or if the fastest is longer than
        ``horizon_rad``.
    """
    alpha, beta = abs(ratio), -cmath.phase(ratio)
    angles = _unit_triangle(alpha) if amplitudes is None else _triangle(alpha, amplitudes)
    candidates = []
    for sign in (1, -1):
        t2 = _not_before(sign * angles[0] - beta, float(shortest[0]))
        t3 = _not_before(sign * angles[1], t2 + float(shortest[1]))
        candidates.append((t3, t2))
    t3, t2 = min(candidates)
    if t3 > horizon_rad:
        raise InfeasibleDesignError(
            f"the fastest ordered solution takes {t3 / PERIOD_RAD:.6g} periods, more than "
            f"max_duration_periods = {horizon_rad / PERIOD_RAD:g}",
            code="ordered_exceeds_duration",
        )
    return np.array([0.0, t2, t3])


def _unit_triangle(alpha: float) -> tuple[float, float]:
    if alpha > MAX_ALPHA:
        raise InfeasibleDesignError(
            f"alpha = |G_decel/G_accel| at the plant's frequency is {alpha!r}, and the vector "
            "diagram of three unit impulses closes only for alpha <= 2",
            code="alpha_above_two",
        )
    half_angle = math.acos(alpha / 2)
    return half_angle, 2 * half_angle


def _triangle(alpha: float, amplitudes: FloatArray) -> tuple[float, float]:
    """Angles from the first side to the second and, reversed, to the third [rad]."""
    a, b, c = (float(abs(one)) for one in amplitudes)
    sides = (a, b * alpha, c)
    if 2 * max(sides) > sum(sides):
        raise InfeasibleDesignError(
            f"the vector diagram does not close: of its sides {sides[0]:.6g}, {sides[1]:.6g} and "
            f"{sides[2]:.6g} none may be longer than the other two together (amplitudes {a:g}, "
            f"{-b:g}, {c:g}; alpha = |G of the second step / G of the others| = {alpha:.6g} at the "
            "plant's frequency)",
            code="diagram_open",
        )
    # Closed except for rounding, a cosine may be beyond 1 by as much.
    second = math.acos(min(1.0, (a * a + sides[1] ** 2 - c * c) / (2 * a * sides[1])))
    third = math.acos(max(-1.0, (sides[1] ** 2 - a * a - c * c) / (2 * a * c)))
    return second, third


def _not_before(angle: float, earliest: float) -> float:
    """Return the angle plus the smallest whole number of turns, at or after ``earliest`` [rad]."""
    return angle + PERIOD_RAD * math.ceil((earliest - angle) / PERIOD_RAD)
