"""The cells of a table as polynomials: what a program joins there, and by how much it is off.

Along each axis a program joins the rows of a stencil by Lagrange's weights in a coordinate c, so
that ``w t_i`` is a polynomial of c of degree 3 at most, exactly. Over a cell ``c = c0 + h u``, u
from -1 to 1; coefficients are in powers of u. `design.tables.proven_bound.stencils` makes them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from design.tables.proven_bound.balls import GROWN, UNIT, Ball
from design.types import FloatArray, IntArray

COORDINATE_ROUNDING = 32 * UNIT
"""Of a coordinate: of rows within 4 units, of a middle one a halving, of a point 2 [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cells:
    """Cells of a table, or parts of them.

    Attributes
    ----------
    number
        Of each among those at first, shape (m,).
    middles, halves
        Coordinates c0, and h >= 0, shape (m, axes).
    phases
        Coefficients of ``w t_i`` in powers of u, shape (m, n, 4, 4), the last of the second axis
        [rad]; with one axis its powers are 0 beyond the first.
    off
        How far the phases of a program are off that counts in double precision, and those that are
        computed here, shape (m, n) [rad].
    """

    number: IntArray
    middles: FloatArray
    halves: FloatArray
    phases: FloatArray
    off: FloatArray

    def take(self, which: IntArray) -> "Cells":
        """Return some of the cells, by their places."""
        return Cells(
            number=self.number[which],
            middles=self.middles[which],
            halves=self.halves[which],
            phases=self.phases[which],
            off=self.off[which],
        )

    @classmethod
    def joined(cls, parts: Sequence["Cells"]) -> "Cells":
        """Return the cells of all parts."""
        return cls(
            number=np.concatenate([part.number for part in parts]),
            middles=np.concatenate([part.middles for part in parts]),
            halves=np.concatenate([part.halves for part in parts]),
            phases=np.concatenate([part.phases for part in parts]),
            off=np.concatenate([part.off for part in parts]),
        )

    def halved(self) -> "Cells":
        """Return two parts of each cell along each axis."""
        parts = [self]
        for axis in range(self.halves.shape[1]):
            parts = [part._half(axis, side) for part in parts for side in (-0.5, 0.5)]
        return Cells.joined(parts)

    def _half(self, axis: int, side: float) -> "Cells":
        """Return the parts about ``u = side``, a half long: u = side + v / 2."""
        powers = np.arange(self.phases.shape[-1])
        shift = np.array([
            [math.comb(j, k) * side ** (j - k) * 0.5**k if k <= j else 0.0 for k in powers]
            for j in powers
        ])
        turned = np.moveaxis(self.phases, 2 + axis, -1) @ shift
        lost = 16 * UNIT * np.abs(self.phases).sum(axis=(2, 3))
        middles, halves = self.middles.copy(), self.halves.copy()
        middles[:, axis] += side * halves[:, axis]
        halves[:, axis] /= 2
        return replace(
            self,
            middles=middles,
            halves=halves,
            phases=np.moveaxis(turned, -1, 2 + axis),
            off=self.off + lost,
        )

    def coordinates(self, reach: FloatArray) -> list[Ball]:
        """Return the coordinates at ``|u_a| <= reach_a``, a ball an axis."""
        found = []
        for axis in range(self.halves.shape[1]):
            middles = self.middles[:, axis]
            rounding = COORDINATE_ROUNDING * np.abs(middles)
            radius = self.halves[:, axis] * reach[:, axis] * GROWN + rounding
            found.append(Ball(middles.astype(np.complex128), radius, rounding))
        return found

    def balls(self, reach: FloatArray) -> list[Ball]:
        """Return the phases at ``|u_a| <= reach_a`` of each axis, as balls.

        Parameters
        ----------
        reach
            Shape (m, axes) [-].

        Returns
        -------
        list of Ball
            n of them.
        """
        powers = np.arange(self.phases.shape[-1])
        first = reach[:, 0, None] ** powers
        other = reach[:, 1, None] ** powers if reach.shape[1] > 1 else np.ones_like(first)
        heights = np.abs(self.phases) * first[:, None, :, None] * other[:, None, None, :]
        heights[:, :, 0, 0] = 0.0
        radii = heights.sum(axis=(2, 3)) * GROWN + self.off
        centres = self.phases[:, :, 0, 0].astype(np.complex128)
        return [Ball(centres[:, i], radii[:, i], self.off[:, i]) for i in range(centres.shape[1])]

    def values(self, nodes: FloatArray) -> tuple[list[FloatArray], list[FloatArray]]:
        """Return phases and coordinates at points of each cell, to compute with.

        Parameters
        ----------
        nodes
            Of u, the same along each axis, shape (k,), from -1 to 1.

        Returns
        -------
        tuple of lists
            n phases, and a coordinate an axis, of shape (m, k) or (m, k * k).
        """
        axes = self.halves.shape[1]
        powers = nodes[:, None] ** np.arange(self.phases.shape[-1])
        if axes == 1:
            phases = np.einsum("mnd,kd->nmk", self.phases[:, :, :, 0], powers)
            at = [nodes]
        else:
            partly = self.phases @ powers.T
            phases = np.einsum("mndl,kd->nmkl", partly, powers)
            at = [np.repeat(nodes, nodes.size), np.tile(nodes, nodes.size)]
        found: list[FloatArray] = [
            self.middles[:, axis, None] + self.halves[:, axis, None] * u
            for axis, u in enumerate(at)
        ]
        return list(phases.reshape(len(phases), len(self.number), -1)), found
