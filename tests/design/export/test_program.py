"""Numbers as every language of a program writes them."""

import math

import pytest

from design.export.program import decimal
from tests.refusals import refused


@pytest.mark.parametrize("value", [math.inf, -math.inf, math.nan])
def test_a_program_holds_finite_numbers_alone(value: float) -> None:
    with refused("not_finite_in_program", "value"):
        decimal(value)
