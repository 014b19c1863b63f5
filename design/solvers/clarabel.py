"""Clarabel, called directly: the least residual over a band for a given duration, as cones."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from design.solvers.outcome import Status
from design.types import ComplexArray, FloatArray

STATUS = {
    "Solved": Status.SOLVE_SUCCEEDED,
    "AlmostSolved": Status.SOLVE_SUCCEEDED,  # a start for Newton's method, never an answer
    "PrimalInfeasible": Status.INFEASIBLE,
    "AlmostPrimalInfeasible": Status.INFEASIBLE,
    "MaxTime": Status.TIME_LIMIT,
}
"""Clarabel's words for ours; any other is FAILED."""

NEGLIGIBLE = 1e-12
"""Share of the largest singular value below which the vectors have none: below `TOLERANCE` [-]."""

CONE_SIZE = 3
"""A bound, and the two parts of the vector that it bounds."""

TOLERANCE = 1e-9
"""Of the gap and of the constraints: a tenth of what a proof of a duration can spare [-]."""

PROGRAM_WORK = 1500.0
ENTRY_WORK = 0.05
POINT_WORK = 2.0
"""Work of a program, of each of its rows' entries in each iteration, and of each level there
[units]."""

MAX_RUN_S = 10.0
"""Where Clarabel ends a run [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CourseSteps:
    """How far a course goes from one point to the next, and where it ends.

    Attributes
    ----------
    rise, fall
        At most, up and down, > 0.
    last
        Its last value, after the unknown ones; the first is 0.
    """

    rise: float
    fall: float
    last: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Levels:
    """The course ``0, x_1 .. x_n, 0`` as slopes of levels, from 0 to 1, that begin at 0.

    Between two points the slope changes evenly.

    Attributes
    ----------
    cell
        Distance of two points, > 0.
    last
        The last level.
    """

    cell: float
    last: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ConeProgram:
    """``min v`` so that ``|offset_k + rows_k x| <= v``, ``lowest <= x <= highest``, ``sum x = 1``.

    Attributes
    ----------
    offset
        Vectors at x = 0, shape (k,), complex [-].
    rows
        What each unknown adds, shape (k, n), complex [-].
    lowest
        Lower bound of the unknowns.
    highest
        Upper bound of the unknowns; infinite for none.
    unit_sum
        Whether the unknowns' sum is 1.
    steps
        Limits of the course ``0, x_1 .. x_n, last``, if it has any.
    levels
        What the unknowns are the slopes of, if of anything.
    """

    offset: ComplexArray
    rows: ComplexArray
    lowest: float
    highest: float
    unit_sum: bool
    steps: CourseSteps | None = None
    levels: Levels | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ConeOutcome:
    """How a run ended.

    Attributes
    ----------
    status
        What became of it.
    unknowns
        x, shape (n,).
    largest
        v.
    weights
        What each of the bounds ``|.| <= v`` costs, shape (k,), sum 1.
    obstacle
        The bounds' dual vectors y, ``Re(y_k row_k x)`` the most that bound k can use, shape (k,).
    iterations
        Iterations of the interior-point method.
    """

    status: Status
    unknowns: FloatArray
    largest: float
    weights: FloatArray
    obstacle: ComplexArray
    iterations: int


def work_of(program: ConeProgram, outcome: ConeOutcome) -> float:
    """Return the work that a program was [units].

    Parameters
    ----------
    program
        The program that was solved.
    outcome
        The end of its run.

    Returns
    -------
    float
        Work by the size of the program and the iterations of the run [units].
    """
    limited = 0.0 if program.levels is None else POINT_WORK * program.rows.shape[1]
    return PROGRAM_WORK + (ENTRY_WORK * program.rows.size + limited) * outcome.iterations


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Columns:
    """A matrix in compressed columns, by the names that Clarabel reads.

    Of `scipy.sparse` it needs no more than these, and importing that takes half a second.
    """

    data: FloatArray
    indices: Any
    indptr: Any
    shape: tuple[int, int]
    has_sorted_indices: bool = True
    has_canonical_format: bool = True

    @property
    def nnz(self) -> int:
        """Number of entries kept."""
        return int(self.data.size)


def columns(matrix: FloatArray) -> _Columns:
    """Return a matrix in compressed columns."""
    held = matrix.T != 0
    column, row = np.nonzero(held)
    starts = np.concatenate(([0], np.cumsum(np.bincount(column, minlength=matrix.shape[1]))))
    return _Columns(
        data=np.ascontiguousarray(matrix.T[held]), indices=row, indptr=starts, shape=matrix.shape
    )


def factors(vectors: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return two factors of a matrix, of the smallest rank to rounding.

    Vectors of neighbouring frequencies are nearly alike: few combinations of the unknowns make all
    of them. Between these few a program is sparse, and by orders faster.

    Parameters
    ----------
    vectors
        Shape (k, n).

    Returns
    -------
    tuple of two FloatArray
        Shapes (k, r) and (r, n).
    """
    if vectors.size == 0:
        return np.zeros((len(vectors), 0)), np.zeros((0, vectors.shape[1]))
    left, values, right = np.linalg.svd(vectors, full_matrices=False)
    rank = int((values > NEGLIGIBLE * values[0]).sum())
    return left[:, :rank], values[:rank, None] * right[:rank]


def solve(program: ConeProgram) -> ConeOutcome:
    """Solve one cone program.

    Parameters
    ----------
    program
        The program.

    Returns
    -------
    ConeOutcome
        Unknowns and status; no claim is made of its exactness.
    """
    import clarabel  # noqa: PLC0415 - where it is used, as all solvers

    bands, count = program.rows.shape
    # y are a few dozen combinations of the unknowns.
    combined, combining = factors(np.concatenate((program.rows.real, program.rows.imag)))
    rank = len(combining)
    between = 0 if program.levels is None else count
    unknowns = count + between + rank + 1  # x, levels, y, v
    others = unknowns - count
    behind = np.zeros((rank, others))
    behind[:, between:-1] = -np.eye(rank)
    blocks, right, cones = [np.hstack((combining, behind))], [], []
    right.append(np.zeros(rank))
    if program.unit_sum:
        blocks.append(np.concatenate((np.ones(count), np.zeros(others)))[None])
        right.append(np.ones(1))
    risen = 0 if program.levels is None else count + 1
    if program.levels is not None:
        # Levels over the cell: rises between two points less the mean of their slopes.
        means = (np.eye(count + 1, count) + np.eye(count + 1, count, -1)) / 2
        rises = np.eye(count + 1, count) - np.eye(count + 1, count, -1)
        blocks.append(np.hstack((-means, rises, np.zeros((count + 1, rank + 1)))))
        right.append(np.append(np.zeros(count), -program.levels.last / program.levels.cell))
    cones.append(clarabel.ZeroConeT(rank + program.unit_sum + risen))
    for sign, bound in ((-1.0, program.lowest), (1.0, program.highest)):
        if np.isfinite(bound):
            blocks.append(np.hstack((sign * np.eye(count), np.zeros((count, others)))))
            right.append(np.full(count, sign * bound))
            cones.append(clarabel.NonnegativeConeT(count))
    if program.levels is not None:
        for sign, bound in ((-1.0, 0.0), (1.0, 1 / program.levels.cell)):
            of_levels = np.zeros((count, unknowns))
            of_levels[:, count : 2 * count] = sign * np.eye(count)
            blocks.append(of_levels)
            right.append(np.full(count, sign * bound))
            cones.append(clarabel.NonnegativeConeT(count))
    if program.steps is not None:
        changes = np.eye(count + 1, count) - np.eye(count + 1, count, -1)
        ends = np.append(np.zeros(count), program.steps.last)
        for sign, most in ((1.0, program.steps.rise), (-1.0, program.steps.fall)):
            blocks.append(np.hstack((sign * changes, np.zeros((count + 1, others)))))
            right.append(most - sign * ends)
            cones.append(clarabel.NonnegativeConeT(count + 1))
    below = np.zeros((bands, CONE_SIZE, unknowns))
    below[:, 0, -1] = -1.0
    first = count + between
    below[:, 1, first:-1], below[:, 2, first:-1] = -combined[:bands], -combined[bands:]
    blocks.append(below.reshape(CONE_SIZE * bands, unknowns))
    offset = np.zeros((bands, CONE_SIZE))
    offset[:, 1], offset[:, 2] = program.offset.real, program.offset.imag
    right.append(offset.ravel())
    cones.extend([clarabel.SecondOrderConeT(CONE_SIZE)] * bands)
    found = run(np.append(np.zeros(unknowns - 1), 1.0), blocks, right, cones)
    duals = found.duals[-CONE_SIZE * bands :].reshape(bands, CONE_SIZE)
    return ConeOutcome(
        status=found.status,
        unknowns=found.unknowns[:count],
        largest=float(found.unknowns[-1]),
        weights=duals[:, 0],
        obstacle=-duals[:, 1] + 1j * duals[:, 2],
        iterations=found.iterations,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ran:
    """What Clarabel answers.

    Attributes
    ----------
    status
        What became of the run.
    unknowns, duals
        Shapes (n,) and (m,).
    iterations
        Iterations of the interior-point method.
    """

    status: Status
    unknowns: FloatArray
    duals: FloatArray
    iterations: int


def run(
    cost: FloatArray,
    blocks: Sequence[FloatArray],
    right: Sequence[FloatArray],
    cones: list[Any],
    *,
    tolerance: float = TOLERANCE,
) -> Ran:
    """Minimise ``cost x`` so that ``right - blocks x`` is in cones.

    Parameters
    ----------
    cost
        Shape (n,).
    blocks, right
        Shapes (m_i, n) and (m_i,).
    cones
        Clarabel's, as long as the blocks in all.
    tolerance
        Of the gap and of the constraints [-].

    Returns
    -------
    Ran
        No claim is made of its exactness.
    """
    import clarabel  # noqa: PLC0415 - where it is used, as all solvers

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1  # programs this small only wait for each other's threads
    settings.time_limit = MAX_RUN_S
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
    none = _Columns(
        data=np.zeros(0),
        indices=np.zeros(0, dtype=np.intp),
        indptr=np.zeros(cost.size + 1, dtype=np.intp),
        shape=(cost.size, cost.size),
    )
    matrix = columns(np.concatenate(blocks))
    found = clarabel.DefaultSolver(
        none, cost, matrix, np.concatenate(right), cones, settings
    ).solve()
    return Ran(
        status=STATUS.get(str(found.status), Status.FAILED),
        unknowns=np.asarray(found.x),
        duals=np.asarray(found.z),
        iterations=int(found.iterations),
    )
