"""The first of the random plants of several modes; `tests.acceptance.random_modes` runs more."""

import pytest

from design.model.actuators.model import Model
from tests.acceptance.random_modes import MODELS, solved, too_slow, wrong

PAIRS, TRIPLES = 40, 10

COMPARED, STARTS = 2, 60
"""Pairs and starts of the comparison: one start takes 30 ms."""


@pytest.mark.parametrize("model", MODELS)
def test_random_plants_are_solved_and_nothing_is_left(model: Model) -> None:
    for count, modes in ((PAIRS, 2), (TRIPLES, 3)):
        found = [case for case in solved(count, modes, model) if case.times_s.size]
        assert len(found) >= 0.95 * count
        assert not any(map(wrong, found))


@pytest.mark.parametrize("model", MODELS)
def test_no_start_of_least_squares_leads_to_faster_steps(model: Model) -> None:
    assert not any(too_slow(case, STARTS) for case in solved(COMPARED, 2, model, seed=2))
