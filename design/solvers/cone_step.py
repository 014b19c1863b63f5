"""One step of a search that ends earlier: the end and what is left, linear in the unknowns."""

from dataclasses import dataclass

import numpy as np

from design.solvers import clarabel
from design.solvers.outcome import Status
from design.types import ComplexArray, FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StepProgram:
    """``min end_changes x + price t`` so that ``|vectors_k + changes_k x| <= 1 + t``.

    Beside that ``room + room_changes x >= 0``, ``|x_i| <= radius`` and ``t >= 0``.

    Attributes
    ----------
    end_changes
        Shape (n,).
    vectors, changes
        Shapes (k,) and (k, n), complex.
    room, room_changes
        Shapes (m,) and (m, n).
    radius
        Of the unknowns.
    price
        Of what is above 1.
    """

    end_changes: FloatArray
    vectors: ComplexArray
    changes: ComplexArray
    room: FloatArray
    room_changes: FloatArray
    radius: float
    price: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StepOutcome:
    """How a run ended.

    Attributes
    ----------
    status
        What became of it.
    moves
        x, shape (n,).
    above
        t.
    work
        What the run was [units].
    """

    status: Status
    moves: FloatArray
    above: float
    work: float


def solve_step(program: StepProgram) -> StepOutcome:
    """Solve the program of one step.

    Parameters
    ----------
    program
        The program.

    Returns
    -------
    StepOutcome
        Unknowns and status; no claim is made of its exactness.
    """
    import clarabel as library  # noqa: PLC0415 - where it is used, as all solvers

    (bands, count), radius = program.changes.shape, program.radius
    each = np.eye(count + 1)
    # Of unknowns over the radius, then t.
    bounds = np.concatenate((each[:count], -each))
    rooms = np.pad(-radius * program.room_changes, ((0, 0), (0, 1)))
    within = np.zeros((bands, clarabel.CONE_SIZE, count + 1))
    within[:, 0, -1] = -1.0
    within[:, 1, :count] = -radius * program.changes.real
    within[:, 2, :count] = -radius * program.changes.imag
    offset = np.column_stack((np.ones(bands), program.vectors.real, program.vectors.imag))
    found = clarabel.run(
        np.append(radius * program.end_changes, program.price),
        [bounds, rooms, within.reshape(-1, count + 1)],
        [np.append(np.ones(2 * count), 0.0), program.room, offset.ravel()],
        [
            library.NonnegativeConeT(2 * count + 1 + program.room.size),
            *[library.SecondOrderConeT(clarabel.CONE_SIZE)] * bands,
        ],
    )
    entries = clarabel.CONE_SIZE * bands * (count + 1)
    return StepOutcome(
        status=found.status,
        moves=radius * found.unknowns[:count],
        above=max(float(found.unknowns[-1]), 0.0),
        work=clarabel.PROGRAM_WORK + clarabel.ENTRY_WORK * entries * found.iterations,
    )
