"""How short no command without vibration in several modes is: a bound, proven between points too.

Whatever the c, ``P(t) = Re sum_k conj(c_k) exp(-s_k t)`` of a command without vibration has
``sum A_i P(t_i) = 0``. Impulses that are all positive therefore do not lie where P is positive. For
a command u from 0 to 1 within these, partial integration makes it ``P(T) = integral of u P'``, at
most the rise of P; P(0) is then at most its fall until T.
"""

from dataclasses import dataclass

import numpy as np

from design.types import BoolArray, ComplexArray, FloatArray

CELLS = 512
"""Cells at first, of the whole time [-]."""

SPLIT = 16
"""Cells that one becomes about which nothing is sure [-]."""

ROUNDS = 6
"""How often cells are split: a width of ``T / (512 * 16^5)``, 2e-9 T, is left at last."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Cells:
    """Stretches of time with what bounds P there."""

    starts: FloatArray
    widths: FloatArray
    heights: FloatArray  # P at both ends, shape (2, n)
    rates: FloatArray  # P', with the same shape
    bends: FloatArray  # a bound of |P''|
    jerks: FloatArray  # a bound of |P'''|

    @property
    def lowest(self) -> FloatArray:
        """A lower bound of P: that of a chord less what an arc may sag below it."""
        found: FloatArray = self.heights.min(axis=0) - self.widths**2 / 8 * self.bends
        return found

    @property
    def monotone(self) -> BoolArray:
        """Where P' keeps its sign."""
        sag = self.widths**2 / 8 * self.jerks
        low, high = self.rates.min(axis=0), self.rates.max(axis=0)
        found: BoolArray = (low > sag) | (high < -sag)
        return found

    @property
    def falls(self) -> FloatArray:
        """An upper bound of how far P falls."""
        drop = np.maximum(self.heights[0] - self.heights[1], 0)
        # At most as long as at its steepest.
        whole = self.widths * (np.abs(self.rates).max(axis=0) + self.widths * self.bends / 2)
        found: FloatArray = np.where(self.monotone, drop, np.maximum(whole, drop))
        return found


def excluded_duration_rad(
    unit_poles: ComplexArray, vectors: ComplexArray, until_rad: float, *, positive: bool
) -> float:
    """Return a duration below which every command has a residual.

    Parameters
    ----------
    unit_poles
        Poles of the modes over a common frequency, shape (m,) [-].
    vectors
        c, shape (m,) [-].
    until_rad
        Where the search for it ends: a duration that is known to be possible [rad].
    positive
        Whether amplitudes are positive; else the command is from 0 to 1.

    Returns
    -------
    float
        Phase of the common frequency, from 0 to ``until_rad`` [rad]; 0 proves nothing.
    """
    edges = np.linspace(0, until_rad, CELLS + 1)
    cells = _cells(unit_poles, vectors, edges[:-1], np.full(CELLS, until_rad / CELLS))
    if cells.heights[0, 0] <= 0:
        return 0.0
    for _ in range(ROUNDS):
        unsure = cells.lowest <= 0 if positive else ~cells.monotone
        if positive:
            # Nothing after the first point below zero matters.
            below = np.flatnonzero(cells.heights[1] <= 0)
            unsure[int(below[0]) + 1 if below.size else unsure.size :] = False
        if not unsure.any():
            break
        finer = cells.widths[unsure, None] / SPLIT * np.arange(SPLIT)
        starts = np.concatenate((
            cells.starts[~unsure],
            (cells.starts[unsure, None] + finer).ravel(),
        ))
        widths = np.concatenate((
            cells.widths[~unsure],
            np.repeat(cells.widths[unsure] / SPLIT, SPLIT),
        ))
        order = np.argsort(starts)
        cells = _cells(unit_poles, vectors, starts[order], widths[order])
    if positive:
        low = np.flatnonzero(cells.lowest <= 0)
        return float(cells.starts[low[0]]) if low.size else until_rad
    falls = np.cumsum(cells.falls)
    late = np.flatnonzero(falls >= cells.heights[0, 0])
    if not late.size:
        return until_rad
    last = int(late[0])
    before = float(falls[last] - cells.falls[last])
    steepest = float(np.abs(cells.rates[:, last]).max() + cells.widths[last] * cells.bends[last])
    return float(cells.starts[last]) + (float(cells.heights[0, 0]) - before) / steepest


def _cells(
    unit_poles: ComplexArray, vectors: ComplexArray, starts: FloatArray, widths: FloatArray
) -> _Cells:
    s, c = unit_poles[:, None], vectors.conj()
    swings = np.exp(-s * np.stack((starts, starts + widths))[:, None])
    # Of all the cell the swings are largest at its end: a mode that decays grows backward.
    largest = np.abs(swings[1])
    sizes = np.abs(c)
    return _Cells(
        starts=starts,
        widths=widths,
        heights=(c @ swings).real,
        rates=(c @ (-s * swings)).real,
        bends=sizes @ (np.abs(s) ** 2 * largest),
        jerks=sizes @ (np.abs(s) ** 3 * largest),
    )
