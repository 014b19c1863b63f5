"""Behind limits and any lag, designs and moves keep what they promise by another route."""

import pytest

from tests.acceptance.random_drives import draw, faults_of_design, faults_of_move


@pytest.mark.parametrize("number", range(12))
def test_a_random_drive_is_served(number: int) -> None:
    assert faults_of_design(draw(number)) == []
    assert faults_of_move(draw(number)) == []
