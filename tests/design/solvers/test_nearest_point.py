"""Nearest points of polyhedra: known ones, optimality, and sets that are empty."""

import numpy as np
import pytest

from design.solvers.nearest_point import Polyhedron, nearest_point
from design.types import FloatArray


def simplex(size: int) -> Polyhedron:
    return Polyhedron(
        equations=np.ones((1, size)), wanted=np.ones(1), bounds=np.eye(size), least=np.zeros(size)
    )


def test_a_point_of_the_polyhedron_is_its_own() -> None:
    inside = np.array([0.2, 0.5, 0.3])
    assert nearest_point(inside, simplex(3)) == pytest.approx(inside, abs=1e-15)


def test_the_nearest_of_a_simplex_is_a_shift_cut_at_zero() -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        start = rng.normal(size=12)
        ordered = np.sort(start)[::-1]
        shifts = (np.cumsum(ordered) - 1) / np.arange(1, 13)
        shift = shifts[np.flatnonzero(ordered > shifts)[-1]]
        found = nearest_point(start, simplex(12))
        assert found == pytest.approx(np.maximum(start - shift, 0), abs=1e-13)


def test_no_feasible_point_is_nearer() -> None:
    rng = np.random.default_rng(1)
    for _ in range(100):
        size = int(rng.integers(4, 20))
        known = rng.random(size) * (rng.random(size) < 0.6)
        rows = rng.normal(size=(int(rng.integers(1, 4)), size))
        levels = np.tril(np.ones((size, size)))
        within = Polyhedron(
            equations=rows,
            wanted=rows @ known,
            bounds=np.concatenate((np.eye(size), -levels)),
            least=np.concatenate((np.zeros(size), -levels @ known - 0.1)),
        )
        start = rng.normal(size=size)
        found = nearest_point(start, within)
        assert found is not None
        assert rows @ found == pytest.approx(rows @ known, abs=1e-11)
        assert (within.bounds @ found - within.least).min() > -1e-10
        # Of a convex set: no way from the nearest point into the set has a part toward the start.
        for other in _others(rng, found, known):
            assert (start - found) @ (other - found) <= 1e-9


def _others(rng: np.random.Generator, found: FloatArray, known: FloatArray) -> list[FloatArray]:
    return [found + share * (known - found) for share in rng.random(3)]


@pytest.mark.parametrize(
    "within",
    [
        Polyhedron(
            equations=np.ones((1, 2)), wanted=-np.ones(1), bounds=np.eye(2), least=np.zeros(2)
        ),
        Polyhedron(
            equations=np.ones((2, 2)),
            wanted=np.array([0.0, 1.0]),
            bounds=np.eye(2),
            least=np.zeros(2),
        ),
    ],
    ids=["bounds", "equations"],
)
def test_an_empty_polyhedron_has_none(within: Polyhedron) -> None:
    assert nearest_point(np.zeros(2), within) is None
