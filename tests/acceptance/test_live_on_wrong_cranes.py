"""The other table of docs/live.md: what commands leave on a crane that is not the one assumed."""

import numpy as np
import pytest

from tests.acceptance.wrong_cranes import TRUTHS, commands, left
from tests.design.live.test_comparison import row_of

ROWS = (
    "unshaped",
    "`zv`, delay line",
    "`numzv`, delay line",
    "`numzvd`, delay line",
    "`numzv`, live",
    "`numzvd`, live",
)


@pytest.mark.parametrize("name", ROWS)
def test_what_is_left_where_the_crane_is_not_as_assumed(name: str) -> None:
    found = [left(name, truth) for truth in TRUTHS]
    shares = [share for one in found for share in (float(np.median(one)), max(one))]
    # To the digits that the page prints.
    assert shares == pytest.approx(row_of(name), rel=0.006, abs=0.006)


@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
def test_live_leaves_at_most_half_of_what_the_delay_line_does(kind: str) -> None:
    for truth in TRUTHS:
        live, line = left(f"`{kind}`, live", truth), left(f"`{kind}`, delay line", truth)
        assert np.median(live) <= np.median(line) / 2
        assert max(live) < max(line)


def test_what_two_plans_in_a_row_command_is_no_step_through_rest_at_once() -> None:
    for one in commands("`numzv`, live"):
        assert np.diff(one.times_s).min() > 1e-9
