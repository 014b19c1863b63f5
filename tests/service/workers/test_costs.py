"""What work is expected to cost."""

import pytest

from service.workers.costs import FIRST_GUESS_S, MAX_SHAPES, SLICE_S, Costs


def test_costs_are_learned_and_forgotten() -> None:
    costs = Costs()
    assert costs.of("a", "new") == FIRST_GUESS_S
    for _ in range(50):
        costs.record("a", "slow", 20.0)
        costs.record("a", "quick", 0.002)
    assert costs.of("b", "slow") == pytest.approx(20.0)
    assert costs.of("b", "quick") == pytest.approx(0.002)
    assert costs.of("b", "new") == pytest.approx(0.002, rel=0.01)
    for number in range(MAX_SHAPES):
        costs.record("a", number, 1.0)
    assert costs.of("b", "slow") == costs.of("b", "new")


def test_what_runs_long_is_expected_of_its_client_alone_and_unlearned() -> None:
    costs = Costs()
    for _ in range(20):
        costs.record("a", "map", 0.002)
    costs.at_least("a", "map", 3.0)
    costs.record("a", "map", 20.0)
    assert costs.of("a", "map") > SLICE_S
    assert costs.of("b", "map") < SLICE_S
    for _ in range(20):
        costs.record("a", "map", 0.002)
    assert costs.of("a", "map") < 0.01


def test_what_waits_for_something_makes_no_machine_slow() -> None:
    costs = Costs()
    for number in range(100):
        costs.took(5.0 if number % 25 == 0 else 0.004, 0.003)
    for _ in range(20):
        costs.took(0.004, 0.003)
    assert costs.slowness < 3.0
