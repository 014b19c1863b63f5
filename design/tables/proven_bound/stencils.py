"""Cells of a table from its rows: polynomials by Lagrange's weights, and how rounding moves them.

Rounding displaces coordinates. A cubic is reproduced from its values at any four nodes, so what
nodes displaced by d make of the rows' ``y_k`` is off by the weights' sum times ``|y_k - P(c_k +
d)|``, at most ``|P'| d``: rows that are close lose nothing. The operations of a weight multiply it
by ``1 + e`` each.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from design.tables.coordinates import Coordinate, coordinate_of, coordinates, scales_with_frequency
from design.tables.proven_bound.balls import UNIT
from design.tables.proven_bound.cells import Cells
from design.tables.stencil import STENCIL, first_of_stencil
from design.types import BoolArray, FloatArray, IntArray

OFF_CELL = 16 * UNIT
"""Share of a coordinate by which a cell is taken wider at either end: a coordinate that is rounded
is still on it [-]."""

COORDINATE_ROUNDINGS: dict[Coordinate, int] = {
    "itself": 1,
    "inverse": 2,
    "root": 3,
    "inverse_root": 4,
}
"""Of a coordinate: its field 1, an inverse 1, a root within one unit in the last place 2."""

OWN_ROUNDINGS = 64
"""Of the coefficients here and of their sums at a point, each of the magnitudes of its terms."""

CLOSE = 0.5
"""How far displaced nodes may change the weights' sum; beyond, rows are too close [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GridAxis:
    """An axis of a grid: its field, as ``plant.cable_length_m``, and its values in the unit."""

    field: str
    values: FloatArray  # Increasing, shape (rows,)

    @property
    def nodes(self) -> FloatArray:
        """Coordinates of the values, shape (rows,)."""
        return coordinates(self.field, self.values)

    @property
    def scales(self) -> bool:
        """Whether the coordinate is the plant's frequency up to a factor."""
        return scales_with_frequency(self.field)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Weights:
    """Lagrange's weights over the cells of an axis."""

    rows: IntArray  # Of each stencil, shape (cells, points)
    middles: FloatArray  # Of the coordinate, shape (cells,)
    halves: FloatArray
    powers: FloatArray  # Coefficients of each weight in u, shape (cells, points, 4)
    largest: FloatArray  # Sum of their magnitudes at most, shape (cells,)
    furthest: FloatArray  # Of the nodes in u, shape (cells,)
    displaced: FloatArray  # Displacement in u by one rounding of the coordinate, shape (cells,)
    steepest: FloatArray  # Sum of the slopes of the weights at the nodes at most, shape (cells,)
    counted: IntArray  # Operations of a weight that round, shape (cells,)
    roundings: int  # Of a coordinate
    scales: bool


def cells_of(
    axes: Sequence[GridAxis], times_s: FloatArray, frequency: float, usable: BoolArray
) -> Cells:
    """Return the cells of a table.

    Parameters
    ----------
    axes
        One or two, the last running fastest along the rows.
    times_s
        Of the rows, shape (rows, n) [s].
    frequency
        Plant's frequency over the coordinates of the axes that scale with it.
    usable
        Which cells to return, one less along each axis than it has values.

    Returns
    -------
    Cells
        Those, numbered as in ``usable.ravel()``.
    """
    weights = [_weights(axis) for axis in axes]
    number = np.flatnonzero(usable)
    places = np.unravel_index(number, usable.shape)
    joined = times_s.reshape(*(axis.values.size for axis in axes), -1) * frequency
    for place, axis in enumerate(axes):
        if axis.scales:
            joined = joined * np.expand_dims(
                axis.nodes, [one for one in range(joined.ndim) if one != place]
            )
    one = weights[0]
    rows, own = one.rows[places[0]], one.powers[places[0]]
    if len(axes) == 1:
        stencils = joined[rows]
        phases = np.einsum("mkd,mkn->mnd", own, stencils)[..., None]
        phases = np.concatenate((phases, np.zeros((*phases.shape[:3], STENCIL - 1))), axis=3)
        terms = np.einsum("mkd,mkn->mn", np.abs(own), np.abs(stencils))
        sizes = np.abs(stencils).max(axis=1)
    else:
        other, across = weights[1], weights[1].powers[places[1]]
        stencils = joined[rows[:, :, None], other.rows[places[1]][:, None, :]]
        partly = np.einsum("mkd,mkln->mdln", own, stencils)
        phases = np.einsum("mle,mdln->mnde", across, partly)
        partly = np.einsum("mkd,mkln->mln", np.abs(own), np.abs(stencils))
        terms = np.einsum("mle,mln->mn", np.abs(across), partly)
        sizes = np.abs(stencils).max(axis=(1, 2))
    off = _off(weights, places, phases, sizes)
    lost = OWN_ROUNDINGS * UNIT * terms + off
    return Cells(
        number=number,
        middles=np.column_stack([
            w.middles[place] for w, place in zip(weights, places, strict=True)
        ]),
        halves=np.column_stack([w.halves[place] for w, place in zip(weights, places, strict=True)]),
        phases=phases,
        off=off + lost,
    )


def _off(
    weights: Sequence[_Weights],
    places: Sequence[IntArray],
    phases: FloatArray,
    sizes: FloatArray,
) -> FloatArray:
    """Return how far a program's phases are off, shape (m, n) [rad]; infinite of rows too close.

    Parameters
    ----------
    weights, places
        Of each axis, and each cell's place along it.
    phases
        As of `Cells`.
    sizes
        Largest of the rows' phases in each stencil, shape (m, n) [rad].
    """
    powers = np.arange(STENCIL)
    heights = np.abs(phases)
    raised = [weights[0].furthest[places[0], None] ** powers]
    raised.append(
        weights[1].furthest[places[1], None] ** powers if len(weights) > 1 else raised[0] ** 0
    )
    summed = np.ones(len(phases))
    slope = np.zeros(sizes.shape)
    counted = np.full(len(phases), 1 + math.prod(w.powers.shape[1] for w in weights))
    counted += len(weights) - 1
    known = np.ones(len(phases), dtype=np.bool_)
    for axis, (own, place) in enumerate(zip(weights, places, strict=True)):
        moved = own.roundings * UNIT * own.displaced[place]
        changed = moved * own.steepest[place]
        known &= changed < CLOSE
        summed *= own.largest[place] / (1 - np.minimum(changed, CLOSE))
        below = np.zeros((len(phases), STENCIL))
        below[:, 1:] = powers[1:] * raised[axis][:, :-1]
        both = [below if one == axis else raised[one] for one in (0, 1)]
        slope += moved[:, None] * np.einsum("mnde,md,me->mn", heights, *both)
        # The coordinates that turn phases into times are off as well, of rows and of the value.
        counted = counted + own.counted[place] + (2 * own.roundings if own.scales else 0)
    grown = 1.0 + 2 * counted * UNIT
    off = (1 + summed[:, None]) * slope * grown[:, None]
    off += (counted * UNIT * grown * summed)[:, None] * sizes
    return np.where(known[:, None], off, np.inf)


def _weights(axis: GridAxis) -> _Weights:
    """Return the weights of an axis."""
    nodes = axis.nodes
    cell = np.arange(nodes.size - 1)
    first, size = first_of_stencil(cell, nodes.size)
    rows = first[:, None] + np.arange(size)
    joined = np.abs(nodes[rows])
    middles = (nodes[cell] + nodes[cell + 1]) / 2
    largest = joined.max(axis=1)
    halves = np.abs(nodes[cell + 1] - nodes[cell]) / 2 + OFF_CELL * largest
    at = (nodes[rows] - middles[:, None]) / halves[:, None]
    powers = np.zeros((cell.size, size, STENCIL))
    powers[:, :, 0] = 1.0
    for mine in range(size):
        for other in range(size):
            if mine != other:
                raised = np.roll(powers[:, mine], 1, axis=1)
                raised[:, 0] = 0.0
                gap = at[:, mine] - at[:, other]
                powers[:, mine] = (raised - at[:, other, None] * powers[:, mine]) / gap[:, None]
    # Between its rows a cell has no node: each weight has one sign there, of the cell's own rows
    # +1, and beyond them alternating.
    place = rows - cell[:, None]
    signs = np.where(np.where(place > 0, place - 1, place) % 2 == 0, 1.0, -1.0)
    signed = in_bernstein(signs[:, :, None] * powers)
    # Where the cell is taken wider a weight may have the other sign.
    wrong = np.maximum(-signed, 0.0).max(axis=2).sum(axis=1)
    furthest = np.maximum(np.abs(at).max(axis=1), 1.0)
    orders = np.arange(1, STENCIL)
    slopes = orders * furthest[:, None] ** (orders - 1)
    # Differences of numbers that are within a factor of 2 are exact (Sterbenz 1974).
    exact = largest < 1.99 * joined.min(axis=1)
    return _Weights(
        rows=rows,
        middles=middles,
        halves=halves,
        powers=powers,
        largest=signed.sum(axis=1).max(axis=1) + 2 * wrong,
        furthest=furthest,
        displaced=largest / halves,
        steepest=np.einsum("mkd,md->m", np.abs(powers[:, :, 1:]), slopes),
        counted=np.where(exact, 2, 4) * (size - 1) + (1 if axis.scales else 0),
        roundings=COORDINATE_ROUNDINGS[coordinate_of(axis.field)],
        scales=axis.scales,
    )


def in_bernstein(powers: FloatArray) -> FloatArray:
    """Return coefficients of cubics in Bernstein's basis over [-1, 1].

    Parameters
    ----------
    powers
        Coefficients of powers of u, shape (..., 4).

    Returns
    -------
    FloatArray
        Shape (..., 4); every value is between the smallest and the largest (Farouki 2012, section
        3: with ``u = 2 s - 1``, ``b_k = sum_j comb(k, j) / comb(3, j) a_j``).
    """
    orders = range(STENCIL)
    shift = [[math.comb(j, k) * 2.0**k * (-1.0) ** (j - k) for k in orders] for j in orders]
    basis = [[math.comb(k, j) / math.comb(STENCIL - 1, j) for k in orders] for j in orders]
    found: FloatArray = powers @ (np.array(shift) @ np.array(basis))
    return found
