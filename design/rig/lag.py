"""How a lag behind a reference of constant jerk moves: compiled, in closed form.

The state of a lag is its error ``e = v - r`` against the reference, and the rate of its velocity
``v'``. It obeys ``v - r + first v' + second v'' = 0``.
"""

import math

from numpy.polynomial.legendre import leggauss

from design.tables.compiled import compiled

NODES, WEIGHTS = ((1 + leggauss(8)[0]) / 2, leggauss(8)[1] / 2)
"""Of the mean from 0 to 1: of a motion through `SHORT_PHASE` exact to rounding."""

SHORT_PHASE = 1.0
"""Phase of the fastest pole up to which the motion is integrated by `NODES` [rad]."""


@compiled
def free_error(first_s: float, second_s2: float, elapsed_s: float) -> tuple[float, float]:
    """Return what becomes of an error of one, and of a rate of one.

    Parameters
    ----------
    first_s, second_s2
        Coefficients of the lag; the second is 0 for one of first order, both of an ideal one.
    elapsed_s
        Time since, >= 0 [s].

    Returns
    -------
    tuple of float
        Of ``e`` that was 1 with no rate [-]; of ``e`` that was 0 with a rate of 1 [s].
    """
    if second_s2 == 0.0:
        return (math.exp(-elapsed_s / first_s) if first_s > 0.0 else 0.0), 0.0
    corner = 1.0 / math.sqrt(second_s2)
    damping = first_s * corner / 2
    phase = corner * elapsed_s
    root = math.sqrt(abs(damping * damping - 1))
    turn = root * phase
    if damping < 1:
        decay = math.exp(-damping * phase)
        even = decay * math.cos(turn)
        odd = decay * phase * (math.sin(turn) / turn if turn > 0.0 else 1.0)
    else:
        slow = math.exp(-phase / (damping + root))
        even = slow * (1 + math.exp(-2 * turn)) / 2
        odd = slow * (phase if root == 0.0 else -math.expm1(-2 * turn) / (2 * root))
    return even + damping * odd, odd / corner


@compiled
def lag_motion(
    first_s: float,
    second_s2: float,
    error: float,
    rate: float,
    slope: float,
    jerk: float,
    elapsed_s: float,
) -> tuple[float, float]:
    """Return the state of a lag some time after a moment.

    Parameters
    ----------
    first_s, second_s2
        Coefficients of the lag [s], [s^2].
    error, rate
        Its state at the moment: velocity less reference [-], and the velocity's rate [1/s].
    slope, jerk
        Of the reference: its rate at the moment [1/s], and the constant rate of that [1/s^2].
    elapsed_s
        Time since the moment, >= 0 [s].

    Returns
    -------
    tuple of float
        Error [-] and rate of the velocity [1/s]. An ideal lag has no error.
    """
    if first_s == 0.0 and second_s2 == 0.0:
        return 0.0, slope + jerk * elapsed_s
    decayed, pushed = free_error(first_s, second_s2, elapsed_s)
    moving = slope != 0.0 or jerk != 0.0
    if second_s2 == 0.0:
        error_rate = 0.0
        fastest = 1 / first_s
    else:
        error_rate = rate - slope
        corner = 1.0 / math.sqrt(second_s2)
        fastest = first_s / second_s2 + corner
    if moving and fastest * elapsed_s <= SHORT_PHASE:
        # The lag falls behind by what the reference gained, as far as it has not caught up.
        behind = 0.0
        behind_rate = 0.0
        for node, weight in zip(NODES, WEIGHTS):  # noqa: B905 - numba knows no strict
            share = weight * elapsed_s * (slope + jerk * elapsed_s * (1 - node))
            left, left_rate = free_error(first_s, second_s2, node * elapsed_s)
            behind += share * left
            behind_rate += share * left_rate
        if second_s2 == 0.0:
            now = decayed * error - behind
            return now, -now / first_s
        now = decayed * error + pushed * rate - behind
        # The rate of what is left of an error of one is -left_rate / second.
        free_rate = -pushed / second_s2 * error + (decayed - first_s / second_s2 * pushed) * rate
        return now, free_rate + behind_rate / second_s2
    steady_rate = -first_s * jerk
    steady = -first_s * slope - second_s2 * jerk - first_s * steady_rate
    drift = steady + steady_rate * elapsed_s
    if second_s2 == 0.0:
        now = drift + decayed * (error - steady)
        return now, -now / first_s
    apart, apart_rate = error - steady, error_rate - steady_rate
    now = drift + decayed * apart + pushed * apart_rate
    moved = -pushed / second_s2 * apart + (decayed - first_s / second_s2 * pushed) * apart_rate
    return now, slope + jerk * elapsed_s + steady_rate + moved
