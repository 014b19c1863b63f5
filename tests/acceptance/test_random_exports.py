"""The first of the random exports; `python -m tests.acceptance.random_exports` runs more."""

from collections import Counter
from pathlib import Path

import pytest

from tests.acceptance.random_exports import (
    BINARY,
    FORMATS,
    MUTABLE,
    MUTATIONS,
    Written,
    _spans,
    miss,
    verdict,
)

EXPORTS_TRIED = 64


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> list[Written]:
    folder = tmp_path_factory.mktemp("exports")
    found = [verdict(number, folder) for number in range(EXPORTS_TRIED)]
    assert not [one.wrong for one in found if one.wrong]
    return [one.written for one in found if one.written is not None]


def test_random_designs_are_read_back_or_refused_by_name(written: list[Written]) -> None:
    counts = Counter(one.name for one in written)
    assert set(counts) == set(FORMATS)
    assert len(written) >= EXPORTS_TRIED / 2


def test_a_digit_or_a_sign_that_is_changed_is_found(written: list[Written], tmp_path: Path) -> None:
    assert list(miss(written, MUTATIONS, tmp_path)) == []


def test_every_number_of_a_file_may_be_the_one_that_is_changed(written: list[Written]) -> None:
    for one in written:
        if one.name in BINARY:
            continue
        impulses = one.made.impulses.times_s.size
        least = {"klipper": 4, "marlin": 2, "rrf": 4 * (impulses - 1)}
        assert len(_spans(one)) >= least.get(one.name, 2 * impulses), one.name
    assert set(MUTABLE) == set(FORMATS)
