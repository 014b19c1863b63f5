"""Balls hold every value, and errors every error: at random points of random balls."""

from collections.abc import Callable

import numpy as np
import pytest

from design.tables.proven_bound.balls import Ball, Number, either_root, exp, mean_decay, sqrt
from design.types import ComplexArray

CASES = 20_000

FORMULAS: dict[str, Callable[[Number, Number], Number]] = {
    "sum": lambda x, y: x + y,
    "difference": lambda x, y: 1.5 - x - y,
    "product": lambda x, y: x * y,
    "quotient": lambda x, y: x / y,
    "inverse": lambda x, y: 2 / x + y,
    "exponential": lambda x, y: exp(-x * y),
    "root": lambda x, y: sqrt(x) * y,
    "even in a root": lambda x, y: mean_decay(2 * either_root(x)) * exp(either_root(x)) - y,
    "mean": lambda x, y: mean_decay(x) - y,
    "one of itself": lambda x, y: x / (1 + x * (y + x * y)),
}


def within(random: np.random.Generator, size: int) -> ComplexArray:
    """Return points of the unit disk, many of them on its edge."""
    far = np.where(random.random(size) < 0.5, 1.0, random.random(size))
    found: ComplexArray = far * np.exp(2j * np.pi * random.random(size))
    return found


def ball(random: np.random.Generator) -> tuple[Ball, ComplexArray, ComplexArray]:
    """Return balls of all sizes, a value of each, and that value as it may be found."""
    centre = random.lognormal(0, 1.5, CASES) * np.exp(2j * np.pi * random.random(CASES))
    centre[::50] = 0
    radius = random.lognormal(-3, 3, CASES) * (random.random(CASES) < 0.9)
    error = random.lognormal(-12, 6, CASES) * (random.random(CASES) < 0.9)
    value = centre + radius * within(random, CASES)
    return Ball(centre, radius, error), value, value + error * within(random, CASES)


@pytest.mark.parametrize("which", FORMULAS)
def test_a_ball_holds_what_is_found_from_any_of_its_values(which: str) -> None:
    formula, random = FORMULAS[which], np.random.default_rng(51)
    (one, x, x_off), (other, y, y_off) = ball(random), ball(random)
    with np.errstate(all="ignore"):
        made, exact, off = formula(one, other), formula(x, y), formula(x_off, y_off)
    known = np.isfinite(made.radius)
    # The plain values that are compared with are themselves rounded.
    exact, off = exact[known], off[known]
    rounding = 1e-13 * np.abs(exact)
    assert np.all(np.abs(exact - made.centre[known]) <= made.radius[known] + rounding)
    assert np.all(np.abs(off - exact) <= made.error[known] + 2 * rounding)
    # Where it holds all numbers it says so, and that is not everywhere.
    assert known.mean() > 0.25
    assert np.all(np.isinf(made.error[~known]))


def test_balls_are_not_much_larger_than_what_they_hold() -> None:
    random = np.random.default_rng(52)
    centre = 1 + 0.3 * within(random, CASES)
    radius = np.full(CASES, 1e-4)
    small = Ball(centre, radius, np.zeros(CASES))
    for which, formula in FORMULAS.items():
        made = formula(small, Ball.of(np.full(CASES, 0.7)))
        moved = formula(centre + 1e-4, np.full(CASES, 0.7)) - formula(centre, np.full(CASES, 0.7))
        # Of what stands twice in a formula each may move, and nothing cancels.
        several = which in {"even in a root", "one of itself"}
        assert np.median(made.radius / np.abs(moved)) < (50 if several else 3), which


def test_nothing_is_known_of_a_quotient_by_zero_and_of_a_root_beyond_it() -> None:
    around = Ball(np.array([0.1 + 0j, 0.1]), np.array([0.2, 0.05]), np.zeros(2))
    for made in (1 / around, sqrt(around), 1 / sqrt(around)):
        assert np.isinf(made.radius).tolist() == [True, False]
    huge = exp(exp(Ball(np.array([800.0 + 0j, 1.0]), np.zeros(2), np.zeros(2))))
    assert np.isinf(huge.radius).tolist() == [True, False]


def test_a_root_about_zero_serves_functions_that_are_even_in_it() -> None:
    random = np.random.default_rng(53)
    size = 0.3 * random.random(CASES)
    values = Ball(0.3 * within(random, CASES), size, np.zeros(CASES))
    points = values.centre + size * within(random, CASES)
    root = either_root(values)
    made = exp(-root) + exp(root)
    exact = 2 * np.cosh(np.sqrt(points))
    assert np.all(np.abs(exact - made.centre) <= made.radius + 1e-14)
    assert np.isfinite(made.radius).all()
