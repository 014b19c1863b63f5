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


def least_violation_of_slopes(
    violable: FloatArray,
    right: FloatArray,
    *,
    cell: float,
    slopes: tuple[float, float],
    jerk: float,
    last: float,
) -> LeastViolation | None:
    """Violate ``violable @ x = right`` as little as possible by slopes.

    The slopes x are those of a course from rest at 0 to rest at ``last`` that stays between 0 and
    1; between two points they change evenly.

    Parameters
    ----------
    violable
        Coefficients of the points between the first and the last, shape (m, n).
    right
        Right side, shape (m,).
    cell
        Distance of two points.
    slopes
        The steepest, up and down, > 0.
    jerk
        The most that a slope changes, over the distance, > 0.
    last
        Level at the end.

    Returns
    -------
    LeastViolation or None
        None where HiGHS says anything but that it is optimal: no such course is as short.
    """
    from scipy.optimize import linprog  # noqa: PLC0415 - takes longer to import than a design
    from scipy.sparse import eye_array, hstack, vstack  # noqa: PLC0415

    count, size = violable.shape
    # Unknown: slopes, levels over the cell at all points but the first, what is violated.
    changes = eye_array(size + 1, size) - eye_array(size + 1, size, k=-1)
    sums = (eye_array(size + 1, size) + eye_array(size + 1, size, k=-1)) / 2
    rises = eye_array(size + 1) - eye_array(size + 1, k=-1)
    slack = eye_array(count)
    equal = vstack([
        hstack([violable, 0 * eye_array(count, size + 1), slack, -slack]),
        hstack([-sums, rises, 0 * eye_array(size + 1, 2 * count)]),
    ])
    bounded = hstack([changes, 0 * eye_array(size + 1, size + 1 + 2 * count)])
    lower = np.zeros(equal.shape[1])
    upper = np.full(lower.size, np.inf)
    lower[:size], upper[:size] = -slopes[1], slopes[0]
    upper[size : 2 * size + 1] = 1 / cell
    lower[2 * size] = upper[2 * size] = last / cell
    found = linprog(
        np.concatenate((np.zeros(2 * size + 1), np.ones(2 * count))),
        A_ub=vstack([bounded, -bounded]).tocsr(),
        b_ub=np.full(2 * size + 2, jerk * cell),
        A_eq=equal.tocsr(),
        b_eq=np.concatenate((right, np.zeros(size + 1))),
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
