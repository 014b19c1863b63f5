"""A course of limited jerk by its events: functionals, conditions, and how they change.

The course begins at rest at 0. A group of pieces of constant jerk takes it from rest at one end of
0 to 1 to rest at an end, where it stays for a while or touches only. An event is where two pieces
meet. Between events the jerk is at a limit, or 0 where the slope is at one. With ``d_j`` the jump
of the jerk at the event ``t_j`` and ``K2'' = kernel``, a functional is ``sum of d_j K2(t_j)``.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.polynomial.legendre import leggauss

from design.solvers.ramps.functionals import Functionals
from design.types import ComplexArray, FloatArray, IntArray

SHORT_RAD = 1.0
"""Turn of the fastest mode over a piece up to which Gauss nodes integrate it [rad]."""

NODES, WEIGHTS = ((1 + leggauss(10)[0]) / 2, leggauss(10)[1] / 2)
"""Of the mean from 0 to 1: exact to rounding up to `SHORT_RAD`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """How fast the reference and its slope may change.

    Attributes
    ----------
    up, down
        Steepest slopes, > 0 [1/rad].
    jerk
        Largest rate of the slope, > 0 [1/rad^2].
    """

    up: float
    down: float
    jerk: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """Pieces between two stays at 0 or 1.

    Attributes
    ----------
    signs
        Signs of the jerk, piece by piece: 0 where the slope is at its limit.
    goal
        Level at which it ends, 0 or 1.
    rests
        Whether the reference stays there for a while; else it touches only, or the course ends.
    """

    signs: tuple[int, ...]
    goal: float
    rests: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class EventCourse:
    """A course by its events.

    Attributes
    ----------
    groups
        Its structure.
    limits
        What its pieces are at.
    widths
        From one event to the next, shape (n - 1,): of short pieces times alone would lose digits
        [rad].
    """

    keeps_order: ClassVar[bool] = False
    """Whether its events never pass each other: where they do the structure is another."""

    groups: tuple[Group, ...]
    limits: Limits
    widths: FloatArray

    @property
    def structure(self) -> tuple[Group, ...]:
        """Its groups."""
        return self.groups

    @property
    def gaps(self) -> FloatArray:
        """From one event to the next, shape (n - 1,) [rad]."""
        return self.widths

    @cached_property
    def times(self) -> FloatArray:
        """Times of the events, shape (n,), from 0 [rad]."""
        return np.append(0.0, np.cumsum(self.widths))

    def moved(self, moves: FloatArray) -> "EventCourse":
        """Return the course with its events moved, shape (n,) [rad]."""
        return replace(self, widths=self.widths + np.diff(moves))

    @property
    def end(self) -> float:
        """When the course ends [rad]."""
        return float(self.times[-1])

    def end_changes(self) -> FloatArray:
        """Return the derivatives of the end in each event, shape (n,) [-]."""
        changes = np.zeros(self.times.size)
        changes[-1] = 1.0
        return changes

    @cached_property
    def firsts(self) -> tuple[int, ...]:
        """Number of the first event of each group."""
        firsts, number = [], 0
        for group in self.groups:
            firsts.append(number)
            number += len(group.signs) + group.rests
        return tuple(firsts)

    def events_of(self, number: int) -> slice:
        """Return the events of a group."""
        first = self.firsts[number]
        return slice(first, first + len(self.groups[number].signs) + 1)

    def widths_of(self, number: int) -> FloatArray:
        """Return how long each piece of a group takes [rad]."""
        first = self.firsts[number]
        return self.widths[first : first + len(self.groups[number].signs)]

    def jerks_of(self, number: int) -> FloatArray:
        """Return the jerk of each piece of a group."""
        return self.limits.jerk * np.array(self.groups[number].signs, dtype=np.float64)

    def jumps_of(self, number: int) -> FloatArray:
        """Return the jumps of the jerk at the events of a group."""
        jumps: FloatArray = np.diff(self.jerks_of(number), prepend=0.0, append=0.0)
        return jumps

    def slopes_of(self, number: int) -> FloatArray:
        """Return the slope at each event of a group."""
        rises = self.jerks_of(number) * self.widths_of(number)
        slopes: FloatArray = np.concatenate(([0.0], np.cumsum(rises)))
        return slopes

    def level_before(self, number: int) -> float:
        """Return the level at which a group begins."""
        return self.groups[number - 1].goal if number else 0.0

    @cached_property
    def jumps(self) -> FloatArray:
        """Jumps of the jerk at the events, shape (n,); 0 at a touch."""
        jumps = np.zeros(self.times.size)
        for number in range(len(self.groups)):
            jumps[self.events_of(number)] += self.jumps_of(number)
        return jumps

    def values(self, functionals: Functionals) -> ComplexArray:
        """Return the functionals of the course, shape (m,)."""
        total = np.zeros(functionals.poles.size, dtype=np.complex128)
        fastest = float(np.abs(functionals.poles).max(initial=0.0))
        for number in range(len(self.groups)):
            at, slopes = self.times[self.events_of(number)], self.slopes_of(number)
            jerks, widths = self.jerks_of(number), self.widths_of(number)
            short = np.abs(widths) * fastest < SHORT_RAD
            long = ~short
            once, twice = functionals.integrals(at), second_integrals(functionals, at)
            ramps = np.diff(slopes * once, axis=1) - jerks * np.diff(twice, axis=1)
            total += ramps[:, long].sum(axis=1)
            nodes = at[:-1][short] + np.multiply.outer(NODES, widths[short])
            kernels = functionals.kernels(nodes.ravel()).reshape(total.size, *nodes.shape)
            along = slopes[:-1][short] + np.multiply.outer(NODES, (jerks * widths)[short])
            total += np.einsum("i,kij,ij,j->k", WEIGHTS, kernels, along, widths[short])
            # A slope that is left at the end is a condition not met, and no part of these.
            total -= slopes[-1] * once[:, -1]
        return total

    def changes(self, functionals: Functionals) -> ComplexArray:
        """Return the derivatives of the functionals in each event, shape (m, n)."""
        changes: ComplexArray = self.jumps * functionals.integrals(self.times)
        return changes

    @cached_property
    def conditions(self) -> FloatArray:
        """What is not met of the structure, shape (c,).

        For each group: the slope of each piece at a limit less it, then slope and level at the end
        less what they are to be.
        """
        missed: list[float] = []
        for number, group in enumerate(self.groups):
            slopes = self.slopes_of(number)
            for piece in _at_limits(group):
                limit = self.limits.up if group.signs[piece - 1] > 0 else -self.limits.down
                missed.append(float(slopes[piece]) - limit)
            risen = float((slopes[1:] + slopes[:-1]) @ self.widths_of(number)) / 2
            missed += [float(slopes[-1]), risen - (group.goal - self.level_before(number))]
        return np.array(missed)

    @cached_property
    def condition_changes(self) -> FloatArray:
        """Derivatives of the conditions in each event, shape (c, n)."""
        rows: list[FloatArray] = []
        for number, group in enumerate(self.groups):
            events, jumps = self.events_of(number), self.jumps_of(number)
            at = self.times[events]
            for last in (*_at_limits(group), len(group.signs)):
                row = np.zeros(self.times.size)
                row[events][: last + 1] = -jumps[: last + 1]
                row[events][last] = jumps[:last].sum()
                rows.append(row)
            row = np.zeros(self.times.size)
            row[events] = -jumps * (at[-1] - at)
            row[events][-1] = self.slopes_of(number)[-1]
            rows.append(row)
        return np.array(rows)

    @cached_property
    def level_conditions(self) -> IntArray:
        """Which condition is the level of each group's end, shape (g,)."""
        counts = [len(_at_limits(group)) + 2 for group in self.groups]
        return np.cumsum(counts) - 1

    def bends(self, functionals: Functionals, multipliers: ComplexArray) -> FloatArray:
        """Return the second derivatives of ``Re sum conj(c_k) F_k``.

        Parameters
        ----------
        functionals
            F.
        multipliers
            c, shape (m,).

        Returns
        -------
        FloatArray
            In two events each, shape (n, n).
        """
        pull = (multipliers.conj() @ functionals.kernels(self.times)).real
        return np.diag(self.jumps * pull)

    def condition_bends(self, prices: FloatArray, /) -> FloatArray:
        """Return second derivatives of the conditions, by their prices."""
        bends = np.zeros((self.times.size, self.times.size))
        for number, price in enumerate(prices[self.level_conditions].tolist()):
            events, jumps = self.events_of(number), self.jumps_of(number)
            inner = bends[events, events]
            inner[np.diag_indices(len(jumps) - 1)] += price * jumps[:-1]
            inner[-1, :-1] -= price * jumps[:-1]
            inner[:-1, -1] -= price * jumps[:-1]
            inner[-1, -1] += price * jumps[:-1].sum()
        return bends

    @cached_property
    def switches(self) -> FloatArray:
        """Changes of the on-off command that it follows, shape (n,) [rad]."""
        switches: list[float] = []
        on = False
        for number, group in enumerate(self.groups):
            at, slopes = self.times[self.events_of(number)], self.slopes_of(number)
            for piece, sign in enumerate(group.signs):
                wanted = sign > 0 or (sign == 0 and slopes[piece] > 0)
                # It brakes at its goal by itself.
                if piece == len(group.signs) - 1:
                    wanted = group.goal == 1
                if wanted != on:
                    switches.append(float(at[piece]))
                    on = wanted
        return np.array(switches)


def second_integrals(functionals: Functionals, times: FloatArray) -> ComplexArray:
    """Return antiderivatives of `Functionals.integrals`.

    Parameters
    ----------
    functionals
        Of m poles.
    times
        Shape (n,) [rad].

    Returns
    -------
    ComplexArray
        Shape (m, n).
    """
    poles = functionals.poles[:, None]
    still, first = poles == 0, functionals.orders[:, None] == 1
    s = np.where(still, 1.0, poles)
    swinging = np.where(first, -(times + 2 / s), 1.0) * np.exp(-poles * times) / (s * s)
    standing = np.where(first, -(times**3) / 6, times * times / 2)
    integrals: ComplexArray = np.where(still, standing, swinging)
    return integrals


def _at_limits(group: Group) -> list[int]:
    """Return which pieces of a group are at a limit of the slope."""
    return [piece for piece, sign in enumerate(group.signs) if sign == 0]
