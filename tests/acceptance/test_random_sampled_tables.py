"""Random tables on samples as programs: what C and Structured Text play is what was verified."""

from pathlib import Path

import pytest

from tests.played_tables import (
    computed,
    difference,
    played_by_c,
    played_by_text,
    random_request,
    written,
)


@pytest.mark.parametrize("number", range(100))
def test_what_is_played_is_what_was_verified(tmp_path: Path, number: int) -> None:
    table = computed(random_request(number))
    assert difference(table, played_by_c(written(table, "c"), tmp_path)) == ""
    assert difference(table, played_by_text(written(table, "st"))) == ""
