"""The residual of a course of the reference, linear in its slope."""

import numpy as np

from design.types import ComplexArray, FloatArray


class Functionals:
    """``F_k(r) = integral of r'(t) (-t)^o_k exp(-s_k t) dt`` of a reference r, for any r.

    Order 0 is the residual of r in a mode with pole s, order 1 its slope in s. With a pole at 0,
    order 1 is the integral of r where r ends at 0: the distance of a move, over its speed.

    Parameters
    ----------
    poles
        Poles over the frequency that turns times into phases, shape (m,) [-].
    orders
        0 or 1 each, shape (m,).
    """

    def __init__(self, poles: ComplexArray, orders: FloatArray) -> None:
        self.poles = poles
        self.orders = orders
        self._poles = poles[:, None]
        self._first = orders[:, None] == 1
        self._still = poles[:, None] == 0

    @property
    def real(self) -> FloatArray:
        """1 of a functional that is always real, 0 of others, shape (m,)."""
        real: FloatArray = (self.poles == 0).astype(np.float64)
        return real

    def kernels(self, times: FloatArray) -> ComplexArray:
        """Return ``(-t)^o exp(-s t)``, shape (m, n)."""
        swings = np.exp(-self._poles * times)
        kernels: ComplexArray = np.where(self._first, -times, 1.0) * swings
        return kernels

    def rates(self, times: FloatArray) -> ComplexArray:
        """Return the derivatives of the kernels in time, shape (m, n)."""
        swings = np.exp(-self._poles * times)
        rates: ComplexArray = np.where(self._first, self._poles * times - 1, -self._poles) * swings
        return rates

    def integrals(self, times: FloatArray) -> ComplexArray:
        """Return antiderivatives of the kernels, shape (m, n)."""
        s = np.where(self._still, 1.0, self._poles)
        swings = np.exp(-self._poles * times)
        swinging = np.where(self._first, (times + 1 / s) / s, -1 / s) * swings
        standing = np.where(self._first, -times * times / 2, times)
        integrals: ComplexArray = np.where(self._still, standing, swinging)
        return integrals

    def scales(self, time: float) -> FloatArray:
        """Return the factors that refer functionals to a time, shape (m,)."""
        scales: FloatArray = np.exp(self.poles.real * time)
        return scales
