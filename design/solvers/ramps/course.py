"""The course of a limited reference under an on-off command, and how it changes with the command.

While the command is 1 the reference r rises at its limit until it is 1, while it is 0 r falls until
it is 0. A switch before r has arrived turns the ramp. Switches between two arrivals are a group:
moving one of them moves the group's arrival, and nothing after that.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

import numpy as np
from numpy.polynomial.legendre import leggauss

from design.solvers.ramps.functionals import Functionals
from design.types import ComplexArray, FloatArray, IntArray

SHORT_RAD = 1.0
"""Turn of the fastest mode below which the mean of a kernel is taken by Gauss nodes [rad]."""

NODES, WEIGHTS = ((1 + leggauss(10)[0]) / 2, leggauss(10)[1] / 2)
"""Of the mean from 0 to 1: exact to rounding up to `SHORT_RAD`."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Slopes:
    """How fast the reference may move: from 0 to 1 and back, in one unit of phase each [1/rad]."""

    up: float
    down: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Course:
    """A course of the reference.

    Attributes
    ----------
    switches
        Phases at which the command changes, up first, ascending from 0, shape (n,) [rad].
    groups
        Number of the group of each switch, shape (n,).
    turns
        Slope before a switch less the slope after it, shape (n,) [1/rad].
    arrivals
        When the reference arrives at 0 or 1, of each group, shape (g,) [rad].
    last_slopes
        Slope with which it arrives, shape (g,) [1/rad].
    starts, ends, slopes
        Stretches of constant slope that is not 0, shape (n,) each [rad], [1/rad].
    rises
        By how much the level changes in each: the times of a short one say it with few digits,
        shape (n,) [-].
    limits
        Limits of the slope.
    """

    keeps_order: ClassVar[bool] = True
    """Whether its switches never pass each other."""

    switches: FloatArray
    groups: IntArray
    turns: FloatArray
    arrivals: FloatArray
    last_slopes: FloatArray
    starts: FloatArray
    ends: FloatArray
    slopes: FloatArray
    rises: FloatArray
    limits: Slopes

    @property
    def end(self) -> float:
        """When the last ramp ends [rad]."""
        return float(self.arrivals[-1])

    @property
    def structure(self) -> int:
        """Number of its switches."""
        return self.switches.size

    @property
    def gaps(self) -> FloatArray:
        """From one switch to the next, shape (n - 1,) [rad]."""
        return np.diff(self.switches)

    def moved(self, moves: FloatArray) -> "Course":
        """Return the course with its switches moved, shape (n,) [rad]."""
        return course_of(self.switches + moves, self.limits)

    @property
    def conditions(self) -> FloatArray:
        """What is not met of its structure: nothing, by any switches, shape (0,)."""
        return np.zeros(0)

    @property
    def condition_changes(self) -> FloatArray:
        """Their derivatives in each switch, shape (0, n)."""
        return np.zeros((0, self.switches.size))

    def condition_bends(self, _: FloatArray, /) -> FloatArray:
        """Return their second derivatives, weighted: none, shape (n, n)."""
        return np.zeros((self.switches.size, self.switches.size))

    def values(self, functionals: Functionals) -> ComplexArray:
        """Return the functionals of the course, shape (m,)."""
        lengths = self.ends - self.starts
        short = lengths * float(np.abs(functionals.poles).max(initial=0.0)) < SHORT_RAD
        long = ~short
        integrals = functionals.integrals(np.concatenate((self.starts[long], self.ends[long])))
        before, after = np.split(integrals, 2, axis=1)
        values: ComplexArray = (after - before) @ self.slopes[long]
        # Of a short ramp the two are nearly alike, and their difference has few digits.
        nodes = self.starts[short] + np.multiply.outer(NODES, lengths[short])
        kernels = functionals.kernels(nodes.ravel()).reshape(functionals.poles.size, *nodes.shape)
        means = np.tensordot(WEIGHTS, kernels, axes=(0, 1))
        values += means @ self.rises[short]
        return values

    def changes(self, functionals: Functionals) -> ComplexArray:
        """Return the derivatives of the functionals in each switch, shape (m, n)."""
        arrivals = self.arrivals[self.groups]
        kernels = functionals.kernels(np.concatenate((self.switches, arrivals)))
        here, arriving = np.split(kernels, 2, axis=1)
        changes: ComplexArray = self.turns * (here - arriving)
        return changes

    def end_changes(self) -> FloatArray:
        """Return the derivatives of the end in each switch, shape (n,) [-]."""
        last = self.groups == self.groups[-1]
        changes: FloatArray = np.where(last, -self.turns / self.last_slopes[-1], 0.0)
        return changes

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
            In two switches each, shape (n, n).
        """
        times = np.concatenate((self.switches, self.arrivals))
        rates = (multipliers.conj() @ functionals.rates(times)).real
        here, arriving = rates[: self.switches.size], rates[self.switches.size :]
        together = self.groups[:, None] == self.groups
        products = self.turns[:, None] * self.turns * (arriving / self.last_slopes)[self.groups]
        bends: FloatArray = np.where(together, products, 0.0) + np.diag(self.turns * here)
        return bends


def course_of(switches: FloatArray, slopes: Slopes) -> Course:
    """Return the course of the reference under a command.

    Parameters
    ----------
    switches
        Phases at which the command goes to 1 and to 0 in turn, ascending from 0, shape (n,) [rad].
    slopes
        Limits of the slope.

    Returns
    -------
    Course
        Until the reference arrives at the command's last value.
    """
    count = switches.size
    steep = np.where(np.arange(count) % 2 == 0, slopes.up, -slopes.down)
    groups, ends, rises = np.zeros(count, dtype=np.intp), np.empty(count), np.empty(count)
    arrivals: list[float] = []
    level = 0.0
    times = [*switches.tolist(), np.inf]
    for number, (now, following) in enumerate(pairwise(times)):
        groups[number] = len(arrivals)
        goal = 1.0 - number % 2
        arrival = now + (goal - level) / float(steep[number])
        if arrival <= following:
            arrivals.append(arrival)
            rises[number], ends[number] = goal - level, arrival
            level = goal
        else:
            rises[number], ends[number] = float(steep[number]) * (following - now), following
            level += float(rises[number])
    first = np.diff(groups, prepend=-1) > 0
    before = np.where(first, 0.0, np.roll(steep, 1))
    last = np.append(first[1:], True)
    return Course(
        switches=switches,
        groups=groups,
        turns=before - steep,
        arrivals=np.array(arrivals),
        last_slopes=steep[last],
        starts=switches,
        ends=ends,
        slopes=steep,
        rises=rises,
        limits=slopes,
    )
