"""Least squares behind limits: an answer, or no number where Newton's method diverged."""

import numpy as np
import pytest

from design.solvers.least_squares import evened_least_squares, least_squares
from design.solvers.ramps.course import Slopes
from design.solvers.ramps.functionals import Functionals
from design.solvers.ramps.optimality import solve_conditions
from tests.acceptance.random_answers import verdict


def test_the_shortest_of_the_nearest_is_returned() -> None:
    found = least_squares(np.array([[1.0, 1.0], [2.0, 2.0]]), np.array([1.0, 3.0]))
    np.testing.assert_allclose(found, [0.7, 0.7], rtol=1e-14)


def test_rows_and_columns_of_other_sizes_lose_no_digits() -> None:
    # The smallest singular value is 1e-20 of the largest, and none of rounding.
    matrix = np.array([[1e10, 1e-10], [1e10, -1e-10]])
    found = evened_least_squares(matrix, np.array([3.0, 1.0]))
    np.testing.assert_allclose(found, [2e-10, 1e10], rtol=1e-14)


@pytest.mark.parametrize("bad", [np.inf, -np.inf, np.nan])
def test_what_is_not_finite_is_no_error(bad: float) -> None:
    fine, right = np.eye(2), np.ones(2)
    assert np.isnan(least_squares(np.array([[1.0, bad], [0.0, 1.0]]), right)).all()
    assert np.isnan(least_squares(fine, np.array([bad, 1.0]))).all()


def test_switches_so_late_that_modes_overflow_have_no_optimum() -> None:
    functionals = Functionals(np.array([-0.5 + 0.8j] * 2), np.array([0.0, 1.0]))
    switches = np.array([0.0, 1e3, 2e3, 3e3, 4e3])
    found = solve_conditions(
        switches, functionals, np.zeros(2, dtype=np.complex128), Slopes(up=1.0, down=2.0)
    )
    assert found is None


@pytest.mark.parametrize("number", [490, 745, 2507, 2633, 4795])
def test_moves_whose_search_diverges_are_served_or_refused(number: int) -> None:
    assert verdict("moves", number).wrong == ()
