"""The first of the random designs of every kind; `tests.acceptance.random_kinds` runs more."""

import pytest

from design.shapers.registry import SHAPERS
from tests.acceptance.random_kinds import report, verdicts
from tests.random_cases import ROUND

CASES = 800
PARTS = 8


@pytest.mark.parametrize("part", range(PARTS))
def test_random_designs_of_every_kind_are_proven_or_refused_for_a_true_reason(part: int) -> None:
    size = CASES // PARTS
    found = list(verdicts(range(part * size, (part + 1) * size)))
    assert not any(one.wrong for one in found), "\n".join(report(found))
    # Some options ask for what there is not; most do not.
    assert sum(bool(one.refusal) for one in found) <= 0.3 * size


def test_every_kind_of_the_registry_comes_up_in_a_round() -> None:
    assert set(ROUND) == set(SHAPERS)
    assert 8 * len(ROUND) <= CASES
