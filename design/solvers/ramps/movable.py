"""What a search over a band needs of a course: how it changes as its times move."""

from collections.abc import Hashable
from typing import ClassVar, Protocol, Self, TypeVar

import numpy as np

from design.solvers.ramps.functionals import Functionals
from design.types import ComplexArray, FloatArray


class Movable(Protocol):
    """A course of a limited reference by n times, the first of which is 0 and stays."""

    keeps_order: ClassVar[bool]
    """Whether its times never pass each other."""

    @property
    def structure(self) -> Hashable:
        """What its times cannot change."""

    @property
    def end(self) -> float:
        """When its last ramp ends [rad]."""

    @property
    def gaps(self) -> FloatArray:
        """From one time to the next, shape (n - 1,) [rad]."""

    @property
    def conditions(self) -> FloatArray:
        """What is not met of its structure, shape (c,)."""

    @property
    def condition_changes(self) -> FloatArray:
        """Their derivatives in each time, shape (c, n)."""

    def condition_bends(self, prices: FloatArray, /) -> FloatArray:
        """Return their second derivatives, weighted, shape (n, n)."""

    def moved(self, moves: FloatArray) -> Self:
        """Return the course with its times moved, shape (n,) [rad]."""

    def values(self, functionals: Functionals) -> ComplexArray:
        """Return the functionals of the course, shape (m,)."""

    def changes(self, functionals: Functionals) -> ComplexArray:
        """Return the derivatives of the functionals in each time, shape (m, n)."""

    def end_changes(self) -> FloatArray:
        """Return the derivatives of the end in each time, shape (n,) [-]."""

    def bends(self, functionals: Functionals, multipliers: ComplexArray) -> FloatArray:
        """Return the second derivatives of ``Re sum conj(c_k) F_k``.

        Parameters
        ----------
        functionals, multipliers
            F and c, shape (m,).

        Returns
        -------
        FloatArray
            In two times each, shape (n, n).
        """


AnyCourse = TypeVar("AnyCourse", bound=Movable)


def kept_share(gaps: FloatArray, moves: FloatArray, most: float) -> float:
    """Return the share of a step that closes no gap by more than a share.

    Parameters
    ----------
    gaps
        Between times, shape (n - 1,) [rad].
    moves
        Of the times after the first, shape (n - 1,) [rad].
    most
        That share [-].

    Returns
    -------
    float
        At most 1 [-].
    """
    closing = np.diff(moves, prepend=0.0)
    shrinking = closing < 0
    return min(1.0, most * float(np.min(-gaps[shrinking] / closing[shrinking], initial=2.0)))
