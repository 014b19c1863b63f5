"""What a proof excludes, and no more."""

import math

import numpy as np

from design.analysis.exclusion import excludes


def test_an_obstacle_excludes_what_it_should_and_no_more() -> None:
    # Undamped, one frequency, V -> 0: p = cos u stays above 0 until a quarter period.
    one, along = np.array([1.0]), np.array([1.0 + 0j])
    assert excludes(1j * one, along, 1.4, 0.1, None)
    assert not excludes(1j * one, along, 1.5, 0.1, None)
    # cos u = 0.1 at 1.4706: the bound is exact there.
    edge = math.acos(0.1)
    assert excludes(1j * one, along, edge * (1 - 1e-10), 0.1, None)
    assert not excludes(1j * one, along, edge * (1 + 1e-10), 0.1, None)
    # Commands in [0, 1]: p(0) - fall = cos D on the way down, too; in [0, 2] twice the fall.
    assert excludes(1j * one, along, edge * (1 - 1e-10), 0.1, (0.0, 1.0))
    assert not excludes(1j * one, along, edge * (1 + 1e-10), 0.1, (0.0, 1.0))
    twice = math.acos(0.55)
    assert excludes(1j * one, along, twice * (1 - 1e-10), 0.1, (0.0, 2.0))
    assert not excludes(1j * one, along, twice * (1 + 1e-10), 0.1, (0.0, 2.0))
