"""Exponential, sine, cosine and angle by sums, products and quotients alone.

Such are rounded alike on every machine, while the last digit of a library's functions depends on
machine and version; and as nothing in them branches, loops over them become vector instructions.
They are right to one unit in the last place, or two.

An argument is a whole multiple of ln 2 or pi / 2 and a remainder, whose function is summed as its
Taylor series. The multiple is rounded to a whole number by adding `WHOLE`, which puts the number
in the last bits of the sum.
"""

import math
from decimal import Context, Decimal

import numpy as np

from design.tables.compiled import compiled, inlined

DECIMAL = Context(prec=50)
PI = Decimal("3.14159265358979323846264338327950288419716939937510582")
LN2 = Decimal(2).ln(DECIMAL)


def _parts(number: Decimal, count: int) -> list[float]:
    """Return parts of a number; whole multiples of all but the last are exact up to 2^20."""
    parts = []
    for _ in range(count - 1):
        unit = 2.0 ** (math.frexp(number)[1] - 33)
        parts.append(math.floor(number / Decimal(unit)) * unit)
        number = DECIMAL.subtract(number, Decimal(parts[-1]))
    return [*parts, float(number)]


WHOLE = 1.5 * 2.0**52
"""The last place of a sum with it is that of 1."""

LN2_HIGH, LN2_LOW = _parts(LN2, 2)
PER_LN2 = float(1 / LN2)

QUARTER_HIGH, QUARTER_MIDDLE, QUARTER_LOW = _parts(DECIMAL.divide(PI, Decimal(2)), 3)
PER_QUARTER = float(2 / PI)
QUARTER_TURN = float(PI / 2)
HALF_TURN = float(PI)

MAX_EXPONENT = 700.0
"""Beyond it the exponential stays as it is there: 1e304 and its inverse stand for all of those."""

E3, E4, E5, E6, E7, E8, E9, E10, E11, E12, E13, E14, E15, E16, E17 = (
    1.0 / math.factorial(n) for n in range(3, 18)
)
"""Coefficients of the series."""

A1, A3, A5, A7, A9 = 0.9998660, 0.3302995, 0.1801410, 0.0851330, 0.0208351
"""Of the arctangent up to 1, within 2e-5 (Abramowitz and Stegun 1964, eq. 4.4.49)."""


@inlined
def _powers(x: float) -> tuple[float, float]:
    """Return ``2^k`` and ``exp(r) - 1`` where ``x = k ln 2 + r`` and r is smallest."""
    x = -MAX_EXPONENT if x < -MAX_EXPONENT else x
    x = MAX_EXPONENT if x > MAX_EXPONENT else x
    shifted = x * PER_LN2 + WHOLE
    k = shifted - WHOLE
    r = (x - k * LN2_HIGH) - k * LN2_LOW
    tail = E8 + r * (E9 + r * (E10 + r * (E11 + r * (E12 + r * E13))))
    tail = 0.5 + r * (E3 + r * (E4 + r * (E5 + r * (E6 + r * (E7 + r * tail)))))
    # The exponent of a double stands above 52 bits of its fraction.
    bits = np.float64(1.0).view(np.int64) + (np.float64(shifted).view(np.int64) << 52)
    return np.int64(bits).view(np.float64), r + r * r * tail


@inlined
def exponential(x: float) -> float:
    """Return exp(x)."""
    power, more = _powers(x)
    return power * (1.0 + more)


@inlined
def exponential_less_one(x: float) -> float:
    """Return exp(x) - 1, with all digits where that is little."""
    power, more = _powers(x)
    return power * more + (power - 1.0)


@inlined
def sine_and_cosine(x: float) -> tuple[float, float]:
    """Return sin(x) and cos(x), with all digits up to a million turns."""
    shifted = x * PER_QUARTER + WHOLE
    k = shifted - WHOLE
    quarters = np.float64(shifted).view(np.int64)
    r = ((x - k * QUARTER_HIGH) - k * QUARTER_MIDDLE) - k * QUARTER_LOW
    q = r * r
    odd = E9 - q * (E11 - q * (E13 - q * (E15 - q * E17)))
    odd = r - r * q * (E3 - q * (E5 - q * (E7 - q * odd)))
    even = E8 - q * (E10 - q * (E12 - q * (E14 - q * E16)))
    even = 1.0 - q * (0.5 - q * (E4 - q * (E6 - q * even)))
    exchanged = (quarters & 1) != 0
    sine = even if exchanged else odd
    cosine = odd if exchanged else even
    sine = -sine if (quarters & 2) != 0 else sine
    cosine = -cosine if ((quarters + 1) & 2) != 0 else cosine
    return sine, cosine


@compiled
def near_angle(x: float, y: float) -> float:
    """Return the angle of a vector within 2e-5 [rad].

    Parameters
    ----------
    x, y
        Vector, not 0.

    Returns
    -------
    float
        From -pi to pi [rad].
    """
    long, short = max(abs(x), abs(y)), min(abs(x), abs(y))
    slope = short / long
    square = slope * slope
    angle = slope * (A1 - square * (A3 - square * (A5 - square * (A7 - square * A9))))
    angle = QUARTER_TURN - angle if abs(y) > abs(x) else angle
    angle = HALF_TURN - angle if x < 0.0 else angle
    return -angle if y < 0.0 else angle


@compiled
def angle(x: float, y: float) -> float:
    """Return the angle of a vector [rad].

    Parameters
    ----------
    x, y
        Vector, not 0.

    Returns
    -------
    float
        From -pi to pi [rad].
    """
    near = near_angle(x, y)
    sine, cosine = sine_and_cosine(near)
    # What is left is so little that two terms of its sine give it.
    left = (y * cosine - x * sine) / math.sqrt(x * x + y * y)
    return near + left * (1.0 + left * left / 6.0)
