"""Complex numbers and lags in CasADi's real expressions."""

from dataclasses import dataclass
from typing import Any

SMALLEST_ROOT = 1e-9
"""Distance of two poles that counts as none: the sine over it is the angle to double precision."""

SHORTEST_TIME_CONSTANT = 1e-9
"""Stands for a time constant of 0: at rest after any gap [rad]."""


@dataclass(frozen=True, slots=True)
class Complex:
    """A complex expression."""

    real: Any
    imag: Any

    def __add__(self, other: "Complex") -> "Complex":
        return Complex(self.real + other.real, self.imag + other.imag)

    def __sub__(self, other: "Complex") -> "Complex":
        return Complex(self.real - other.real, self.imag - other.imag)

    def __mul__(self, other: "Complex") -> "Complex":
        return Complex(
            self.real * other.real - self.imag * other.imag,
            self.real * other.imag + self.imag * other.real,
        )

    def __truediv__(self, other: "Complex") -> "Complex":
        size = other.real * other.real + other.imag * other.imag
        return self * Complex(other.real / size, -other.imag / size)

    def scaled(self, factor: Any) -> "Complex":  # noqa: ANN401 - casadi ships no types
        """Return the product with a real expression."""
        return Complex(factor * self.real, factor * self.imag)


def exponential(exponent: Complex) -> Complex:
    """Return the exponential of a complex expression."""
    import casadi as ca  # noqa: PLC0415

    size = ca.exp(exponent.real)
    return Complex(size * ca.cos(exponent.imag), size * ca.sin(exponent.imag))


class SymbolicSet:
    """A lag ``G = 1 / (1 + first s + second s^2)`` whose coefficients are expressions."""

    def __init__(self, first: Any, second: Any, s: Complex) -> None:  # noqa: ANN401
        self._first = first
        self._second = second
        below = Complex(1, 0) + s.scaled(first) + (s * s).scaled(second)
        self.gain = Complex(1, 0) / below

    def ringing(self, error: Any, rate: Any, s: Complex) -> Complex:  # noqa: ANN401
        """Return what an error and its rate leave if this set stays in force.

        It is ``G (second s rate - error)``.
        """
        return self.gain * (s.scaled(self._second * rate) - Complex(error, 0))

    def free_motion(
        self,
        gap: Any,  # noqa: ANN401
        error: Any,  # noqa: ANN401
        rate: Any,  # noqa: ANN401
        order: int,
    ) -> tuple[Any, Any]:
        """Return error and rate after a gap, by the closed form for any damping."""
        import casadi as ca  # noqa: PLC0415

        if order == 1:
            return error * ca.exp(-gap / ca.fmax(self._first, SHORTEST_TIME_CONSTANT)), rate
        corner = 1 / ca.sqrt(self._second)
        damping = self._first * corner / 2
        phase = corner * gap
        root = ca.fmax(ca.sqrt(ca.fabs(damping * damping - 1)), SMALLEST_ROOT)
        # Either branch must be finite where the other holds: both are computed.
        under = ca.exp(-ca.fmin(damping, 1) * phase)
        slow = ca.exp(-phase / (ca.fmax(damping, 1) + root))
        oscillates = damping < 1
        even = ca.if_else(
            oscillates, under * ca.cos(root * phase), slow * (1 + ca.exp(-2 * root * phase)) / 2
        )
        odd = ca.if_else(
            oscillates,
            under * ca.sin(root * phase) / root,
            -slow * ca.expm1(-2 * root * phase) / (2 * root),
        )
        return (
            (even + damping * odd) * error + odd * rate / corner,
            -odd * corner * error + (even - damping * odd) * rate,
        )
