"""Behind limits and two lags, no command of a random start ends earlier than the design."""

import pytest

from tests.acceptance.random_ramps import GAIN, tried


@pytest.mark.parametrize("number", range(6))
def test_no_random_start_ends_earlier(number: int) -> None:
    gain, solved = tried(number, 12)
    assert solved > 0
    assert gain < GAIN
