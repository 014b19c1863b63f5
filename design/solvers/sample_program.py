"""Amplitudes on samples, as one cone program of Clarabel: the least violation, or the nearest."""

from dataclasses import dataclass

import numpy as np

from design.solvers.clarabel import CONE_SIZE, ENTRY_WORK, PROGRAM_WORK, factors, run
from design.solvers.outcome import Status
from design.types import ComplexArray, FloatArray

TOLERANCE = 1e-10
"""Of the gap and of the constraints: what is left is made zero afterwards [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SampleProgram:
    """``|bounded_offset + bounded x| <= v limits``, ``zero_offset + zero x = 0``.

    Besides ``equal x = right``, ``below x <= most`` and ``0 <= x <= highest``.

    Attributes
    ----------
    bounded, bounded_offset, limits
        Vectors of which the largest, over its limit, is v: shapes (k, n), (k,), (k,).
    zero, zero_offset
        Vectors that are to be zero, shapes (m, n), (m,).
    equal, right
        Equations, shapes (e, n), (e,).
    below, most
        Inequalities, shapes (q, n), (q,).
    highest
        Upper bounds, finite, shape (n,).
    cost
        What is minimised in place of v, shape (n,); None to minimise v.
    """

    bounded: ComplexArray
    bounded_offset: ComplexArray
    limits: FloatArray
    zero: ComplexArray
    zero_offset: ComplexArray
    equal: FloatArray
    right: FloatArray
    below: FloatArray
    most: FloatArray
    highest: FloatArray
    cost: FloatArray | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SampleOutcome:
    """How a program ended.

    Attributes
    ----------
    status
        What became of it.
    unknowns
        x, shape (n,).
    value
        v, or the cost.
    bound
        No x makes v less: by the dual, in whose sum every error counts; minus infinity where none
        is known.
    work
        Work that it was [units].
    """

    status: Status
    unknowns: FloatArray
    value: float
    bound: float
    work: float


def solve(program: SampleProgram) -> SampleOutcome:
    """Solve one program.

    Parameters
    ----------
    program
        The program.

    Returns
    -------
    SampleOutcome
        Unknowns, value and bound; the bound holds whatever the solver's accuracy.
    """
    import clarabel  # noqa: PLC0415 - where it is used, as all solvers

    size = program.highest.size
    by_value = program.cost is None
    parts, combining = factors(np.concatenate((program.bounded.real, program.bounded.imag)))
    rank = len(combining)
    bounds = program.limits.size
    width = size + rank + by_value
    linear = np.concatenate((program.equal, program.zero.real, program.zero.imag))
    sides = np.concatenate((program.right, -program.zero_offset.real, -program.zero_offset.imag))
    cones = np.zeros((bounds, CONE_SIZE, width))
    cones[:, 1, size : size + rank] = -parts[:bounds]
    cones[:, 2, size : size + rank] = -parts[bounds:]
    offset = np.zeros((bounds, CONE_SIZE))
    offset[:, 1], offset[:, 2] = program.bounded_offset.real, program.bounded_offset.imag
    if by_value:
        cones[:, 0, -1] = -program.limits
    else:  # v is 1: what is bounded keeps its limits
        offset[:, 0] = program.limits

    def padded(block: FloatArray) -> FloatArray:
        return np.hstack((block, np.zeros((len(block), width - size))))

    combined = padded(combining)
    combined[:, size : size + rank] = -np.eye(rank)
    matrix = np.concatenate((
        padded(linear),
        padded(program.below),
        cones.reshape(-1, width),
        padded(-np.eye(size)),
        padded(np.eye(size)),
        combined,
    ))
    right = np.concatenate((
        sides,
        program.most,
        offset.ravel(),
        np.zeros(size),
        program.highest,
        np.zeros(rank),
    ))
    objective = np.zeros(width)
    if program.cost is None:
        objective[-1] = 1.0
    else:
        objective[:size] = program.cost
    kinds = [
        *([clarabel.ZeroConeT(len(linear))] if len(linear) else []),
        *([clarabel.NonnegativeConeT(len(program.below))] if len(program.below) else []),
        *[clarabel.SecondOrderConeT(CONE_SIZE)] * bounds,
        clarabel.NonnegativeConeT(2 * size),
        *([clarabel.ZeroConeT(rank)] if rank else []),
    ]
    found = run(objective, [matrix], [right], kinds, tolerance=TOLERANCE)
    return SampleOutcome(
        status=found.status,
        unknowns=np.clip(found.unknowns[:size], 0.0, program.highest),
        value=float(objective @ found.unknowns),
        bound=_bound(program, found.duals) if by_value else -np.inf,
        work=PROGRAM_WORK + ENTRY_WORK * np.count_nonzero(matrix) * found.iterations,
    )


def _bound(program: SampleProgram, duals: FloatArray) -> float:
    """Return what v is at least: the Lagrangian's minimum over the box, for multipliers near these.

    Multipliers are made valid first, those of a cone as large as its vector, the others of their
    sign; by their scale v has no part in it.
    """
    if not np.isfinite(duals).all():
        return -np.inf
    sizes = (len(program.equal), len(program.zero), len(program.zero), len(program.below))
    equal, real, imaginary, below, cones = np.split(
        duals[: sum(sizes) + CONE_SIZE * program.limits.size], np.cumsum(sizes)
    )
    below = np.maximum(below, 0.0)
    vectors = cones.reshape(-1, CONE_SIZE)[:, 1:] @ np.array([1.0, 1j])
    scale = float(np.abs(vectors) @ program.limits)
    if scale <= 0:
        return -np.inf
    zero = real + 1j * imaginary
    slopes = (
        program.equal.T @ equal
        + program.below.T @ below
        + (program.zero.T @ zero.conj()).real
        - (program.bounded.T @ vectors.conj()).real
    )
    sides = (
        program.right @ equal
        + program.most @ below
        - (program.zero_offset @ zero.conj()).real
        + (program.bounded_offset @ vectors.conj()).real
    )
    return float((np.minimum(slopes, 0.0) @ program.highest - sides) / scale)
