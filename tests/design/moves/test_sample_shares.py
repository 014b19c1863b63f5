"""Samples around the steps of a command."""

import numpy as np
import pytest

from design.model.impulses import Impulses
from design.moves.sample_shares import sample_shares

MOVE = Impulses(times_s=np.array([0.0, 0.25, 1.0, 1.27]), amplitudes=np.array([1.0, -1, 1, -1]))


def test_a_step_is_split_between_the_samples_around_it() -> None:
    found = sample_shares(MOVE, 0.1, reach=1, later=0, fix_first=False)
    assert found.numbers.tolist() == [0, 2, 3, 10, 12, 13]
    assert found.split == pytest.approx([1, -0.5, -0.5, 1, -0.3, -0.7])
    assert found.rising.tolist() == [True, False, False, True, False, False]
    assert found.groups.tolist() == [0, 1, 1, 2, 3, 3]
    assert not found.crossed.any()


def test_samples_further_off_belong_to_the_step_nearest() -> None:
    found = sample_shares(MOVE, 0.1, reach=2, later=1, fix_first=False)
    assert found.numbers.tolist() == [0, 1, 2, 3, 4, 9, 10, 11, 12, 13, 14]
    assert found.groups.tolist() == [0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3]


def test_the_first_step_may_be_held_where_it_is() -> None:
    found = sample_shares(MOVE, 0.1, reach=2, later=0, fix_first=True)
    assert found.numbers.tolist() == [0, 2, 3, 4, 9, 10, 11, 12, 13]


def test_steps_that_share_a_sample_are_one_group() -> None:
    command = Impulses(times_s=np.array([0.0, 0.42, 0.47, 1.0]), amplitudes=MOVE.amplitudes)
    found = sample_shares(command, 0.1, reach=1, later=0, fix_first=False)
    assert found.groups.tolist() == [0, 1, 1, 2]
    assert found.totals == pytest.approx([1, 0, -1])
    assert found.crossed.tolist() == [False, True, False]
    assert found.rising.tolist() == [True, False, True, False]
