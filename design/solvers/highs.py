"""Linear programs by HiGHS, as SciPy has it."""

from dataclasses import dataclass

import numpy as np

from design.types import FloatArray

SOLVED = 0
"""SciPy's word for an optimum."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LeastViolation:
    """The end of one linear program.

    Attributes
    ----------
    violation
        Sum of what the violable equations are off by, the least possible.
    unknowns
        Where, shape (n,).
    multipliers
        Change of the violation with the right side of each violable equation, shape (m,).
    """

    violation: float
    unknowns: FloatArray
    multipliers: FloatArray


def least_violation(
    violable: FloatArray, right: FloatArray, *, sum_to_one: bool
) -> LeastViolation | None:
    """Violate ``violable @ x = right`` as little as possible, ``x >= 0``.

    Parameters
    ----------
    violable
        Coefficients, shape (m, n).
    right
        Right side, shape (m,).
    sum_to_one
        Whether x sums to 1; else no x is above 1.

    Returns
    -------
    LeastViolation or None
        None where HiGHS says anything but that it is optimal.
    """
    from scipy.optimize import linprog  # noqa: PLC0415 - takes longer to import than a design

    count, size = violable.shape
    slack = np.eye(count)
    matrix = np.hstack((violable, slack, -slack))
    sides = right
    if sum_to_one:
        total = np.concatenate((np.ones(size), np.zeros(2 * count)))
        matrix, sides = np.vstack((matrix, total)), np.append(right, 1.0)
    upper = np.full(size + 2 * count, np.inf)
    if not sum_to_one:
        upper[:size] = 1.0
    found = linprog(
        np.concatenate((np.zeros(size), np.ones(2 * count))),
        A_eq=matrix,
        b_eq=sides,
        bounds=np.column_stack((np.zeros(upper.size), upper)),
        method="highs-ds",
    )
    if found.status != SOLVED:
        return None
    return LeastViolation(
        violation=float(found.fun),
        unknowns=found.x[:size],
        multipliers=found.eqlin.marginals[:count],
    )


def least_violation_of_course(
    violable: FloatArray, right: FloatArray, *, rise: float, fall: float, last: float
) -> LeastViolation | None:
    """Violate ``violable @ x = right`` as little as possible by a course.

    The course x begins at 0.
    ``0 <= x <= 1``, and x rises and falls from one point to the next by no more than it may.

    Parameters
    ----------
    violable
        Coefficients of the points after the first, shape (m, n).
    right
        Right side, shape (m,).
    rise, fall
        The most that x rises and falls from one point to the next, > 0.
    last
        Value of x at the last point.

    Returns
    -------
    LeastViolation or None
        None where HiGHS says anything but that it is optimal: no such course is as short.
    """
    from scipy.optimize import linprog  # noqa: PLC0415 - takes longer to import than a design
    from scipy.sparse import coo_array  # noqa: PLC0415

    count, size = violable.shape
    slack = np.eye(count)
    matrix = np.hstack((violable, slack, -slack))
    # x_k - x_(k-1), up and down; x_(-1) is 0.
    here, before = np.arange(size), np.arange(1, size)
    rows = np.concatenate((here, before))
    columns = np.concatenate((here, before - 1))
    steps = np.concatenate((np.ones(size), -np.ones(size - 1)))
    changes = coo_array(
        (
            np.concatenate((steps, -steps)),
            (np.concatenate((rows, rows + size)), np.concatenate((columns, columns))),
        ),
        shape=(2 * size, size + 2 * count),
    )
    lower, upper = np.zeros(size + 2 * count), np.full(size + 2 * count, np.inf)
    upper[:size] = 1.0
    lower[size - 1] = upper[size - 1] = last
    found = linprog(
        np.concatenate((np.zeros(size), np.ones(2 * count))),
        A_ub=changes.tocsr(),
        b_ub=np.concatenate((np.full(size, rise), np.full(size, fall))),
        A_eq=matrix,
        b_eq=right,
        bounds=np.column_stack((lower, upper)),
        method="highs-ds",
    )
    if found.status != SOLVED:
        return None
    return LeastViolation(
        violation=float(found.fun),
        unknowns=found.x[:size],
        multipliers=found.eqlin.marginals[:count],
    )
