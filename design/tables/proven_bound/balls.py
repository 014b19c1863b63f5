"""Ball arithmetic: disks that hold all values of a function, and what rounding makes of each value.

A `Ball` stands for a function on a set, as the residual's vector over a cell of a table. All its
values lie within ``radius`` of ``centre``. In floating numbers, from inputs that are off, each
value is found to within ``error`` of itself. Both follow from the operands by the triangle
inequality, as in a running analysis of errors (Wilkinson 1963, chapter 1) and in midpoint-radius
arithmetic (Rump 1999, BIT 39, 534-554).

Where nothing can be said, as of a quotient whose divisor may be 0, the radius is infinite. A finite
radius on a disk therefore proves that the function is analytic there: it is made of analytic
operations, each on a set that has none of their singular points.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from design.types import BoolArray, ComplexArray, FloatArray

UNIT = float(np.finfo(np.float64).eps) / 2
"""Relative rounding of one operation with doubles [-]."""

ROUNDING = 8 * UNIT
"""Of a complex sum, product or inverse, and of the product of both: ``sqrt(5)`` units at most
(Brent, Percival, Zimmermann 2007), 3 of an inverse by its squared magnitude [-]."""

FUNCTION_ROUNDING = 32 * UNIT
"""Of a complex exponential or root: real functions are within 4 units in the last place in the
libraries that numpy uses, and three of them, multiplied, make one of these [-]."""

GROWN = 1 + 64 * UNIT
"""On a radius and an error, for the rounding of the operations that find them [-]."""

Number = Any
"""A `Ball`, an array or a number: a formula in these is evaluated on sets or at points."""


@dataclass(frozen=True, slots=True, eq=False)
class Ball:
    """Values of a function on a set, one a cell.

    Attributes
    ----------
    centre
        Shape (m,), complex.
    radius
        How far values are from it, shape (m,), >= 0; infinite where that is not known.
    error
        How far a value is off that is found by rounding arithmetic, shape (m,), >= 0.
    """

    # Before numpy's own operators, which would make an array of balls.
    __array_ufunc__ = None

    centre: ComplexArray
    radius: FloatArray
    error: FloatArray

    @classmethod
    def of(cls, value: Number) -> "Ball":
        """Return numbers as balls that hold just them; a ball as it is."""
        if isinstance(value, Ball):
            return value
        centre = np.asarray(value, dtype=np.complex128)
        return cls(centre, np.zeros(centre.shape), np.zeros(centre.shape))

    @classmethod
    def near(cls, value: FloatArray) -> "Ball":
        """Return numbers that are known to rounding, as balls."""
        centre = value.astype(np.complex128)
        rounding = ROUNDING * np.abs(centre)
        return cls(centre, rounding, rounding)

    @property
    def size(self) -> FloatArray:
        """Largest magnitude, shape (m,)."""
        return (np.abs(self.centre) + self.radius) * GROWN

    @property
    def least(self) -> FloatArray:
        """Smallest magnitude less the error, shape (m,); <= 0 if none is sure."""
        return np.abs(self.centre) * (2 - GROWN) - (self.radius + self.error) * GROWN

    def __neg__(self) -> "Ball":
        return Ball(-self.centre, self.radius, self.error)

    def __add__(self, other: Number) -> "Ball":
        that = Ball.of(other)
        return _rounded(
            self.centre + that.centre, self.radius + that.radius, self.error + that.error
        )

    __radd__ = __add__

    def __sub__(self, other: Number) -> "Ball":
        return self + (-Ball.of(other))

    def __rsub__(self, other: Number) -> "Ball":
        return -self + Ball.of(other)

    def __mul__(self, other: Number) -> "Ball":
        that = Ball.of(other)
        with np.errstate(invalid="ignore", over="ignore"):
            radius = np.abs(self.centre) * that.radius + self.radius * that.size
            error = self.size * that.error + self.error * (that.size + that.error)
            return _rounded(self.centre * that.centre, radius, error)

    __rmul__ = __mul__

    def __truediv__(self, other: Number) -> "Ball":
        return self * Ball.of(other).inverse()

    def __rtruediv__(self, other: Number) -> "Ball":
        return self.inverse() * Ball.of(other)

    def inverse(self) -> "Ball":
        """Return 1 over the ball; without bound where that may be 0."""
        away = self.least > 0
        centre = np.where(away, self.centre, 1.0)
        least = np.where(away, self.least, 1.0)
        radius = self.radius / (np.abs(centre) * least)
        # |1/(x + d) - 1/x| = |d| / (|x| |x + d|), and both are at least this.
        found = np.reciprocal(centre).astype(np.complex128)
        return _rounded(found, radius, self.error / least**2).only(away)

    def exp(self) -> "Ball":
        """Return the exponential.

        ``|exp(x + d) - exp(x)| <= |exp(x)| (exp(|d|) - 1)``.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            centre = np.exp(self.centre)
            height = np.exp(self.centre.real)
            radius = height * np.expm1(self.radius)
            error = (height + radius) * np.expm1(self.error)
            return _rounded(centre, radius, error, FUNCTION_ROUNDING)

    def sqrt(self) -> "Ball":
        """Return the principal root; without bound where a value may be left of 0.

        ``|sqrt(x + d) - sqrt(x)| <= |d| / sqrt(|x|)``, as both roots are in one quadrant about the
        positive axis.
        """
        right = self.centre.real * (2 - GROWN) - (self.radius + self.error) * GROWN > 0
        centre = np.where(right, self.centre, 1.0)
        least = np.where(right, self.least, 1.0)
        radius = self.radius / np.sqrt(np.abs(centre))
        error = self.error / np.sqrt(least)
        return _rounded(np.sqrt(centre), radius, error, FUNCTION_ROUNDING).only(right)

    def only(self, known: BoolArray) -> "Ball":
        """Return the ball, without bound where nothing is known."""
        return Ball(
            np.where(known, self.centre, 0.0),
            np.where(known, self.radius, np.inf),
            np.where(known, self.error, np.inf),
        )


def _rounded(
    centre: ComplexArray, radius: FloatArray, error: FloatArray, rounding: float = ROUNDING
) -> Ball:
    """Return a ball with the rounding of its centre, and of values, added; infinite for none."""
    with np.errstate(invalid="ignore", over="ignore"):
        radius = (radius + rounding * np.abs(centre)) * GROWN
        error = (error + rounding * (np.abs(centre) + radius + error)) * GROWN
        known = np.isfinite(centre) & (radius < np.inf) & (error < np.inf)
    return Ball(
        np.where(known, centre, 0.0),
        np.where(known, radius, np.inf),
        np.where(known, error, np.inf),
    )


def exp(value: Number) -> Number:
    """Return the exponential of balls, arrays or numbers."""
    return value.exp() if isinstance(value, Ball) else np.exp(value)


def sqrt(value: Number) -> Number:
    """Return the principal root of balls, arrays or numbers."""
    return value.sqrt() if isinstance(value, Ball) else np.sqrt(value)


def either_root(value: Number) -> Number:
    """Return one of the two roots, for functions that are even in it.

    Parameters
    ----------
    value
        Balls, arrays or numbers; it may be on either side of 0, and 0.

    Returns
    -------
    Number
        Balls that hold one root of each value: all about 0 where the value may vanish. A function
        that is even in the root is analytic in the value there too.
    """
    if not isinstance(value, Ball):
        return np.sqrt(np.asarray(value, dtype=np.complex128))
    left = value.centre.real < 0
    there = Ball(np.where(left, -value.centre, value.centre), value.radius, value.error).sqrt()
    turned = Ball(np.where(left, 1j, 1.0) * there.centre, there.radius, there.error)
    # Of both roots the nearer one is |sqrt(q + d) - sqrt(q)| <= sqrt(|d|) away.
    around = Ball(np.zeros_like(value.centre), np.sqrt(value.size), np.sqrt(value.error) * GROWN)
    own = np.isfinite(there.radius)
    return Ball(
        np.where(own, turned.centre, around.centre),
        np.where(own, turned.radius, around.radius),
        np.where(own, turned.error, around.error),
    )


def mean_decay(value: Number) -> Number:
    """Return ``(1 - exp(-x)) / x``, the mean of ``exp(-x u)`` for u to 1.

    It is entire.

    Parameters
    ----------
    value
        Balls, arrays or numbers x.

    Returns
    -------
    Number
        By ``|exp(-(x + d) u) - exp(-x u)| <= |exp(-x u)| (exp(|d| u) - 1)`` under the mean: the
        last factor is convex in u, and its mean at most half of its largest.
    """
    x = np.asarray(value.centre if isinstance(value, Ball) else value, dtype=np.complex128)
    still = x == 0
    with np.errstate(over="ignore", invalid="ignore"):
        found = np.where(still, 1.0, -np.expm1(-x) / np.where(still, 1.0, x))
        if not isinstance(value, Ball):
            return found
        height = np.maximum(np.exp(-x.real), 1.0)
        radius = height * np.expm1(value.radius) / 2
        sizes = np.maximum(np.exp(value.radius - x.real), 1.0)
        error = sizes * np.expm1(value.error) / 2
        # The difference of 1 and an exponential is off by units of either.
        radius, error = radius + FUNCTION_ROUNDING * height, error + FUNCTION_ROUNDING * height
        return _rounded(found, radius, error, FUNCTION_ROUNDING)
