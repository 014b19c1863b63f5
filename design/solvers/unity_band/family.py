"""What steps up and down in turn leave over a band of frequencies, compiled, and its peaks."""

import functools
from dataclasses import dataclass

import numpy as np

from design.formulations.bands import BandModel
from design.solvers.buffered import Buffered
from design.solvers.newton import INSTRUCTION_WORK
from design.solvers.trust_region_step import DISKS
from design.types import BoolArray, FloatArray, IntArray, Symbolic

LANES = 64
"""Ratios that are looked at by one call of the compiled expressions."""

MAX_TURN_RAD = 0.1
"""Turn of the last impulse's phase from one ratio to the next, where peaks are looked for [rad]."""

PEAKS = 8
"""Peaks that are refined by one call."""

PEAKS_WORK = 300.0
REFINED_SHARE = 2.0
"""Work of a search for peaks except evaluations, and how many evaluations refine them, over those
of the grid: at most about [units], [-]."""

PEAK_STEPS = 4
"""Newton's steps to a peak from the highest of three neighbours."""


@dataclass(frozen=True, slots=True, eq=False)
class Peaks:
    """The ends of the band and the local maxima between them.

    Attributes
    ----------
    ratios
        Of frequencies, the two ends first, shape (m,) [-].
    squares
        Of the residual over the tolerance's, shape (m,) [-].
    """

    ratios: FloatArray
    squares: FloatArray

    @property
    def excess(self) -> float:
        """By how much the highest square is above the tolerance's [-]."""
        return max(float(self.squares.max()) - 1, 0.0)


class Family:
    """What a family's impulses leave over a band, compiled."""

    def __init__(self, model: BandModel) -> None:
        import casadi as ca  # noqa: PLC0415

        parts = model.expressions()
        x, p, ratio, vector = parts.unknowns, parts.parameters, parts.ratio, parts.vibration
        self.size = int(x.numel())

        def compile_buffered(
            lanes: int, names: str, given: list[Symbolic], found: list[Symbolic]
        ) -> Buffered:
            inputs, outputs = (one.split() for one in names.split("->"))
            one = ca.Function("band", given, [ca.densify(part) for part in found], inputs, outputs)
            return Buffered(one.map(lanes), tuple(inputs), tuple(outputs))

        square = ca.sumsqr(vector)
        slope = ca.gradient(square, ratio)
        bend = ca.gradient(slope, ratio)
        one = ca.Function("squares", [x, p, ratio], [square])
        self._instructions = int(one.n_instructions())
        self._squares = compile_buffered(LANES, "x p ratio -> square", [x, p, ratio], [square])
        self._slopes = compile_buffered(
            PEAKS, "x p ratio -> square slope bend", [x, p, ratio], [square, slope, bend]
        )
        self._vectors = compile_buffered(
            DISKS, "x p ratio -> vector jacobian", [x, p, ratio], [vector, ca.jacobian(vector, x)]
        )
        weights = ca.SX.sym("weights", 2)
        self._curvatures = compile_buffered(
            DISKS,
            "x p ratio weights -> hessian mixed bend",
            [x, p, ratio, weights],
            [
                ca.hessian(ca.dot(weights, vector), x)[0],
                ca.gradient(slope, x),
                ca.gradient(slope, ratio),
            ],
        )

    @staticmethod
    def _write_inputs(function: Buffered, x: FloatArray, p: FloatArray, ratios: FloatArray) -> None:
        """Write the inputs; lanes without a ratio repeat the nominal one."""
        each = function.inputs["ratio"]
        function.inputs["x"].reshape(each.size, -1)[:] = x
        function.inputs["p"].reshape(each.size, -1)[:] = p
        each[: ratios.size], each[ratios.size :] = ratios, 1.0

    def squares(self, x: FloatArray, p: FloatArray, ratios: FloatArray) -> FloatArray:
        """Return the squared residuals at ratios.

        Parameters
        ----------
        x
            Gaps between the impulses, shape (n,) [rad].
        p
            Parameters of the family, shape (k,).
        ratios
            Frequency ratios, shape (m,) with m a multiple of `LANES` [-].

        Returns
        -------
        FloatArray
            Squares of the residuals, shape (m,) [-].
        """
        found = np.empty(ratios.size)
        for first in range(0, ratios.size, LANES):
            part = slice(first, first + LANES)
            self._write_inputs(self._squares, x, p, ratios[part])
            self._squares.run()
            found[part] = self._squares.outputs["square"]
        return found

    def vectors(
        self, x: FloatArray, p: FloatArray, ratios: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the vectors of the residual at ratios, and their Jacobians.

        Parameters
        ----------
        x
            Gaps between the impulses, shape (n,) [rad].
        p
            Parameters of the family, shape (k,).
        ratios
            Frequency ratios, shape (m,) with m <= `DISKS` [-].

        Returns
        -------
        tuple of FloatArray and FloatArray
            Vectors, shape (m, 2) [-], and Jacobians by the gaps, shape (m, 2, n) [1/rad].
        """
        self._write_inputs(self._vectors, x, p, ratios)
        self._vectors.run()
        vectors = self._vectors.outputs["vector"].reshape(DISKS, 2)[: ratios.size].copy()
        jacobians = self._vectors.outputs["jacobian"].reshape(DISKS, self.size, 2)
        return vectors, jacobians[: ratios.size].swapaxes(1, 2).copy()

    def curvature(
        self,
        x: FloatArray,
        p: FloatArray,
        ratios: FloatArray,
        weights: FloatArray,
        moving: BoolArray,
    ) -> FloatArray:
        """Return second derivatives of weighted squares less ``2 J' J``.

        The largest of a square over the ratio moves with x where it is a peak: that bends it by
        ``-m m' / b``, m and b the derivatives of its slope in ratio by x and by ratio.

        Parameters
        ----------
        x
            Gaps between the impulses, shape (n,) [rad].
        p
            Parameters of the family, shape (k,).
        ratios
            Frequency ratios, shape (m,) with m <= `DISKS` [-].
        weights
            Weights of the squares at the ratios, shape (m,).
        moving
            Which ratios are of peaks that move with x, shape (m,).

        Returns
        -------
        FloatArray
            The second derivatives by the gaps, shape (n, n) [unit of the weights / rad^2].
        """
        vectors, _ = self.vectors(x, p, ratios)
        self._write_inputs(self._curvatures, x, p, ratios)
        each = self._curvatures.inputs["weights"].reshape(DISKS, 2)
        each[: ratios.size], each[ratios.size :] = 2 * weights[:, None] * vectors, 0.0
        self._curvatures.run()
        found = self._curvatures.outputs
        mixed = found["mixed"].reshape(DISKS, self.size)[: ratios.size]
        bend = found["bend"][: ratios.size]
        peaked = moving & (bend < 0)
        pulls = np.where(peaked, weights / np.where(peaked, -bend, 1.0), 0.0)
        own = found["hessian"].reshape(DISKS, self.size, self.size).sum(axis=0)
        curvature: FloatArray = own + np.einsum("k,ki,kj->ij", pulls, mixed, mixed)
        return curvature

    @staticmethod
    def _blocks(x: FloatArray, half_width: float) -> int:
        """Return how many calls of `LANES` ratios show all peaks over a band."""
        turn = 2 * half_width * float(x.sum())
        return 1 + int(turn / (LANES * MAX_TURN_RAD))

    def peaks_work(self, x: FloatArray, half_width: float) -> float:
        """Return the work of `peaks` [units].

        Parameters
        ----------
        x
            Gaps between the impulses, shape (n,) [rad].
        half_width
            Half width of the band in ratios [-].

        Returns
        -------
        float
            Work by the points that show all peaks, and by the size of the expressions [units].
        """
        lanes = LANES * self._blocks(x, half_width) * (1 + REFINED_SHARE)
        return PEAKS_WORK + INSTRUCTION_WORK * lanes * self._instructions

    def peaks(self, x: FloatArray, p: FloatArray, half_width: float, limit: float) -> Peaks:
        """Return ends and local maxima of the residual over a band.

        Parameters
        ----------
        x
            Gaps between the impulses, shape (n,) [rad].
        p
            Parameters of the family, shape (k,).
        half_width
            The band goes from 1 less this to 1 plus this, ratios of the frequency [-].
        limit
            Residual whose square is the unit of the squares returned [-].

        Returns
        -------
        Peaks
            The two ends first.
        """
        blocks = self._blocks(x, half_width)
        ratios = np.linspace(1 - half_width, 1 + half_width, LANES * blocks)
        squares = self.squares(x, p, ratios)
        # An end that is higher than its neighbour may hide a peak between the two.
        padded = np.pad(squares, 1, constant_values=-np.inf)
        at = np.flatnonzero((squares >= padded[:-2]) & (squares >= padded[2:]))
        found, heights = ratios[at], squares[at]
        for first in range(0, at.size, PEAKS):
            part = slice(first, first + PEAKS)
            found[part], heights[part] = self._refine_peaks(x, p, ratios, at[part])
        inside = (found > ratios[0]) & (found < ratios[-1])
        return Peaks(
            np.concatenate((ratios[[0, -1]], found[inside])),
            np.concatenate((squares[[0, -1]], heights[inside])) / limit**2,
        )

    def _refine_peaks(
        self, x: FloatArray, p: FloatArray, ratios: FloatArray, at: IntArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the maxima between the neighbours of some ratios, by Newton's method."""
        found = ratios[at]
        lowest, highest = ratios[np.maximum(at - 1, 0)], ratios[np.minimum(at + 1, ratios.size - 1)]
        for step in range(PEAK_STEPS + 1):
            self._write_inputs(self._slopes, x, p, found)
            self._slopes.run()
            square, slope, bend = (one[: at.size] for one in self._slopes.outputs.values())
            if step < PEAK_STEPS:
                down = bend < 0
                moved = found - np.where(down, slope / np.where(down, bend, -1.0), 0.0)
                found = np.clip(moved, lowest, highest)
        return found, square.copy()


@functools.cache
def family_of(model: BandModel) -> Family:
    """Return the compiled expressions of a family.

    They are compiled at their first use in this process.
    """
    return Family(model)
