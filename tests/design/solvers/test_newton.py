"""Newton's method on a family of small problems with known roots."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from design.formulations.expressions import Expressions
from design.formulations.unity_magnitude import ZERO_VIBRATION
from design.solvers import near_root, newton


@dataclass(frozen=True)
class Circle:
    """x^2 + y^2 = p, x = y: roots at ±sqrt(p / 2)."""

    def expressions(self) -> Expressions:
        import casadi as ca

        x, p = ca.SX.sym("x", 2), ca.SX.sym("p", 1)
        return Expressions(
            unknowns=x,
            parameters=p,
            objective=ca.sum1(x),
            equations=ca.vertcat(x[0] ** 2 + x[1] ** 2 - p, x[0] - x[1]),
        )


@dataclass(frozen=True)
class Powers:
    """x = p, x y^2 = 8: its Jacobian is not symmetric, and singular where x or y is 0."""

    def expressions(self) -> Expressions:
        import casadi as ca

        x, p = ca.SX.sym("x", 2), ca.SX.sym("p", 1)
        return Expressions(
            unknowns=x,
            parameters=p,
            objective=ca.sum1(x),
            equations=ca.vertcat(x[0] - p, x[0] * x[1] ** 2 - 8),
        )


def test_one_start_ends_at_the_near_root() -> None:
    end = near_root.root(Circle(), np.array([1.1, 0.9]), np.array([2.0]))
    assert end == pytest.approx([1.0, 1.0], abs=1e-12)  # the tolerance asked for


def test_many_starts_end_at_their_own_roots_in_their_order() -> None:
    # 150 starts: two full calls of 64 lanes and a part of one.
    random = np.random.default_rng(5)
    parameters = random.uniform(0.5, 8.0, (150, 1))
    signs = random.choice([-1.0, 1.0], 150)
    starts = signs[:, None] * random.uniform(0.5, 2.0, (150, 2))
    ends = newton.roots(Circle(), starts, parameters)
    expected = signs[:, None] * np.sqrt(parameters / 2)
    assert ends.converged.all()
    assert ends.unknowns == pytest.approx(expected @ np.ones((1, 2)), abs=1e-11)


def test_one_set_of_parameters_serves_all_starts() -> None:
    ends = newton.roots(Circle(), np.array([[3.0, 1.0], [-1.0, -1.5]]), np.array([2.0]))
    assert ends.unknowns == pytest.approx(np.array([[1, 1], [-1, -1]]), abs=1e-11)


def test_an_unsymmetric_jacobian_is_not_transposed() -> None:
    # Newton from (2, 1.9) converges in a few steps only with the right Jacobian.
    ends = newton.roots(Powers(), np.array([[2.3, 1.9]]), np.array([2.0]), iterations=6)
    assert ends.unknowns == pytest.approx(np.array([[2.0, 2.0]]), abs=1e-12)


def test_steps_are_no_longer_than_a_tenth_of_a_period() -> None:
    start = np.array([[100.0, 100.0]])
    ends = newton.roots(Circle(), start, np.array([2.0]), iterations=3)
    assert ends.unknowns == pytest.approx(start - 3 * newton.MAX_STEP_RAD, rel=1e-12)
    assert not ends.converged.any()


def test_starts_without_a_root_are_told_by_their_miss() -> None:
    ends = newton.roots(Circle(), np.array([[1.0, 1.0]]), np.array([-1.0]))
    x, y = ends.unknowns[0]
    assert not ends.converged[0]
    assert ends.misses[0] >= max(0.5, abs(x * x + y * y + 1) - 1e-12)


def test_a_singular_start_does_not_stop_the_others() -> None:
    ends = newton.roots(Powers(), np.array([[0.0, 0.0], [1.5, 1.5]]), np.array([2.0]))
    assert ends.converged[1]
    assert ends.unknowns[1] == pytest.approx([2.0, 2.0], abs=1e-12)


def test_a_root_given_is_kept() -> None:
    ends = newton.roots(Powers(), np.array([[2.0, 2.0]]), np.array([2.0]))
    assert ends.unknowns.tolist() == [[2.0, 2.0]]
    assert ends.misses.tolist() == [0]


def test_both_ways_find_the_undamped_umzv() -> None:
    parameters = np.zeros(5)
    start = np.array([1.0, 1.1])
    one = near_root.root(ZERO_VIBRATION, start, parameters)
    many = newton.roots(ZERO_VIBRATION, start[None], parameters)
    assert one == pytest.approx([math.pi / 3, math.pi / 3], abs=1e-12)
    assert many.unknowns[0] == pytest.approx(one, abs=1e-12)


def test_starts_and_parameters_of_the_caller_are_left_alone() -> None:
    starts, parameters = np.array([[3.0, 1.0]]), np.array([2.0])
    newton.roots(Circle(), starts, parameters)
    near_root.root(Circle(), starts[0], parameters)
    assert starts.tolist() == [[3.0, 1.0]]
    assert parameters.tolist() == [2.0]


@dataclass(frozen=True)
class Cancelled:
    """x = p, -1e-14 y^2 = 0: where y is 1/2 the hair on the diagonal makes a zero of it."""

    def expressions(self) -> Expressions:
        import casadi as ca

        x, p = ca.SX.sym("x", 2), ca.SX.sym("p", 1)
        return Expressions(
            unknowns=x,
            parameters=p,
            objective=ca.sum1(x),
            equations=ca.vertcat(x[0] - p, -1e-14 * x[1] ** 2),
        )


def test_a_lane_that_is_singular_to_the_last_digit_stops_no_other() -> None:
    starts = np.array([[1.6, 0.5], [1.5, 2.0]])
    ends = newton.roots(Cancelled(), starts, np.array([1.0]))
    assert ends.converged.all()
    assert ends.unknowns[:, 0] == pytest.approx([1.0, 1.0], abs=1e-12)
